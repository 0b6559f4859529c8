/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/spectra.h: all that the modes of a packed pair tell, in one pass over their rows. */
#ifndef SHEAR_MEASURE_SPECTRA_H
#define SHEAR_MEASURE_SPECTRA_H

#include "measure/internal.h"

typedef struct spectra {
    moments difference; /* galaxy minus noise */
    moments noise, cross;
    high_power high;
    double shot, noise_shot; /* plateaus of difference and noise: not yet taken off */
    double flux;             /* of the filtered pair */
} spectra;

/* docs/method.md, step 4, of the pair that pack_pair has left in ws: the rows of modes that the
 * transfer lets through, and for the noise's power the others, too. */
spectra spectra_of(const shear_plan *plan, shear_workspace *ws, const transfer *t);

/* Further noise stamps, two as a pair: `share` (1, or 1/2 of one that was taken twice) of their
 * noise is added to that of `all`. */
void spectra_add_noise(spectra *all, const spectra *pair, double share);
/* The mean of the n noise stamps whose sum is in `all` takes the place of that in *s. */
void spectra_set_noise(spectra *s, const spectra *all, int n);
/* Of noise stamps without noise: what they have is their mean's, and what transforms round. */
void spectra_forget_noise(spectra *s);
/* Shot noise off the difference, where the plan asks for it. */
void spectra_subtract_plateau(spectra *s, const shear_plan *plan, const transfer *t);

#endif
