/* SPDX-License-Identifier: GPL-3.0-or-later */
/* pixels.h: table and figures of the experiment `pixels`. */
#ifndef VALIDATION_PIXELS_H
#define VALIDATION_PIXELS_H

#include "engine/methods.h"

enum { PIXELS_MAX_SIZES = 3, PIXELS_SERIES = N_METHODS * N_PSF_SAMPLINGS };

/* How many of enum psf_sampling are measured. */
int pixels_samplings(const struct request *r);

/* tallies [sizes]: of each size the well-sampled reference (series 0), then, ratio by ratio, the
 * six methods with each sampling of the PSF. */
int pixels_report(const struct request *r, const struct ledger *ledger,
                  struct tally *const *tallies, shear_error *err);

#endif
