/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/internal.h: the members of an open exposure. */
#pragma once

#include "fits/field/reader.h"
#include "survey/chip_stamps.h"
#include "survey/cutout/cutter.h"
#include "survey/near_chip.h"

/* A chip, as far as it is known without its pixels. */
typedef struct exposure_chip {
    chip_stamps stamps;
    carry_rows carried;
    int64_t first; /* number of its first stamp */
    int table;     /* of the catalog */
    int model;     /* of the PSF */
    bool mapped;   /* there is a map to the sky */
    int noise;     /* number of its noise image */
    near_chip sky; /* of a catalog that serves several chips; else NaN */
} exposure_chip;

/* The chip whose pixels are held. */
typedef struct held_chip {
    chip_pixels *pixels;
    chip_pixels *noise; /* of the noise image; NULL: there is none */
    cutter *cutter;
    int chip; /* -1: none */
} held_chip;

typedef struct exposure {
    shear_field base; /* the first member: a shear_field is one of these */
    shear_exposure options;
    exposure_images *images, *noise_images; /* the second: of SHEAR_NOISE_IMAGE */
    psf_models *psf;
    source_catalog *catalog;
    carry_list carried;   /* columns of the catalog */
    exposure_chip *chips; /* [n_chips] */
    int n_chips;
    held_chip held;
} exposure;

/* Return whether the field is an exposure. */
bool exposure_is(const shear_field *field);

static inline exposure *exposure_of(shear_field *field) {
    return (exposure *)field;
}

/* Read a block, and its columns alone: functions of a field_reader. */
int exposure_read_columns(shear_field *field, int64_t first, int count, shear_block *block,
                          shear_error *err);
int exposure_read(shear_field *field, int64_t first, int count, shear_block *block,
                  shear_error *err);
/* Return the chip of a stamp. */
int exposure_find_chip(const exposure *e, int64_t stamp);
/* Hold the pixels of a chip, in place of those of another. */
int exposure_hold(exposure *e, int chip, shear_error *err);
/* Cut stamp `i` of a chip. */
int exposure_cut(exposure *e, int chip, int64_t i, cutter_pair *pair, shear_error *err);
/* Return the number on a chip of the stamp nearest to its middle that has a PSF; -1: none has. */
int64_t exposure_middle_stamp(const exposure *e, int chip);
/* Compute R_PSF at that stamp, pixels. SHEAR_E_PSF: no stamp of it
 * has a PSF; SHEAR_E_NOMEM; *r is unchanged then. */
int exposure_r_psf(const exposure *e, int chip, double *r);
/* Free the pixels of the chip that is held. */
void exposure_let_go(held_chip *h);
