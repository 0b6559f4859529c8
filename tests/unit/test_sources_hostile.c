/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Catalogs that are wrong, huge or no catalogs, and options that are wrong: an error that says what
 * and where, and bounded memory. */
#include "source_fixture.h"

#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* ---- options ---- */

static void expect_columns(const char *columns, int code, const char *word, const char *other) {
    const char *path = fixture_path("options.cat");
    source_fixture_write(path, 3);
    const shear_exposure e = {.origin = 1, .columns = columns};
    source_fixture_expect(path, &e, code, word, other, NULL);
}

static void test_columns(void **state) {
    (void)state;
    expect_columns("wieght=MAG_AUTO", SHEAR_E_SETTING, "wieght", "did you mean weight?");
    expect_columns("", SHEAR_E_SETTING, "KEY=COLUMN", "x=XWIN_IMAGE");
    expect_columns("x=", SHEAR_E_SETTING, "'x='", "KEY=COLUMN");
    expect_columns("id=NUMBER,,", SHEAR_E_SETTING, "''", "KEY=COLUMN");
    expect_columns("id=NUMBER,ID=FLAGS", SHEAR_E_SETTING, "ID", "twice");
    expect_columns("x=X_IMAGE", SHEAR_E_SETTING, "x is given without y", "both");
    expect_columns("dec=X_IMAGE", SHEAR_E_SETTING, "dec is given without ra", "both");
    expect_columns("a=X_IMAGE,b=X_IMAGE", SHEAR_E_SETTING, "a is given without theta", "columns");
    expect_columns("weight=MAG_ATUO", SHEAR_E_FORMAT, "MAG_ATUO, which columns gives for weight",
                   "did you mean MAG_AUTO? columns: NUMBER, X_IMAGE");
    char longest[200] = "id=";
    memset(longest + 3, 'a', 100);
    expect_columns(longest, SHEAR_E_SETTING, "longer", "FITS");
}

static void test_origin(void **state) {
    (void)state;
    const char *path = fixture_path("origin.cat");
    source_fixture_write(path, 3);
    const shear_exposure e = {.origin = 2};
    source_fixture_expect(path, &e, SHEAR_E_SETTING, "origin", NULL);
}

/* ---- texts ---- */

static void expect_text(const char *text, const char *word, const char *other) {
    const char *path = fixture_path("bad.txt");
    source_fixture_text(path, text);
    source_fixture_expect(path, NULL, SHEAR_E_FORMAT, "bad.txt", word, other, NULL);
}

static void test_texts(void **state) {
    (void)state;
    expect_text("", "empty", "0 bytes");
    expect_text("1 2.5 3.5\n", "neither FITS nor", "ASCII_HEAD");
    expect_text("\x7f\x45LF\x02", "neither FITS nor", "ASCII_HEAD");
    expect_text("# only a remark\n", "without a head", "ASCII_HEAD");
    expect_text("# a remark\n1 2 3\n", "line 2: no head", "ASCII_HEAD");
    expect_text("# 1\n", "line 1", "name");
    expect_text("# 1 it's\n", "line 1", "name");
    expect_text("# 0 X_IMAGE\n", "line 1", "increase");
    expect_text("# -1 X_IMAGE\n", "line 1", "increase");
    expect_text("# 1 X_IMAGE\n# 1 Y_IMAGE\n", "line 2", "increase");
    expect_text("# 100001 X_IMAGE\n", "line 1", "100000");
    expect_text("# 1 X_IMAGE\n# 3 Y_IMAGE\n1 2\n", "line 3", "2 values, not 3");
    expect_text("# 1 X_IMAGE\n# 2 Y_IMAGE\n1 2\n1 2 3\n", "line 4", "3 values, not 2");
    expect_text("# 1 X_IMAGE\n# 2 Y_IMAGE\n1 2z\n", "line 3", "'2z' is not a number");
    expect_text("# 1 X_IMAGE\n# 2 Y_IMAGE\n1 2\n# 1 X_IMAGE\n", "line 4", "second head");
    expect_text("# 1 X_IMAGE\n# 2 X_IMAGE\n# 3 Y_IMAGE\n1 2 3\n", "positions", "--columns");
    expect_text("# 1 MAG\n# 2 Y_IMAGE\n1 2\n", "positions", "MAG, Y_IMAGE");
}

static void test_zero_byte(void **state) {
    (void)state;
    const char *path = fixture_path("zero.txt");
    fixture_save(path, "# 1 X_IMAGE\n# 2 Y\0IMAGE\n", 25);
    source_fixture_expect(path, NULL, SHEAR_E_FORMAT, "line 2", "zero byte", NULL);
}

/* A line of a mebibyte is read; a longer one is not. */
static void test_long_lines(void **state) {
    (void)state;
    enum { LONGEST = 1 << 20 };
    static const char head[] = "# 1 X_IMAGE\n# 2 Y_IMAGE\n";
    const char *path = fixture_path("long.txt");
    for (size_t more = 0; more < 2; more++) {
        const size_t n = strlen(head) + LONGEST + more;
        char *text = malloc(n);
        assert_non_null(text);
        memset(text, ' ', n);
        memcpy(text, head, strlen(head));
        memcpy(text + n - 6, "12 3.5", 6);
        fixture_save(path, text, n);
        free(text);
        if (more > 0) {
            source_fixture_expect(path, NULL, SHEAR_E_FORMAT, "line 3", "longer", NULL);
            continue;
        }
        source_list s = source_fixture_read(path, NULL);
        assert_true(s.n == 1 && s.x[0] == 12.0 && s.y[0] == 3.5);
        source_list_deinit(&s);
    }
}

/* FITS allows 999 columns. */
static void test_many_columns(void **state) {
    (void)state;
    const char *path = fixture_path("many.txt");
    for (int n = 998; n <= 10000; n += 10000 - 998) {
        FILE *f = fopen(path, "w");
        assert_non_null(f);
        for (int i = 1; i <= n; i++)
            fprintf(f, "# %d %s%d\n", i, i == 7 ? "X_IMAGE" : i == 990 ? "Y_IMAGE" : "C", i);
        for (int i = 1; i <= n; i++)
            fprintf(f, "%d ", i);
        fclose(f);
        const shear_exposure e = {.origin = 1, .columns = "x=X_IMAGE7,y=Y_IMAGE990"};
        if (n > 998) {
            source_fixture_expect(path, &e, SHEAR_E_FORMAT, "998 columns", NULL);
            continue;
        }
        source_list s = source_fixture_read(path, &e);
        assert_true(s.n == 1 && s.x[0] == 7.0 && s.y[0] == 990.0);
        source_list_deinit(&s);
    }
}

/* ---- tables ---- */

static double odd(long i) {
    static const double values[] = {1e300, -1e300, NAN, INFINITY, -INFINITY, 0.0};
    return values[i % 6];
}
static double flags(long i) {
    static const double values[] = {0.0, 3.0, 4.0, -1.0, 99.0, 2147483647.0};
    return values[i % 6];
}

/* Odd numbers are the caller's to judge. */
static void test_odd_numbers(void **state) {
    (void)state;
    static const source_fixture_column columns[] = {
        {"X_IMAGE", "1D", NULL, odd},      {"Y_IMAGE", "1E", NULL, odd},
        {"NUMBER", "1D", NULL, odd},       {"ALPHA_J2000", "1D", NULL, odd},
        {"DELTA_J2000", "1D", "rad", odd}, {"FLUX_RADIUS", "1D", NULL, odd},
        {"FLAGS", "1J", NULL, flags}};
    const char *path = fixture_path("odd.fits");
    fitsfile *f = fixture_create(path);
    source_fixture_table(f, "SRC", columns, 7, 6);
    fixture_close(f);
    fixture_patch(path, "SRC", "TNULL7", "99");
    source_list s = source_fixture_read(path, NULL);
    assert_true(s.x[0] == 1e300 && s.x[1] == -1e300 && isnan(s.x[2]) && isinf(s.y[3]));
    for (int i = 0; i < 6; i++) {
        assert_int_equal(s.selected[i], i < 2);
        assert_int_equal(s.id[i], i == 5 ? 0 : -1);
        assert_true(isnan(s.r_gal[i]) == (i != 0));
        assert_true(isnan(s.a[i]) == isnan(s.b[i]));
    }
    source_list_deinit(&s);
}

/* A file whose table claims to have, and has, that many rows, all zeros. */
static void write_sparse(const char *path, long rows) {
    static const source_fixture_column columns[] = {{"X", "1E", NULL, odd}, {"Y", "1E", NULL, odd}};
    char value[24];
    fitsfile *f = fixture_create(path);
    source_fixture_table(f, "SRC", columns, 2, 0);
    fixture_close(f);
    snprintf(value, sizeof value, "%ld", rows);
    fixture_patch(path, "SRC", "NAXIS2", value);
    const off_t bytes = (off_t)fixture_data_offset(path, "SRC") + (8 * rows + 2879) / 2880 * 2880;
    assert_int_equal(truncate(path, bytes), 0);
}

static void test_many_rows(void **state) {
    (void)state;
    const char *path = fixture_path("rows.fits");
    write_sparse(path, 4000000);
    const shear_exposure e = {.origin = 1, .select = "X == 0 && Y < 1"};
    source_list s = source_fixture_read(path, &e);
    assert_int_equal(s.n, 4000000);
    assert_int_equal(source_fixture_selected(&s), 4000000);
    assert_true(s.id[3999999] == 4000000);
    source_list_deinit(&s);
    write_sparse(path, 4000001);
    source_fixture_expect(path, NULL, SHEAR_E_FORMAT, "4000001 of its rows are of one chip",
                          "cut the catalog", NULL);
    write_sparse(path, 400000001);
    source_fixture_expect(path, NULL, SHEAR_E_FORMAT, "400000001 rows", "split", NULL);
}

static void test_no_tables(void **state) {
    (void)state;
    const char *path = fixture_path("none.fits");
    fixture_close(fixture_create(path));
    source_fixture_expect(path, NULL, SHEAR_E_FORMAT, "no binary table", NULL);
    static const source_fixture_column other[] = {{"ra", "1D", NULL, odd}, {"dec", "1D", "K", odd}};
    fitsfile *f = fixture_create(path);
    source_fixture_table(f, "OBJECTS", other, 1, 1);
    fixture_close(f);
    source_fixture_expect(path, NULL, SHEAR_E_FORMAT, "1 (OBJECTS)", "--columns x=NAME", NULL);
    f = fixture_create(path);
    source_fixture_table(f, "", other, 2, 1);
    fixture_close(f);
    source_fixture_expect(path, NULL, SHEAR_E_FORMAT, "dec", "unit 'K'", "TUNIT", NULL);
}

static void test_bad_header_column(void **state) {
    (void)state;
    static const source_fixture_column wrong[] = {{"Field Header Card", "81A", NULL, odd}};
    const char *path = fixture_path("header.cat");
    fitsfile *f = fixture_create(path);
    source_fixture_table(f, "LDAC_IMHEAD", wrong, 1, 0);
    source_fixture_table(f, "LDAC_OBJECTS", source_fixture_usual, 5, 2);
    fixture_close(f);
    source_list s = source_fixture_read(path, NULL); /* no row, no header */
    source_list_deinit(&s);
    f = fixture_create(path);
    source_fixture_table(f, "LDAC_IMHEAD", wrong, 1, 0);
    int status = 0;
    fits_insert_rows(f, 0, 1, &status);
    assert_int_equal(status, 0);
    source_fixture_table(f, "LDAC_OBJECTS", source_fixture_usual, 5, 2);
    fixture_close(f);
    source_fixture_expect(path, NULL, SHEAR_E_FORMAT, "Field Header Card", "80 characters", NULL);
}

/* Wherever the file ends, it is refused. */
static void test_truncated(void **state) {
    (void)state;
    const char *path = fixture_path("cut.cat");
    source_fixture_write(path, 400);
    size_t size = 0;
    unsigned char *bytes = fixture_load(path, &size);
    for (size_t n = size - 2880; n > 2880; n -= 1111) {
        fixture_save(path, bytes, n);
        source_fixture_expect(path, NULL, SHEAR_E_FORMAT, "cut.cat", NULL);
        if (n < 4000)
            break;
    }
    free(bytes);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_columns),     cmocka_unit_test(test_origin),
        cmocka_unit_test(test_texts),       cmocka_unit_test(test_zero_byte),
        cmocka_unit_test(test_long_lines),  cmocka_unit_test(test_many_columns),
        cmocka_unit_test(test_odd_numbers), cmocka_unit_test(test_many_rows),
        cmocka_unit_test(test_no_tables),   cmocka_unit_test(test_bad_header_column),
        cmocka_unit_test(test_truncated),
    };
    return cmocka_run_group_tests(tests, fixture_setup, fixture_teardown);
}
