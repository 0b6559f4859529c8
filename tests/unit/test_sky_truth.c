/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Positions and Jacobians of real headers, as another program computed them. */
#include "fits/header/cards.h"
#include "sky_fixture.h"
#include "survey/wcs/head_file.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

static const struct {
    const char *name, *file;
    int hdu;
} headers[] = {{"tpv_mosaic.fits", "wcs/tpv.fits", 0},
               {"tanpv_scamp_style.fits", "wcs/tanpv.fits.gz", 0},
               {"sipsample.fits", "wcs/sipsample.fits", 0},
               {"tanflip.fits", "wcs/tanflip.fits.gz", 0},
               {"DECam_00154912_12_header.fits", "wcs/DECam_00154912_12_header.fits", 0},
               {"hsc_small.fits", "exposures/HSC-0908120-056-small.fits", 1},
               {"sim_sci.fits", "run/sim_sci_int16.fits.fz", 1},
               {"razero.fits", "wcs/razero.fits", 0},
               {"pole.fits", "wcs/pole.fits", 0},
               {"decam_ooi.fits", "exposures/c4d_170916_045042_ooi_r_ls9.N15.fits", 1}};

static double real(const json_t *object, const char *key) {
    const json_t *const value = json_object_get(object, key);
    assert_true(json_is_number(value));
    return json_number_value(value);
}

/* Compare one point. Truth has the Jacobian of (East, North). */
static void compare(sky_map *map, const json_t *point) {
    const double x = real(point, "x"), y = real(point, "y");
    const double a = real(point, "ra"), d = real(point, "dec");
    double ra, dec, xx, yy, j[4];
    sky_map_to_sky(map, 1, &x, &y, &ra, &dec);
    assert_true(sky_distance(ra, dec, a, d) < 1e-8);
    sky_map_to_pixel(map, 1, &a, &d, &xx, &yy);
    assert_close(xx, x, 1e-4);
    assert_close(yy, y, 1e-4);
    assert_true(sky_map_jacobian(map, x, y, j));
    const json_t *const rows = json_object_get(point, "J");
    for (size_t i = 0; i < 4; i++) {
        const double truth = json_number_value(json_array_get(json_array_get(rows, i / 2), i % 2));
        assert_close(i < 2 ? -j[i] : j[i], truth, 1e-7);
    }
}

static void check_header(const char *file, int hdu, const json_t *truth) {
    char path[1024];
    shear_error err = {0};
    sf_file f;
    sf_cards cards;
    sky_map *map = NULL;
    snprintf(path, sizeof path, SHEAR_SHARED "/survey/%s", file);
    assert_int_equal(sf_file_open(&f, path, -1, &err), SHEAR_OK);
    assert_true(hdu < f.count);
    assert_int_equal(sf_cards_init(&cards, &f, &f.hdus[hdu], "1", &err), SHEAR_OK);
    if (sky_map_new(&map, cards.text, cards.count, file, &err) != SHEAR_OK)
        fail_msg("%s", err.message);
    assert_non_null(map);
    size_t i = 0;
    const json_t *point = NULL;
    json_array_foreach(json_object_get(truth, "points"), i, point) {
        compare(map, point);
    }
    assert_true(i >= 5);
    sky_map_free(map);
    sf_cards_deinit(&cards);
    sf_file_close(&f);
}

static void real_headers(void **state) {
    (void)state;
    const char *const path = SHEAR_SHARED "/survey/wcs/wcs_truth.json";
    if (access(path, R_OK) != 0)
        skip();
    json_t *const truth = json_load_file(path, 0, NULL);
    for (size_t i = 0; i < sizeof headers / sizeof *headers; i++)
        check_header(headers[i].file, headers[i].hdu, json_object_get(truth, headers[i].name));
    json_decref(truth);
}

/* A file of SCAMP's, whose polynomial is not small: its chip is a map, there and back. */
static void real_head_file(void **state) {
    (void)state;
    const char *const path = SHEAR_SHARED "/survey/wcs/scamp.head";
    if (access(path, R_OK) != 0)
        skip();
    head_file h;
    shear_error err = {0};
    assert_int_equal(head_file_init(&h, path, -1, &err), SHEAR_OK);
    assert_int_equal(h.n, 1);
    int64_t count = 0;
    char *const cards = head_file_merge(&h, 0, NULL, &count);
    sky_map *map = NULL;
    assert_int_equal(sky_map_new(&map, cards, count, path, &err), SHEAR_OK);
    assert_non_null(map);
    for (int i = 0; i < 100; i++) {
        const double x = 200.0 * (i % 10), y = 200.0 * (double)(i / 10);
        double ra, dec, xx, yy;
        sky_map_to_sky(map, 1, &x, &y, &ra, &dec);
        sky_map_to_pixel(map, 1, &ra, &dec, &xx, &yy);
        assert_close(xx, x, 1e-5);
        assert_close(yy, y, 1e-5);
    }
    sky_map_free(map);
    free(cards);
    head_file_deinit(&h);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(real_headers),
                                       cmocka_unit_test(real_head_file)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
