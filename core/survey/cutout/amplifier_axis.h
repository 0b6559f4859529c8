/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/cutout/amplifier_axis.h: the pixels of a chip along one axis, in as many equal parts as
 * there are amplifiers side by side: each has its own gain, and noise of its own level and
 * correlation. Where the parts are no whole pixels, a border is rounded down. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

typedef struct amplifier_axis {
    int pixels, parts; /* parts <= pixels */
} amplifier_axis;

/* Return the first pixel of an amplifier; of amplifier `parts`, all pixels. */
static inline int amplifier_axis_start(const amplifier_axis *a, int amplifier) {
    return (int)((int64_t)amplifier * a->pixels / a->parts);
}

/* Return the amplifier of a pixel of the chip. */
static inline int amplifier_axis_at(const amplifier_axis *a, int pixel) {
    return (int)((((int64_t)pixel + 1) * a->parts - 1) / a->pixels);
}

/* Return whether the pixels first .. end-1 are all of one amplifier; false beyond the chip. */
static inline bool amplifier_axis_holds(const amplifier_axis *a, int first, int end) {
    return first >= 0 && end <= a->pixels &&
           amplifier_axis_at(a, first) == amplifier_axis_at(a, end - 1);
}
