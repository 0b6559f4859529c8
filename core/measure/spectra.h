/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/spectra.h: all that is summed over the modes of a packed pair, in one pass over their
 * rows. */
#pragma once

#include "measure/internal.h"

typedef struct spectra {
    moments difference; /* galaxy minus noise */
    moments noise, cross;
    high_power high;
    double shot, noise_shot; /* plateaus of difference and noise, not yet subtracted */
    double flux;             /* of the filtered pair */
} spectra;

/* Sum over the modes (docs/method.md, section 4) of the pair that pack_pair has left in ws: the
 * rows that the transfer lets through, and those that the noise's power needs. */
spectra spectra_of(const shear_plan *plan, shear_workspace *ws, const transfer *t);

/* Add the noise of a pair of further noise stamps to that of `all`, times `share` (1, or 1/2 if one
 * stamp was packed twice). */
void spectra_add_noise(spectra *all, const spectra *pair, double share);
/* Replace the noise of *s by the mean of the n noise stamps whose sum is in `all`. */
void spectra_set_noise(spectra *s, const spectra *all, int n);
/* Set the noise to 0, for noise stamps without noise: their spectra hold only their mean and the
 * rounding of transforms. */
void spectra_forget_noise(spectra *s);
/* Subtract the shot noise's plateau from the difference, if the plan says so. */
void spectra_subtract_plateau(spectra *s, const shear_plan *plan, const transfer *t);
