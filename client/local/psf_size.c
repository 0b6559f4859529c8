/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "local/psf_size.h"

#include "sheard/advice.h"

#include <stdio.h>

/* FLUX_RADIUS of a star misses the wings, and scatters. */
static const double SMALLEST = 0.9;

const char *psf_size_warning(const shear_chip *chip, char *line, size_t size) {
    if (!(chip->source_quartile < SMALLEST * chip->psf_half_light))
        return NULL;
    snprintf(line, size,
             "its PSF (half of the light within %.2f px) is broader than a quarter of its sources "
             "(FLUX_RADIUS below %.2f px): was it made from galaxies? Every shear is wrong then; "
             "take brighter stars, or fewer (psfex: SAMPLE_MINSN, SAMPLE_FWHMRANGE)",
             chip->psf_half_light, chip->source_quartile);
    return line;
}

void psf_size_warn(const shear_field *field, warning_list *warnings) {
    const int chips = shear_field_chips(field);
    for (int i = 0; i < chips; i++) {
        shear_chip chip;
        char line[SHEARD_ADVICE_SIZE];
        if (shear_field_get_chip(field, i, &chip, NULL) == SHEAR_OK &&
            psf_size_warning(&chip, line, sizeof line) != NULL) {
            warnings_add(warnings, "chip %d (%s): %s", i + 1,
                         chip.name[0] != '\0' ? chip.name : "no EXTNAME", line);
        }
    }
}
