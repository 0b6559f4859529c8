/* SPDX-License-Identifier: GPL-3.0-or-later */
/* weight_map.h: is the weight map of the kind that --weight-kind says? */
#pragma once

#include "sheard/validation_report.h"

/* How often the standard deviations of good pixels have each power of 2. {0} is empty. */
typedef struct sigma_range {
    int64_t n[256];
} sigma_range;
void sigma_range_add(sigma_range *r, const float *sigma, const uint8_t *defect, size_t n);
/* Return how many are below 10^-5 (2^-17) of the median. */
int64_t sigma_range_extreme(const sigma_range *r);

/* Write what is doubtful of a chip's weight map, which is read as `kind`, and return `line`; NULL:
 * nothing. */
const char *weight_map_warning(const sheard_chip_report *r, enum shear_weight_kind kind, char *line,
                               size_t size);
