/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Warn of noise stamps that hold no noise. */
#include "sheard/advice.h"

#include "report/advice_say.h"

#include <math.h>
#include <stdio.h>

static const double BIAS_MIN = 2e-3; /* of the shear: least bias to warn of */
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
