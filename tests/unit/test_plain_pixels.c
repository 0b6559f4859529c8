/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Plain images: the values of CFITSIO to the last bit, for all types, scales and BLANKs, and any
 * bytes. */
#include "fits/tiles/image.h"
#include "fits_fixture.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { NX = 23, NY = 311, NZ = 5, PIXELS = NX * NY * NZ }; /* 64-bit pixels: four reads */

static const char *path(void) {
    return fixture_path("plain.fits");
}

/* Write the image, and any bytes into its pixels: numbers of all sizes, NaN and infinities. Every
 * ninth pixel is the one before, so that some are BLANK. */
static void write_any(const fixture_image *image) {
    double *zeros = calloc(PIXELS, sizeof *zeros); /* as stored */
    for (size_t i = 0; i < PIXELS; i++)
        zeros[i] = image->bzero;
    fitsfile *f = fixture_create(path());
    fixture_append(f, image, zeros);
    fixture_close(f);
    free(zeros);
    size_t size = 0;
    unsigned char *bytes = fixture_load(path(), &size);
    const size_t width = (size_t)abs(image->bitpix) / 8;
    unsigned char *data = bytes + size - (PIXELS * width + 2879) / 2880 * 2880;
    uint64_t state = 88172645463325252U;
    for (size_t i = 0; i < PIXELS * width; i++) {
        state = state * 6364136223846793005U + 1442695040888963407U;
        data[i] = (unsigned char)(state >> 56);
    }
    for (size_t i = 9; i < PIXELS && image->has_blank; i += 9) {
        for (size_t k = 0; k < width; k++)
            data[i * width + k] = (unsigned char)((uint64_t)image->blank >> 8 * (width - 1 - k));
    }
    fixture_save(path(), bytes, size);
    free(bytes);
}

static void read_by_cfitsio(const int64_t first[3], const int64_t size[3], int bitpix,
                            double *out) {
    fitsfile *f = NULL;
    int status = 0;
    int any = 0;
    long low[3];
    long high[3];
    long step[3] = {1, 1, 1};
    double null = bitpix < 0 ? 0.0 : NAN;
    for (int k = 0; k < 3; k++) {
        low[k] = (long)first[k] + 1;
        high[k] = (long)(first[k] + size[k]);
    }
    fits_open_diskfile(&f, path(), READONLY, &status);
    fits_movabs_hdu(f, 2, NULL, &status);
    fits_read_subset(f, TDOUBLE, low, high, step, &null, out, &any, &status);
    fits_close_file(f, &status);
    assert_int_equal(status, 0);
}

/* Return whether floats are said to have all values. */
static bool read_here(const int64_t first[3], const int64_t size[3], double *out) {
    shear_error err = {0};
    sf_file file;
    sf_image image;
    assert_int_equal(sf_file_open(&file, path(), -1, &err), SHEAR_OK);
    assert_int_equal(sf_image_init(&image, &file, &file.hdus[1], "ANY", &err), SHEAR_OK);
    assert_int_equal(sf_image_read(&image, first, size, out, &err), SHEAR_OK);
    const bool fits_float = sf_plain_fits_float(&image.plain);
    sf_image_deinit(&image);
    sf_file_close(&file);
    return fits_float;
}

static bool all_floats(const double *v, int64_t n) {
    bool all = true;
    for (int64_t i = 0; i < n; i++)
        all = all && (!isfinite(v[i]) || (fabs(v[i]) <= FLT_MAX && (double)(float)v[i] == v[i]));
    return all;
}

/* The whole image, whole rows, and a box within rows. */
static void check(const fixture_image *image) {
    static const int64_t boxes[][2][3] = {
        {{0, 0, 0}, {NX, NY, NZ}}, {{0, 7, 1}, {NX, 40, 3}}, {{3, 5, 2}, {17, 100, 3}}};
    double *expected = calloc(PIXELS, sizeof *expected);
    double *found = calloc(PIXELS, sizeof *found);
    write_any(image);
    for (size_t b = 0; b < sizeof boxes / sizeof boxes[0]; b++) {
        const int64_t *size = boxes[b][1];
        int blanks = 0;
        read_by_cfitsio(boxes[b][0], size, image->bitpix, expected);
        const bool fits_float = read_here(boxes[b][0], size, found);
        assert_int_equal(fits_float, all_floats(found, size[0] * size[1] * size[2]));
        for (int64_t i = 0; i < size[0] * size[1] * size[2]; i++) {
            if (!(isnan(found[i]) && isnan(expected[i])))
                assert_memory_equal(&found[i], &expected[i], sizeof found[i]);
            blanks += isnan(found[i]);
        }
        if (image->has_blank)
            assert_true(blanks > 0);
    }
    free(expected);
    free(found);
}

static fixture_image image_of(int bitpix) {
    return (fixture_image){.name = "ANY", .bitpix = bitpix, .naxis = 3, .axes = {NX, NY, NZ}};
}

static void types_and_scales(void **state) {
    (void)state;
    static const int types[] = {8, 16, 32, 64, -32, -64};
    static const double scales[][2] = {{0.0, 0.0}, {0.1, 0.0}, {1.0, 32768.0}, {-3.7e-5, 12.3}};
    for (size_t t = 0; t < sizeof types / sizeof types[0]; t++) {
        for (size_t s = 0; s < sizeof scales / sizeof scales[0]; s++) {
            fixture_image image = image_of(types[t]);
            image.bscale = scales[s][0];
            image.bzero = scales[s][1];
            check(&image);
        }
    }
}

static void blanks(void **state) {
    (void)state;
    static const struct {
        int bitpix;
        long blank;
    } cases[] = {{8, 255}, {16, -32768}, {16, 77}, {32, INT32_MIN}, {64, INT64_MIN}, {64, 12}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        for (int scaled = 0; scaled < 2; scaled++) {
            fixture_image image = image_of(cases[i].bitpix);
            image.has_blank = true;
            image.blank = cases[i].blank;
            image.bscale = scaled != 0 ? 0.3 : 0.0;
            check(&image);
        }
    }
}

/* The usual BZERO of unsigned integers; that of 64 bits is no number that is simply added. */
static void unsigned_integers(void **state) {
    (void)state;
    static const struct {
        int bitpix;
        double zero;
    } cases[] = {{8, -128.0}, {16, 0x1p15}, {32, 0x1p31}, {64, 0x1p63}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        fixture_image image = image_of(cases[i].bitpix);
        image.bscale = 1.0;
        image.bzero = cases[i].zero;
        check(&image);
    }
}

/* A file that was cut while it is open. */
static void cut_off(void **state) {
    (void)state;
    static const int64_t first[3] = {0};
    static const int64_t size[3] = {NX, NY, NZ};
    double *out = calloc(PIXELS, sizeof *out);
    const fixture_image any = image_of(16);
    shear_error err = {0};
    sf_file file;
    sf_image image;
    write_any(&any);
    assert_int_equal(sf_file_open(&file, path(), -1, &err), SHEAR_OK);
    assert_int_equal(sf_image_init(&image, &file, &file.hdus[1], "ANY", &err), SHEAR_OK);
    fixture_save(path(), "", 0);
    assert_int_equal(sf_image_read(&image, first, size, out, &err), SHEAR_E_FORMAT);
    assert_non_null(strstr(err.message, "plain.fits', HDU ANY: its pixels cannot be read"));
    sf_image_deinit(&image);
    sf_file_close(&file);
    free(out);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(types_and_scales),
        cmocka_unit_test(blanks),
        cmocka_unit_test(unsigned_integers),
        cmocka_unit_test(cut_off),
    };
    return cmocka_run_group_tests(tests, fixture_setup, fixture_teardown);
}
