/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Warn of the noise level and its error, in words. */
#include "sheard/advice.h"

#include "report/advice_say.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>

static const double LEVEL_MIN = 0.01, LEVEL_SIGMA = 4.0, EFFECT_MIN = 2e-3;
static const double LEVEL_FAR = 2.0; /* or its inverse */
static const double SHAPE_MIN = 0.03, SHAPE_SIGMA = 5.0;
static const double FEWEST = 10.0;     /* fewest stamps whose scatter gives an error */
static const double SCATTER_MAX = 0.5; /* a stamp's own error is a few percent */
static const double SHARE_MIN = 0.5;
static const double NARROW_PX = 1.0; /* R_PSF below which galaxies have power at all wave numbers */
static const double NO_DIGITS = 0.1; /* part of D that would be left */

const char *sheard_advice_without_level(double effect, char *buf, size_t size) {
    if (1.0 + effect < NO_DIGITS)
        return advice_say(buf, size, "there would be no shear");
    const double small = effect / (1.0 + effect);
    return advice_say(buf, size, "the shear would be %.2g %% too %s", 100.0 * fabs(small),
                      small > 0.0 ? "small" : "large");
}

static bool is_far(double level) {
    return level > LEVEL_FAR || level * LEVEL_FAR < 1.0;
}

/* Return whether the two spectra of noise differ enough to matter. */
static bool has_other_shape(const shear_result *r) {
    const double shape = fabs(r->noise_shape);
    return r->valid && !(r->n_eff < FEWEST) && shape > SHAPE_MIN &&
           shape > SHAPE_SIGMA * r->noise_shape_err && shape * fabs(r->noise_share) > EFFECT_MIN;
}

const char *sheard_advice_noise_level(const shear_result *r, const shear_plan_info *plan, char *buf,
                                      size_t size) {
    char effect[64];
    const double more = r->noise_level - 1.0;
    const double err = r->noise_level_err;
    (void)plan;
    if (!r->valid || !(fabs(more) > LEVEL_MIN) || !(fabs(more) > LEVEL_SIGMA * err) ||
        !(fabs(r->noise_effect) > EFFECT_MIN) || has_other_shape(r)) {
        return NULL;
    }
    sheard_advice_without_level(r->noise_effect, effect, sizeof effect);
    if (is_far(r->noise_level)) {
        return advice_say(
            buf, size,
            "the noise stamps are not of the galaxies' noise: under the galaxies it has %.3g "
            "+- %.1g times their variance (another image? another unit? objects in the noise "
            "stamps?): taken into account, since without that, %s; but give noise stamps of "
            "the same image",
            r->noise_level, err, effect);
    }
    const int digits = err < 1e-3 ? 2 : 1;
    return advice_say(buf, size,
                      "the noise under the galaxies is %.*f +- %.*f %% %s than in the noise stamps "
                      "(%s): taken into account; without that, %s",
                      digits, 100.0 * fabs(more), digits, 100.0 * err,
                      more > 0.0 ? "stronger" : "weaker",
                      more > 0.0 ? "photons of the galaxies themselves? another depth?"
                                 : "objects in the noise stamps? another depth?",
                      effect);
}

const char *sheard_advice_noise_unchecked(const shear_result *r, const shear_plan_info *plan,
                                          char *buf, size_t size) {
    char cause[64];
    char effect[64];
    const bool narrow = plan->r_psf_px < NARROW_PX;
    if (!r->valid || isfinite(r->noise_level) || !(fabs(r->noise_share) > SHARE_MIN) ||
        !(narrow || plan->interpolation != SHEAR_INTERP_NONE)) {
        return NULL;
    }
    if (narrow) {
        snprintf(cause, sizeof cause, "R_PSF is only %.2g px", plan->r_psf_px);
    } else {
        snprintf(cause, sizeof cause, "stamps are interpolated");
    }
    return advice_say(
        buf, size,
        "the level of the noise cannot be checked (%s): were it 1 %% higher under the "
        "galaxies than in the noise stamps, %s",
        cause, sheard_advice_without_level(0.01 * r->noise_share, effect, sizeof effect));
}

const char *sheard_advice_noise_shape(const shear_result *r, const shear_plan_info *plan, char *buf,
                                      size_t size) {
    (void)plan;
    if (!has_other_shape(r))
        return NULL;
    return advice_say(
        buf, size,
        "the noise under the galaxies has a different spectrum from that of the noise stamps: it "
        "is %.3g times as strong (+- %.1g), and beyond Nyquist %.0f +- %.1g %% %s than that "
        "(is one correlated from pixel to pixel, and the other less?): no noise level cures "
        "that, the shear is biased; take noise stamps from the same image, resampled alike",
        r->noise_level, r->noise_level_err, 100.0 * fabs(r->noise_shape),
        100.0 * r->noise_shape_err, r->noise_shape > 0.0 ? "stronger" : "weaker");
}

const char *sheard_advice_noise_scatter(const shear_result *r, const shear_plan_info *plan,
                                        char *buf, size_t size) {
    (void)plan;
    const double err = r->noise_level_err;
    if (!r->valid || !(err > SCATTER_MAX * r->noise_level) ||
        !(err * fabs(r->noise_share) > EFFECT_MIN)) {
        return NULL;
    }
    return advice_say(
        buf, size,
        "the noise level, %.3g +- %.2g, depends on one stamp with absurd pixels; look at stamp "
        "%" PRId64 " first, which counts most (shearctl plot --stamp %" PRId64 "), and mask "
        "it (column FLAGS) where it is no galaxy",
        r->noise_level, err, r->top_stamp, r->top_stamp);
}
