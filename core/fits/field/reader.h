/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/field/reader.h: what lies behind a shear_field: a field file, its parts, or an exposure.
 *
 * Plan, run, service and catalogs know shear_field only. Each kind of source embeds it as its first
 * member, and supplies these functions. */
#pragma once

#include "shear/field.h"

typedef struct field_reader {
    /* Read pairs [first, first + count), which exist, into the block, which has room for them. */
    int (*read)(shear_field *field, int64_t first, int count, shear_block *block, shear_error *err);
    /* Read all but pixels: the columns, and the numbers of PSFs that are models. */
    int (*read_columns)(shear_field *field, int64_t first, int count, shear_block *block,
                        shear_error *err);
    /* Read PSF image `index`, which exists. NULL: the PSFs are models. */
    int (*read_psf)(shear_field *field, int64_t index, double *out, shear_error *err);
    /* Close and free it. */
    void (*close)(shear_field *field);
} field_reader;

struct shear_field {
    const field_reader *reader;
    shear_field_info info;
    shear_psf_model *models; /* [info.n_models]; owned by the reader */
};

/* Open a field file, or parts: shear_field_open_input() of those inputs. */
int field_file_open(shear_field **field, const shear_input *input, const int *fds,
                    shear_error *err);
