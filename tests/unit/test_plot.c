/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shearctl plot's helpers: cuts, profiles, text; and catalogs of every kind that can be drawn. */
#include "test.h"

#include "plot/array.h"
#include "plot/plot.h"
#include "plot/text.h"

#include <math.h>
#include <string.h>

static void test_cuts_know_their_edges(void **state) {
    (void)state;
    double array[5][7];
    for (int j = 0; j < 5; j++) {
        for (int i = 0; i < 7; i++)
            array[j][i] = 10 * j + i;
    }
    const plot_lattice lattice = {
        .nx = 7, .ny = 5, .x0 = 3.0, .y0 = 2.0, .step_x = 0.5, .step_y = 0.5};
    plot_cut cut;
    assert_int_equal(plot_cut_init(&cut, &array[0][0], &lattice, 1.0, NULL), SHEAR_OK);
    assert_int_equal(cut.nx, 5);
    assert_int_equal(cut.ny, 5);
    assert_true(cut.pixels[0] == 1.0 && cut.pixels[24] == 45.0);
    assert_true(cut.x.lo == -1.25 && cut.x.hi == 1.25);
    plot_cut_deinit(&cut);
    assert_int_equal(plot_cut_init(&cut, &array[0][0], &lattice, INFINITY, NULL), SHEAR_OK);
    assert_true(cut.nx == 7 && cut.ny == 5 && cut.x.lo == -1.75);
    assert_memory_equal(cut.pixels, array, sizeof array);
    plot_cut_deinit(&cut);
    assert_int_equal(plot_cut_init(&cut, &array[0][0], &lattice, 0.0, NULL), SHEAR_OK);
    assert_true(cut.nx == 1 && cut.ny == 1 && cut.pixels[0] == 23.0);
    plot_cut_deinit(&cut);
}

/* A function of the radius alone comes back; rings without samples are NaN. */
static void test_radial_mean_of_a_radial_function(void **state) {
    (void)state;
    double array[9][9];
    for (int j = 0; j < 9; j++) {
        for (int i = 0; i < 9; i++)
            array[j][i] = floor(hypot(i - 4, j - 4) + 0.5);
    }
    const plot_lattice lattice = {
        .nx = 9, .ny = 9, .x0 = 4.0, .y0 = 4.0, .step_x = 2.0, .step_y = 2.0};
    double mean[8];
    assert_int_equal(plot_radial_mean(mean, 8, 2.0, &array[0][0], &lattice, NULL), SHEAR_OK);
    for (int b = 0; b < 7; b++)
        assert_true(b == 7 || fabs(mean[b] - b) < 1e-13);
    assert_true(isnan(mean[7])); /* the corner is at 5.7 */
}

static void test_core_centre(void **state) {
    (void)state;
    double array[20][30] = {0};
    for (int j = 0; j < 20; j++) {
        for (int i = 0; i < 30; i++)
            array[j][i] = exp(-(pow(i - 17.0, 2) + pow(j - 6.5, 2)) / 18.0);
    }
    double x = 0.0;
    double y = 0.0;
    plot_core_centre(&array[0][0], 30, 20, &x, &y);
    assert_true(fabs(x - 17.0) < 1e-12 && fabs(y - 6.5) < 1e-12);
    memset(array, 0, sizeof array);
    plot_core_centre(&array[0][0], 30, 20, &x, &y);
    assert_true(x == 14.5 && y == 9.5);
}

static void test_minus_signs(void **state) {
    (void)state;
    char text[64];
    plot_print(text, sizeof text, "%.1f, %s, %g", -1.5, "log-bicubic", -2e-7);
    assert_string_equal(text, "\xe2\x88\x92"
                              "1.5, log-bicubic, \xe2\x88\x92"
                              "2e\xe2\x88\x92"
                              "07");
    char small[8];
    plot_print(small, sizeof small, "%d", -123456789);
    assert_true(strlen(small) < sizeof small);
}

static void test_tables_drop_what_is_too_much(void **state) {
    (void)state;
    plot_table t = {0};
    for (int i = 0; i < 2 * PLOT_TABLE_ROWS; i++)
        plot_table_add(&t, "key", "%0200d", i);
    assert_int_equal(t.n, PLOT_TABLE_ROWS);
    assert_int_equal(strlen(t.values[0]) < PLOT_CELL, 1);
}

enum { N = 64 };

static void fill(shear_catalog_table *t, shear_row rows[N]) {
    *t = (shear_catalog_table){
        .n = N, .field = "mock", .beta_px = 2.0, .r_psf_px = 1.5, .has_truth = true, .rows = rows};
    for (int i = 0; i < N; i++) {
        rows[i] =
            (shear_row){.n1 = sin(i), .n2 = cos(i), .d = 2.0, .weight = 1.0, .snr = 20.0 + i % 7};
    }
    t->result = (shear_result){.valid = true,
                               .g1 = 0.01,
                               .g2 = -0.02,
                               .g1_err = 0.003,
                               .g2_err = 0.004,
                               .n_stamps = N,
                               .n_used = N};
}

static void assert_drawn(const shear_catalog_table *t) {
    shear_figure *f = NULL;
    shear_error err = {0};
    assert_int_equal(plot_catalog(&f, t, &err), SHEAR_OK);
    assert_non_null(f);
    int inked = 0;
    for (int x = 0; x < 1280; x++)
        inked += shear_figure_pixel(f, x, 300) != 0xffffff;
    assert_true(inked >= 6); /* at least the frames of three panels */
    shear_figure_free(f);
}

static void test_catalogs_of_every_kind(void **state) {
    (void)state;
    shear_row rows[N];
    shear_catalog_table t;
    fill(&t, rows);
    assert_drawn(&t);
    t.result.valid = false; /* no shear, no truth, no noise, all flagged */
    t.result.g1 = t.result.g2 = t.result.g1_err = NAN;
    t.has_truth = false;
    for (int i = 0; i < N; i++) {
        rows[i].snr = rows[i].n1 = rows[i].d = NAN;
        rows[i].flags = 1u << i % SHEAR_N_FLAGS;
    }
    assert_drawn(&t);
    fill(&t, rows); /* all alike; missing columns are NaN */
    t.beta_px = t.r_psf_px = NAN;
    t.result.g1_err = t.result.g2_err = 0.0;
    for (int i = 0; i < N; i++)
        rows[i] = (shear_row){.n1 = 1.0, .n2 = NAN, .d = 1.0, .weight = NAN, .snr = 5.0};
    assert_drawn(&t);
    t.n = 0; /* a table without rows */
    t.result.valid = false;
    assert_drawn(&t);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_cuts_know_their_edges),
        cmocka_unit_test(test_radial_mean_of_a_radial_function),
        cmocka_unit_test(test_core_centre),
        cmocka_unit_test(test_minus_signs),
        cmocka_unit_test(test_tables_drop_what_is_too_much),
        cmocka_unit_test(test_catalogs_of_every_kind),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
