/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Catalogs of sources: the same rows in all formats are the same sources, and real ones are read.
 */
#include "source_fixture.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static void test_one_table(void **state) {
    (void)state;
    const char *path = fixture_path("one.cat");
    source_fixture_write(path, 50);
    source_list s = source_fixture_read(path, NULL);
    assert_int_equal(s.n, 50);
    for (int64_t i = 0; i < s.n; i++) {
        assert_true(s.id[i] == i + 1);
        assert_true(s.x[i] == 10.5 + (double)i * 1.25);
        assert_true(s.y[i] == 2000.0 - (double)i * 0.5);
        assert_int_equal(s.selected[i], i % 8 < 4);
    }
    assert_null(s.ra);
    assert_null(s.dec);
    assert_null(s.r_gal);
    assert_null(s.weight);
    assert_null(s.a);
    source_list_deinit(&s);
}

/* ---- real files ---- */

static bool near(double a, double b, double tolerance) {
    return fabs(a - b) <= tolerance;
}

/* SExtractor wrote the same 915 rows as FITS_1.0 and as text, with as many digits as the text has.
 */
static void test_real_twins(void **state) {
    (void)state;
    const char *fits = source_fixture_real("ldac/sim_FITS_1.0.cat");
    const char *text = source_fixture_real("ldac/sim_ASCII_HEAD.cat");
    if (fits == NULL || text == NULL)
        skip();
    source_list a = source_fixture_read(fits, NULL);
    source_list b = source_fixture_read(text, NULL);
    assert_int_equal(a.n, 915);
    assert_int_equal(b.n, 915);
    for (int64_t i = 0; i < a.n; i++) {
        assert_true(a.id[i] == b.id[i]);
        assert_true(near(a.x[i], b.x[i], 5.1e-5) && near(a.y[i], b.y[i], 5.1e-5));
        assert_true(near(a.ra[i], b.ra[i], 5.1e-8) && near(a.dec[i], b.dec[i], 5.1e-8));
        assert_true(near(a.r_gal[i], b.r_gal[i], 1.1e-3));
        assert_true(near(a.a[i], b.a[i], 1.3e-3));
        assert_int_equal(a.selected[i], b.selected[i]);
    }
    source_list_deinit(&a);
    source_list_deinit(&b);
}

typedef struct real_file {
    const char *name;
    int64_t rows;
    bool sky, ellipse;
} real_file;

static void test_real_files(void **state) {
    (void)state;
    static const real_file files[] = {
        {"ldac/DECam_00241238_01_cat.fits", 950, true, true},
        {"ldac/D00572501_z_c01_r3624p01_red-fullcat.fits", 2469, true, true},
        {"ldac/DECam_00241238_01_psfcat_tb_maxmag_17.0_magcut_3.0_findstars.fits", 117, true, true},
        {"ldac/DECam_00241238_01_psfcat.used.fits", 105, false, false},
        {"run/ntt_ldac.cat.gz", 680, false, true},
        {"run/ntt_psfex_out.cat", 680, false, false}};
    for (size_t k = 0; k < sizeof files / sizeof *files; k++) {
        const char *path = source_fixture_real(files[k].name);
        if (path == NULL)
            continue;
        source_catalog *c = source_fixture_open(path, NULL);
        int64_t cards = 0;
        assert_non_null(source_catalog_header(c, 0, &cards));
        assert_true(cards >= 7);
        source_list s = source_fixture_load(c, 0);
        assert_int_equal(s.n, files[k].rows);
        assert_true((s.ra != NULL) == files[k].sky);
        assert_true((s.a != NULL) == files[k].ellipse);
        for (int64_t i = 0; i < s.n; i++)
            assert_true(s.x[i] > 0.0 && s.x[i] < 2100.0 && s.y[i] > 0.0 && s.y[i] < 4200.0);
        source_list_deinit(&s);
        source_catalog_close(c);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_one_table),
        cmocka_unit_test(test_real_twins),
        cmocka_unit_test(test_real_files),
    };
    return cmocka_run_group_tests(tests, fixture_setup, fixture_teardown);
}
