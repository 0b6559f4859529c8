/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/score.h: what each bin of a histogram of signs tells of the shear: its response over its
 * variance.
 *
 * Notes
 *
 * 1. A bin's response is how its n_i - n_-i falls from g - width to g + width. Of few stamps it is
 * noise for the most part. So their scores are not responses over variances, bin by bin, but the
 * curve a t + b t^2 that comes closest to them, t = (i + 1/2)/bins: two numbers are found from the
 * stamps instead of one per bin. More stamps have a third term, and many each bin for itself.
 *
 * 2. A score that follows its own stamps' noise makes S(g) = sum_i score_i (n_i - n_-i) look as if
 * it fell faster than it does. So the slope of each group of stamps is taken with scores from all
 * other groups, in which this group's noise is not.
 */
#ifndef SHEAR_MEASURE_SCORE_H
#define SHEAR_MEASURE_SCORE_H

#include "measure/sign_histogram.h"

#include "shear/error.h"

enum { SCORE_TERMS = 3 };

typedef struct scores {
    int bins;
    int terms;           /* of note 1; 0 = each bin for itself */
    double *all;         /* [bins] of all stamps: those of S */
    double *without;     /* [SIGN_GROUPS][bins] of all stamps but the group's */
    double *fall, *size; /* [SIGN_GROUPS + 1][bins] scratch */
    sign_counts at[2];   /* [SIGN_GROUPS][bins] scratch */
} scores;

/* The terms for so many stamps; with weights, (sum w)^2 / sum w^2 of them. */
int scores_terms(double stamps);

/* SHEAR_E_NOMEM; terms = 0. deinit frees all that there is. */
int scores_init(scores *s, int bins, shear_error *err);
void scores_deinit(scores *s);

/* From the responses over g -+ width; `h` has its edges and groups. */
void scores_fit(scores *s, const sign_histogram *h, double g, double width);

/* -dS/dg by a straight line from g - half to g + half, each group with the scores of the others. */
double scores_slope(scores *s, const sign_histogram *h, double g, double half);

/* The curve of note 1 in 1 to SCORE_TERMS terms: fall [bins] and size [bins], the variance of n_i -
 * n_-i. Terms that the bins do not tell apart are left out. */
void score_curve(const double *fall, const double *size, int bins, int terms, double *score);

#endif
