/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pictures: layout, axes, marks and text at known places, and what cannot be drawn. */
#include "figure_fixture.h"
#include "test.h"

#include <math.h>
#include <string.h>

/* ---- layout ---- */

static void test_cells_tile_the_area(void **state) {
    (void)state;
    static const double weights[3] = {1.0, 2.0, 1.0};
    const shear_grid g = {.area = {10, 20, 420, 210},
                          .rows = 2,
                          .columns = 3,
                          .gap_x = 10,
                          .gap_y = 10,
                          .column_weights = weights};
    const shear_rect first = shear_grid_cell(&g, 0, 0, 1, 1);
    const shear_rect middle = shear_grid_cell(&g, 1, 1, 1, 1);
    const shear_rect last = shear_grid_cell(&g, 1, 2, 1, 1);
    const shear_rect all = shear_grid_cell(&g, 0, 0, 2, 3);
    assert_true(first.x == 10 && first.y == 20 && first.w == 100 && first.h == 100);
    assert_true(middle.x == 120 && middle.y == 130 && middle.w == 200);
    assert_true(last.x == 330 && last.x + last.w == 430 && last.y + last.h == 230);
    assert_memory_equal(&all, &g.area, sizeof all);
    assert_true(shear_grid_cell(&g, 0, 2, 1, 2).w == 0.0);
    assert_true(shear_grid_cell(&g, -1, 0, 1, 1).w == 0.0);
    assert_true(shear_grid_cell(&g, 0, 0, 0, 1).w == 0.0);
}

/* ---- axes ---- */

static void begin(shear_figure *f, shear_range x, shear_range y, bool log) {
    const shear_axes axes = {
        .cell = {0, 0, SIDE, SIDE}, .x = {.range = x, .log = log}, .y = {.range = y, .log = log}};
    shear_axes_begin(f, &axes);
}

static void test_marks_are_where_the_data_are(void **state) {
    (void)state;
    shear_figure *f = new_figure();
    begin(f, (shear_range){0, 10}, (shear_range){-1, 1}, false);
    const shear_rect r = shear_axes_frame(f);
    shear_axes_vline(f, 2.5, &(shear_style){.width = 3.0});
    const double x = 7.5;
    const double y = 0.5;
    shear_axes_points(f, 1, &x, &y, NULL, NULL, &(shear_style){.size = 10.0});
    assert_true(darkness(f, r.x + 0.25 * r.w, r.y + 0.9 * r.h) > 500);
    assert_true(darkness(f, r.x + 0.75 * r.w, r.y + 0.25 * r.h) > 500);
    assert_int_equal(darkness(f, r.x + 0.75 * r.w, r.y + 0.75 * r.h), 0);
    assert_int_equal(darkness(f, r.x + 0.5 * r.w, r.y + 0.5 * r.h), 0);
    shear_axes_end(f);
    assert_true(darkness(f, r.x + 0.5 * r.w, r.y - 0.5) > 300); /* the frame */
    assert_saves(f);
}

static void test_log_axes(void **state) {
    (void)state;
    shear_figure *f = new_figure();
    begin(f, (shear_range){1, 1e4}, (shear_range){1e-4, 1}, true);
    const shear_rect r = shear_axes_frame(f);
    shear_axes_vband(f, 90.0, 110.0, &(shear_style){.fill = 1.0});
    shear_axes_hline(f, 1e-3, &(shear_style){.width = 3.0});
    assert_true(darkness(f, r.x + 0.5 * r.w, r.y + 0.5 * r.h) > 500);
    assert_true(darkness(f, r.x + 0.1 * r.w, r.y + 0.75 * r.h) > 500);
    assert_int_equal(darkness(f, r.x + 0.1 * r.w, r.y + 0.5 * r.h), 0);
    const double x[3] = {-1.0, 0.0, 10.0}; /* without a place, but the last */
    const double y[3] = {1e-2, 1e-2, 1e-2};
    const double bars[3] = {5.0, 5.0, 50.0};
    shear_axes_points(f, 3, x, y, bars, bars, &(shear_style){0});
    shear_axes_line(f, 3, x, y, &(shear_style){0});
    assert_true(darkness(f, r.x + 0.25 * r.w, r.y + 0.5 * r.h) > 500);
    shear_axes_end(f);
    assert_saves(f);
}

static void test_error_bars_have_their_length(void **state) {
    (void)state;
    shear_figure *f = new_figure();
    begin(f, (shear_range){0, 1}, (shear_range){0, 1}, false);
    const shear_rect r = shear_axes_frame(f);
    const double x = 0.5;
    const double error = 0.25;
    shear_axes_points(f, 1, &x, &x, NULL, &error, &(shear_style){.width = 3.0, .size = 4.0});
    assert_true(darkness(f, r.x + r.w / 2, r.y + 0.27 * r.h) > 500);
    assert_true(darkness(f, r.x + r.w / 2, r.y + 0.73 * r.h) > 500);
    assert_int_equal(darkness(f, r.x + r.w / 2, r.y + 0.22 * r.h), 0);
    assert_int_equal(darkness(f, r.x + 0.4 * r.w, r.y + r.h / 2), 0); /* none along x */
    shear_axes_end(f);
    shear_figure_free(f);
}

static void test_histogram_and_bars_are_as_high_as_their_counts(void **state) {
    (void)state;
    static const double counts[2] = {4.0, 1.0};
    shear_figure *f = new_figure();
    begin(f, (shear_range){0, 4}, (shear_range){0, 5}, false);
    const shear_rect r = shear_axes_frame(f);
    const shear_style solid = {.fill = 1.0, .width = 1.0};
    shear_axes_histogram(f, 2, (shear_range){0, 2}, counts, &solid);
    shear_axes_bar(f, false, 3.0, 0.5, 0.0, 3.0, &solid);
    assert_true(darkness(f, r.x + r.w / 8, r.y + 0.25 * r.h) > 500);
    assert_int_equal(darkness(f, r.x + r.w / 8, r.y + 0.15 * r.h), 0);
    assert_true(darkness(f, r.x + 3 * r.w / 8, r.y + 0.9 * r.h) > 500);
    assert_int_equal(darkness(f, r.x + 3 * r.w / 8, r.y + 0.7 * r.h), 0);
    assert_true(darkness(f, r.x + 6 * r.w / 8, r.y + 0.45 * r.h) > 500);
    assert_int_equal(darkness(f, r.x + 6 * r.w / 8, r.y + 0.35 * r.h), 0);
    shear_axes_end(f);
    assert_saves(f);
}

/* On the line x = y = t the ellipse ends at t^2 (1, 1) C^-1 (1, 1)^T = n^2. */
static void test_ellipse_follows_the_covariance(void **state) {
    (void)state;
    static const double cov[3] = {1.0, 0.8, 1.0};
    shear_figure *f = new_figure();
    begin(f, (shear_range){-4, 4}, (shear_range){-4, 4}, false);
    const shear_rect r = shear_axes_frame(f);
    shear_axes_ellipse(f, 0.0, 0.0, cov, 2.0, &(shear_style){.fill = 1.0, .width = 1.0});
    const double along = 2.0 * sqrt((1.0 + 0.8) / 2.0);
    const double across = 2.0 * sqrt((1.0 - 0.8) / 2.0);
    for (int i = 0; i < 2; i++) {
        const double t = i != 0 ? across : along;
        const double sign = i != 0 ? -1.0 : 1.0;
        for (int outside = 0; outside < 2; outside++) {
            const double at = t * (outside != 0 ? 1.12 : 0.88);
            const int dark =
                darkness(f, r.x + r.w * (0.5 + at / 8.0), r.y + r.h * (0.5 - sign * at / 8.0));
            assert_true(outside ? dark == 0 : dark > 500);
        }
    }
    shear_axes_end(f);
    shear_figure_free(f);
}

static void test_impossible_ellipses_draw_nothing(void **state) {
    (void)state;
    static const double bad[][3] = {{1, 2, 1}, {0, 0, 0}, {-1, 0, 1}, {NAN, 0, 1}};
    shear_figure *f = new_figure();
    begin(f, (shear_range){-4, 4}, (shear_range){-4, 4}, false);
    const shear_rect r = shear_axes_frame(f);
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
        shear_axes_ellipse(f, 0.0, 0.0, bad[i], 1.0, &(shear_style){.fill = 1.0});
    for (int x = 0; x < (int)r.w; x++)
        assert_int_equal(darkness(f, r.x + x, r.y + r.h / 2), 0);
    shear_axes_end(f);
    assert_saves(f);
}

static void test_equal_axes_have_equal_units(void **state) {
    (void)state;
    shear_figure *f = new_figure();
    const shear_axes axes = {
        .cell = {0, 0, SIDE, SIDE}, .equal = true, .x = {.range = {0, 4}}, .y = {.range = {0, 1}}};
    shear_axes_begin(f, &axes);
    const shear_rect r = shear_axes_frame(f);
    assert_true(fabs(r.w / r.h - 4.0) < 0.1); /* frames end on whole pixels */
    shear_axes_end(f);
    shear_figure_free(f);
}

static void test_wild_numbers_do_no_harm(void **state) {
    (void)state;
    static const double wild[] = {0.5, 1e300, -1e300, NAN, INFINITY, -INFINITY, 0.5, 1e-300};
    enum { N = sizeof wild / sizeof wild[0] };
    const shear_range ranges[] = {{0, 1}, {NAN, NAN}, {1, 1}, {-1e308, 1e308}, {5, 2}, {0, 1e-310}};
    const shear_style style = {.fill = 0.5, .label = "\xff\xfe odd \xc3"};
    for (size_t i = 0; i < sizeof ranges / sizeof ranges[0]; i++) {
        for (int log = 0; log < 2; log++) {
            shear_figure *f = new_figure();
            begin(f, ranges[i], ranges[i], log);
            shear_axes_line(f, N, wild, wild, &style);
            shear_axes_points(f, N, wild, wild, wild, wild, &style);
            shear_axes_vband(f, NAN, 1.0, &style);
            shear_axes_hline(f, INFINITY, &style);
            shear_axes_circle(f, NAN, 0.0, 1e300, &style);
            shear_axes_text(f, NAN, 0.5, false, "nowhere", &(shear_text_style){0});
            shear_axes_end(f);
            assert_saves(f);
        }
    }
}

static void test_calls_in_the_wrong_order_are_told(void **state) {
    (void)state;
    shear_figure *f = new_figure();
    shear_axes_hline(f, 0.5, &(shear_style){0});
    assert_failed(f, SHEAR_E_INTERNAL);
    f = new_figure();
    begin(f, (shear_range){0, 1}, (shear_range){0, 1}, false);
    begin(f, (shear_range){0, 1}, (shear_range){0, 1}, false);
    assert_failed(f, SHEAR_E_INTERNAL);
    f = new_figure();
    begin(f, (shear_range){0, 1}, (shear_range){0, 1}, false);
    shear_axes_histogram(f, 0, (shear_range){0, 1}, NULL, &(shear_style){0});
    assert_failed(f, SHEAR_E_INTERNAL);
}

static void test_more_labels_than_the_legend_holds(void **state) {
    (void)state;
    static const char long_label[] =
        "a label that is much longer than the legend keeps, with a character of two bytes just "
        "where it is cut: \xc3\xa9\xc3\xa9\xc3\xa9\xc3\xa9\xc3\xa9\xc3\xa9\xc3\xa9\xc3\xa9";
    shear_figure *f = new_figure();
    begin(f, (shear_range){0, 1}, (shear_range){0, 1}, false);
    for (int i = 0; i < 40; i++)
        shear_axes_hline(f, i / 40.0, &(shear_style){.label = long_label});
    shear_axes_end(f);
    assert_saves(f);
}

/* ---- text ---- */

static int ink(shear_figure *f, int x0, int y0, int x1, int y1) {
    int sum = 0;
    for (int y = y0; y < y1; y++) {
        for (int x = x0; x < x1; x++)
            sum += darkness(f, x, y) > 200;
    }
    return sum;
}

static void test_text_is_where_it_should_be(void **state) {
    (void)state;
    shear_figure *f = new_figure();
    const shear_text_style right = {.size = 14.0, .align = 1.0};
    const shear_text_style upward = {.size = 14.0, .upward = true};
    shear_figure_text(f, 150, 50, "HHHH", &right);
    assert_true(ink(f, 90, 40, 150, 60) > 50);
    assert_int_equal(ink(f, 151, 0, SIDE, 100), 0);
    shear_figure_text(f, 250, 250, "HHHH", &upward);
    assert_true(ink(f, 240, 190, 260, 250) > 50);
    assert_int_equal(ink(f, 200, 252, SIDE, SIDE), 0);
    assert_saves(f);
}

static void test_scripts_are_small_and_shifted(void **state) {
    (void)state;
    shear_figure *f = new_figure();
    const double plain = shear_figure_text_width(f, "ab", 20.0);
    const double script = shear_figure_text_width(f, "a_{b}", 20.0);
    assert_true(script < plain && script > shear_figure_text_width(f, "a", 20.0));
    assert_true(shear_figure_text_width(f, "a_b", 20.0) > plain); /* no brace: a character */
    const shear_text_style style = {.size = 40.0};
    shear_figure_text(f, 20, 100, "^{H}", &style);
    shear_figure_text(f, 120, 100, "_{H}", &style);
    assert_true(ink(f, 20, 60, 60, 85) > 0);
    assert_int_equal(ink(f, 120, 60, 160, 90), 0);
    assert_saves(f);
}

static void test_any_bytes_can_be_text(void **state) {
    (void)state;
    static const char *const odd[] = {
        "\xff", "\xc3", "\xe2\x88", "\xed\xa0\x80", "\xf5\x80\x80\x80",
        "_{",   "^{a",  "_",        "\x01\n",       ""};
    shear_figure *f = new_figure();
    for (size_t i = 0; i < sizeof odd / sizeof odd[0]; i++)
        shear_figure_text(f, 10, 20.0 * (double)i, odd[i], &(shear_text_style){0});
    shear_figure_text(f, 10, 10, NULL, &(shear_text_style){0});
    char longest[1000];
    for (size_t i = 0; i + 2 < sizeof longest; i += 2)
        memcpy(longest + i, "\xc3\xa9", 2);
    longest[sizeof longest - 2] = longest[sizeof longest - 1] = '\0';
    const double width = shear_figure_text_width(f, longest, 10.0);
    const double one = shear_figure_text_width(f, "\xc3\xa9", 10.0);
    assert_true(fabs(width - 499.0 * one) < 1e-6 * width); /* no character is lost between pieces */
    assert_saves(f);
}

static void test_tables(void **state) {
    (void)state;
    static const char *const keys[] = {"first", "", "third"};
    static const char *const values[] = {"1", "2", "3"};
    shear_figure *f = new_figure();
    shear_figure_table(f, (shear_rect){20, 20, 200, 200}, "title", 3, keys, values);
    assert_true(ink(f, 20, 20, 200, 120) > 50);
    assert_int_equal(ink(f, 20, 130, SIDE, SIDE), 0);
    assert_saves(f);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_cells_tile_the_area),
        cmocka_unit_test(test_marks_are_where_the_data_are),
        cmocka_unit_test(test_log_axes),
        cmocka_unit_test(test_error_bars_have_their_length),
        cmocka_unit_test(test_histogram_and_bars_are_as_high_as_their_counts),
        cmocka_unit_test(test_ellipse_follows_the_covariance),
        cmocka_unit_test(test_impossible_ellipses_draw_nothing),
        cmocka_unit_test(test_equal_axes_have_equal_units),
        cmocka_unit_test(test_wild_numbers_do_no_harm),
        cmocka_unit_test(test_calls_in_the_wrong_order_are_told),
        cmocka_unit_test(test_more_labels_than_the_legend_holds),
        cmocka_unit_test(test_text_is_where_it_should_be),
        cmocka_unit_test(test_scripts_are_small_and_shifted),
        cmocka_unit_test(test_any_bytes_can_be_text),
        cmocka_unit_test(test_tables),
    };
    return cmocka_run_group_tests(tests, make_directory, remove_directory);
}
