/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "local/weight_map.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>

enum { OFFSET = 128, FAR = 17 };

void sigma_range_add(sigma_range *r, const float *sigma, const uint8_t *defect, size_t n) {
    for (size_t i = 0; i < n; i++) {
        if (defect[i] == 0 && isnormal(sigma[i]))
            r->n[ilogbf(sigma[i]) + OFFSET]++;
    }
}

int64_t sigma_range_extreme(const sigma_range *r) {
    int64_t all = 0;
    int64_t below = 0;
    int64_t extreme = 0;
    int median = 0;
    for (int i = 0; i < 2 * OFFSET; i++)
        all += r->n[i];
    while (median < 2 * OFFSET && 2 * (below += r->n[median]) < all)
        median++;
    for (int i = 0; i < median - FAR; i++)
        extreme += r->n[i];
    return extreme;
}

/* What a map holds, as a power of the standard deviation: sigma is its value to the inverse. */
static const struct {
    const char *name;
    double power;
} kinds[] = {[SHEAR_WEIGHT_IS_WEIGHT] = {"weight", -2.0},
             [SHEAR_WEIGHT_IS_VARIANCE] = {"variance", 2.0},
             [SHEAR_WEIGHT_IS_RMS] = {"rms", 1.0}};

/* Return the kind that goes with the noise as this slope says, if the map is read as `kind`; NULL:
 * none, or this one. Weights and variances of one map have the slopes -1 and 1; rms is half a
 * variance. */
static const char *other_kind(double slope, enum shear_weight_kind kind) {
    const double power = kinds[kind].power / slope; /* of sigma, that the map follows */
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++) {
        if (i != (size_t)kind && fabs(power / kinds[i].power - 1.0) < 0.25)
            return kinds[i].name;
    }
    return NULL;
}

const char *weight_map_warning(const sheard_chip_report *r, enum shear_weight_kind kind, char *line,
                               size_t size) {
    const char *other = isfinite(r->weight_slope) ? other_kind(r->weight_slope, kind) : NULL;
    if (other != NULL) {
        snprintf(line, size,
                 "over the chip the weight map goes with the noise as a map of kind '%s' does, but "
                 "it is read as '%s': give --weight-kind %s",
                 other, kinds[kind].name, other);
        return line;
    }
    if (r->n_extreme == 0)
        return NULL;
    snprintf(line, size,
             "%" PRId64 " of its pixels have 10^10 times the weight of most: are they the bad ones "
             "of a map of variances or deviations (--weight-kind variance or rms)?",
             r->n_extreme);
    return line;
}
