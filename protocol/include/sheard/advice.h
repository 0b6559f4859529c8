/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sheard/advice.h: what a result says about the settings it was measured with. Pure functions of
 * result and plan.
 *
 * Each writes one line into buf and returns it, or returns NULL if there is nothing to say. */
#ifndef SHEARD_ADVICE_H
#define SHEARD_ADVICE_H

#include "shear/plan.h"
#include "shear/sums.h"
#include "sheard/report.h"

#include <stdbool.h>
#include <stddef.h>

typedef const char *sheard_advice(const shear_result *r, const shear_plan_info *plan, char *buf,
                                  size_t size);

/* The filter takes more than 1 % off the stacked flux (and more than 3 errors): the shear is
 * biased. Not of a core that was found: it was chosen by what it does to the shear, and wings far
 * out may hold a percent of the flux and nothing of the moments. */
sheard_advice sheard_advice_filter;

/* Without a filter: the border pixels of the galaxy stamps are brighter than those of the noise
 * stamps by more than 4 errors, and, were the whole stamp so bright, by more than 2 % of the mean
 * flux. */
sheard_advice sheard_advice_bright_border;

/* Without a filter: the borders vary more than the noise under the galaxies (the noise stamps' at
 * the noise level) by more than 4 errors, by more than 5 % of the noise stamps' variance, and, were
 * the whole stamp off by that much (root mean square), by more than 2 % of the mean flux. The last
 * condition is what is left where the noise is negligible: a galaxy's own faint wings must not
 * count. */
sheard_advice sheard_advice_rough_border;

/* A gradient over the stamps: the border's sides differ from those opposite by more than 4 errors
 * beyond the noise stamps', and by so much that the shear changes by about 10^-4: over a whole
 * stamp, 30 % of the mean flux without a filter, all of it with one. */
sheard_advice sheard_advice_gradient;

/* "the shear would be 0.77 % too large": were it measured with a D that is too large by the part
 * `effect` (shear_result.noise_effect). Returns buf. */
const char *sheard_advice_without_level(double effect, char *buf, size_t size);

/* The noise under the galaxies is not as strong as in the noise stamps: by more than 1 % and 4
 * errors, and the shear would change by more than 0.2 % without the noise level. Said otherwise
 * where it is more than twice or less than half; not where the spectra differ, for then it is no
 * cure. */
sheard_advice sheard_advice_noise_level;

/* That cannot be checked (narrow PSF, or stamps are interpolated), and matters: the noise stamps
 * take off more than half of sum w D. */
sheard_advice sheard_advice_noise_unchecked;

/* The two noises' spectra differ: by more than 3 % and 5 errors between the two bands, and by 0.2 %
 * of the shear. */
sheard_advice sheard_advice_noise_shape;

/* The noise stamps hold no noise and the galaxies do: what that makes of sum w D, as a part of what
 * it would be without; 0 where it is not so, or cannot be told. The noise is taken for white. */
double sheard_advice_noise_left(const shear_result *r, const shear_plan_info *plan);
/* In words, above 0.2 % of the shear; with or without a shear. */
sheard_advice sheard_advice_no_noise;

/* The stamps are too small for beta, by more than 0.2 % of the shear (shear_plan_periodic_bias). */
sheard_advice sheard_advice_small_stamps;

/* More than 2 % of the galaxy stamps (and 10) have artefacts: with so many it matters which
 * galaxies they are found in. */
sheard_advice sheard_advice_many_artefacts;

/* What makes the shear wrong by more than a percent, or leaves none, beyond all that can be
 * corrected: noise stamps without noise, or with noise of another spectrum, and stamps that are too
 * small (by an estimate of more than 10 %). Static words. False: nothing of that. */
typedef struct sheard_cause {
    const char *words, *advice;
} sheard_cause;
bool sheard_cause_of(const shear_result *r, const shear_plan_info *plan, sheard_cause *cause);

/* The noise level has an error of more than half of it, and that matters: one stamp decides it. */
sheard_advice sheard_advice_noise_scatter;

/* With jackknife errors of 10 groups or more: they and the delta method's differ by a factor of
 * more than 1.5, and by more than 3 of the jackknife's own errors. */
sheard_advice sheard_advice_errors;

/* Of the ratio of means: one stamp has more than a tenth of sum w D and more than 5 times its part,
 * or more than 50 stamps count as less than 10. `top_file`: the file it is in; NULL: not known, or
 * clear without saying. */
const char *sheard_advice_influence(const shear_result *r, const char *top_file, char *buf,
                                    size_t size);

/* All that there is to say: the warnings of `shearctl measure` and of the service. */
enum {
    SHEARD_RESULT_ADVICES = 12,
    SHEARD_PSF_ADVICES = SHEAR_N_PSF_FLAWS + 1,
    SHEARD_ADVICES = 1 + SHEARD_RESULT_ADVICES + SHEARD_PSF_ADVICES,
    SHEARD_ADVICE_SIZE = 640
};
typedef struct sheard_advice_list {
    const char *lines[SHEARD_ADVICES]; /* [n], in text */
    size_t n;
    char text[SHEARD_ADVICES][SHEARD_ADVICE_SIZE];
} sheard_advice_list;
/* Appends what is doubtful in the PSF or the PSFs that the plan is of (shear/psf.h), with numbers,
 * cause and cure: for `shearctl validate`, too. */
void sheard_advice_psf(sheard_advice_list *list, const shear_plan_info *plan);
/* sheard_advice_all is on the first file's PSF; this is on those of the others of `files`, as many
 * as are known: how many are doubtful, and what one of them is. `first`: the path of the first.
 * Returns buf, or NULL if there is nothing to say. */
const char *sheard_advice_other_psfs(const sheard_report_file *files, size_t n, const char *first,
                                     char *buf, size_t size);
/* `plan`: of the field's first file; NULL if it is not known: then only influence is told.
 * `top_file` as above. */
void sheard_advice_all(sheard_advice_list *list, const shear_result *r, const shear_plan_info *plan,
                       const char *top_file);

#endif
