/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/wcs/sky_ctype.h: what kind of coordinates an image has, from CTYPE1 and CTYPE2. */
#pragma once

#include "fits/header/card.h"
#include "shear/error.h"

#include <stdbool.h>

typedef struct sky_ctype {
    char text[2][SF_CARD]; /* CTYPE1 and CTYPE2; "": absent */
    char projection[4];    /* TAN, TPV, ... */
    int lng;               /* axis of RA, 0 or 1 */
    bool has_sip;          /* they end in -SIP */
} sky_ctype;

/* Return whether a CTYPEi is meant to be an angle on the sky. */
bool sky_ctype_is_angle(const char *ctype);

/* Parse the texts. SHEAR_E_FORMAT: they are not RA and Dec of one projection, or of one that is not
 * read. */
int sky_ctype_parse(sky_ctype *t, const char *where, shear_error *err);
