/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Our pixels are those that CFITSIO reads by itself from the whole file, bit by bit, whatever the
 * keywords say that decide what pixels are. */
#include "fits_fixture.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { N = 5, NX = 13, NY = 9, PIXELS = N * NX * NY };

static const char *file(void) {
    return fixture_path("oracle.fits");
}

static void read_ours(double *out) {
    shear_field *field = NULL;
    shear_block *b = NULL;
    shear_error err = {0};
    if (shear_field_open(&field, file(), &err) != SHEAR_OK)
        fail_msg("%s", err.message);
    assert_int_equal(shear_block_new(&b, shear_field_get_info(field), N, NULL), SHEAR_OK);
    if (shear_field_read(field, 0, N, b, &err) != SHEAR_OK)
        fail_msg("%s", err.message);
    memcpy(out, b->galaxy, PIXELS * sizeof *out);
    shear_block_free(b);
    shear_field_close(field);
}

static void read_theirs(double *out) {
    char name[] = "GALAXY";
    double null = NAN;
    int status = 0;
    int any = 0;
    fitsfile *f = NULL;
    fits_open_diskfile(&f, file(), READONLY, &status);
    fits_movnam_hdu(f, ANY_HDU, name, 0, &status);
    fits_read_img(f, TDOUBLE, 1, PIXELS, &null, out, &any, &status);
    fits_close_file(f, &status);
    assert_int_equal(status, 0);
}

static void same_pixels(const char *key, const char *value) {
    static double ours[PIXELS];
    static double theirs[PIXELS];
    read_ours(ours);
    read_theirs(theirs);
    for (int i = 0; i < PIXELS; i++) {
        if (memcmp(&ours[i], &theirs[i], sizeof ours[i]) != 0 &&
            !(isnan(ours[i]) && isnan(theirs[i]))) {
            fail_msg("%s = %s: pixel %d is %.17g, and %.17g for CFITSIO", key, value, i, ours[i],
                     theirs[i]);
        }
    }
}

typedef struct change {
    int compression, bitpix;
    bool lossy;
    const char *key, *value;
} change;

static void keywords_that_decide(void **state) {
    (void)state;
    static const change changes[] = {
        {RICE_1, -32, true, "ZDITHER0", "1"},
        {RICE_1, -32, true, "ZDITHER0", "4711"},
        {RICE_1, -32, true, "ZDITHER0", "10000"},
        {RICE_1, -32, true, "ZQUANTIZ", "'NO_DITHER'"},
        {RICE_1, -32, true, "ZQUANTIZ", "'SUBTRACTIVE_DITHER_2'"},
        {GZIP_1, -64, true, "ZQUANTIZ", "'SUBTRACTIVE_DITHER_1'"},
        {HCOMPRESS_1, -32, true, "ZDITHER0", "77"},
        {RICE_1, -32, true, "BSCALE", "2.5"},
        {RICE_1, -32, true, "BZERO", "-1D2"},
        {RICE_1, -32, true, "ZBLANK", "3"},
        {RICE_1, 16, false, "BSCALE", "0.25"},
        {RICE_1, 16, false, "BZERO", "32768"},
        {RICE_1, 16, false, "ZBLANK", "17"},
        {RICE_1, 16, false, "BLANK", "17"},
        {RICE_1, 16, false, "ZSCALE", "3"},
        {RICE_1, 32, false, "ZTILE1", "100"},
        {GZIP_2, -32, false, "BSCALE", "3"},
        {GZIP_2, -64, false, "BZERO", "7"},
        {PLIO_1, 16, false, "BZERO", "32768"},
        {HCOMPRESS_1, 16, false, "ZVAL2", "1"},
        {HCOMPRESS_1, 16, false, "ZVAL1", "2"},
        {0, 16, false, "BLANK", "17"},
        {0, 8, false, "BZERO", "-128"},
        {0, 64, false, "BZERO", "9223372036854775808"},
        {0, 64, false, "BSCALE", "1E-3"},
        {0, -32, false, "BSCALE", "3"},
        {0, -64, false, "BLANK", "3"},
    };
    for (size_t i = 0; i < sizeof changes / sizeof changes[0]; i++) {
        const change *c = &changes[i];
        const bool packed = c->compression != 0;
        const fixture_image image = {.bitpix = c->bitpix,
                                     .axes = {NX, NY},
                                     .compression = c->compression,
                                     .lossy = c->lossy,
                                     .tile = {packed ? NX : 0, packed ? NY : 0, packed ? 1 : 0}};
        fixture_write_like(file(), &image, N);
        same_pixels(c->key, "as written");
        fixture_patch(file(), "GALAXY", c->key, c->value);
        same_pixels(c->key, c->value);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(keywords_that_decide)};
    return cmocka_run_group_tests(tests, fixture_setup, fixture_teardown);
}
