/* SPDX-License-Identifier: GPL-3.0-or-later */
/* run/file_source.h: an open field file as a source of stamps, with one block per slot. */
#pragma once

#include "shear/work.h"

typedef struct file_source {
    shear_field *field;
    shear_block **blocks; /* [slots], owned */
    int slots;
} file_source;

/* Allocate blocks of `capacity` stamps. SHEAR_E_NOMEM. Call file_source_deinit after an error,
 * too. */
int file_source_init(file_source *s, shear_field *field, int slots, int capacity, shear_error *err);
void file_source_deinit(file_source *s);

/* Return the source for a shear_work_spec. It points to *s, which must not move. */
shear_source file_source_as_source(file_source *s);
