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
    } else if (sheard_psf_is_broad(r->n_bright, r->n_sharp, r, plan)) {
        *cause = (sheard_cause){
            "bright stamps are sharper than their PSF, as no galaxy is: the PSF is too broad",
            "give the PSF of this image, made from its stars; not from galaxies"};
    } else {
        return false;
    }
    return true;
}
