/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/field/internal.h: the members of an open field file. */
#pragma once

#include "fits/field/columns.h"
#include "fits/field/parts.h"
#include "fits/field/stamps.h"

enum { SF_PSF_MIN_SIDE = 3, SF_PSF_MAX_SIDE = 4096, SF_MAX_OVERSAMPLE = 64 };

struct shear_field {
    sf_parts parts;
    shear_field_info info;
    sf_stamps galaxy, noise;
    sf_image psf;
    sf_columns catalog;
};

/* Read FIELD, PIXSCALE, SIM_G1, SIM_G2 of the galaxies' file into f->info (keys.c). */
int sf_field_read_keys(shear_field *f, const sf_cards *primary, shear_error *err);
/* Open the PSF's HDU and set its shape, number and OVERSAMP in f->info (psf.c). The catalog must be
 * open. */
int sf_field_open_psf(shear_field *f, shear_error *err);
