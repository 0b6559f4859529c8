/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/score.h: the weight of each bin of a sign histogram in the shear: its response over its
 * variance.
 *
 * Notes
 *
 * 1. A bin's response is the decrease of n_i - n_-i from g - width to g + width. With few stamps it
 * is mostly noise. Therefore scores are not computed bin by bin, but as the curve a t + b t^2 that
 * fits responses over variances best, t = (i + 1/2)/bins: two numbers are found from the stamps
 * instead of one per bin. With more stamps there is a third term, and with many each bin has its
 * own score.
 *
 * 2. A score that follows the noise of its own stamps makes S(g) = sum_i score_i (n_i - n_-i) look
 * steeper than it is. Therefore the slope of each group of stamps is computed with scores from all
 * other groups, which do not contain this group's noise. */
#pragma once

#include "measure/sign_histogram.h"

enum { SCORE_TERMS = 3 };

typedef struct scores {
    int bins;
    int terms;           /* of note 1; 0 = a score of its own for each bin */
    double *all;         /* [bins] from all stamps: those of S */
    double *without;     /* [SIGN_GROUPS][bins] from all stamps but the group's */
    double *fall, *size; /* [SIGN_GROUPS + 1][bins] scratch */
    sign_counts at[2];   /* [SIGN_GROUPS][bins] scratch */
} scores;

/* Return the number of terms for so many stamps; with weights, for (sum w)^2 / sum w^2 stamps. */
int scores_terms(double stamps);

void scores_place(scores *s, int bins, arena *a);

/* Fit the scores to the responses over g -+ width; `h` has its edges and groups. */
void scores_fit(scores *s, const sign_histogram *h, double g, double width);

/* Return -dS/dg from a straight line over g - half to g + half, each group with the scores of the
 * others. */
double scores_slope(scores *s, const sign_histogram *h, double g, double half);

/* Fit the curve of note 1 with 1 to SCORE_TERMS terms to fall [bins], the responses, and size
 * [bins], the variances of n_i - n_-i. Terms that the bins cannot distinguish are left out. */
void score_curve(const double *fall, const double *size, int bins, int terms, double *score);
