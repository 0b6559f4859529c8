/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sheard/no_shear.h: why a field has no shear (enum shear_no_shear), for machines and for people.
 */
#ifndef SHEARD_NO_SHEAR_H
#define SHEARD_NO_SHEAR_H

#include "shear/sums.h"

#include <stdbool.h>
#include <stddef.h>

/* "too_few_stamps", "no_weight", "same_stamps", "no_signal", "swapped", "too_narrow",
 * "no_symmetry", "not_finite": names that stay. NULL if there is a shear. */
const char *sheard_no_shear_name(enum shear_no_shear why);
/* Back again; SHEAR_HAS_SHEAR for NULL and what is no such name. */
enum shear_no_shear sheard_no_shear_of(const char *name);

/* In a few words, without numbers; static. NULL if there is a shear. Of the enum alone, and of
 * a result, which also tells whether one stamp spoils the others. */
const char *sheard_no_shear_words(enum shear_no_shear why);
const char *sheard_no_shear_brief(const shear_result *r);
/* The cause with its numbers, and what to do. Each writes into buf and returns it. */
const char *sheard_no_shear_text(const shear_result *r, char *buf, size_t size);
const char *sheard_no_shear_advice(const shear_result *r, char *buf, size_t size);

/* One stamp has more than half of sum (w D)^2, of more than 5 stamps: it decides alone. */
bool sheard_one_outweighs(const shear_result *r);

#endif
