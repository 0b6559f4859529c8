/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "local/validation.h"

#include "local/chip_scan.h"
#include "local/sources_away.h"
#include "shear/settings.h"
#include "sheard/advice.h"
#include "sheard/no_shear.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>

/* Return a number of two digits slightly above -lowest > 0: a pedestal that makes all pixels
 * positive. */
static double pedestal_above(double lowest) {
    double x = 1.01 * -lowest;
    double unit = pow(10.0, floor(log10(x)) - 1.0);
    return ceil(x / unit) * unit;
}

/* Return whether there is a background that the filter would turn into an edge: its mean is
 * significant, and not small compared to the scatter of pixels. */
static bool has_background(const sheard_validation_report *v) {
    static const double sigma = 4.0;
    static const double part = 0.1;
    return v->plan->filter != SHEAR_FILTER_NONE && shear_settings_keep_background(v->settings) &&
           fabs(v->noise_mean) > sigma * v->noise_mean_err &&
           fabs(v->noise_mean) > part * v->noise_rms;
}

static const char subtract_background[] =
    "the noise stamps have a mean, a background that the filter would cut an edge into: give "
    "--background noise-mean";

/* Return the advice for a file that can be measured. */
static const char *advice_for(const sheard_validation_report *v) {
    if (has_background(v))
        return subtract_background;
    return v->weight_is_suspect
               ? "weights made of the stamps' own flux bias the shear by several per cent: take "
                 "weights of something else, or none, and --estimator pdf-sym"
               : NULL;
}

static void fail_negative(const sheard_validation_report *v, shear_error *words) {
    char advice[200];
    snprintf(advice, sizeof advice,
             "give --pedestal %.3g or more, or a method without logarithm (--interpolation none)",
             pedestal_above(v->lowest_pixel));
    shear_fail(words, SHEAR_E_NEGATIVE, advice,
               "%s cannot take negative pixels: %" PRId64 " of %" PRId64
               " stamps have some, down to %.6g",
               shear_interpolation_name(v->plan->interpolation), v->negative.count,
               v->field->n_stamps, v->lowest_pixel);
}

static void fail_no_shear(const sheard_validation_report *v, shear_error *words) {
    char text[400];
    char advice[400];
    sheard_no_shear_advice(&v->result, advice, sizeof advice);
    shear_fail(words, SHEAR_E_FORMAT, has_background(v) ? subtract_background : advice,
               "%s: no shear could be measured",
               sheard_no_shear_text(&v->result, text, sizeof text));
}

/* Return the first chip whose coordinates place it where the catalog has no sources; NULL: none. */
static const sheard_chip_report *find_astray(const sheard_validation_report *v) {
    const sheard_chip_report *r = v->chips;
    while (r < v->chips + v->n_chips && !sources_away_far(&r->chip))
        r++;
    return r < v->chips + v->n_chips ? r : NULL;
}

static void fail_astray(const sheard_chip_report *r, shear_error *words) {
    char name[96];
    char line[SHEARD_ADVICE_SIZE];
    shear_fail(words, SHEAR_E_FORMAT,
               "correct its coordinates (--wcs), or leave the chip out: it would not be measured",
               "chip %s: %s", chip_scan_name(r, name, sizeof name),
               sources_away_warning(&r->chip, line, sizeof line));
}

/* Return whether the PSF of a chip is too broad. */
static bool has_broad_psf(const sheard_validation_report *v) {
    const sheard_chip_report *r = v->chips;
    while (r < v->chips + v->n_chips &&
           !sheard_psf_is_broad(r->n_bright, r->n_sharp, &v->result, v->plan)) {
        r++;
    }
    return r < v->chips + v->n_chips;
}

void validation_conclude(sheard_validation_report *v, shear_error *words) {
    const int64_t n = v->field->n_stamps;
    sheard_cause cause;
    if (v->negative.count > 0) {
        fail_negative(v, words);
    } else if (v->n_measurable < 2) {
        shear_fail(words, SHEAR_E_FORMAT, "a field's shear needs two usable stamps at least",
                   "only %" PRId64 " of %" PRId64 " stamps could be measured", v->n_measurable, n);
    } else if (find_astray(v) != NULL) {
        fail_astray(find_astray(v), words);
    } else if (v->measured && sheard_cause_of(&v->result, v->plan, &cause)) {
        shear_fail(words, SHEAR_E_FORMAT, cause.advice, "%s: %s", cause.words,
                   v->result.valid ? "the shear is biased" : "no shear could be measured");
    } else if (v->measured && has_broad_psf(v)) {
        shear_fail(words, SHEAR_E_FORMAT, "give each chip the PSF of its own stars",
                   "the PSF of a chip is too broad: the shear is biased");
    } else if (v->measured && !v->result.valid) {
        fail_no_shear(v, words);
    } else {
        v->good = true;
        shear_fail(words, SHEAR_OK, advice_for(v),
                   "would measure %" PRId64 " of %" PRId64 " stamps", v->n_measurable, n);
    }
}
