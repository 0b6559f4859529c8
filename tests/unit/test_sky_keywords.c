/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which headers are refused, and why; which have no coordinates; what is left alone. */
#include "sky_fixture.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A good header with one card more is refused. */
static void refuse_with(const char *type, const char *card, const char *word) {
    sky_header h = sky_header_make(type);
    if (strstr(type, "SIP") != NULL)
        sky_header_add_sip(&h);
    sky_header_set(&h, card);
    sky_fixture_refuse(&h, SHEAR_E_FORMAT, word, NULL);
}

static void numbers_are_checked(void **state) {
    (void)state;
    refuse_with("TAN", "CRVAL1  = NaN", "CRVAL1");
    refuse_with("TAN", "CRVAL2  = 'text'", "CRVAL2");
    refuse_with("TAN", "CRPIX1  = 1E999", "CRPIX1");
    refuse_with("TAN", "CD1_1   = T", "CD1_1");
    refuse_with("TAN", "LONPOLE = INF", "LONPOLE");
    refuse_with("TAN-SIP", "A_2_0   = ''", "A_2_0");
    refuse_with("TPV", "PV1_4   = 1.5X", "PV1_4");
}

static void contradictions_are_named(void **state) {
    (void)state;
    refuse_with("TAN", "PC1_1   = 1.0", "both CDi_j and PCi_j");
    refuse_with("TAN", "CUNIT1  = 'arcsec'", "CUNIT1");
    refuse_with("TAN", "EQUINOX = 1950.0", "EQUINOX");
    refuse_with("TAN", "CPDIS1  = 'LOOKUP'", "CPDIS1");
    refuse_with("TAN", "D2IMDIS1= 'LOOKUP'", "D2IMDIS1");
    refuse_with("TAN", "A_2_0   = 1E-7", "-SIP");
    refuse_with("TAN", "CTYPE2  = 'DEC--SIN'", "one projection");
    refuse_with("TAN", "CTYPE2  = 'RA---TAN'", "one projection");
    refuse_with("TAN", "CTYPE2  = 'FREQ'", "one projection");
    refuse_with("TAN-SIP", "A_ORDER = 3", "A_ORDER is 3");
    refuse_with("TAN-SIP", "B_ORDER = 1000000000", "B_ORDER");
    refuse_with("TAN-SIP", "B_ORDER = -1", "B_ORDER");
    refuse_with("TAN-SIP", "A_ORDER = 2.5", "A_ORDER");
    refuse_with("TAN-SIP", "A_7_7   = 1.0", "A_7_7");
    refuse_with("TPV", "PV1_40  = 1.0", "PV1_40");
    sky_header h = sky_header_make("TAN");
    memcpy(h.cards[h.n], "CRVAL1  = 150.2", 15);
    memset(h.cards[h.n++] + 15, ' ', 65);
    sky_fixture_refuse(&h, SHEAR_E_FORMAT, "CRVAL1 is given twice", NULL);
}

static void what_is_missing_is_named(void **state) {
    (void)state;
    const char *const needed[] = {"CRVAL1", "CRVAL2", "CRPIX1", "CRPIX2"};
    for (size_t i = 0; i < sizeof needed / sizeof *needed; i++) {
        sky_header h = sky_header_make("TAN");
        sky_header_remove(&h, needed[i]);
        sky_fixture_refuse(&h, SHEAR_E_FORMAT, needed[i], "missing", NULL);
    }
    const char *const matrix[] = {"CD1_1", "CD1_2", "CD2_1", "CD2_2"};
    sky_header h = sky_header_make("TAN");
    for (int i = 0; i < 4; i++)
        sky_header_remove(&h, matrix[i]);
    sky_fixture_refuse(&h, SHEAR_E_FORMAT, "CDELT1", NULL);
    h = sky_header_make("TAN-SIP");
    sky_fixture_refuse(&h, SHEAR_E_FORMAT, "A_ORDER", NULL);
    h = sky_header_make("TAN");
    sky_header_remove(&h, "CTYPE2");
    sky_fixture_refuse(&h, SHEAR_E_FORMAT, "CTYPE2", NULL);
}

static void projections_that_are_not_read(void **state) {
    (void)state;
    const char *const types[] = {"TAB", "TPU", "XYZ", "TAN-TPD", "TA", "tan"};
    for (size_t i = 0; i < sizeof types / sizeof *types; i++) {
        const sky_header h = sky_header_make(types[i]);
        sky_fixture_refuse(&h, SHEAR_E_FORMAT, "CTYPE", NULL);
    }
    sky_header h = sky_header_make("TAN");
    sky_header_set(&h, "CTYPE1  = 'GLON-TAN'");
    sky_header_set(&h, "CTYPE2  = 'GLAT-TAN'");
    sky_fixture_refuse(&h, SHEAR_E_FORMAT, "GLON-TAN", NULL);
}

static void singular_matrices_are_refused(void **state) {
    (void)state;
    sky_header h = sky_header_make("TAN");
    sky_header_number(&h, "CD1_1", 1e-4);
    sky_header_number(&h, "CD1_2", 2e-4);
    sky_header_number(&h, "CD2_1", 1e-4);
    sky_header_number(&h, "CD2_2", 2e-4);
    sky_fixture_refuse(&h, SHEAR_E_FORMAT, "singular", NULL);
    const char *const matrix[] = {"CD1_1", "CD1_2", "CD2_1", "CD2_2"};
    for (int i = 0; i < 4; i++)
        sky_header_number(&h, matrix[i], 0.0);
    sky_fixture_refuse(&h, SHEAR_E_FORMAT, "singular", NULL);
    /* one that is almost singular has positions, but no Jacobian */
    sky_header_number(&h, "CD1_1", 1e-4);
    sky_header_number(&h, "CD2_2", 1e-14);
    sky_map *map = sky_fixture_map(&h);
    double j[4];
    assert_false(sky_map_jacobian(map, 100.0, 100.0, j));
    sky_map_free(map);
}

/* Nothing is said of headers without RA and Dec, whatever else is in them. */
static void no_coordinates(void **state) {
    (void)state;
    const char *const types[] = {"CTYPE1  = ''", "CTYPE1  = 'LINEAR'", "CTYPE1  = 'PIXEL'",
                                 "CTYPE1  = 5",  "CTYPE1  = 'RAW'",    "COMMENT   none"};
    for (size_t i = 0; i < sizeof types / sizeof *types; i++) {
        sky_header h = sky_header_make("TAN");
        sky_header_remove(&h, "CTYPE1");
        sky_header_remove(&h, "CTYPE2");
        sky_header_set(&h, types[i]);
        sky_header_set(&h, "CRVAL1  = NaN");
        sky_header_set(&h, "CUNIT1  = 'pixel'");
        shear_error err;
        sky_map *map = NULL;
        assert_int_equal(sky_map_new(&map, h.cards[0], h.n, "f", &err), SHEAR_OK);
        assert_null(map);
    }
    shear_error err;
    sky_map *map = NULL;
    assert_int_equal(sky_map_new(&map, NULL, 0, "f", &err), SHEAR_OK);
    assert_null(map);
}

/* Alternate coordinates, third axes and equal repetitions change nothing. */
static void what_is_left_alone(void **state) {
    (void)state;
    const char *const more[] = {
        "CRVAL1A = 0.0",    "CTYPE1A = 'LINEAR'", "CRPIX1A = 1.0",
        "LTV1    = -100.0", "NAXIS   = 3",        "CTYPE3  = 'FREQ'",
        "CRVAL3  = NaN",    "CD3_3   = 0.0",      "CD1_3   = 7.0",
        "PV3_1   = 'x'",    "EQUINOX = 2000.0",   "WCSAXES = 3",
        "PV2_1   = 0.0",    "PV2_2   = 0.0",      "CRVAL1  =             1.501D+02"};
    sky_header h = sky_header_make("TAN"), plain = h;
    for (size_t i = 0; i < sizeof more / sizeof *more; i++)
        sky_header_set(&h, more[i]);
    memcpy(h.cards[h.n++], h.cards[3], 80);
    sky_map *map = sky_fixture_map(&h), *same = sky_fixture_map(&plain);
    double x = 1.0, y = 2.0, ra[2], dec[2];
    sky_map_to_sky(map, 1, &x, &y, &ra[0], &dec[0]);
    sky_map_to_sky(same, 1, &x, &y, &ra[1], &dec[1]);
    assert_true(ra[0] == ra[1] && dec[0] == dec[1]);
    sky_map_free(map);
    sky_map_free(same);
    sky_map_free(NULL);
}

/* A million cards take no time and no memory. */
static void a_million_cards(void **state) {
    (void)state;
    enum { MILLION = 1000000 };
    sky_header h = sky_header_make("TPV");
    sky_header_add_tpv(&h);
    char *const cards = malloc((size_t)MILLION * 80);
    assert_non_null(cards);
    for (int64_t i = 0; i < MILLION; i++)
        memcpy(cards + 80 * i, h.cards[i % h.n], 80);
    shear_error err;
    sky_map *map = NULL;
    assert_int_equal(sky_map_new(&map, cards, MILLION, "f", &err), SHEAR_OK);
    assert_non_null(map);
    sky_map_free(map);
    free(cards);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers_are_checked),
        cmocka_unit_test(contradictions_are_named),
        cmocka_unit_test(what_is_missing_is_named),
        cmocka_unit_test(projections_that_are_not_read),
        cmocka_unit_test(singular_matrices_are_refused),
        cmocka_unit_test(no_coordinates),
        cmocka_unit_test(what_is_left_alone),
        cmocka_unit_test(a_million_cards),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
