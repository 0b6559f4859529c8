/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/cutout/marks.h"

#include "base/simd.h"

SHEAR_SIMD void marks_add(uint8_t *restrict to, const uint8_t *restrict from, size_t n) {
#pragma omp simd
    for (size_t i = 0; i < n; i++)
        to[i] |= from[i] != 0;
}

SHEAR_SIMD bool marks_meet(const uint8_t *restrict one, const uint8_t *restrict other, size_t n) {
    uint8_t found = 0;
#pragma omp simd reduction(| : found)
    for (size_t i = 0; i < n; i++)
        found |= (uint8_t)((one[i] != 0) & (other[i] != 0));
    return found != 0;
}
