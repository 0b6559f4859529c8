/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sheard/no_shear.h: the reason why a field has no shear (enum shear_no_shear), as a name, in words
 * and as advice. */
#ifndef SHEARD_NO_SHEAR_H
#define SHEARD_NO_SHEAR_H

#include "shear/sums.h"

#include <stdbool.h>
#include <stddef.h>

/* Return the name of the reason: "too_few_stamps", "no_weight", "same_stamps", "no_signal",
 * "swapped", "too_narrow", "no_symmetry" or "not_finite"; NULL if there is a shear. These names
 * never change. */
const char *sheard_no_shear_name(enum shear_no_shear why);
/* Return the reason of that name, or SHEAR_HAS_SHEAR for NULL and any other name. */
enum shear_no_shear sheard_no_shear_of(const char *name);

/* Return the reason in a few words without numbers, static, or NULL if there is a shear.
 * sheard_no_shear_brief also detects that one stamp outweighs the others. */
const char *sheard_no_shear_words(enum shear_no_shear why);
const char *sheard_no_shear_brief(const shear_result *r);
/* Write the reason with its numbers, or what to do, into buf. Return buf. */
const char *sheard_no_shear_text(const shear_result *r, char *buf, size_t size);
const char *sheard_no_shear_advice(const shear_result *r, char *buf, size_t size);

/* Return whether one stamp of more than 5 has more than half of sum (w D)^2, so that it decides
 * alone. */
bool sheard_one_outweighs(const shear_result *r);

#endif
