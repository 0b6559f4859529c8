/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Causes that make a field's shear wrong, or prevent it, in words. */
#include "sheard/advice.h"

#include "report/advice_say.h"
#include "sheard/no_shear.h"

#include <math.h>
#include <stdio.h>

static const double BIAS_MIN = 2e-3; /* of the shear: least bias to warn of */
static const double BIAS_BAD = 1e-2; /* of the shear: bias that makes a file bad */
static const double BIAS_NONE = 0.1; /* of the shear, by a rough estimate; may prevent any shear */
static const double SIGMA = 4.0;
static const double NOTHING = 0.01; /* of the galaxies' noise: negligible */
static const double SMOOTH = 4.0;   /* a variance below so many squared means may be wings */

/* Return the variance of a pixel's noise under the galaxies, or 0 if it cannot be determined. It is
 * read off at high k or, if the PSF leaves no wave numbers for that, from the borders. */
static double noise_of_galaxies(const shear_result *r) {
    const double wings = SMOOTH * r->border_excess * r->border_excess;
    const bool rough = r->border_rough > SIGMA * r->border_rough_err && r->border_rough > wings;
    return isfinite(r->high_galaxy) ? r->high_galaxy : rough ? r->border_rough : 0.0;
}

/* Return the contribution of white noise of that variance to a stamp's D, for a PSF near a
 * Gaussian: the integral of (k^2 - beta^2 k^4/2) T over the plane of modes. */
static double d_of_noise(double variance, const shear_plan_info *plan) {
    const double r2 = plan->r_psf_px * plan->r_psf_px;
    const double gamma2 = plan->beta_px * plan->beta_px - r2;
    const double area = (double)plan->geometry.nx * plan->geometry.ny;
    return gamma2 > 0.1 * r2 ? -variance * area * r2 / (4.0 * M_PI * pow(gamma2, 3.0)) : 0.0;
}

double sheard_advice_noise_left(const shear_result *r, const shear_plan_info *plan) {
    const double variance = noise_of_galaxies(r);
    const double noise_d = r->sum_weight * d_of_noise(variance, plan);
    const double corrected = r->noise_share * r->sum_d; /* subtracted by the noise stamps */
    const bool has_none = !isfinite(r->noise_level) && variance > 0.0 &&
                          fabs(corrected) < NOTHING * fabs(noise_d) &&
                          r->border_noise_var < NOTHING * (r->border_rough + r->border_noise_var);
    return has_none ? noise_d / fabs(r->sum_d - noise_d) : 0.0;
}

const char *sheard_advice_no_noise(const shear_result *r, const shear_plan_info *plan, char *buf,
                                   size_t size) {
    char effect[64] = "and there is no shear";
    const double left = sheard_advice_noise_left(r, plan);
    if (!(fabs(left) > BIAS_MIN))
        return NULL;
    if (r->valid) {
        snprintf(effect, sizeof effect, "which makes the shear %.2g %% too %s",
                 100.0 * fabs(left / (1.0 + left)), left > 0.0 ? "small" : "large");
    }
    return advice_say(
        buf, size,
        "the noise stamps hold no noise (or only what rounding makes), and the galaxies do, "
        "of a variance of about %.2g per pixel: it is not taken off, %s; give noise stamps of "
        "the same image",
        noise_of_galaxies(r), effect);
}

const char *sheard_advice_small_stamps(const shear_result *r, const shear_plan_info *plan,
                                       char *buf, size_t size) {
    char much[32] = "by more than 10 %";
    const double bias = shear_plan_periodic_bias(plan);
    (void)r;
    if (!(bias > BIAS_MIN))
        return NULL;
    if (bias < BIAS_NONE)
        snprintf(much, sizeof much, "by about %.2g %%", 100.0 * bias);
    return advice_say(
        buf, size,
        "stamps of %d x %d px are small for beta = %.3g px, since the transform is "
        "periodic: the shear of galaxies 1.5 times as large as the PSF is biased %s; cut "
        "stamps of %.0f px at least (10 beta), or larger",
        plan->geometry.nx, plan->geometry.ny, plan->beta_px, much, ceil(10.0 * plan->beta_px));
}

/* Return whether the two spectra of noise differ by that much. */
static bool has_wrong_noise(const shear_result *r, const shear_plan_info *plan) {
    char line[SHEARD_ADVICE_SIZE];
    return sheard_advice_noise_shape(r, plan, line, sizeof line) != NULL &&
           fabs(r->noise_shape * r->noise_share) > BIAS_BAD;
}

static bool lacks_shear(const shear_result *r) {
    return !r->valid &&
           (r->why == SHEAR_TOO_NARROW || r->why == SHEAR_NO_SIGNAL || r->why == SHEAR_SWAPPED) &&
           !sheard_one_outweighs(r);
}

bool sheard_cause_of(const shear_result *r, const shear_plan_info *plan, sheard_cause *cause) {
    const bool looked_at = r->valid || lacks_shear(r);
    if (looked_at && fabs(sheard_advice_noise_left(r, plan)) > BIAS_BAD) {
        *cause = (sheard_cause){"the noise stamps hold no noise, and the galaxies do",
                                "give noise stamps of the same image as the galaxies"};
    } else if (has_wrong_noise(r, plan)) {
        *cause = (sheard_cause){
            "the noise under the galaxies has a different spectrum from that of the noise stamps",
            "take noise stamps from the same image, resampled alike"};
    } else if (looked_at && shear_plan_periodic_bias(plan) > BIAS_NONE) {
        *cause = (sheard_cause){
            "the stamps are too small for beta, or the PSF is not as wide (OVERSAMP forgotten?)",
            "cut stamps that are 10 beta wide at least; give the keyword OVERSAMP where the PSF "
            "has several samples per galaxy pixel"};
    } else {
        return false;
    }
    return true;
}
