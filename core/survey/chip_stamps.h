/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/chip_stamps.h: the galaxies of one chip that are to be measured: their places in pixels
 * and on the sky, Jacobians, and coefficients of the PSF. */
#pragma once

#include "survey/contexts.h"
#include "survey/pixels/chip_pixels.h"
#include "survey/psf/psf_models.h"
#include "survey/sources/source_list.h"
#include "survey/wcs/sky_distortion.h"
#include "survey/wcs/sky_map.h"

/* Arrays of [n]. */
typedef struct chip_stamps {
    int64_t n;
    int64_t *id;
    int64_t *row;     /* in the catalog's table, from 0 */
    double *x, *y;    /* pixels, from 1 */
    double *ra, *dec; /* degrees; NaN without a sky map */
    double *weight;   /* NULL if the catalog has none, like r_gal */
    double *r_gal;
    bool r_gal_measured;   /* 2 FLUX_RADIUS, the PSF included */
    double star_radius;    /* FLUX_RADIUS of the stars that are left out; NaN: unknown */
    double r_light;        /* their median then, else NaN: chip_stamps_light() */
    double (*jacobian)[4]; /* NaN without a sky map */
    double *psf_terms;     /* [n][terms] */
    uint32_t *flags;       /* enum shear_flag: no place, no PSF there */
    int terms;
    object_shape *shapes; /* [n_shapes] of all sources of the catalog, measured or not; b is NaN
                             where no ellipse is known, and a is r_gal, or 0 */
    int64_t n_shapes;
    int64_t n_sources; /* of the catalog that are on the chip, measured or not */
    void *memory;      /* of all arrays; owned */
} chip_stamps;

/* What a chip's stamps are made from. */
typedef struct chip_inputs {
    source_list *sources;
    sky_map *map; /* NULL: the image has no WCS */
    const psf_models *psf;
    const contexts *contexts;
    int model;
    int nx, ny;       /* of the chip */
    bool only_inside; /* the catalog covers more than this chip: leave out what is not on it */
} chip_inputs;

/* Make the stamps. SHEAR_E_NOMEM. Call chip_stamps_deinit after an error, too. */
int chip_stamps_init(chip_stamps *s, const chip_inputs *in, shear_error *err);
/* Give the sources without an ellipse a circle that holds the light of a galaxy of r_gal. */
void chip_stamps_size_shapes(chip_stamps *s, double r_psf_px);
/* Return the r_gal by which galaxy i's light is held off bad pixels and neighbours: its own if the
 * catalog gives R_GAL itself. FLUX_RADIUS grows with the ellipticity, and with it the chance to be
 * left out, which would make the shear of those that are kept too small: there it is one for all.
 */
double chip_stamps_light(const chip_stamps *s, int64_t i);
/* Find the r_gal below which this part of the galaxies is; NaN: unknown. False: out of memory. */
bool chip_stamps_quantile(const chip_stamps *s, double part, double *r_gal);
void chip_stamps_deinit(chip_stamps *s);
