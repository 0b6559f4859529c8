/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sky_fixture.h: headers with celestial coordinates, and what they say by formulas of this file. */
#pragma once

#include "survey/wcs/sky_map.h"
#include "test.h"

/* cmocka's own comparison is in float. */
#define assert_close(a, b, tolerance) sky_check_close(a, b, tolerance, #a, __FILE__, __LINE__)
void sky_check_close(double a, double b, double tolerance, const char *what, const char *file,
                     int line);

enum { SKY_FIXTURE_CARDS = 256 };

typedef struct sky_header {
    char cards[SKY_FIXTURE_CARDS][80];
    int64_t n;
} sky_header;

/* Set a card, such as "CRVAL1  = 10.5", in place of the one with its keyword, or at the end. */
void sky_header_set(sky_header *h, const char *card);
/* The same as "KEY = value". */
void sky_header_number(sky_header *h, const char *key, double value);
void sky_header_remove(sky_header *h, const char *key);
/* The coordinates `type` (TAN, TPV, TAN-SIP ...) of a chip of 2,000 x 4,000 pixels of 0.26 arcsec,
 * turned by 20 degrees, at RA 150.1, Dec 2.2. */
sky_header sky_header_make(const char *type);
/* Add distortions of a few per cent at the chip's corners: PVi_m with radial terms, up to degree 7;
 * or A_p_q and B_p_q, up to order 4. */
void sky_header_add_tpv(sky_header *h);
void sky_header_add_sip(sky_header *h);

/* Return the map, which must be there; or check that it is refused with `code`, and that the
 * message or advice has these words (up to NULL). */
sky_map *sky_fixture_map(const sky_header *h);
void sky_fixture_refuse(const sky_header *h, int code, ...);

/* Compute the place of pixel (x, y) from the header's numbers: TAN, with TPV or SIP where it has
 * coefficients; axes may be exchanged. */
void sky_oracle(const sky_header *h, double x, double y, double *ra, double *dec);
/* Return the distance of two places, degrees. */
double sky_distance(double ra, double dec, double ra0, double dec0);
/* Compute the Jacobian as by sky_map_jacobian, from differences of unit vectors. */
void sky_oracle_jacobian(const sky_header *h, double x, double y, double j[4]);
