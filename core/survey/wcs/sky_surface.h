/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/wcs/sky_surface.h: the polynomials of TNX and ZPX, which IRAF writes as text into the
 * keywords WAT1_001, WAT1_002, ...
 *
 * wcslib's own parser of these writes beyond its arrays for some texts. */
#pragma once

#include "fits/header/card.h"
#include "shear/error.h"

#include <stdbool.h>

enum {
    SKY_SURFACE_ORDER = 10, /* terms along an axis: powers 0 to 9 */
    SKY_SURFACE_CARDS = 64, /* at most, per axis */
    SKY_SURFACE_PIECE = 68, /* characters of a card */
    SKY_SURFACE_PROJP = 30  /* parameters of ZPX: projp0 to projp29 */
};

/* The text of an axis. */
typedef struct sky_surface_text {
    char text[SKY_SURFACE_CARDS * SKY_SURFACE_PIECE + 1];
} sky_surface_text;

/* Return whether the card is WAT1_nnn or WAT2_nnn, and add it to its axis's text. *too_long is true
 * if it is beyond the last card. */
bool sky_surface_add(sky_surface_text text[2], const char card[SF_CARD], bool *too_long);

enum sky_surface_kind { SKY_SURFACE_NONE = 0, SKY_CHEBYSHEV, SKY_LEGENDRE, SKY_MONOMIAL };

/* The correction c[m][n] p_m(x) p_n(y) of an axis, degrees: x and y are xi and eta, which for other
 * than monomials are scaled from [low, high] to [-1, 1]. */
typedef struct sky_surface {
    enum sky_surface_kind kind; /* NONE: there is no correction */
    double low[2], high[2];
    double c[SKY_SURFACE_ORDER][SKY_SURFACE_ORDER];
    double projp[SKY_SURFACE_PROJP]; /* NaN: absent */
} sky_surface;

/* Parse the text of an axis. Return what is wrong with it, or NULL. */
const char *sky_surface_parse(sky_surface *s, const sky_surface_text *text);
