/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The border filter: its formula and symmetry, the rules for its core, and the flux that it
 * removes. */
#include "gaussian.h"
#include "oracle.h"
#include "pair.h"
#include "test.h"

#include "base/cleanup.h"
#include "measure/filter.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* The filter of Zhang (2010), section 4.2, on every point, and the bounding columns and rows of
 * what is not zero. Values below 1e-18 are zero. */
static void check_map(int nx, int ny, int s, double core, double width) {
    filter_map m;
    arena a = {.used = 1 << 22};
    CLEANUP(release_free) void *memory = arena_allocate(&a);
    filter_map_place(&m, nx, ny, s, &a);
    filter_map_fill(&m, core, width);
    for (int y = 0; y < ny * s; y++) {
        for (int x = 0; x < nx * s; x++) {
            const double v = m.value[y * nx * s + x];
            assert_near(v, oracle_filter(nx, ny, s, x, y, core, width), 2e-18 + 1e-14 * v, 1.0,
                        "filter");
            /* Symmetric about the stamp's centre, on the periodic grid. */
            const int mx = ((nx - 1) * s - x + nx * s) % (nx * s);
            const int my = ((ny - 1) * s - y + ny * s) % (ny * s);
            assert_true(v == m.value[y * nx * s + mx] && v == m.value[my * nx * s + x]);
            const bool inside = y >= m.y0 && y < m.y1 && x >= m.x0[y] && x < m.x1[y];
            assert_true(inside || v == 0.0);
        }
        assert_true(m.x0[y] >= 0 && m.x0[y] <= m.x1[y] && m.x1[y] <= nx * s);
    }
}

static void test_formula(void **state) {
    (void)state;
    static const int shapes[][3] = {{16, 16, 1}, {17, 17, 1}, {16, 21, 2}, {9, 8, 8}, {30, 11, 4}};
    for (int i = 0; i < 5; i++) {
        check_map(shapes[i][0], shapes[i][1], shapes[i][2], 3.3, 1.7);
        check_map(shapes[i][0], shapes[i][1], shapes[i][2], 0.0, 2.0);
        check_map(shapes[i][0], shapes[i][1], shapes[i][2], 2.0, 0.05); /* rows with nothing */
        check_map(shapes[i][0], shapes[i][1], shapes[i][2], 100.0, 1.0);
    }
}

/* Chosen points: the core's rim is 1, one width beyond exp(-1/2), two widths exp(-2). */
static void test_chosen_points(void **state) {
    (void)state;
    filter_map m;
    arena a = {.used = 1 << 22};
    CLEANUP(release_free) void *memory = arena_allocate(&a);
    filter_map_place(&m, 21, 21, 1, &a);
    filter_map_fill(&m, 5.0, 2.0);
    const double *centre = m.value + 10 * 21 + 10;
    assert_true(centre[0] == 1.0 && centre[5] == 1.0 && centre[-5 * 21] == 1.0 &&
                centre[3 * 21 - 4] == 1.0);
    assert_near(centre[7], exp(-0.5), 1e-15, 1.0, "one width");
    assert_near(centre[-9 * 21], exp(-2.0), 1e-15, 1.0, "two widths");
    assert_near(centre[8 * 21 + 6], exp(-0.5 * 6.25), 1e-15, 1.0, "r = 10");
    filter_map_fill(&m, 9.0, 2.0); /* refilled where it differs */
    assert_true(centre[9] == 1.0);
    filter_map_fill(&m, 9.0, 0.5);
    assert_near(centre[10], exp(-2.0), 1e-15, 1.0, "another width");
}

static shear_plan_info info_of(const pair *p, bool has_r_gal) {
    shear_plan *plan = NULL;
    shear_error err = {0};
    if (shear_plan_new(&plan,
                       &(shear_plan_request){.settings = &p->settings,
                                             .geometry = p->geometry,
                                             .psf = p->psf,
                                             .has_r_gal = has_r_gal},
                       &err) != SHEAR_OK) {
        fail_msg("%s", err.message);
    }
    const shear_plan_info info = *shear_plan_get_info(plan);
    shear_plan_free(plan);
    return info;
}

static void check_rule(const char *filter, const char *core, const char *width, bool has_r_gal,
                       int expected, double core_px, double width_px) {
    pair p;
    pair_init(&p, 40, 48, 15, 15, 1);
    pair_draw(&p, 1.2, 1);
    pair_set(&p, "filter", filter);
    pair_set(&p, "core", core);
    pair_set(&p, "width", width);
    pair_set(&p, "beta", "2");
    const shear_plan_info info = info_of(&p, has_r_gal);
    assert_int_equal(info.filter, expected);
    assert_int_equal(info.filter_per_stamp, expected == SHEAR_FILTER_PAPER && isnan(core_px));
    assert_true((isnan(core_px) && isnan(info.core_px)) || fabs(info.core_px - core_px) < 1e-12);
    assert_true((isnan(width_px) && isnan(info.width_px)) || info.width_px == width_px);
    pair_deinit(&p);
}

static void test_rules(void **state) {
    (void)state;
    const double fall = sqrt(2.0 * log(1000.0)); /* widths from 1 to 1e-3 */
    check_rule("auto", "auto", "auto", false, SHEAR_FILTER_NONE, NAN, NAN);
    check_rule("none", "auto", "auto", true, SHEAR_FILTER_NONE, NAN, NAN);
    check_rule("auto", "auto", "auto", true, SHEAR_FILTER_PAPER, NAN, 2.0);
    check_rule("paper", "auto", "3", true, SHEAR_FILTER_PAPER, NAN, 3.0);
    check_rule("auto", "11", "auto", false, SHEAR_FILTER_PAPER, 11.0, 2.0);
    check_rule("auto", "11", "0.5", true, SHEAR_FILTER_PAPER, 11.0, 0.5);
    check_rule("edge", "auto", "auto", false, SHEAR_FILTER_EDGE, 19.5 - fall, 1.0);
    check_rule("edge", "auto", "2", true, SHEAR_FILTER_EDGE, 19.5 - 2.0 * fall, 2.0);
    assert_near(filter_edge_core(40, 48, 1.0), 19.5 - fall, 1e-15, 19.5, "edge");
    assert_near(filter_edge_core(64, 33, 2.0), 16.0 - 2.0 * fall, 1e-15, 16.0, "edge");
}

static void check_refused(const char *filter, const char *core, const char *width,
                          const char *word) {
    pair p;
    shear_row row;
    shear_error err = {0};
    pair_init(&p, 16, 16, 15, 15, 1);
    pair_draw(&p, 1.2, 1);
    pair_set(&p, "filter", filter);
    pair_set(&p, "core", core);
    pair_set(&p, "width", width);
    assert_int_equal(pair_try(&p, &row, &err), SHEAR_E_SETTING);
    if (strstr(err.message, word) == NULL)
        fail_msg("'%s' does not name %s", err.message, word);
    pair_deinit(&p);
}

static void test_refusals(void **state) {
    (void)state;
    check_refused("paper", "auto", "auto", "R_GAL"); /* no such column */
    check_refused("paper", "5", "auto", "core");
    check_refused("edge", "5", "auto", "core");
    check_refused("none", "5", "auto", "core");
    check_refused("none", "auto", "2", "width");
    check_refused("edge", "auto", "2.1", "2.1 px"); /* falls over 7.8 px, and there are 7.5 */
}

/* filter=paper: the core of stamp i is R_GAL + 4 beta. Each stamp equals one measured with that
 * core. */
static void test_core_per_stamp(void **state) {
    (void)state;
    enum { N = 5 };
    static const double r_gal[N] = {3.0, 6.5, 3.0, 0.25, 9.0};
    pair p;
    pair_init(&p, 32, 33, 15, 15, 1);
    pair_draw(&p, 1.2, 9);
    pair_set(&p, "interpolation", "bicubic");
    pair_set(&p, "beta", "1.75");
    shear_plan *plan = NULL;
    shear_workspace *ws = NULL;
    assert_int_equal(shear_plan_new(&plan,
                                    &(shear_plan_request){.settings = &p.settings,
                                                          .geometry = p.geometry,
                                                          .psf = p.psf,
                                                          .has_r_gal = true},
                                    NULL),
                     SHEAR_OK);
    assert_int_equal(shear_workspace_new(&ws, plan, NULL), SHEAR_OK);
    for (int i = 0; i < N; i++) {
        shear_row row;
        char core[32];
        const shear_stamps one = {.count = 1,
                                  .nx = 32,
                                  .ny = 33,
                                  .galaxy = p.galaxy,
                                  .noise = p.noise,
                                  .r_gal = &r_gal[i]};
        assert_int_equal(shear_measure(plan, ws, &one, 0, &row, NULL), SHEAR_OK);
        pair fixed = p;
        snprintf(core, sizeof core, "%.17g", r_gal[i] + 4.0 * 1.75);
        pair_set(&fixed, "core", core);
        const shear_row expected = pair_measure(&fixed);
        assert_same_rows(&row, &expected, 1);
    }
    shear_workspace_free(ws);
    shear_plan_free(plan);
    pair_deinit(&p);
}

/* The removed flux, stamp by stamp and as a part of the field's. Half of the flux sits where the
 * filter is exp(-2): it takes (1 - exp(-2)) / 2. */
static void test_removed_flux(void **state) {
    (void)state;
    enum { N = 21 };
    pair p;
    pair_init(&p, N, N, 15, 15, 1);
    pair_draw(&p, 1.2, 9);
    memset(p.galaxy, 0, N * N * sizeof(double));
    memset(p.noise, 0, N * N * sizeof(double));
    p.galaxy[10 * N + 10] = 3.0;
    p.galaxy[10 * N + 19] = 4.0; /* 9 px from the centre */
    p.noise[10 * N + 19] = 1.0;
    pair_set(&p, "interpolation", "none");
    pair_set(&p, "core", "5");
    pair_set(&p, "width", "2");
    const shear_row row = pair_measure(&p);
    const double removed = 3.0 * (1.0 - exp(-2.0));
    assert_near(row.flux, 6.0, 1e-15, 6.0, "flux");
    assert_near(row.flux_removed, removed, 1e-14, 6.0, "removed");
    shear_block_sums block;
    shear_field_sums *sums = NULL;
    shear_result result;
    shear_block_sums_init(&block);
    shear_block_sums_add(&block, &row);
    shear_block_sums_add(&block, &row);
    assert_int_equal(shear_field_sums_new(&sums, NULL), SHEAR_OK);
    shear_field_sums_add(sums, &block);
    shear_field_result(sums, &result);
    assert_near(result.filter_removed, removed / 6.0, 1e-14, 1.0, "part");
    assert_near(result.filter_removed_err, 0.0, 1e-7, 1.0,
                "no scatter"); /* the root of a rounding error */
    shear_field_sums_free(sums);
    pair_deinit(&p);
}

/* background=noise-mean, which auto is with a filter: a constant on both stamps is not seen,
 * neither in the moments nor in the removed flux, where it is seen with background=keep. */
static void test_background(void **state) {
    (void)state;
    static const char *const methods[] = {"none", "bicubic", "spline"};
    for (int m = 0; m < 3; m++) {
        shear_row rows[6];
        for (int i = 0; i < 6; i++) {
            pair p;
            pair_init(&p, 24, 21, 15, 15, 1);
            pair_draw(&p, 1.3, 6);
            pair_set(&p, "interpolation", methods[m]);
            pair_set(&p, "core", "4");
            pair_set(&p, "width", "2");
            if (i < 4)
                pair_set(&p, "background", i < 2 ? "keep" : "noise-mean");
            for (int k = 0; i % 2 == 1 && k < 24 * 21; k++) {
                p.galaxy[k] += 0.75;
                p.noise[k] += 0.75;
            }
            rows[i] = pair_measure(&p);
            pair_deinit(&p);
        }
        const double scale = fabs(rows[0].d) + rows[0].m4;
        assert_true(fabs(rows[1].d - rows[0].d) > 1e-3 * scale);
        assert_true(rows[4].d == rows[2].d && rows[5].d == rows[3].d);
        assert_near(rows[3].n1, rows[2].n1, 1e-12, scale, "N1");
        assert_near(rows[3].n2, rows[2].n2, 1e-12, scale, "N2");
        assert_near(rows[3].d, rows[2].d, 1e-12, scale, "D");
        assert_near(rows[3].v, rows[2].v, 1e-12, scale, "V");
        assert_near(rows[2].flux_removed, rows[0].flux_removed, 1e-12, rows[0].flux, "removed");
        assert_near(rows[3].flux_removed, rows[0].flux_removed, 1e-12, rows[0].flux, "removed");
    }
}

/* D of the pair with `step` added to pixel k of one of its stamps, and taken from it: what a pixel
 * of noise adds on the average. */
static double added_by(pair *p, double *pixel, double step, double without) {
    const double was = *pixel;
    *pixel = was + step;
    const double more = pair_measure(p).d;
    *pixel = was - step;
    const double less = pair_measure(p).d;
    *pixel = was;
    return 0.5 * (more + less) - without;
}

/* White noise of one variance in both stamps adds nothing to D on the average, also behind a
 * filter, where both lose levels that the noise stamp's noise makes: D is a quadratic form of the
 * noise, and its mean the sum over the pixels. */
static void test_noise_adds_nothing(void **state) {
    (void)state;
    static const int sides[][2] = {{16, 16}, {17, 12}, {8, 19}};
    for (int i = 0; i < 4; i++) {
        const int nx = sides[i % 3][0];
        const int ny = sides[i % 3][1];
        pair p;
        pair_init(&p, nx, ny, 15, 15, 1);
        pair_draw(&p, 1.3, 7);
        memset(p.noise, 0, (size_t)(nx * ny) * sizeof *p.noise);
        pair_set(&p, "core", "3");
        pair_set(&p, "width", "2");
        pair_set(&p, "artefacts", "keep");
        pair_set(&p, "interpolation", i < 3 ? "none" : "bicubic");
        const double without = pair_measure(&p).d;
        double galaxy = 0.0;
        double noise = 0.0;
        for (int k = 0; k < nx * ny; k++) {
            galaxy += added_by(&p, &p.galaxy[k], 0.5, without);
            noise += added_by(&p, &p.noise[k], 0.5, without);
        }
        assert_near(galaxy + noise, 0.0, 1e-9, galaxy, "what noise adds to D");
        pair_deinit(&p);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_formula),        cmocka_unit_test(test_chosen_points),
        cmocka_unit_test(test_rules),          cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_core_per_stamp), cmocka_unit_test(test_removed_flux),
        cmocka_unit_test(test_background),     cmocka_unit_test(test_noise_adds_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
