/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "sheard/advice.h"

#include "report/advice_say.h"

#include <assert.h>
#include <math.h>

static const double REMOVED_MAX = 0.01, REMOVED_SIGMA = 3.0;
/* Step of a gradient across a stamp, as a part of the mean flux, at which its effect on the shear
 * is 10^-4: c = 1.6 10^-3 of its square without a filter, a twentieth of that with one. */
static const double STEP_OPEN = 0.3, STEP_FILTERED = 1.0;
static const double ROUNDING = 1e-9;
enum { FEWEST = 10 }; /* fewest stamps whose scatter gives an error */
static const double BORDER_SIGMA = 4.0, BORDER_FLUX = 0.02, ROUGH_MAX = 0.05;
static const double ARTEFACT_SHARE = 0.02;
static const int64_t ARTEFACTS_MIN = 10;

const char *sheard_advice_filter(const shear_result *r, const shear_plan_info *plan, char *buf,
                                 size_t size) {
    bool much = r->filter_removed > REMOVED_MAX &&
                r->filter_removed > REMOVED_SIGMA * r->filter_removed_err;
    if (plan->filter == SHEAR_FILTER_NONE || plan->core_found || !much)
        return NULL;
    char cure[96] = "R_GAL is too small, or use --filter none";
    if (!plan->filter_per_stamp) {
        advice_say(cure, sizeof cure,
                   "use a --core larger than %.3g px, larger stamps, or --filter none",
                   plan->core_px);
    }
    return advice_say(
        buf, size,
        "the filter removes %.1f %% of the stacked flux; where that is the galaxies' own and "
        "not their neighbours', the shear is biased: %s",
        100.0 * r->filter_removed, cure);
}

static double stamp_area(const shear_plan_info *plan) {
    return (double)plan->geometry.nx * plan->geometry.ny;
}

const char *sheard_advice_bright_border(const shear_result *r, const shear_plan_info *plan,
                                        char *buf, size_t size) {
    bool bright = r->border_excess > BORDER_SIGMA * r->border_excess_err &&
                  r->border_excess * stamp_area(plan) > BORDER_FLUX * r->mean_flux;
    if (plan->filter != SHEAR_FILTER_NONE || !bright)
        return NULL;
    return advice_say(
        buf, size,
        "the stamps' borders are brighter than the noise stamps' by %.2g +- %.1g per pixel, over "
        "a whole stamp %.1f %% of the mean flux: wings that are cut off, neighbours, or a sky "
        "that the noise stamps do not have? cut larger stamps; see that the sky of both is "
        "subtracted alike",
        r->border_excess, r->border_excess_err,
        100.0 * r->border_excess * stamp_area(plan) / r->mean_flux);
}

/* Return the variance of the borders beyond the noise under the galaxies: that of the noise stamps
 * at the noise level, if it is known, or all of it if the noise stamps hold no noise. */
static double beyond_noise(const shear_result *r, const shear_plan_info *plan) {
    const bool known = r->noise_level > 0.0;
    const bool all = isfinite(r->high_galaxy) && sheard_advice_noise_left(r, plan) != 0.0;
    return r->border_rough - (known ? (r->noise_level - 1.0) * r->border_noise_var
                              : all ? r->high_galaxy
                                    : 0.0);
}

const char *sheard_advice_rough_border(const shear_result *r, const shear_plan_info *plan,
                                       char *buf, size_t size) {
    const double extra = beyond_noise(r, plan);
    bool rough = extra > BORDER_SIGMA * r->border_rough_err &&
                 extra > ROUGH_MAX * r->border_noise_var &&
                 sqrt(extra) * stamp_area(plan) > BORDER_FLUX * r->mean_flux;
    if (plan->filter != SHEAR_FILTER_NONE || !rough ||
        sheard_advice_no_noise(r, plan, buf, size) != NULL) {
        return NULL;
    }
    return advice_say(
        buf, size,
        "the stamps' borders are rougher than the noise stamps' (extra variance %.2g +- %.1g, "
        "noise %.2g): neighbours, or wings that are cut off? leave out stamps with neighbours "
        "(column FLAGS), or cut larger stamps",
        extra, r->border_rough_err, r->border_noise_var);
}

/* Return the mean square of the steps beyond that of white noise at the level under the galaxies.
 */
static double step2_beyond_noise(const shear_result *r, const shear_plan_info *plan) {
    const bool known = r->noise_level > 0.0;
    const double of_noise =
        2.0 * r->border_noise_var * (1.0 / (plan->geometry.nx - 2) + 1.0 / (plan->geometry.ny - 2));
    return r->border_step2 - (known ? (r->noise_level - 1.0) * of_noise : 0.0);
}

/* Return whether the step changes the shear by about 10^-4 or more. */
static bool is_steep(double step, const shear_result *r, const shear_plan_info *plan) {
    const double part = step * stamp_area(plan) / r->mean_flux;
    return part > (plan->filter != SHEAR_FILTER_NONE ? STEP_FILTERED : STEP_OPEN);
}

const char *sheard_advice_gradient(const shear_result *r, const shear_plan_info *plan, char *buf,
                                   size_t size) {
    static const char cure[] = "subtract the sky with a plane or a finer mesh";
    const double common = hypot(r->border_step_x, r->border_step_y);
    const double step2 = step2_beyond_noise(r, plan);
    const double rms = sqrt(fmax(0.0, step2));
    if (r->n_used < FEWEST)
        return NULL;
    const bool sure = fabs(r->border_step_x) > BORDER_SIGMA * r->border_step_x_err ||
                      fabs(r->border_step_y) > BORDER_SIGMA * r->border_step_y_err;
    if (sure && is_steep(common, r, plan)) {
        return advice_say(
            buf, size,
            "a gradient lies over the stamps, beyond the noise stamps': their borders' right "
            "side is brighter than the left one by %.2g +- %.1g per pixel, the top than the "
            "bottom by %.2g +- %.1g (over a whole stamp %.0f %% of the mean flux), which biases "
            "the shear: %s, unless neighbours lie on that side",
            r->border_step_x, r->border_step_x_err, r->border_step_y, r->border_step_y_err,
            100.0 * common * stamp_area(plan) / r->mean_flux, cure);
    }
    if (sheard_advice_noise_shape(r, plan, buf, size) != NULL ||
        sheard_advice_no_noise(r, plan, buf, size) != NULL) {
        return NULL; /* the steps of correlated noise cannot be derived from white noise */
    }
    const bool real = fabs(r->border_step2) > ROUNDING * r->border_noise_var;
    if (real && step2 > BORDER_SIGMA * r->border_step2_err && is_steep(rms, r, plan)) {
        return advice_say(
            buf, size,
            "gradients lie over the stamps, beyond the noise stamps', in changing directions: "
            "opposite sides of their borders differ by %.2g per pixel (root mean square; over a "
            "whole stamp %.0f %% of the mean flux): neighbours, or a sky that varies: %s",
            rms, 100.0 * rms * stamp_area(plan) / r->mean_flux, cure);
    }
    return NULL;
}

const char *sheard_advice_many_artefacts(const shear_result *r, const shear_plan_info *plan,
                                         char *buf, size_t size) {
    int64_t n = 0;
    (void)plan;
    for (unsigned bit = 0; bit < SHEAR_N_FLAGS; bit++)
        n += 1u << bit == SHEAR_FLAG_ARTEFACT ? r->flagged[bit] : 0;
    if (n < ARTEFACTS_MIN || !((double)n > ARTEFACT_SHARE * (double)r->n_stamps))
        return NULL;
    return advice_say(
        buf, size,
        "%.2g %% of the stamps are left out for artefacts: cosmic rays in so many (of an exposure, "
        "is this its --mask)? else the PSF "
        "is broader than the images' own, or the sky is a few photons per pixel, which look like "
        "them, and then the bright galaxies are left out: give --artefacts keep, and FLAGS of "
        "your own",
        100.0 * (double)n / (double)r->n_stamps);
}

void sheard_advice_all(sheard_advice_list *list, const shear_result *r, const shear_plan_info *plan,
                       const char *top_file) {
    static sheard_advice *const all[SHEARD_RESULT_ADVICES] = {
        sheard_advice_no_noise,     sheard_advice_small_stamps,    sheard_advice_noise_scatter,
        sheard_advice_noise_level,  sheard_advice_noise_unchecked, sheard_advice_noise_shape,
        sheard_advice_errors,       sheard_advice_filter,          sheard_advice_bright_border,
        sheard_advice_rough_border, sheard_advice_gradient,        sheard_advice_many_artefacts,
        sheard_advice_centring,     sheard_advice_broad_psf};
    list->n = 0;
    const char *line = sheard_advice_influence(r, top_file, list->text[0], SHEARD_ADVICE_SIZE);
    if (line != NULL)
        list->lines[list->n++] = line;
    for (size_t i = 0; plan != NULL && i < SHEARD_RESULT_ADVICES; i++) {
        line = all[i](r, plan, list->text[list->n], SHEARD_ADVICE_SIZE);
        if (line != NULL)
            list->lines[list->n++] = line;
    }
    if (plan != NULL)
        sheard_advice_psf(list, plan);
    assert(list->n <= SHEARD_ADVICES);
}
