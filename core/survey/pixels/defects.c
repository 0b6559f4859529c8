/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/pixels/defects.h"

#include "base/simd.h"
#include "survey/pixels/chip_pixels.h"

#include <float.h>
#include <math.h>
#include <string.h>

SHEAR_SIMD void defects_of_values(const double *restrict value, size_t n, double saturate,
                                  uint8_t *restrict defect) {
#pragma omp simd
    for (size_t i = 0; i < n; i++) {
        const int bad = fabs(value[i]) <= DBL_MAX ? 0 : PIXEL_BAD;
        const int saturated = value[i] >= saturate ? PIXEL_SATURATED : 0;
        defect[i] = (uint8_t)(bad | saturated);
    }
}

/* SExtractor takes a variance of 1e30 or more for a bad pixel; that is a standard deviation of
 * 1e15, as a float is nearest to it. Below the other limit one is not a normal float. */
static const double least_sigma = FLT_MIN;
static const double most_sigma = (double)1e15F;

/* Store sigma, or NaN and a defect if it cannot be one. Two comparisons by themselves, and no
 * conversion that only one branch needs: else it becomes no vector. */
static SHEAR_INLINE void store(double s, float *sigma, uint8_t *defect) {
    const int below = s >= least_sigma ? 0 : PIXEL_BAD;
    const int beyond = s < most_sigma ? 0 : PIXEL_BAD;
    const int bad = below | beyond;
    *sigma = (float)(s + (bad != 0 ? (double)NAN : 0.0));
    *defect = (uint8_t)(*defect | bad);
}

SHEAR_SIMD static void of_weights(const double *restrict w, size_t n, float *restrict sigma,
                                  uint8_t *restrict defect) {
#pragma omp simd
    for (size_t i = 0; i < n; i++)
        store(1.0 / sqrt(w[i]), &sigma[i], &defect[i]); /* 1/0 is beyond the limit */
}

SHEAR_SIMD static void of_variances(const double *restrict w, size_t n, float *restrict sigma,
                                    uint8_t *restrict defect) {
#pragma omp simd
    for (size_t i = 0; i < n; i++)
        store(sqrt(w[i]), &sigma[i], &defect[i]);
}

SHEAR_SIMD static void of_rms(const double *restrict w, size_t n, float *restrict sigma,
                              uint8_t *restrict defect) {
#pragma omp simd
    for (size_t i = 0; i < n; i++)
        store(w[i], &sigma[i], &defect[i]);
}

void defects_of_weights(const double *weight, size_t n, enum shear_weight_kind kind, float *sigma,
                        uint8_t *defect) {
    switch (kind) {
    case SHEAR_WEIGHT_IS_VARIANCE:
        of_variances(weight, n, sigma, defect);
        break;
    case SHEAR_WEIGHT_IS_RMS:
        of_rms(weight, n, sigma, defect);
        break;
    default:
        of_weights(weight, n, sigma, defect);
    }
}

/* The last bits of the sum of this and a whole number below 2^51 are its two's complement. */
static const double magic = 0x1.8p52;

SHEAR_SIMD static void of_bits(const double *restrict mask, size_t n, uint64_t bad,
                               uint64_t saturated, uint8_t *restrict defect) {
#pragma omp simd
    for (size_t i = 0; i < n; i++) {
        const double sum = mask[i] + magic;
        uint64_t bits = 0;
        memcpy(&bits, &sum, sizeof bits);
        const bool whole = fabs(mask[i]) < 0x1p51 && sum - magic == mask[i];
        const int is_bad = whole && (bits & bad) == 0 ? 0 : PIXEL_BAD;
        const int is_saturated = whole && (bits & saturated) != 0 ? PIXEL_SATURATED : 0;
        defect[i] = (uint8_t)(defect[i] | is_bad | is_saturated);
    }
}

/* Compare with 0: a pixel is good if the mask is 0; or if it is not, if `zero` is bad. */
SHEAR_SIMD static void of_zeros(const double *restrict mask, size_t n, bool zero,
                                uint8_t *restrict defect) {
#pragma omp simd
    for (size_t i = 0; i < n; i++) {
        const double size = fabs(mask[i]);
        const bool good = zero ? size > 0.0 && size <= DBL_MAX : size == 0.0;
        defect[i] = (uint8_t)(defect[i] | (good ? 0 : PIXEL_BAD));
    }
}

void defects_of_mask(const double *mask, size_t n, const mask_rule *rule, uint8_t *defect) {
    if (rule->family == MASK_BITS) {
        of_bits(mask, n, rule->bad, rule->saturated, defect);
    } else {
        of_zeros(mask, n, rule->family == MASK_ZERO, defect);
    }
}

SHEAR_SIMD void defects_owners(const double *restrict segmentation, size_t n,
                               int32_t *restrict owner) {
#pragma omp simd
    for (size_t i = 0; i < n; i++) {
        const double v = segmentation[i];
        const double sum = v + magic;
        uint64_t bits = 0;
        memcpy(&bits, &sum, sizeof bits);
        const int below = v >= 0.0 ? 0 : 1;
        const int beyond = v <= (double)INT32_MAX ? 0 : 1;
        const int part = sum - magic == v ? 0 : 1;
        owner[i] = (below | beyond | part) != 0 ? -1 : (int32_t)bits;
    }
}
