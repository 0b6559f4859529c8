/* SPDX-License-Identifier: GPL-3.0-or-later */
/* advice.h: what a result says about the settings it was measured with. Pure functions of result
 * and plan.
 *
 * Each writes one line into buf and returns it, or returns NULL where there is nothing to say. */
#ifndef CLIENT_ADVICE_H
#define CLIENT_ADVICE_H

#include "shear/plan.h"
#include "shear/sums.h"

#include <stddef.h>

/* The filter takes more than 1 % off the stacked flux (and more than 3 errors): the shear is
 * biased. */
const char *advice_filter(const shear_result *r, const shear_plan_info *plan, char *buf,
                          size_t size);

/* Without a filter: the border pixels of the galaxy stamps are brighter than those of the noise
 * stamps by more than 4 errors, and, were the whole stamp so bright, by more than 2 % of the mean
 * flux. */
const char *advice_bright_border(const shear_result *r, const shear_plan_info *plan, char *buf,
                                 size_t size);

/* Without a filter: the borders vary more than the noise stamps' by more than 4 errors, by more
 * than 5 % of the noise stamps' variance, and, were the whole stamp off by that much (root mean
 * square), by more than 2 % of the mean flux. The last condition is what is left where the noise is
 * negligible: a galaxy's own faint wings must not count. */
const char *advice_rough_border(const shear_result *r, const shear_plan_info *plan, char *buf,
                                size_t size);

#endif
