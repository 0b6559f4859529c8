/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "local/psf_size.h"

#include "base/cleanup.h"
#include "base/sort.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>

/* Half of the light of a Gaussian of R_PSF = 1 lies within it; of other PSFs within more. */
static const double HALF_LIGHT = 1.177;
/* FLUX_RADIUS of stars is 0.94 to 1.02 times that of the PSF (PSFEx, real and mock). */
static const double STARS_DIFFER = 1.1;
/* That of narrower PSFs has the pixel in it once more. */
static const double WIDE_PX = 1.0;
/* Chips of one camera differ by a few percent. */
static const double ODD = 0.15;
enum { FEWEST_CHIPS = 4 };

static const char *unlike_stars(const shear_chip *chip, char *line, size_t size) {
    const double ratio = chip->star_radius_px / chip->psf_radius_px;
    const bool narrower = ratio > STARS_DIFFER;
    if (!(chip->psf_radius_px >= WIDE_PX && (narrower || ratio < 1.0 / STARS_DIFFER)))
        return NULL;
    snprintf(line, size,
             "its PSF is %s (half of its light within %.2f px) than the small sources that are not "
             "selected (FLUX_RADIUS %.2f px): if these are stars, every shear is wrong; is it the "
             "PSF of this image%s?",
             narrower ? "narrower" : "broader", chip->psf_radius_px, chip->star_radius_px,
             narrower ? "" : ", and made from its stars alone");
    return line;
}

const char *psf_size_warning(const shear_chip *chip, char *line, size_t size) {
    if (unlike_stars(chip, line, size) != NULL)
        return line;
    if (!(chip->source_quartile < HALF_LIGHT * chip->r_psf_px))
        return NULL;
    snprintf(line, size,
             "its PSF (R_PSF %.2f px) is broader than a quarter of its sources "
             "(FLUX_RADIUS below %.2f px): was it made from galaxies (then every shear is wrong), "
             "or are these noise? "
             "take brighter stars, or fewer (psfex: SAMPLE_MINSN, SAMPLE_FWHMRANGE)",
             chip->r_psf_px, chip->source_quartile);
    return line;
}

double psf_size_median(const shear_field *field) {
    const int chips = shear_field_chips(field);
    CLEANUP(release_free) double *size = malloc((size_t)(chips + 1) * sizeof *size);
    size_t n = 0;
    for (int i = 0; i < chips && size != NULL; i++) {
        shear_chip chip;
        if (shear_field_get_chip(field, i, &chip, NULL) == SHEAR_OK && chip.r_psf_px > 0.0)
            size[n++] = chip.r_psf_px;
    }
    if (n < FEWEST_CHIPS)
        return NAN;
    sort_doubles(size, n);
    return size[n / 2];
}

const char *psf_size_odd(const shear_chip *chip, double median, char *line, size_t size) {
    if (!(fabs(chip->r_psf_px / median - 1.0) > ODD))
        return NULL;
    snprintf(line, size,
             "its PSF has an R_PSF of %.2f px, those of the other chips of %.2f px: "
             "look at its stars",
             chip->r_psf_px, median);
    return line;
}
