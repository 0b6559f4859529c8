/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/intake/dropped_files.h: files of the watch folder are taken as jobs, with their key as
 * idempotency key. */
#ifndef SHEARD_SERVICE_DROPPED_FILES_H
#define SHEARD_SERVICE_DROPPED_FILES_H

#include "shear/error.h"

typedef struct service service;

/* Open the watch folder, if there is to be one. Errors of spool_open. */
int dropped_files_open(service *s, shear_error *err);

#endif
