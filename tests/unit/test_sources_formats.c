/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Catalogs of sources: the same rows in all formats are the same sources, and real ones are read.
 */
#include "source_fixture.h"

#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

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

/* ---- FITS_LDAC, FITS_1.0 and other tables ---- */

static const char *const chip_header[] = {"SIMPLE  =                    T",
                                          "EXTNAME = 'N15     '           / chip", "END", NULL};
static const char *const nameless_header[] = {"SIMPLE  =                    T", "END", NULL};

/* Two chips; old files have other names. */
static void check_ldac(const char *head, const char *objects) {
    const char *path = fixture_path("ldac.cat");
    fitsfile *f = fixture_create(path);
    source_fixture_header(f, head, chip_header);
    source_fixture_table(f, objects, source_fixture_usual, 5, 7);
    source_fixture_header(f, head, nameless_header);
    source_fixture_table(f, objects, source_fixture_usual, 5, 0);
    fixture_close(f);
    source_catalog *c = source_fixture_open(path, NULL);
    assert_int_equal(source_catalog_tables(c), 2);
    assert_string_equal(source_catalog_chip(c, 0), "N15");
    assert_string_equal(source_catalog_chip(c, 1), "");
    int64_t cards = 0;
    assert_memory_equal(source_catalog_header(c, 0, &cards) + 80, "EXTNAME = 'N15", 14);
    assert_int_equal(cards, 3);
    for (int i = 0; i < 2; i++) {
        source_list s = source_fixture_load(c, i);
        assert_int_equal(s.n, i == 0 ? 7 : 0);
        assert_non_null(s.x);
        source_list_deinit(&s);
    }
    source_catalog_close(c);
}

static void test_ldac(void **state) {
    (void)state;
    check_ldac("LDAC_IMHEAD", "LDAC_OBJECTS");
    check_ldac("FIELDS", "OBJECTS");
}

static double seven(long i) {
    return 7.0 + (double)i;
}

/* Of a file with other tables, those with positions are taken if they have the same columns. */
static void test_any_tables(void **state) {
    (void)state;
    static const source_fixture_column none[] = {{"EXTENT", "1D", NULL, seven}};
    static const source_fixture_column xy[] = {
        {"y", "1J", NULL, seven}, {"ra", "1D", NULL, seven}, {"x", "1D", NULL, seven}};
    static const source_fixture_column more[] = {
        {"x", "1D", NULL, seven}, {"y", "1D", NULL, seven}, {"what", "1D", NULL, seven}};
    const char *path = fixture_path("any.fits");
    fitsfile *f = fixture_create(path);
    source_fixture_table(f, "ARCHIVE", none, 1, 3);
    source_fixture_table(f, "CCD1", xy, 3, 4);
    source_fixture_table(f, "OTHER", more, 3, 5);
    source_fixture_table(f, "CCD2", xy, 3, 6);
    fixture_close(f);
    source_catalog *c = source_fixture_open(path, NULL);
    assert_int_equal(source_catalog_tables(c), 2);
    assert_string_equal(source_catalog_chip(c, 1), "");
    int64_t cards = -1;
    assert_null(source_catalog_header(c, 0, &cards));
    assert_int_equal(cards, 0);
    source_list s = source_fixture_load(c, 1);
    assert_int_equal(s.n, 6);
    assert_null(s.ra); /* without dec */
    assert_true(s.x[5] == 12.0 && s.id[5] == 6);
    source_list_deinit(&s);
    source_catalog_close(c);
}

static double chip_of(long i) {
    return (double)(i % 3 == 0 ? 1 : 4);
}

/* One table of several chips, told apart by a column; chips 2 and 3 have no sources. */
static void test_chips_of_one_table(void **state) {
    (void)state;
    static const source_fixture_column merged[] = {{"X", "1D", NULL, seven},
                                                   {"Y", "1D", NULL, seven},
                                                   {"MAG", "1D", NULL, seven},
                                                   {"EXT_NUMBER", "1I", NULL, chip_of}};
    static const char *const contexts[] = {"MAG", "EXT_NUMBER"};
    const char *path = fixture_path("merged.fits");
    fitsfile *f = fixture_create(path);
    source_fixture_table(f, "OBJECTS", merged, 4, 10);
    fixture_close(f);
    source_catalog *c = source_fixture_open(path, NULL);
    assert_int_equal(source_catalog_tables(c), 4);
    for (int i = 0; i < 4; i++) {
        source_list s;
        assert_string_equal(source_catalog_chip(c, i), "");
        assert_int_equal(source_catalog_load(c, i, contexts, 2, NULL, &s, NULL), SHEAR_OK);
        assert_int_equal(s.n, i == 0 ? 4 : i == 3 ? 6 : 0);
        for (int64_t k = 0; k < s.n; k++) {
            const int64_t row = s.id[k] - 1;
            assert_true(s.x[k] == seven(row) && s.y[k] == seven(row) && s.selected[k] == 1);
            assert_true(s.context[2 * k] == seven(row) && s.context[2 * k + 1] == i + 1);
        }
        source_list_deinit(&s);
    }
    source_catalog_close(c);
    fixture_patch(path, "OBJECTS", "TZERO4", "-1");
    source_fixture_expect(path, NULL, SHEAR_E_FORMAT, "row 1: EXT_NUMBER", "1000", NULL);
    fixture_patch(path, "OBJECTS", "TZERO4", "997");
    source_fixture_expect(path, NULL, SHEAR_E_FORMAT, "row 2: EXT_NUMBER", "1000", NULL);
}

static int64_t rows_of(const char *path, const char *extname, int64_t hdu) {
    source_catalog *c = NULL;
    shear_error err = {0};
    const shear_exposure e = {.origin = 1};
    const shear_input_part part = {.path = path, .extname = extname, .hdu = hdu};
    const int code = source_catalog_open(&c, &part, -1, &e, &err);
    if (code != SHEAR_OK)
        return -code;
    assert_int_equal(source_catalog_tables(c), 1);
    source_list s = source_fixture_load(c, 0);
    const int64_t n = s.n;
    source_list_deinit(&s);
    source_catalog_close(c);
    return n;
}

static void test_chosen_hdu(void **state) {
    (void)state;
    const char *path = fixture_path("chosen.fits");
    fitsfile *f = fixture_create(path);
    source_fixture_table(f, "A", source_fixture_usual, 5, 3);
    source_fixture_table(f, "B", source_fixture_usual, 5, 4);
    fixture_close(f);
    assert_int_equal(rows_of(path, "b", -1), 4);
    assert_int_equal(rows_of(path, NULL, 1), 3);
    assert_int_equal(rows_of(path, NULL, 0), -SHEAR_E_FORMAT);
    assert_int_equal(rows_of(path, NULL, 3), -SHEAR_E_FORMAT);
    assert_int_equal(rows_of(path, NULL, INT64_MAX), -SHEAR_E_FORMAT);
    assert_int_equal(rows_of(path, "C", -1), -SHEAR_E_FORMAT);
}

/* ---- columns ---- */

static double half(long i) {
    return (double)i + 0.5;
}
static double quarter(long i) {
    return (double)i + 0.25;
}
static double radians(long i) {
    return 0.01 * (double)i;
}

static const source_fixture_column crowded[] = {
    {"xwin_image", "1D", NULL, half},     {"YWIN_IMAGE", "1D", NULL, half},
    {"X", "1D", NULL, quarter},           {"Y", "1D", NULL, quarter},
    {"coord_ra", "1D", "rad", radians},   {"coord_dec", "1D", "rad", radians},
    {"ALPHA_J2000", "1D", "hours", half}, {"DELTA_J2000", "1D", "deg", quarter},
    {"R_GAL", "1D", NULL, half},          {"FLUX_RADIUS", "1D", NULL, quarter},
    {"Weight", "1D", NULL, half},         {"MASKED", "1J", NULL, seven}};

static source_list read_crowded(const char *columns, int origin) {
    const char *path = fixture_path("crowded.fits");
    fitsfile *f = fixture_create(path);
    source_fixture_table(f, "SRC", crowded, 12, 9);
    fixture_close(f);
    const shear_exposure e = {.origin = origin, .columns = columns};
    return source_fixture_read(path, &e);
}

static void test_usual_columns(void **state) {
    (void)state;
    source_list s = read_crowded(NULL, 0);
    for (long i = 0; i < 9; i++) {
        assert_true(s.x[i] == half(i) + 1.0 && s.y[i] == half(i) + 1.0);
        assert_true(s.ra[i] == 15.0 * half(i) && s.dec[i] == quarter(i));
        assert_true(s.r_gal[i] == half(i));
        assert_true(s.weight[i] == half(i));
        assert_true(s.a[i] == 2.5 * quarter(i) && s.b[i] == s.a[i] && s.theta[i] == 0.0);
        assert_int_equal(s.id[i], i + 1);
        assert_int_equal(s.selected[i], 1);
    }
    source_list_deinit(&s);
}

static void test_chosen_columns(void **state) {
    (void)state;
    source_list s =
        read_crowded("ra=coord_ra,DEC=coord_dec,r_gal=flux_radius,flags=MASKED,id=MASKED,"
                     "weight=Y",
                     1);
    assert_null(s.x); /* ra and dec are chosen */
    for (long i = 0; i < 9; i++) {
        assert_true(fabs(s.ra[i] - radians(i) * 57.295779513082321) < 1e-14);
        assert_true(s.r_gal[i] == 2.0 * quarter(i));
        assert_true(s.weight[i] == quarter(i));
        assert_int_equal(s.id[i], 7 + i);
        assert_int_equal(s.selected[i], 0);
    }
    source_list_deinit(&s);
    s = read_crowded("x=X,y=Y,r_gal=Weight", 1);
    for (long i = 0; i < 9; i++)
        assert_true(s.x[i] == quarter(i) && s.r_gal[i] == half(i));
    assert_non_null(s.ra);
    source_list_deinit(&s);
}

static void test_contexts(void **state) {
    (void)state;
    const char *path = fixture_path("contexts.cat");
    source_fixture_write(path, 12);
    source_catalog *c = source_fixture_open(path, NULL);
    static const char *const names[] = {"mag_auto", "NUMBER", "MAG_AUTOS"};
    source_list s;
    shear_error err = {0};
    assert_int_equal(source_catalog_load(c, 0, names, 2, NULL, &s, &err), SHEAR_OK);
    assert_int_equal(s.n_contexts, 2);
    for (long i = 0; i < 12; i++) {
        assert_true(s.context[2 * i] == 18.0 + (double)(i % 10) * 0.5);
        assert_true(s.context[2 * i + 1] == (double)(i + 1));
    }
    source_list_deinit(&s);
    assert_int_equal(source_catalog_load(c, 0, names, 3, NULL, &s, &err), SHEAR_E_FORMAT);
    assert_non_null(strstr(err.message, "MAG_AUTOS"));
    assert_non_null(strstr(err.advice, "did you mean MAG_AUTO?"));
    source_list_deinit(&s);
    source_catalog_close(c);
}

/* ---- ellipses ---- */

static double two(long i) {
    (void)i;
    return 2.0;
}
static double one(long i) {
    (void)i;
    return 1.0;
}
static double kron(long i) {
    return i == 0 ? 3.5 : 0.0;
}
static double area(long i) {
    return i == 2 ? 0.0 : 40.0;
}
static double bad(long i) {
    return i == 0 ? NAN : i == 1 ? -1.0 : INFINITY;
}

static const source_fixture_column shapes[] = {
    {"X_IMAGE", "1D", NULL, half},       {"Y_IMAGE", "1D", NULL, half},
    {"A_IMAGE", "1E", "pixel", two},     {"B_IMAGE", "1E", "pixel", one},
    {"THETA_IMAGE", "1E", "deg", half},  {"KRON_RADIUS", "1E", NULL, kron},
    {"ISOAREA_IMAGE", "1J", NULL, area}, {"FLUX_RADIUS", "1E", NULL, bad}};

static void test_ellipses(void **state) {
    (void)state;
    const char *path = fixture_path("shapes.fits");
    fitsfile *f = fixture_create(path);
    source_fixture_table(f, "SRC", shapes, 8, 3);
    fixture_close(f);
    source_list s = source_fixture_read(path, NULL);
    assert_true(s.a[0] == 7.0 && s.b[0] == 3.5 && s.theta[0] == 0.5);
    assert_true(fabs(M_PI * s.a[1] * s.b[1] - 1.25 * 1.25 * 40.0) < 1e-9 && s.a[1] == 2.0 * s.b[1]);
    assert_true(s.a[2] == 6.0 && s.b[2] == 3.0);
    for (int i = 0; i < 3; i++)
        assert_true(isnan(s.r_gal[i]));
    source_list_deinit(&s);
    const shear_exposure e = {.origin = 1, .columns = "a=KRON_RADIUS,b=B_IMAGE,theta=THETA_IMAGE"};
    s = source_fixture_read(path, &e);
    assert_true(s.a[0] == 3.5 && s.b[0] == 1.0);
    assert_true(isnan(s.a[1]) && isnan(s.b[1])); /* not positive */
    source_list_deinit(&s);
}

/* ---- text ---- */

static const char text_catalog[] = "# written by hand\n"
                                   "#   1 NUMBER          Running object number\n"
                                   "#   2 X_IMAGE         Position along x      [pixel]\n"
                                   "#   3 Y_IMAGE         Position along y      [pixel]\n"
                                   "#   4 FLUX_APER       Flux vector           [count]\n"
                                   "#   7 ALPHA_J2000     Right ascension       [deg]\n"
                                   "#   8 DELTA_J2000     Declination\n"
                                   "#   9 FLAGS           Flags\n"
                                   "#  10 VIGNET\n"
                                   "  12  1.5 2.5  1 2 3  150.25 -2.125  0   0 0 0\n"
                                   "\n"
                                   "# a remark\n"
                                   "\t13  nan 1e300  1 2 3  inf +3  4   0 0 0\r\n"
                                   "14 1 2 3 4 5 6 7 8 9 10 11";

static void check_text(const char *path) {
    const shear_exposure e = {.origin = 1, .select = "X_IMAGE < 2 || FLAGS > 2"};
    source_list s = source_fixture_read(path, &e);
    assert_int_equal(s.n, 3);
    assert_int_equal(s.id[0], 12);
    assert_true(s.x[0] == 1.5 && s.y[0] == 2.5 && s.ra[0] == 150.25 && s.dec[0] == -2.125);
    assert_true(isnan(s.x[1]) && s.y[1] == 1e300 && isinf(s.ra[1]) && s.dec[1] == 3.0);
    assert_true(s.x[2] == 1.0 && s.ra[2] == 6.0);
    assert_int_equal(s.selected[0], 1);
    assert_int_equal(s.selected[1], 1);
    assert_int_equal(s.selected[2], 1);
    source_list_deinit(&s);
}

static void test_text(void **state) {
    (void)state;
    const char *path = fixture_path("text.cat");
    const char *packed = fixture_path("text.cat.gz");
    source_fixture_text(path, text_catalog);
    check_text(path);
    fixture_gzip(path, packed);
    check_text(packed);
    source_fixture_text(path, "# 1 X_IMAGE\n# 2 Y_IMAGE\n");
    source_list s = source_fixture_read(path, NULL);
    assert_int_equal(s.n, 0);
    source_list_deinit(&s);
    source_fixture_text(path, "#   5 X_IMAGE\n#   7 Y_IMAGE\n1 2 3 4 5 6 7 8\n");
    source_fixture_expect(path, NULL, SHEAR_E_FORMAT, "positions", "X_IMAGE, Y_IMAGE", NULL);
    source_fixture_text(path, "#   5 X_IMAGE\n#   6 Y_IMAGE\n1 2 3 4 5 6\n");
    s = source_fixture_read(path, NULL);
    assert_true(s.n == 1 && s.x[0] == 5.0 && s.y[0] == 6.0);
    source_list_deinit(&s);
}

/* Whole numbers stay exact, and have bits. */
static void test_text_integers(void **state) {
    (void)state;
    const char *path = fixture_path("whole.cat");
    source_fixture_text(path, "# 1 ID\n# 2 X\n# 3 Y\n# 4 MASK\n# 5 BIG\n# 6 REAL\n"
                              "9007199254740993 1 2 2147483647 2147483648 4\n"
                              "-9223372036854775808 1 2 -2147483648 4 4.5\n"
                              "1 1 2 6 4 4\n");
    const shear_exposure e = {.origin = 1, .select = "(MASK & 4) == 4 && REAL == 4"};
    source_list s = source_fixture_read(path, &e);
    assert_true(s.id[0] == 9007199254740993 && s.id[1] == INT64_MIN && s.id[2] == 1);
    assert_true(s.selected[0] == 1 && s.selected[1] == 0 && s.selected[2] == 1);
    source_list_deinit(&s);
    const shear_exposure big = {.origin = 1, .select = "BIG > 2147483647"};
    s = source_fixture_read(path, &big);
    assert_true(s.selected[0] == 1 && s.selected[1] == 0 && s.selected[2] == 0);
    source_list_deinit(&s);
}

/* A gzipped catalog, and one through a descriptor, are read as the file is. */
static void test_packed(void **state) {
    (void)state;
    const char *path = fixture_path("plain.cat");
    const char *packed = fixture_path("packed.cat.gz");
    source_fixture_write(path, 30);
    fixture_gzip(path, packed);
    source_list a = source_fixture_read(path, NULL);
    source_list b = source_fixture_read(packed, NULL);
    assert_int_equal(b.n, a.n);
    assert_memory_equal(a.x, b.x, (size_t)a.n * sizeof *a.x);
    source_list_deinit(&a);
    source_list_deinit(&b);
    const int fd = open(packed, O_RDONLY);
    assert_true(fd >= 0);
    source_catalog *c = NULL;
    const shear_input_part part = {.path = "no such path", .hdu = -1};
    const shear_exposure e = {.origin = 1};
    assert_int_equal(source_catalog_open(&c, &part, fd, &e, NULL), SHEAR_OK);
    source_catalog_close(c);
    assert_int_equal(close(fd), 0);
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
        cmocka_unit_test(test_one_table),          cmocka_unit_test(test_ldac),
        cmocka_unit_test(test_any_tables),         cmocka_unit_test(test_chosen_hdu),
        cmocka_unit_test(test_chips_of_one_table), cmocka_unit_test(test_usual_columns),
        cmocka_unit_test(test_chosen_columns),     cmocka_unit_test(test_contexts),
        cmocka_unit_test(test_ellipses),           cmocka_unit_test(test_text),
        cmocka_unit_test(test_text_integers),      cmocka_unit_test(test_packed),
        cmocka_unit_test(test_real_twins),         cmocka_unit_test(test_real_files),
    };
    return cmocka_run_group_tests(tests, fixture_setup, fixture_teardown);
}
