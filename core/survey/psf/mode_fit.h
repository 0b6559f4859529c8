/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/psf/mode_fit.h: |W|^2 of every mode as a polynomial in position, from images of a PSF at
 * many places. */
#pragma once

#include "survey/psf/internal.h"
#include "survey/psf/places.h"

/* Spectra at places. */
typedef struct mode_spectra {
    int n;
    int stamp;      /* modes along either axis */
    double *power;  /* [n][stamp][stamp], 1 at mode 0; owned */
    double *weight; /* [n] in the fit; 0 leaves one out; owned */
} mode_spectra;

/* Allocate. SHEAR_E_FORMAT: more than 2^26 numbers in all; SHEAR_E_NOMEM. Call mode_spectra_deinit
 * after an error, too. */
int mode_spectra_init(mode_spectra *s, int n, int stamp, sf_place at, shear_error *err);
void mode_spectra_deinit(mode_spectra *s);
/* Return the spectrum of place i. */
double *mode_spectra_of(const mode_spectra *s, int i);

/* Fit the spectra, and set c's polynomial and model; earlier ones are freed. Its variables have
 * been set by psf_places_set_variables. The degree is lower than `degree` if the places do not
 * determine such a polynomial. */
int mode_fit(psf_chip *c, const psf_places *places, const mode_spectra *s, int degree, sf_place at,
             shear_error *err);
/* Compute the model's power[stamp][stamp] at place i. */
void mode_fit_at(const psf_chip *c, const psf_places *places, int i, double *power);
