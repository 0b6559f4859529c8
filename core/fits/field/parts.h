/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/field/parts.h: the files that a field consists of, and the HDU of each part. */
#pragma once

#include "fits/header/file.h"
#include "shear/input.h"

#include <sys/stat.h>

typedef struct sf_part {
    const sf_file *file; /* one of the files below */
    const sf_hdu *hdu;   /* in that file's index; NULL: this part is absent */
    char label[SF_NAME]; /* of the HDU, for messages */
} sf_part;

typedef struct sf_parts {
    sf_file files[SHEAR_N_PARTS]; /* [n_files]: a file that holds several parts is opened once */
    struct stat stats[SHEAR_N_PARTS];
    int n_files;
    sf_part of[SHEAR_N_PARTS];
} sf_parts;

/* Open the files (fds: see shear_field_open_input) and choose the HDUs. *p must not move: the parts
 * point into it. SHEAR_E_IO, SHEAR_E_FORMAT. Call sf_parts_deinit after an error, too. */
int sf_parts_init(sf_parts *p, const shear_input *input, const int *fds, shear_error *err);
void sf_parts_deinit(sf_parts *p);

/* Return SHEAR_E_FORMAT if the part is absent. */
int sf_part_require(const sf_part *part, shear_error *err);

/* Return whether the parts are those of one field file. */
bool sf_parts_are_whole(const sf_parts *p);
