/* SPDX-License-Identifier: GPL-3.0-or-later */
/* run/file_source.h: an open field file as a source of stamps: a block for every slot. */
#ifndef SHEAR_RUN_FILE_SOURCE_H
#define SHEAR_RUN_FILE_SOURCE_H

#include "shear/work.h"

typedef struct file_source {
    shear_field *field;
    shear_block **blocks; /* [slots] */
    int slots;
} file_source;

/* Blocks of `capacity` stamps. Deinit it, also after an error. SHEAR_E_NOMEM. */
int file_source_init(file_source *s, shear_field *field, int slots, int capacity, shear_error *err);
void file_source_deinit(file_source *s);

/* As libshear's work wants it; *s stays where it is. */
shear_source file_source_as_source(file_source *s);

#endif
