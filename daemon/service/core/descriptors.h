/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/core/descriptors.h: clients may not use up the file descriptors that the service itself
 * needs for its files, its jobs and its administrators. */
#ifndef SHEARD_SERVICE_DESCRIPTORS_H
#define SHEARD_SERVICE_DESCRIPTORS_H

#include "sheard/config.h"

/* Have as many as this configuration needs, or as the hard limit allows: then it is logged that
 * they are not enough. */
void descriptors_raise(const sheard_config *config);

/* [limits] connections, or those of them that there are descriptors for. */
int64_t descriptors_connections(const sheard_config *config);

#endif
