/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "local/sources_away.h"

#include <math.h>
#include <stdio.h>

/* Around a dead chip sources begin at its edges, half of its side from its middle. */
static const double NEAR = 1.5;
static const double WIDE_DEG = 20.0; /* no chip of a camera sees so far from its middle */

const char *sources_away_warning(const shear_chip *chip, char *line, size_t size) {
    if (chip->n_sources > 0 || isnan(chip->nearest_source_deg))
        return NULL;
    if (isinf(chip->nearest_source_deg)) {
        snprintf(line, size,
                 "no source of the catalog is on it, and not all of it has a place on the sky: are "
                 "its coordinates right?");
    } else {
        snprintf(line, size,
                 "no source of the catalog is on it: the nearest is %.3g deg from its middle, its "
                 "corners %.3g deg: are its coordinates right?",
                 chip->nearest_source_deg, chip->corner_deg);
    }
    return line;
}

bool sources_away_far(const shear_chip *chip) {
    char line[256];
    return sources_away_warning(chip, line, sizeof line) != NULL &&
           !(chip->nearest_source_deg <= NEAR * chip->corner_deg && chip->corner_deg < WIDE_DEG);
}
