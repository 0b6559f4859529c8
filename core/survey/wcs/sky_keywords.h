/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/wcs/sky_keywords.h: the keywords of an image's celestial coordinates, as numbers.
 *
 * wcslib never sees a file's own cards: every keyword that it is told is checked here. Alternate
 * coordinates (CRVAL1A), and axes beyond the second, are not looked at. */
#pragma once

#include "survey/wcs/sky_ctype.h"
#include "survey/wcs/sky_surface.h"

#include <stdint.h>

enum {
    SKY_PV = 40,    /* PVi_0 ... PVi_39: TPV has no more, and no projection more than 21 */
    SKY_POWERS = 10 /* A_p_q and B_p_q have p + q <= 9 */
};

/* Numbers that are absent are NaN. Arrays are by axis, CTYPE1 first. */
typedef struct sky_keywords {
    /* The projection is TPV also for TAN with PV coefficients (SCAMP); with -SIP, sip[] counts, and
     * pv[] is absent. TNX is TAN, ZPX is ZPN, with surface[]. */
    sky_ctype type;
    double crval[2], crpix[2], cdelt[2], crota[2];
    double cd[2][2], pc[2][2];
    double lonpole, latpole, equinox;
    double pv[2][SKY_PV];
    double sip[2][SKY_POWERS][SKY_POWERS]; /* A_p_q, B_p_q */
    double sip_order[2];
    sky_surface surface[2]; /* kind 0 without TNX or ZPX */
} sky_keywords;

/* Read the keywords of `count` cards of 80 characters; `where` names the file and HDU in messages.
 * *celestial is false, without an error, if neither CTYPE1 nor CTYPE2 is an angle on the sky.
 * SHEAR_E_FORMAT: a keyword that is not a number, missing, repeated or in contradiction to another;
 * coordinates that sky_ctype_parse refuses; tables of distortion. */
int sky_keywords_read(sky_keywords *k, const char *cards, int64_t count, const char *where,
                      bool *celestial, shear_error *err);

/* Return whether the card belongs to the primary coordinates, whether read here or not. */
bool sky_keywords_has(const char card[SF_CARD]);
