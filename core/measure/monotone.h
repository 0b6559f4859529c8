/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/monotone.h: the root of a decreasing function, which may have steps. */
#pragma once

/* Find the root between `low`, where the function is > 0, and `high`, where it is <= 0: false
 * position with the Illinois rule, until two steps differ by less than `tolerance`. */
double monotone_find_root(double (*function)(void *context, double x), void *context, double low,
                          double high, double tolerance);
