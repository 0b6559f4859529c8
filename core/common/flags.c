/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Names and explanations of a row's flags, names of frames, and the check of a weight. */
#include "shear/stamp.h"

#include <math.h>
#include <stddef.h>

static const struct {
    const char *name;
    const char *help;
} flags[SHEAR_N_FLAGS] = {
    {"galaxy_not_finite", "NaN, infinite or BLANK pixels in the galaxy stamp"},
    {"noise_not_finite", "NaN, infinite or BLANK pixels in the noise stamp"},
    {"masked", "CATALOG.FLAGS is not zero"},
    {"empty", "all pixels of the galaxy stamp are equal"},
    {"psf_unusable", "the stamp's PSF is not finite, flat, has no flux, its peak at the edge, is "
                     "too wide for beta, or "
                     "is missing"},
    {"bad_weight", "CATALOG.WEIGHT is negative, not finite, or above 0 but below 1e-100"},
    {"bad_r_gal", "CATALOG.R_GAL is not positive and finite, and the filter needs it"},
    {"overflow", "the pixels are finite, but the moments, or the sums made of them, are not"},
    {"artefact",
     "a pixel sharper than the PSF can be, below the sky, or one of a saturated flat top, in "
     "the galaxy stamp"},
    {"noise_artefact", "a pixel sharper than the PSF can be, or below the sky, in the noise stamp"},
    {"edge", "the stamp and its frame do not fit into the chip"},
    {"hole", "bad pixels in the galaxy's light"},
    {"saturated", "saturated pixels in the galaxy's light"},
    {"neighbour", "another object is too near"},
    {"no_noise", "no box of empty sky near the galaxy"},
    {"no_position", "the position is not finite, not in the image, or has no place on the sky"},
};

const char *shear_flag_name(int bit) {
    return bit >= 0 && bit < SHEAR_N_FLAGS ? flags[bit].name : NULL;
}

const char *shear_flag_help(int bit) {
    return bit >= 0 && bit < SHEAR_N_FLAGS ? flags[bit].help : NULL;
}

const char *shear_frame_name(enum shear_frame frame) {
    static const char *const names[] = {"pixel", "sky", "sky-east"};
    return (unsigned)frame < SHEAR_N_FRAMES ? names[frame] : "unknown";
}

bool shear_weight_is_good(double weight) {
    static const double smallest = 1e-100;
    return weight == 0.0 || (weight >= smallest && isfinite(weight));
}
