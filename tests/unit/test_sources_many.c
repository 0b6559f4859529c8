/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Catalogs of many rows, of which those near a place are loaded. */
#include "source_fixture.h"

#include "survey/sources/row_choice.h"

#include <math.h>
#include <string.h>

enum { ROWS = 3 * ROW_CHUNK - 5, STRIDE = 7919 };

static double number(long i) {
    return 5.0 + (double)i;
}

/* All over a square of 8 degrees, in no order. */
static double ra(long i) {
    return 146.0 + 8.0 * fmod((double)i * STRIDE, ROWS) / ROWS;
}

static double dec(long i) {
    return i % 1000 == 17 ? NAN : -4.0 + 8.0 * fmod((double)i * 31.0, 997.0) / 997.0;
}

static double flags(long i) {
    return i % 3 == 0 ? 4.0 : 0.0;
}

static double small(long i) {
    return (double)(i % 11);
}

static double chip(long i) {
    return (double)(1 + i % 2);
}

static const source_fixture_column columns[] = {
    {"NUMBER", "1J", NULL, number},  {"RA", "1D", NULL, ra},
    {"DEC", "1D", NULL, dec},        {"FLAGS", "1I", NULL, flags},
    {"A_IMAGE", "1E", NULL, small},  {"B_IMAGE", "1E", NULL, small},
    {"THETA_IMAGE", "1E", NULL, ra}, {"WEIGHT", "1E", NULL, small},
    {"MAG", "1E", NULL, small},      {"FLUX_RADIUS", "1E", NULL, dec},
    {"EXT_NUMBER", "1J", NULL, chip}};
enum { COLUMNS = sizeof columns / sizeof columns[0] };

static void write(const char *path, int n_columns) {
    fitsfile *f = fixture_create(path);
    source_fixture_table(f, "SOURCES", columns, n_columns, ROWS);
    fixture_close(f);
}

static source_list load(source_catalog *c, int table, source_cap *cap) {
    static const char *const contexts[] = {"MAG", "NUMBER"};
    source_list s;
    shear_error err = {0};
    if (source_catalog_load(c, table, contexts, 2, cap, &s, &err) != SHEAR_OK)
        fail_msg("%s", err.message);
    return s;
}

static bool same(double a, double b) {
    return memcmp(&a, &b, sizeof a) == 0 || (isnan(a) && isnan(b));
}

/* Row `i` of one list is row `k` of the other. */
static void compare(const source_list *a, int64_t i, const source_list *b, int64_t k) {
    assert_true(a->id[i] == b->id[k] && a->row[i] == b->row[k]);
    assert_int_equal(a->selected[i], b->selected[k]);
    assert_true(same(a->ra[i], b->ra[k]) && same(a->dec[i], b->dec[k]));
    assert_true(same(a->a[i], b->a[k]) && same(a->b[i], b->b[k]) && same(a->theta[i], b->theta[k]));
    assert_true(same(a->weight[i], b->weight[k]) && same(a->r_gal[i], b->r_gal[k]));
    for (int c = 0; c < 2; c++)
        assert_true(same(a->context[2 * i + c], b->context[2 * k + c]));
}

/* What is loaded of a cap is what of the whole table is in it, in its order. */
static void test_a_cap(void **state) {
    const char *path = fixture_path("many.fits");
    const shear_exposure options = {.origin = 1, .select = "MAG != 4"};
    (void)state;
    write(path, COLUMNS - 1);
    source_catalog *c = source_fixture_open(path, &options);
    source_list all = load(c, 0, NULL);
    assert_true(all.n == ROWS && all.rows == ROWS);
    for (int64_t i = 0; i < ROWS; i++) {
        assert_true(all.row[i] == i && all.id[i] == i + 5);
        assert_int_equal(all.selected[i], i % 3 != 0 && i % 11 != 4);
    }
    source_cap cap = source_cap_about(150.0, 1.0);
    cap.radius = 0.5;
    source_list near = load(c, 0, &cap);
    assert_true(near.rows == ROWS && near.rows_selected == source_fixture_selected(&all));
    int64_t k = 0;
    double nearest = 180.0;
    for (int64_t i = 0; i < ROWS; i++) {
        if (isnan(all.dec[i]))
            continue;
        const double d = source_cap_distance(&cap, all.ra[i], all.dec[i]);
        nearest = fmin(nearest, d);
        if (d <= 0.5)
            compare(&near, k++, &all, i);
    }
    assert_true(near.n == k && k > 500 && k < ROWS / 20);
    assert_true(cap.nearest == nearest);
    source_list_deinit(&near);
    /* and of one where there is nothing, nothing */
    cap = source_cap_about(330.0, -1.0);
    cap.radius = 0.5;
    near = load(c, 0, &cap);
    assert_true(near.n == 0 && near.rows == ROWS && cap.nearest > 170.0 && cap.nearest < 180.0);
    source_list_deinit(&near);
    source_list_deinit(&all);
    source_catalog_close(c);
}

/* A table of two chips is read as two, in chunks. */
static void test_chips_of_one_table(void **state) {
    const char *path = fixture_path("chips.fits");
    (void)state;
    write(path, COLUMNS);
    source_catalog *c = source_fixture_open(path, NULL);
    assert_int_equal(source_catalog_tables(c), 2);
    for (int table = 1; table >= 0; table--) {
        source_list s = load(c, table, NULL);
        assert_true(s.n == (ROWS + 1 - table) / 2 && s.rows == s.n);
        for (int64_t i = 0; i < s.n; i++)
            assert_int_equal(s.row[i], 2 * i + table);
        source_list_deinit(&s);
    }
    source_catalog_close(c);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_cap),
        cmocka_unit_test(test_chips_of_one_table),
    };
    return cmocka_run_group_tests(tests, fixture_setup, fixture_teardown);
}
