/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Row expressions: which sources are selected, compared with the same condition in C; and what is
 * refused before CFITSIO sees it. */
#include "source_fixture.h"

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>

/* ---- what is selected ---- */

enum { ROWS = 23000 }; /* several of CFITSIO's blocks */

static double number(long i) {
    return (double)(i + 1);
}
static double x(long i) {
    return (double)((i * 7919) % 2048) + 0.5;
}
static double y(long i) {
    return i % 17 == 0 ? NAN : (double)((i * 104729) % 4096);
}
static double size(long i) {
    return (double)(i % 40) * 0.25 - 1.0;
}
static double flags(long i) {
    return (double)(i % 16);
}
static double scaled(long i) {
    return (double)(i % 100) * 0.5 + 10.0;
}
static double unsigned_number(long i) {
    return 40000.0 + (double)(i % 20000);
}
static double logical(long i) {
    return (double)(i % 2);
}

static const source_fixture_column columns[] = {
    {"VIGNET", "5E", NULL, size},      {"NUMBER", "1J", NULL, number},
    {"X_IMAGE", "1E", NULL, x},        {"Y_IMAGE", "1D", NULL, y},
    {"FLUX_RADIUS", "1E", NULL, size}, {"FLAGS", "1I", NULL, flags},
    {"SCALED", "1I", NULL, scaled},    {"UNSIGNED", "1U", NULL, unsigned_number},
    {"CLEAN", "1L", NULL, logical},    {"S/N (win)", "1E", NULL, scaled}};
enum { COLUMNS = sizeof columns / sizeof *columns };

typedef struct condition {
    const char *expression;
    bool (*holds)(long i);
} condition;

static bool by_flags(long i) {
    return i % 16 == 5 || x(i) < 20.0;
}
static bool by_size(long i) {
    return size(i) > 2.0 && i % 16 < 4;
}
static bool by_position(long i) {
    return (x(i) > 50.0 && x(i) <= 2000.0 && !(y(i) < 100.0) && !isnan(y(i))) && i % 16 < 4;
}
static bool by_bits(long i) {
    return (i % 16 & 10) == 0;
}
static bool by_null(long i) {
    return isnan(y(i)) && i % 16 < 4;
}
static bool by_function(long i) {
    return sqrt(x(i)) + fabs(size(i)) > 30.0 && i % 16 < 4;
}
static bool by_division(long i) {
    return (double)(i + 1) / 2.0 == 3.5;
}
static bool by_remainder(long i) {
    return (i + 1) % 10 == 3;
}
static bool by_scale(long i) {
    return scaled(i) >= 30.5 && unsigned_number(i) > 50000.0;
}
static bool by_logical(long i) {
    return i % 2 == 1;
}
static bool by_circle(long i) {
    return hypot(x(i) - 500.0, y(i) - 900.0) < 300.0;
}
static bool none(long i) {
    (void)i;
    return false;
}

static const condition conditions[] = {
    {"flags == 5 || X_IMAGE < 20", by_flags},
    {"FLUX_RADIUS > 2", by_size},
    {"X_IMAGE > 50 .and. x_image <= 2e3 && Y_IMAGE >= 100", by_position},
    {"(FLAGS & 10) == 0", by_bits},
    {"isnull(Y_IMAGE)", by_null},
    {"sqrt(X_IMAGE) + ABS(FLUX_RADIUS) > 30", by_function},
    {"NUMBER/2 == 3.5 && FLAGS >= 0", by_division},
    {"NUMBER % 10 == 3 && FLAGS >= 0", by_remainder},
    {"SCALED >= 30.5 && UNSIGNED > 50000 && FLAGS > -1", by_scale},
    {"$S/N (win)$ >= 30.5 && UNSIGNED > 50000 && FLAGS > -1", by_scale},
    {"CLEAN && FLAGS < 99", by_logical},
    {"circle(500, 900, 300, X_IMAGE, Y_IMAGE) && FLAGS < 99", by_circle},
    {"FLUX_RADIUS / 0 > 1", none},
    {"Y_IMAGE > 1e300 || X_IMAGE != X_IMAGE", none}};

static void test_conditions(void **state) {
    (void)state;
    const char *path = fixture_path("rows.cat");
    fitsfile *f = fixture_create(path);
    source_fixture_table(f, "OBJECTS", columns, COLUMNS, 0);
    int status = 0;
    fits_update_key_dbl(f, "TSCAL7", 0.5, 15, NULL, &status);
    fits_update_key_dbl(f, "TZERO7", 10.0, 15, NULL, &status);
    fits_set_hdustruc(f, &status);
    source_fixture_fill(f, columns, COLUMNS, ROWS);
    assert_int_equal(status, 0);
    fixture_close(f);
    for (size_t k = 0; k < sizeof conditions / sizeof *conditions; k++) {
        const shear_exposure e = {.origin = 1, .select = conditions[k].expression};
        source_list s = source_fixture_read(path, &e);
        assert_int_equal(s.n, ROWS);
        for (long i = 0; i < ROWS; i++) {
            if (s.selected[i] != conditions[k].holds(i))
                fail_msg("'%s': row %ld", conditions[k].expression, i + 1);
        }
        source_list_deinit(&s);
    }
}

/* ---- what is refused ---- */

static void expect(const char *expression, const char *word, const char *other) {
    const char *path = fixture_path("refused.cat");
    const shear_exposure e = {.origin = 1, .select = expression};
    source_fixture_expect(path, &e, SHEAR_E_SETTING, "row expression", word, other, NULL);
}

static void write_refused(void) {
    fitsfile *f = fixture_create(fixture_path("refused.cat"));
    source_fixture_table(f, "OBJECTS", columns, COLUMNS, 8);
    fixture_close(f);
}

static void test_files(void **state) {
    (void)state;
    write_refused();
    expect("gtifilter('/etc/passwd')", "function 'gtifilter'", "functions: abs");
    expect("X_IMAGE>0 && GTIFIND ('a.fits')", "function 'GTIFIND'", "abs");
    expect("gtioverlap(\"a.fits\", X_IMAGE, Y_IMAGE) > 0", "function 'gtioverlap'", "abs");
    expect("1regfilter('a.reg')", "function '1regfilter'", "abs");
    expect("@/etc/passwd", "'@'", "columns");
    expect(" @/etc/passwd", "'@'", "columns");
    expect("X_IMAGE > 0\n@a", "cannot have", "columns");
}

static void test_others(void **state) {
    (void)state;
    write_refused();
    expect("", "names no column", "X_IMAGE");
    expect("T", "names no column", "X_IMAGE");
    expect("#row < 4", "names no column", "X_IMAGE");
    expect("X_IMGE > 3", "no column 'X_IMGE'", "did you mean X_IMAGE?");
    expect("$X_IMA*$ > 3", "no column 'X_IMA*'", "X_IMAGE");
    expect("VIGNET > 3", "column 'VIGNET'", "one number");
    expect("X_IMAGE[1] > 3", "'['", "columns");
    expect("X_IMAGE{-1} > 3", "'{'", "columns");
    expect("X_IMAGE == {1,2}", "'{'", "columns");
    expect("sum(X_IMAGE) > 1", "function 'sum'", "abs");
    expect("random() < X_IMAGE", "function 'random'", "abs");
    expect("X_IMAGE > #$a$", "'#'", "KEYWORD");
    expect("X_IMAGE > 'a\"b'", "breaks off", "quotes");
    expect("X_IMAGE > 'a", "breaks off", "quotes");
    expect("X_IMAGE > #AUTHOR", "CFITSIO", "AUTHOR");
    expect("X_IMAGE >", "CFITSIO", "X_IMAGE");
    expect("X_IMAGE", "CFITSIO", "logical");
    expect("X_IMAGE = 3", "CFITSIO", "X_IMAGE");
    expect("X_IMAGE > h000000000000000000000000000000000000000000000000000000000000", "too long",
           "60");
}

/* Longer than allowed; and as long as allowed, deep or with many terms. */
static void test_length(void **state) {
    (void)state;
    char text[1100];
    const char *path = fixture_path("refused.cat");
    write_refused();
    memset(text, '(', sizeof text);
    snprintf(text + 1001, sizeof text - 1001, "X");
    expect(text, "1002 characters", "1000");
    memset(text, '(', 490);
    memcpy(text + 490, "X_IMAGE>0", 9);
    memset(text + 499, ')', 490);
    text[989] = '\0';
    const shear_exposure e = {.origin = 1, .select = text};
    source_list s = source_fixture_read(path, &e);
    source_list_deinit(&s);
    text[0] = '\0';
    while (strlen(text) < 970)
        strcat(text, "X_IMAGE>-Y_IMAGE||");
    strcat(text, "X_IMAGE>0");
    s = source_fixture_read(path, &e);
    assert_int_equal(source_fixture_selected(&s), 4);
    source_list_deinit(&s);
    memset(text, '!', 900);
    memcpy(text + 900, "(X_IMAGE>0)", 12);
    s = source_fixture_read(path, &e);
    source_list_deinit(&s);
}

/* CFITSIO 4.2 ends the process by the first of these, and by a column with -2^63. */
static void test_integers(void **state) {
    (void)state;
    static const char *const deadly[] = {"(0-9223372036854775807-1)/(-1)==X_IMAGE",
                                         "(4294967296*2147483648)%(-1)>X_IMAGE",
                                         "NUMBER/0==1",
                                         "NUMBER%0==1",
                                         "(NUMBER*0+4294967296)*2147483648/(-1)==4",
                                         "(int)(X_IMAGE*1e300)/(0-1)==4"};
    const char *path = fixture_path("refused.cat");
    write_refused();
    for (size_t k = 0; k < sizeof deadly / sizeof *deadly; k++) {
        const shear_exposure e = {.origin = 1, .select = deadly[k]};
        source_list s = source_fixture_read(path, &e);
        source_list_deinit(&s);
    }
}

/* ---- threads ---- */

static void *read_often(void *path) {
    const shear_exposure e = {.origin = 1, .select = "X_IMAGE < 20"};
    for (int k = 0; k < 20; k++) {
        source_list s = source_fixture_read(path, &e);
        assert_int_equal(source_fixture_selected(&s), 4);
        source_list_deinit(&s);
    }
    return NULL;
}

static void test_threads(void **state) {
    (void)state;
    pthread_t threads[4];
    char path[600];
    snprintf(path, sizeof path, "%s", fixture_path("threads.cat"));
    source_fixture_write(path, 12);
    for (int k = 0; k < 4; k++)
        assert_int_equal(pthread_create(&threads[k], NULL, read_often, path), 0);
    for (int k = 0; k < 4; k++)
        assert_int_equal(pthread_join(threads[k], NULL), 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_conditions), cmocka_unit_test(test_files),
        cmocka_unit_test(test_others),     cmocka_unit_test(test_length),
        cmocka_unit_test(test_integers),   cmocka_unit_test(test_threads),
    };
    return cmocka_run_group_tests(tests, fixture_setup, fixture_teardown);
}
