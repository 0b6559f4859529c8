/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Warn of stamps that are sharper than their PSF, in words. */
#include "sheard/advice.h"

#include "report/advice_say.h"

#include <inttypes.h>
#include <math.h>

/* Part of the bright stamps from which to warn, and from which the PSF is surely wrong. Of galaxies
 * that all have a neighbour 1 % are sharp, of 90 real objects, stars among them, there were 3. */
static const double SHARP_SHARE = 0.02, SHARP_BAD = 0.05;
static const int64_t SHARP_MIN = 5;
/* Triples in blocks, and how many times more than if sharp stamps were anywhere. A blend is a pair
 * at most. */
static const int64_t TRIPLES_MIN = 10;
static const double TRIPLES_FACTOR = 20.0;
/* Without interpolation the pixels' aliases make a point source sharp behind a narrower PSF
 * (docs/method.md, section 1). */
static const double NARROW_PX = 0.6;
/* Noise that is not taken off makes D smaller, as a part of it. */
static const double NOISE_MAX = 0.01;
/* The periodic transform makes D negative where the shear is biased by more. */
static const double PERIODIC_MAX = 0.02;

/* Return whether D of a point source can be trusted. */
static bool can_tell(const shear_result *r, const shear_plan_info *plan) {
    return (r->valid || r->why == SHEAR_NO_SIGNAL) &&
           shear_plan_periodic_bias(plan) < PERIODIC_MAX &&
           (plan->r_psf_px >= NARROW_PX || plan->interpolation != SHEAR_INTERP_NONE) &&
           fabs(sheard_advice_noise_left(r, plan)) < NOISE_MAX;
}

static bool are_many(int64_t bright, int64_t sharp, double share) {
    return sharp >= SHARP_MIN && (double)sharp > share * (double)bright;
}

bool sheard_psf_is_broad(int64_t bright, int64_t sharp, const shear_result *r,
                         const shear_plan_info *plan) {
    return are_many(bright, sharp, SHARP_BAD) && can_tell(r, plan);
}

/* Return the triples that there were by chance. */
static double triples_by_chance(const shear_result *r) {
    return (double)r->bright_triples * pow((double)r->n_sharp / (double)r->n_bright, 3.0);
}

const char *sheard_advice_broad_psf_of(int64_t bright, int64_t sharp, const shear_result *r,
                                       const shear_plan_info *plan, char *buf, size_t size) {
    shear_result part = *r;
    part.n_bright = bright;
    part.n_sharp = sharp;
    part.sharp_triples = 0;
    return sheard_advice_broad_psf(&part, plan, buf, size);
}

const char *sheard_advice_broad_psf(const shear_result *r, const shear_plan_info *plan, char *buf,
                                    size_t size) {
    const bool many = are_many(r->n_bright, r->n_sharp, SHARP_SHARE);
    const bool together = r->sharp_triples >= TRIPLES_MIN &&
                          (double)r->sharp_triples > TRIPLES_FACTOR * triples_by_chance(r);
    if (!(many || together) || !can_tell(r, plan))
        return NULL;
    return advice_say(
        buf, size,
        "%" PRId64 " of %" PRId64
        " bright stamps are sharper than their PSF%s, which no galaxy is: the PSF is too broad, "
        "and the shear wrong, by tens of percent where it was made from galaxies; is it that of "
        "this image? take brighter stars, or fewer (psfex: SAMPLE_MINSN, SAMPLE_FWHMRANGE)",
        r->n_sharp, r->n_bright,
        many ? "" : ", and come together: those of one chip or file (shearctl validate)");
}
