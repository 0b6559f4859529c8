/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/core/descriptors.h: keep enough file descriptors for the service's own files, jobs and
 * administrators, whatever clients use. */
#pragma once

#include "sheard/config.h"

/* Raise the limit of file descriptors to what this configuration needs, or to the hard limit; log a
 * warning if that is not enough. */
void descriptors_raise(const sheard_config *config);

/* Return [limits] connections, or as many as there are descriptors for. */
int64_t descriptors_connections(const sheard_config *config);
