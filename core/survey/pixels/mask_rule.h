/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/pixels/mask_rule.h: which values of a mask's pixels are defects. */
#pragma once

#include "fits/header/cards.h"

#include <stdint.h>

enum mask_family {
    MASK_ANY = 0, /* every value but 0 */
    MASK_ZERO,    /* 0 */
    MASK_BITS     /* certain bits */
};
/* Bits of a pixel that are read: whole numbers of a double, negative ones as well. */
enum { MASK_MAX_BITS = 51 };

typedef struct mask_rule {
    enum mask_family family;
    uint64_t bad, saturated; /* of MASK_BITS */
} mask_rule;

/* Parse "any", "zero", "bits=N" or "planes=NAME,...". Planes are the bits that the keywords
 * MP_<NAME> in the mask's header number. NULL: the usual planes if the header has such keywords,
 * else "any". SHEAR_E_SETTING: it is none of these; SHEAR_E_FORMAT: the header has no such plane.
 */
int mask_rule_init(mask_rule *rule, const char *text, const sf_cards *mask, shear_error *err);
