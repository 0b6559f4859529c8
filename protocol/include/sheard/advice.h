/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sheard/advice.h: warnings about a result and the settings that it was measured with, in words.
 *
 * All functions depend on result and plan only. Each writes one line into buf and returns it, or
 * returns NULL if there is nothing to warn of. */
#ifndef SHEARD_ADVICE_H
#define SHEARD_ADVICE_H

#include "shear/plan.h"
#include "shear/sums.h"
#include "sheard/report.h"

#include <stdbool.h>
#include <stddef.h>

typedef const char *sheard_advice(const shear_result *r, const shear_plan_info *plan, char *buf,
                                  size_t size);

/* The filter removes more than 1 % of the stacked flux (and more than 3 errors), so the shear is
 * biased. Not for a core that was found: it was chosen by its effect on the shear, and faint outer
 * wings may hold a percent of the flux without changing the moments. */
sheard_advice sheard_advice_filter;

/* Without a filter: the border pixels of the galaxy stamps are brighter than those of the noise
 * stamps by more than 4 errors; and, if the whole stamp were so bright, by more than 2 % of the
 * mean flux. */
sheard_advice sheard_advice_bright_border;

/* Without a filter: the borders' variance exceeds that of the noise under the galaxies (the noise
 * stamps' at the noise level) by more than 4 errors and by more than 5 % of the noise stamps'
 * variance; and, if the whole stamp were off by that much (root mean square), by more than 2 % of
 * the mean flux. If the noise is negligible, only the last condition remains: a galaxy's own faint
 * wings must not count. */
sheard_advice sheard_advice_rough_border;

/* There is a gradient over the stamps: opposite sides of the border differ by more than 4 errors
 * beyond those of the noise stamps, and so much that the shear changes by about 10^-4. Over a whole
 * stamp that is 30 % of the mean flux without a filter, and all of it with one. */
sheard_advice sheard_advice_gradient;

/* Write "the shear would be 0.77 % too large", for a D that is too large by the part `effect`
 * (shear_result.noise_effect). Return buf. */
const char *sheard_advice_without_level(double effect, char *buf, size_t size);

/* The noise under the galaxies differs in strength from that of the noise stamps by more than 1 %
 * and 4 errors, and the shear would change by more than 0.2 % without the noise level. The words
 * differ if it is more than twice or less than half. Not if the spectra differ, because then the
 * noise level is no remedy. */
sheard_advice sheard_advice_noise_level;

/* The noise level cannot be checked (narrow PSF, or stamps are interpolated), and it matters: the
 * noise stamps subtract more than half of sum w D. */
sheard_advice sheard_advice_noise_unchecked;

/* The two spectra of noise differ by more than 3 % and 5 errors between the two bands, and by 0.2 %
 * of the shear. */
sheard_advice sheard_advice_noise_shape;

/* Return the part by which the galaxies' noise changes sum w D, if the noise stamps hold no noise
 * but the galaxies do; 0 otherwise, or if that cannot be determined. The noise is assumed to be
 * white. */
double sheard_advice_noise_left(const shear_result *r, const shear_plan_info *plan);
/* The same in words, above 0.2 % of the shear; with or without a shear. */
sheard_advice sheard_advice_no_noise;

/* The stamps are too small for beta, by more than 0.2 % of the shear (shear_plan_periodic_bias). */
sheard_advice sheard_advice_small_stamps;

/* More than 2 % of the galaxy stamps (and 10) have artefacts. With so many it matters which
 * galaxies they are found in. */
sheard_advice sheard_advice_many_artefacts;

/* More than 2 % of the bright stamps (and 5) are sharper than their PSF, or fewer, but in the same
 * blocks (docs/method.md section 5.1): the PSF is too broad. Not where noise, aliases or small
 * stamps may have made them so. */
sheard_advice sheard_advice_broad_psf;
/* The same of a part, a chip or a file, with so many bright and sharp stamps; the rest is of all.
 */
const char *sheard_advice_broad_psf_of(int64_t bright, int64_t sharp, const shear_result *r,
                                       const shear_plan_info *plan, char *buf, size_t size);

/* Return whether a part, a chip or all, has more than 5 %: the PSF is surely too broad. */
bool sheard_psf_is_broad(int64_t bright, int64_t sharp, const shear_result *r,
                         const shear_plan_info *plan);

/* The light of galaxies is not where their positions are: they count from another pixel, or belong
 * to another image. */
sheard_advice sheard_advice_centring;
/* The same for any sample. */
const char *sheard_advice_positions(const shear_centring *c, char *buf, size_t size);

/* A cause that makes the shear wrong by more than a percent, or prevents it, and cannot be
 * corrected: noise stamps without noise or with noise of another spectrum, stamps that are too
 * small (by an estimate of more than 10 %), or a PSF that is too broad. sheard_cause_of returns
 * false if there is none. The strings are static. */
typedef struct sheard_cause {
    const char *words, *advice;
} sheard_cause;
bool sheard_cause_of(const shear_result *r, const shear_plan_info *plan, sheard_cause *cause);

/* The noise level's error exceeds half of it, and that matters: one stamp decides it. */
sheard_advice sheard_advice_noise_scatter;

/* With jackknife errors of 10 groups or more: they differ from those of the delta method by a
 * factor of more than 1.5, and by more than 3 of the jackknife's own errors. */
sheard_advice sheard_advice_errors;

/* For the ratio of means: one stamp has more than a tenth of sum w D and more than 5 times its
 * part, or more than 50 stamps count as less than 10. `top_file` is the file with that stamp, or
 * NULL if it is unknown or need not be named. */
const char *sheard_advice_influence(const shear_result *r, const char *top_file, char *buf,
                                    size_t size);

/* All warnings: those of `shearctl measure` and of the service. */
enum {
    SHEARD_RESULT_ADVICES = 14,
    SHEARD_PSF_ADVICES = SHEAR_N_PSF_FLAWS + 1,
    SHEARD_ADVICES = 1 + SHEARD_RESULT_ADVICES + SHEARD_PSF_ADVICES,
    SHEARD_ADVICE_SIZE = 640
};
typedef struct sheard_advice_list {
    const char *lines[SHEARD_ADVICES]; /* [n] pointers into text */
    size_t n;
    char text[SHEARD_ADVICES][SHEARD_ADVICE_SIZE];
} sheard_advice_list;
/* Append warnings about the PSF or PSFs of the plan (shear/psf.h), with numbers, cause and remedy.
 * `shearctl validate` uses it, too. */
void sheard_advice_psf(sheard_advice_list *list, const shear_plan_info *plan);
/* Warn about the PSFs of the other files, as far as known: how many are doubtful, and what one of
 * them is. sheard_advice_all covers that of the first file, whose path is `first`. Return buf, or
 * NULL if there is nothing to warn of. */
const char *sheard_advice_other_psfs(const sheard_report_file *files, size_t n, const char *first,
                                     char *buf, size_t size);
/* Make all warnings. `plan` is that of the field's first file; if it is unknown (NULL), only
 * influence is reported. `top_file` is as above. */
void sheard_advice_all(sheard_advice_list *list, const shear_result *r, const shear_plan_info *plan,
                       const char *top_file);

#endif
