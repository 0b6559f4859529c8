/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Damaged field files: each is a clear error at once, whatever its header says. */
#include "fits_fixture.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

#define END ((const char *)NULL)

enum { BLOCK = 2880 };

static const char *bad(void) {
    return fixture_path("bad.fits");
}

/* A good cube; the same as a mosaic; with a catalog. */
static void cube(void) {
    fixture_write_good(bad());
}

static void mosaic(void) {
    shear_field_spec s = fixture_spec();
    s.layout = SHEAR_LAYOUT_MOSAIC;
    s.mosaic_columns = 4;
    fixture_write(bad(), &s);
}

static void with_catalog(void) {
    shear_field_spec s = fixture_spec();
    s.columns = SHEAR_COL_ID | SHEAR_COL_X | SHEAR_COL_WEIGHT;
    fixture_write(bad(), &s);
}

/* Patch one card of a fresh cube, and expect a message about it. */
static void patched(const char *hdu, const char *key, const char *value, const char *word) {
    cube();
    fixture_patch(bad(), hdu, key, value);
    fixture_expect_open(bad(), SHEAR_E_FORMAT, hdu[0] != '\0' ? hdu : "primary", word, END);
}

static void not_fits(void **state) {
    (void)state;
    fixture_save(bad(), "", 0);
    fixture_expect_open(bad(), SHEAR_E_FORMAT, "is empty", END);
    fixture_save(bad(), "S", 1);
    fixture_expect_open(bad(), SHEAR_E_FORMAT, "not a FITS file", "SIMPLE", END);
    fixture_save(bad(), "some text that is no FITS file at all\n", 38);
    fixture_expect_open(bad(), SHEAR_E_FORMAT, "not a FITS file", END);
    fixture_save(bad(), "SIMPLE  =                    T", 30);
    fixture_expect_open(bad(), SHEAR_E_FORMAT, "header", "byte 2880", "has 30", END);
}

/* Every prefix of a file is an error, at the latest when its stamps are read; never a wrong number.
 */
static void truncated(void **state) {
    (void)state;
    cube();
    size_t size = 0;
    unsigned char *bytes = fixture_load(bad(), &size);
    for (size_t cut = 1; cut < size; cut += cut < 400 ? 80 : 719) {
        fixture_save(bad(), bytes, size - cut);
        shear_field *field = NULL;
        shear_error err = {0};
        assert_int_equal(shear_field_open(&field, bad(), &err), SHEAR_E_FORMAT);
        assert_null(field);
        assert_non_null(strstr(err.message, "bad.fits"));
    }
    char actual[32];
    char expected[32];
    snprintf(actual, sizeof actual, "%zu", size - 100);
    snprintf(expected, sizeof expected, "%zu", size);
    fixture_save(bad(), bytes, size - 100);
    fixture_expect_open(bad(), SHEAR_E_FORMAT, "HDU PSF", expected, actual, END);
    free(bytes);
}

static void truncated_after_opening(void **state) {
    (void)state;
    cube();
    shear_field *field = NULL;
    shear_block *b = NULL;
    shear_error err = {0};
    assert_int_equal(shear_field_open(&field, bad(), &err), SHEAR_OK);
    assert_int_equal(shear_block_new(&b, shear_field_get_info(field), 10, &err), SHEAR_OK);
    assert_int_equal(truncate(bad(), (off_t)fixture_data_offset(bad(), "NOISE")), 0);
    assert_int_equal(shear_field_read(field, 0, 10, b, &err), SHEAR_E_FORMAT);
    assert_non_null(strstr(err.message, "HDU NOISE"));
    shear_block_free(b);
    shear_field_close(field);
}

static void missing_hdus(void **state) {
    (void)state;
    static const char *const names[] = {"GALAXY", "NOISE", "PSF"};
    for (int i = 0; i < 3; i++) {
        char message[32];
        snprintf(message, sizeof message, "has no HDU %s", names[i]);
        cube();
        fixture_patch(bad(), names[i], "EXTNAME", "'OTHER'");
        fixture_expect_open(bad(), SHEAR_E_FORMAT, message, "OTHER", END);
    }
    cube();
    fixture_patch(bad(), "PSF", "EXTNAME", "'noise'");
    fixture_expect_open(bad(), SHEAR_E_FORMAT, "HDU NOISE", "two HDUs", END);
    fixture_close(fixture_create(bad()));
    fixture_expect_open(bad(), SHEAR_E_FORMAT, "has no HDU GALAXY", "none", END);
}

static void structural_keywords(void **state) {
    (void)state;
    patched("GALAXY", "BITPIX", "12", "BITPIX");
    patched("GALAXY", "BITPIX", "'text'", "BITPIX");
    patched("GALAXY", "NAXIS", "2000", "NAXIS");
    patched("GALAXY", "NAXIS", "-1", "NAXIS");
    patched("GALAXY", "NAXIS", "2", "NAXIS");
    patched("GALAXY", "NAXIS1", "-5", "NAXIS1");
    patched("GALAXY", "NAXIS1", "1.5", "NAXIS1");
    patched("GALAXY", "NAXIS1", "99999999999999999999", "NAXIS1");
    patched("GALAXY", "NAXIS3", "0", "NAXIS3");
    patched("GALAXY", "PCOUNT", "-1", "PCOUNT");
    patched("GALAXY", "PCOUNT", "4", "PCOUNT");
    patched("GALAXY", "GCOUNT", "0", "GCOUNT");
    patched("GALAXY", "GROUPS", "T", "random groups");
    patched("GALAXY", "GROUPS", "1", "GROUPS");
    patched("", "NAXIS", "7", "NAXIS");
    patched("GALAXY", "BSCALE", "0.0", "BSCALE");
    patched("GALAXY", "BZERO", "'zero'", "BZERO");
    cube();
    fixture_patch(bad(), "GALAXY", "COMMENT1", "0");
    size_t size = 0;
    unsigned char *bytes = fixture_load(bad(), &size);
    memcpy(memmem(bytes, size, "COMMENT1", 8), "NAXIS2  ", 8); /* a second NAXIS2 */
    fixture_save(bad(), bytes, size);
    free(bytes);
    fixture_expect_open(bad(), SHEAR_E_FORMAT, "GALAXY", "NAXIS2", "twice", END);
}

static void exchange_cards(const char *one, const char *other) {
    size_t size = 0;
    unsigned char *bytes = fixture_load(bad(), &size);
    const size_t start = fixture_data_offset(bad(), "GALAXY") - 2880;
    unsigned char *a = memmem(bytes + start, 2880, one, strlen(one));
    unsigned char *b = memmem(bytes + start, 2880, other, strlen(other));
    unsigned char card[80];
    assert_true(a != NULL && b != NULL);
    memcpy(card, a, 80);
    memcpy(a, b, 80);
    memcpy(b, card, 80);
    fixture_save(bad(), bytes, size);
    free(bytes);
}

/* CFITSIO believes the place of these cards, not their names. */
static void cards_out_of_order(void **state) {
    (void)state;
    static const char *const pairs[][2] = {{"BITPIX  ", "NAXIS   "},
                                           {"NAXIS   ", "NAXIS1  "},
                                           {"NAXIS1  ", "NAXIS2  "},
                                           {"NAXIS3  ", "PCOUNT  "},
                                           {"BITPIX  ", "EXTNAME "}};
    for (size_t i = 0; i < sizeof pairs / sizeof pairs[0]; i++) {
        cube();
        exchange_cards(pairs[i][0], pairs[i][1]);
        fixture_expect_open(bad(), SHEAR_E_FORMAT, "GALAXY", "must be card", END);
    }
}

/* A header whose first card is damaged is not taken for what may stand behind the last HDU. */
static void lost_extension(void **state) {
    (void)state;
    size_t size = 0;
    with_catalog();
    unsigned char *bytes = fixture_load(bad(), &size);
    memcpy(bytes + fixture_data_offset(bad(), "CATALOG") - BLOCK, "XTENSIOM", 8);
    fixture_save(bad(), bytes, size);
    free(bytes);
    fixture_expect_open(bad(), SHEAR_E_FORMAT, "does not begin with XTENSION", END);
}

/* All readers of a header see the same END: cards behind it are not keywords. */
static void cards_behind_end(void **state) {
    (void)state;
    static const char behind[] = "PIXSCALE=                   -1";
    size_t size = 0;
    shear_field *field = NULL;
    shear_error err = {0};
    cube();
    unsigned char *bytes = fixture_load(bad(), &size);
    unsigned char *end = memmem(bytes, size, "END     ", 8);
    memcpy(end, "END\0 \0 ", 8);
    memcpy(end + 80, behind, strlen(behind));
    fixture_save(bad(), bytes, size);
    free(bytes);
    assert_int_equal(shear_field_open(&field, bad(), &err), SHEAR_OK);
    shear_field_close(field);
}

/* CFITSIO 4.2 overruns a buffer over such values. It never sees them: where the keyword means
 * nothing it is not looked at, where it does it is refused. */
static void long_numbers(void **state) {
    (void)state;
    static const char *const keys[] = {"BLANK", "ZBLANK", "ZDITHER0", "ZVAL2", "TNULL1"};
    static const char *const values[] = {"'a string of many more characters than thirty'",
                                         "100000000000000000000000000000"};
    const fixture_image image = {.bitpix = 16, .axes = {13, 9}};
    for (size_t i = 0; i < 2 * sizeof keys / sizeof keys[0]; i++) {
        shear_field *field = NULL;
        shear_error err = {0};
        cube();
        fixture_patch(bad(), "GALAXY", keys[i / 2], values[i % 2]);
        assert_int_equal(shear_field_open(&field, bad(), &err), SHEAR_OK);
        shear_field_close(field);
        fixture_write_like(bad(), &image, 5);
        fixture_patch(bad(), "GALAXY", "BLANK", values[i % 2]);
        fixture_expect_open(bad(), SHEAR_E_FORMAT, "HDU GALAXY", "BLANK", END);
    }
}

/* Seconds and bytes that opening takes. */
static void absurd_sizes(void **state) {
    (void)state;
    static const char *const axes[][3] = {{"100000000", "100000000", "1"},
                                          {"12", "10", "1000000000000"},
                                          {"4611686018427387904", "4", "1"},
                                          {"9223372036854775807", "9223372036854775807", "9"}};
    struct rusage before;
    struct rusage after;
    getrusage(RUSAGE_SELF, &before);
    const clock_t start = clock();
    for (size_t i = 0; i < sizeof axes / sizeof axes[0]; i++) {
        static const char *const hdus[] = {"GALAXY", "NOISE", "PSF"};
        for (int h = 0; h < (i == 1 ? 2 : 3); h++) { /* the PSF has no third axis */
            cube();
            fixture_patch(bad(), hdus[h], "NAXIS1", axes[i][0]);
            fixture_patch(bad(), hdus[h], "NAXIS2", axes[i][1]);
            if (h < 2)
                fixture_patch(bad(), hdus[h], "NAXIS3", axes[i][2]);
            fixture_expect_open(bad(), SHEAR_E_FORMAT, hdus[h], END);
        }
    }
    getrusage(RUSAGE_SELF, &after);
    assert_true((double)(clock() - start) / CLOCKS_PER_SEC <
                5.0);                                            /* 12 files, also under valgrind */
    assert_true(after.ru_maxrss - before.ru_maxrss < 64 * 1024); /* KiB */
    cube();
    fixture_patch(bad(), "GALAXY", "NAXIS1", "100000000");
    fixture_patch(bad(), "GALAXY", "NAXIS2", "100000000");
    size_t size = 0;
    free(fixture_load(bad(), &size));
    char actual[32];
    snprintf(actual, sizeof actual, "%zu", size);
    fixture_expect_open(bad(), SHEAR_E_FORMAT, "GALAXY", actual, "end at byte 400000000", END);
}

static void endless_header(void **state) {
    (void)state;
    const size_t size = 5000 * 2880;
    char *bytes = malloc(size);
    assert_non_null(bytes);
    memset(bytes, ' ', size);
    static const char *const cards[] = {"SIMPLE  =                    T", "BITPIX  = 8",
                                        "NAXIS   = 0"};
    for (size_t i = 0; i < 3; i++)
        memcpy(bytes + 80 * i, cards[i], strlen(cards[i]));
    fixture_save(bad(), bytes, size);
    free(bytes);
    fixture_expect_open(bad(), SHEAR_E_FORMAT, "primary", "header", "END", END);
}

static void many_hdus(void **state) {
    (void)state;
    cube();
    size_t size = 0;
    unsigned char *bytes = fixture_load(bad(), &size);
    char extension[2880];
    memset(extension, ' ', sizeof extension);
    static const char *const cards[] = {"XTENSION= 'IMAGE   '", "BITPIX  = 8", "NAXIS   = 0",
                                        "PCOUNT  = 0",          "GCOUNT  = 1", "END"};
    for (size_t i = 0; i < 6; i++)
        memcpy(extension + 80 * i, cards[i], strlen(cards[i]));
    unsigned char *joined = malloc(size + 1200 * sizeof extension);
    memcpy(joined, bytes, size);
    for (size_t i = 0; i < 1200; i++)
        memcpy(joined + size + i * sizeof extension, extension, sizeof extension);
    fixture_save(bad(), joined, size + 900 * sizeof extension);
    shear_field *field = NULL;
    assert_int_equal(shear_field_open(&field, bad(), NULL), SHEAR_OK);
    shear_field_close(field);
    fixture_save(bad(), joined, size + 1200 * sizeof extension);
    fixture_expect_open(bad(), SHEAR_E_FORMAT, "1000 HDUs", END);
    free(joined);
    free(bytes);
}

static void stamps_that_do_not_agree(void **state) {
    (void)state;
    static const int other[][3] = {{12, 10, 9}, {12, 11, 10}, {13, 10, 10}};
    for (int i = 0; i < 3; i++) {
        double *pixels = calloc(13 * 11 * 10, sizeof *pixels);
        fitsfile *f = fixture_create(bad());
        fixture_append(
            f, &(fixture_image){.name = "GALAXY", .bitpix = -32, .naxis = 3, .axes = {12, 10, 10}},
            pixels);
        fixture_append(f,
                       &(fixture_image){.name = "NOISE",
                                        .bitpix = -32,
                                        .naxis = 3,
                                        .axes = {other[i][0], other[i][1], other[i][2]}},
                       pixels);
        fixture_append(
            f, &(fixture_image){.name = "PSF", .bitpix = -32, .naxis = 2, .axes = {3, 3}}, pixels);
        fixture_close(f);
        char noise[64];
        snprintf(noise, sizeof noise, "%d stamps of %d x %d", other[i][2], other[i][0],
                 other[i][1]);
        fixture_expect_open(bad(), SHEAR_E_FORMAT, "HDU NOISE", "GALAXY", noise, "10 of 12 x 10",
                            END);
        free(pixels);
    }
}

static void stamp_shapes(void **state) {
    (void)state;
    static const long shapes[][3] = {{7, 8, 3}, {8, 7, 3}, {1025, 8, 1}, {8, 1025, 1}};
    double *pixels = calloc(1025 * 8, sizeof *pixels);
    for (int i = 0; i < 4; i++) {
        fitsfile *f = fixture_create(bad());
        fixture_image image = {.name = "GALAXY", .bitpix = -32, .naxis = 3};
        memcpy(image.axes, shapes[i], sizeof image.axes);
        fixture_append(f, &image, pixels);
        fixture_close(f);
        fixture_expect_open(bad(), SHEAR_E_FORMAT, "HDU GALAXY", "8 to 1024", END);
    }
    fitsfile *f = fixture_create(bad());
    fixture_append(f, &(fixture_image){.name = "GALAXY", .bitpix = -32, .naxis = 1, .axes = {100}},
                   pixels);
    fixture_close(f);
    fixture_expect_open(bad(), SHEAR_E_FORMAT, "HDU GALAXY", "2 or 3 axes", END);
    free(pixels);
}

static void mosaic_keywords(void **state) {
    (void)state;
    static const struct {
        const char *key, *value, *word;
    } cases[] = {{"STAMPNX", "13", "not a multiple"}, {"STAMPNY", "11", "not a multiple"},
                 {"STAMPNX", "0", "STAMPNX"},         {"STAMPNY", "-10", "STAMPNY"},
                 {"STAMPNX", "12.5", "STAMPNX"},      {"STAMPNX", "'12 px'", "STAMPNX"},
                 {"STAMPNX", "4", "8 to 1024"},       {"NSTAMP", "0", "NSTAMP"},
                 {"NSTAMP", "13", "1 to 12"},         {"NSTAMP", "9", "10 stamps"}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        mosaic();
        fixture_patch(bad(), "GALAXY", cases[i].key, cases[i].value);
        fixture_expect_open(bad(), SHEAR_E_FORMAT, "GALAXY", cases[i].word, END);
    }
    mosaic();
    size_t size = 0;
    unsigned char *bytes = fixture_load(bad(), &size);
    memcpy(memmem(bytes, size, "STAMPNY ", 8), "IGNORED ", 8);
    fixture_save(bad(), bytes, size);
    free(bytes);
    fixture_expect_open(bad(), SHEAR_E_FORMAT, "GALAXY", "STAMPNX without STAMPNY", END);
    patched("GALAXY", "STAMPNY", "10", "STAMPNY without STAMPNX");
    cube();
    fixture_patch(bad(), "GALAXY", "STAMPNX", "12");
    fixture_patch(bad(), "GALAXY", "STAMPNY", "8");
    fixture_expect_open(bad(), SHEAR_E_FORMAT, "GALAXY", "12 x 8", "12 x 10", END);
}

static void write_psf(int naxis, long nx, long ny, long n) {
    double *pixels = calloc(5000 * 12, sizeof *pixels);
    fitsfile *f = fixture_create(bad());
    fixture_image image = {.name = "GALAXY", .bitpix = -32, .naxis = 3, .axes = {8, 8, 4}};
    fixture_append(f, &image, pixels);
    image.name = "NOISE";
    fixture_append(f, &image, pixels);
    fixture_append(
        f, &(fixture_image){.name = "PSF", .bitpix = -32, .naxis = naxis, .axes = {nx, ny, n}},
        pixels);
    fixture_close(f);
    free(pixels);
}

static void psf_shapes(void **state) {
    (void)state;
    static const long many[] = {2, 3, 5};
    for (int i = 0; i < 3; i++) {
        char number[32];
        snprintf(number, sizeof number, "%ld images for 4 stamps", many[i]);
        write_psf(3, 9, 7, many[i]);
        fixture_expect_open(bad(), SHEAR_E_FORMAT, "HDU PSF", number, "PSF_ID", END);
    }
    static const long sides[][2] = {{2, 9}, {9, 2}, {4097, 3}, {3, 4097}};
    for (int i = 0; i < 4; i++) {
        write_psf(2, sides[i][0], sides[i][1], 1);
        fixture_expect_open(bad(), SHEAR_E_FORMAT, "HDU PSF", "3 to 4096", END);
    }
    patched("PSF", "OVERSAMP", "0", "OVERSAMP");
    patched("PSF", "OVERSAMP", "65", "0.1 to 64");
    patched("PSF", "OVERSAMP", "0.05", "OVERSAMP");
    patched("PSF", "OVERSAMP", "'many'", "OVERSAMP");
    write_psf(2, 9, 9, 1);
    fixture_patch(bad(), "", "OVERSAMP", "-3");
    fixture_expect_open(bad(), SHEAR_E_FORMAT, "HDU primary", "OVERSAMP", END);
    fixture_patch(bad(), "", "OVERSAMP", "16");
    shear_field *field = NULL;
    assert_int_equal(shear_field_open(&field, bad(), NULL), SHEAR_OK);
    assert_int_equal(shear_field_get_info(field)->geometry.psf_oversample, 16);
    shear_field_close(field);
    fixture_patch(bad(), "", "OVERSAMP", "2.375");
    assert_int_equal(shear_field_open(&field, bad(), NULL), SHEAR_OK);
    assert_true(shear_field_get_info(field)->geometry.psf_oversample == 2.375);
    shear_field_close(field);
}

/* The file opens, and only who wants its name is told why it has none. */
static void no_default_name(const char *path, const char *word) {
    shear_field *field = NULL;
    shear_error err = {0};
    assert_int_equal(shear_field_open(&field, path, &err), SHEAR_OK);
    const shear_field_info *info = shear_field_get_info(field);
    assert_string_equal(info->name, "");
    assert_int_equal(shear_field_need_name(info, path, &err), SHEAR_E_FORMAT);
    assert_non_null(strstr(err.message, "file's name"));
    assert_non_null(strstr(err.message, word));
    shear_field_close(field);
}

static void primary_keywords(void **state) {
    (void)state;
    patched("", "PIXSCALE", "0.0", "PIXSCALE");
    patched("", "PIXSCALE", "-0.2", "PIXSCALE");
    patched("", "PIXSCALE", "'fine'", "PIXSCALE");
    patched("", "SIM_G1", "1.0", "SIM_G1");
    patched("", "SIM_G2", "-2", "SIM_G2");
    patched("", "SIM_G1", "1E400", "SIM_G1");
    patched("", "FIELD", "'a name with a tab\tin it'", "control");
    patched("", "FIELD", "'caf\xc3\xa9'", "non-ASCII");
    cube();
    size_t size = 0;
    unsigned char *bytes = fixture_load(bad(), &size);
    const char *path = fixture_path("caf\xc3\xa9.fits");
    fixture_save(path, bytes, size);
    no_default_name(path, "non-ASCII");
    fixture_patch(path, "", "FIELD", "'cafe'");
    shear_field *field = NULL;
    assert_int_equal(shear_field_open(&field, path, NULL), SHEAR_OK);
    shear_field_close(field);
    path = fixture_path(
        "a-name-of-more-than-seventy-one-characters-which-is-more-than-any-field-has.fits");
    fixture_save(path, bytes, size);
    no_default_name(path, "1 to 71");
    free(bytes);
}

static void long_field_name(void **state) {
    (void)state;
    cube();
    fitsfile *f = NULL;
    int status = 0;
    fits_open_diskfile(&f, bad(), READWRITE, &status);
    fits_write_key_longstr(f, "FIELD",
                           "a name of more than seventy-one characters, which goes on and on "
                           "and on over several cards, and is refused",
                           NULL, &status);
    fits_close_file(f, &status);
    assert_int_equal(status, 0);
    fixture_expect_open(bad(), SHEAR_E_FORMAT, "keyword FIELD", "106 characters", END);
}

static void catalog_tables(void **state) {
    (void)state;
    static const struct {
        const char *key, *value, *word;
    } cases[] = {{"TFORM1", "'8A'", "ID"},
                 {"TFORM1", "'8A'", "strings"},
                 {"TFORM2", "'1PD(3)'", "variable"},
                 {"TFORM2", "'2E'", "repeat"},
                 {"TFORM3", "'1C'", "WEIGHT"},
                 {"TFORM3", "'8L'", "repeat"},
                 {"TFORM3", "'64X'", "WEIGHT"},
                 {"TTYPE3", "'x'", "two columns called X"},
                 {"NAXIS2", "9", "9 rows"},
                 {"TFIELDS", "1000", "TFIELDS"},
                 {"TFIELDS", "-1", "TFIELDS"},
                 {"TFORM2", "'9999999999D'", "CATALOG"},
                 {"TFORM2", "'?'", "CATALOG"},
                 {"TFORM2", "''", "CATALOG"},
                 {"ZTABLE", "T", "compressed"},
                 {"ZIMAGE", "T", "compressed"},
                 {"XTENSION", "'TABLE   '", "binary table"}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        with_catalog();
        fixture_patch(bad(), "CATALOG", cases[i].key, cases[i].value);
        fixture_expect_open(bad(), SHEAR_E_FORMAT, "HDU CATALOG", cases[i].word, END);
    }
    cube();
    fixture_patch(bad(), "PSF", "EXTNAME", "'CATALOG'");
    fixture_expect_open(bad(), SHEAR_E_FORMAT, "HDU CATALOG", "binary table", END);
    with_catalog();
    fixture_patch(bad(), "GALAXY", "EXTNAME", "'OTHER'");
    fixture_patch(bad(), "CATALOG", "EXTNAME", "'GALAXY'");
    fixture_expect_open(bad(), SHEAR_E_FORMAT, "HDU GALAXY", "is a table", END);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(not_fits),
        cmocka_unit_test(truncated),
        cmocka_unit_test(truncated_after_opening),
        cmocka_unit_test(missing_hdus),
        cmocka_unit_test(structural_keywords),
        cmocka_unit_test(cards_out_of_order),
        cmocka_unit_test(lost_extension),
        cmocka_unit_test(cards_behind_end),
        cmocka_unit_test(long_numbers),
        cmocka_unit_test(absurd_sizes),
        cmocka_unit_test(endless_header),
        cmocka_unit_test(many_hdus),
        cmocka_unit_test(stamps_that_do_not_agree),
        cmocka_unit_test(stamp_shapes),
        cmocka_unit_test(mosaic_keywords),
        cmocka_unit_test(psf_shapes),
        cmocka_unit_test(primary_keywords),
        cmocka_unit_test(long_field_name),
        cmocka_unit_test(catalog_tables),
    };
    return cmocka_run_group_tests(tests, fixture_setup, fixture_teardown);
}
