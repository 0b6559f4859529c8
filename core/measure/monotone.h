/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/monotone.h: functions that fall through 0, steps and all. */
#ifndef SHEAR_MEASURE_MONOTONE_H
#define SHEAR_MEASURE_MONOTONE_H

typedef struct monotone {
    double (*at)(void *context, double x);
    void *context;
} monotone;

/* The root between `low`, where the function is above 0, and `high`, where it is not: false
 * position with the Illinois rule, until two steps differ by less than `tolerance`. */
double monotone_find_root(const monotone *f, double low, double high, double tolerance);

#endif
