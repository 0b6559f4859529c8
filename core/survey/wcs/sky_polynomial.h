/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/wcs/sky_polynomial.h: the distortion polynomials of a map, for wcslib: SIP, TPV, TNX, ZPX.
 */
#pragma once

#include "survey/wcs/sky_keywords.h"

#include <wcslib/lin.h>

/* Attach the polynomials, if there are any, to an initialised *lin, which owns them then. Return
 * false if out of memory. */
bool sky_polynomial_attach(struct linprm *lin, const sky_keywords *k);
