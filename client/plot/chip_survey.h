/* SPDX-License-Identifier: GPL-3.0-or-later */
/* chip_survey.h: what is drawn of a chip of an exposure: its pixels, its galaxies, its PSF. */
#pragma once

#include "shear/chip.h"
#include "shear/plan.h"

enum { CHIP_PSFS = 7, CHIP_SIDE = 1100 }; /* PSFs along the longer side; most pixels of a side */

/* A galaxy of the chip. */
typedef struct chip_galaxy {
    shear_chip_place place;
    unsigned flags; /* enum shear_flag, by pixels, catalog and chip */
} chip_galaxy;

/* The PSF at a galaxy: second moments, square pixels. */
typedef struct chip_psf {
    double x, y;
    double cov[3];    /* xx, xy, yy */
    double fwhm;      /* of the Gaussian, pixels */
    double e1, e2, e; /* (a - b) / (a + b) of its axes, with direction */
} chip_psf;

typedef struct chip_survey {
    int number;
    shear_chip chip;
    int nx, ny, bin; /* of the picture; pixels of the chip along a side of one of its pixels */
    double *pixels;  /* [ny][nx] means of the good pixels; NaN: bad */
    chip_galaxy *galaxies; /* [chip.n_stamps] */
    chip_psf psfs[CHIP_PSFS * CHIP_PSFS];
    int n_psfs;
    double bad;         /* part of the chip's pixels that are */
    double jacobian[4]; /* near its middle; NaN: no WCS */
} chip_survey;

/* Find the chip that `name` means: its EXTNAME, in any case, else its number from 1; NULL: the
 * first one. SHEAR_E_SETTING: there is none; the advice lists some. */
int chip_survey_find(const shear_field *field, const char *name, int *chip, shear_error *err);
/* Survey a chip. Flags are those of a measurement with this plan. Call chip_survey_deinit after an
 * error, too. */
int chip_survey_init(chip_survey *s, shear_field *field, int chip, const shear_plan *plan,
                     shear_error *err);
void chip_survey_deinit(chip_survey *s);
