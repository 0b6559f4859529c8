/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/psf/places.h: where images of a PSF were taken: pixels, or positions on the sky. */
#pragma once

#include "survey/psf/internal.h"
#include "survey/psf/record.h"

typedef struct psf_places {
    int n;
    bool sky;   /* RA and Dec, degrees; else x and y, pixels from 1 */
    double *at; /* [n][2]; owned */
} psf_places;

/* Find the columns X and Y (or X_IMAGE, ...), else RA and DEC (or ALPHA_J2000, ...); NULL if there
 * are none. SHEAR_E_FORMAT: only one of two. */
int psf_places_find(const psf_record *r, const sf_column *columns[2], bool *sky, shear_error *err);
/* Read n places: a row each, or cells of n numbers. SHEAR_E_FORMAT: there are no columns, or not n
 * numbers, or one is not finite. Call psf_places_deinit after an error, too. */
int psf_places_init(psf_places *p, const psf_record *r, int n, shear_error *err);
void psf_places_deinit(psf_places *p);

/* Set the variables of c, and put the places in them: x and y, or u and v about the middle of the
 * places; `zero` and `scale` are such that a polynomial has values from -1 to 1 there. */
void psf_places_set_variables(psf_places *p, psf_chip *c);
