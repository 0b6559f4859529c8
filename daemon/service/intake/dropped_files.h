/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/intake/dropped_files.h: submit files of the watch folder as jobs, with their spool key as
 * idempotency key. */
#pragma once

#include "shear/error.h"

typedef struct service service;

/* Open the watch folder, unless it is switched off. Errors of spool_open. */
int dropped_files_open(service *s, shear_error *err);
