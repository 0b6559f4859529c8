/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/field/internal.h: the members of an open field file. */
#pragma once

#include "fits/carry/carry_rows.h"
#include "fits/field/columns.h"
#include "fits/field/parts.h"
#include "fits/field/reader.h"
#include "fits/field/stamps.h"

typedef struct field_file {
    shear_field base; /* the first member: a shear_field is one of these */
    sf_parts parts;
    sf_stamps galaxy, noise;
    sf_image psf;
    sf_columns catalog;
    carry_list carried; /* other columns of the catalog */
    carry_rows carried_rows;
    double *samples; /* of all PSF models; NULL: PSFs are images */
} field_file;

static inline field_file *field_file_of(shear_field *field) {
    return (field_file *)field;
}

/* Read a block, and its columns alone: functions of a field_reader. */
int field_file_read_columns(shear_field *field, int64_t first, int count, shear_block *block,
                            shear_error *err);
int field_file_read(shear_field *field, int64_t first, int count, shear_block *block,
                    shear_error *err);
