/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/pixels/defects.h: what the pixels of image, weight map, mask and segmentation mean. All
 * arrays are [n]. */
#pragma once

#include "shear/input.h"
#include "survey/pixels/mask_rule.h"

#include <stddef.h>
#include <stdint.h>

/* Set the defects that the values themselves show. `saturate` is NaN if unknown. */
void defects_of_values(const double *value, size_t n, double saturate, uint8_t *defect);
/* Set sigma, NaN where the weight is bad, and add PIXEL_BAD there. */
void defects_of_weights(const double *weight, size_t n, enum shear_weight_kind kind, float *sigma,
                        uint8_t *defect);
/* Add the mask's defects. A value that is not finite, or not whole for MASK_BITS, is PIXEL_BAD. */
void defects_of_mask(const double *mask, size_t n, const mask_rule *rule, uint8_t *defect);
/* Set the owners: the values as integers, or -1 if they are none from 0 to 2^31 - 1. */
void defects_owners(const double *segmentation, size_t n, int32_t *owner);
