/* SPDX-License-Identifier: GPL-3.0-or-later */
/* quality_text.h: how good a result is, in a line each: the noise level, and how many stamps
 * decide.
 */
#ifndef CLIENT_QUALITY_TEXT_H
#define CLIENT_QUALITY_TEXT_H

#include <stdint.h>
#include <stdio.h>

/* What the lines need; numbers that are not known are NaN, and `top_stamp` is -1. */
struct quality {
    double noise_level, noise_level_err, noise_effect, noise_share; /* shear/sums.h */
    double n_eff, top_share;
    int64_t n_used, top_stamp;
};

/* The lines "  level ..." and "  influence ..."; nothing of what nothing is known of. */
void quality_text_print(const struct quality *q, FILE *out);

#endif
