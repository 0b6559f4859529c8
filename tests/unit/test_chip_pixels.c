/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The pixels of a chip: values, standard deviations, defects and owners, against plain formulas. */
#include "exposure_fixture.h"
#include "scarce.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NX = 40, NY = 30, N = NX * NY };

static const char *image(void) {
    return fixture_path("image.fits");
}

static const char *other(void) {
    return fixture_path("other.fits");
}

/* An image of whole numbers from 1 on. */
static void write_ramp(void) {
    double pixels[N];
    for (int i = 0; i < N; i++)
        pixels[i] = i + 1.0;
    exposure_write(image(), NULL, -32, NX, NY, pixels);
}

/* ---- values ---- */

static void values_of_all_types(void **state) {
    (void)state;
    static const int bitpix[] = {8, 16, 32, -32, -64};
    static const int packing[] = {0, RICE_1, GZIP_1, GZIP_2};
    for (int t = 0; t < 5; t++) {
        for (int p = 0; p < 4; p++) {
            double pixels[N];
            for (int i = 0; i < N; i++)
                pixels[i] = (i * 7 % 251) + (bitpix[t] < 0 ? 0.25 : 0.0);
            const bool rice = packing[p] == RICE_1;
            if (rice && bitpix[t] < 0)
                continue; /* not exact */
            const fixture_image one = {.name = "CHIP",
                                       .bitpix = bitpix[t],
                                       .naxis = 2,
                                       .axes = {NX, NY, 1},
                                       .compression = packing[p]};
            fitsfile *f = fixture_create(image());
            fixture_append(f, &one, pixels);
            fixture_close(f);
            const shear_input input = exposure_input(image(), NULL, NULL, NULL);
            chip_arrays a = exposure_read_all(&input);
            for (int i = 0; i < N; i++) {
                assert_true(a.value[i] == pixels[i]);
                assert_true(isnan(a.sigma[i]));
                assert_int_equal(a.defect[i], 0);
                assert_int_equal(a.owner[i], 0);
            }
            chip_arrays_free(&a);
        }
    }
}

static void bad_values(void **state) {
    (void)state;
    double pixels[N] = {1.0, NAN, INFINITY, -INFINITY, 99.0, 100.0, 101.0, -5.0, 1e300};
    exposure_write(image(), "CHIP", -64, NX, NY, pixels);
    const shear_input input = exposure_input(image(), NULL, NULL, NULL);
    static const struct {
        const char *saturate; /* keyword; NULL: none */
        bool used;
    } cases[] = {{NULL, false},    {"100.0", true}, {"0", false}, {"-1.", false},
                 {"1E300", false}, {"'?'", false},  {"100", true}};
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        if (cases[k].saturate != NULL)
            fixture_patch(image(), "CHIP", "SATURATE", cases[k].saturate);
        chip_arrays a = exposure_read_all(&input);
        for (int i = 0; i < N; i++) {
            int expected = isfinite(pixels[i]) ? 0 : PIXEL_BAD;
            expected |= cases[k].used && pixels[i] >= 100.0 ? PIXEL_SATURATED : 0;
            assert_int_equal(a.defect[i], expected);
        }
        chip_arrays_free(&a);
    }
}

static void blank_values(void **state) {
    (void)state;
    double pixels[N] = {5.0, NAN, 7.0};
    const fixture_image one = {.name = "CHIP",
                               .bitpix = 16,
                               .naxis = 2,
                               .axes = {NX, NY, 1},
                               .bscale = 0.5,
                               .bzero = 3.0,
                               .has_blank = true,
                               .blank = -32768};
    fitsfile *f = fixture_create(image());
    fixture_append(f, &one, pixels);
    fixture_close(f);
    const shear_input input = exposure_input(image(), NULL, NULL, NULL);
    chip_arrays a = exposure_read_all(&input);
    assert_true(a.value[0] == 5.0 && isnan(a.value[1]) && a.value[2] == 7.0);
    assert_int_equal(a.defect[0], 0);
    assert_int_equal(a.defect[1], PIXEL_BAD);
    assert_int_equal(a.defect[2], 0);
    chip_arrays_free(&a);
}

/* ---- weights ---- */

static void weights(void **state) {
    (void)state;
    static const double w[] = {4.0,    0.0,    -1.0, NAN,  INFINITY, -INFINITY, 1e-300,       1e30,
                               0.0625, 1e-290, 1e29, 3e30, 1e300,    -0.0,      (double)1e15F};
    enum { CASES = sizeof w / sizeof w[0] };
    double pixels[N];
    for (int i = 0; i < N; i++)
        pixels[i] = w[i % CASES];
    write_ramp();
    exposure_write(other(), "W", -64, NX, NY, pixels);
    shear_input input = exposure_input(image(), other(), NULL, NULL);
    for (int kind = SHEAR_WEIGHT_IS_WEIGHT; kind <= SHEAR_WEIGHT_IS_RMS; kind++) {
        input.exposure.weight_kind = (enum shear_weight_kind)kind;
        chip_arrays a = exposure_read_all(&input);
        for (int i = 0; i < N; i++) {
            const double v = pixels[i];
            double sigma = kind == SHEAR_WEIGHT_IS_RMS        ? v
                           : kind == SHEAR_WEIGHT_IS_VARIANCE ? sqrt(v)
                                                              : 1.0 / sqrt(v);
            const bool good = v > 0.0 && isfinite(v) && sigma < (double)1e15F && sigma > FLT_MIN;
            assert_int_equal(a.defect[i], good ? 0 : PIXEL_BAD);
            assert_true(good ? a.sigma[i] == (float)sigma : isnan(a.sigma[i]));
        }
        chip_arrays_free(&a);
    }
}

/* ---- masks ---- */

/* Write a mask of integers; bzero as CFITSIO writes unsigned ones. */
static void write_mask(int bitpix, double bzero, int compression, const double *pixels) {
    const fixture_image one = {.name = "MASK",
                               .bitpix = bitpix,
                               .naxis = 2,
                               .axes = {NX, NY, 1},
                               .bscale = bzero != 0.0 ? 1.0 : 0.0,
                               .bzero = bzero,
                               .compression = compression};
    fitsfile *f = fixture_create(other());
    fixture_append(f, &one, pixels);
    fixture_close(f);
}

/* Read with the rule, and compare each defect with that of the mask's bits. */
static void check_mask(const char *rule, const double *pixels, uint64_t bad, uint64_t saturated) {
    shear_input input = exposure_input(image(), NULL, other(), NULL);
    input.exposure.mask_bad = rule;
    chip_arrays a = exposure_read_all(&input);
    for (int i = 0; i < N; i++) {
        const uint64_t bits = (uint64_t)(int64_t)pixels[i];
        const int expected =
            ((bits & bad) != 0 ? PIXEL_BAD : 0) | ((bits & saturated) != 0 ? PIXEL_SATURATED : 0);
        assert_int_equal(a.defect[i], expected);
    }
    chip_arrays_free(&a);
}

static void mask_bits(void **state) {
    (void)state;
    static const struct {
        int bitpix, compression;
        double bzero, first, step;
    } cases[] = {{8, 0, 0.0, 0.0, 1.0},
                 {16, 0, 0.0, -32768.0, 53.0},
                 {16, 0, 32768.0, 0.0, 54.0},
                 {32, 0, 0.0, -2147483648.0, 3579139.0},
                 {32, 0, 2147483648.0, 0.0, 3579139.0},
                 {32, RICE_1, 0.0, -2147483648.0, 3579139.0},
                 {-32, 0, 0.0, 0.0, 1.0},
                 {-64, 0, 0.0, 0.0, 1e9}};
    write_ramp();
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        double pixels[N];
        for (int i = 0; i < N; i++) {
            pixels[i] = cases[k].first + cases[k].step * i;
            pixels[i] = cases[k].bitpix == 8 ? fmod(pixels[i], 256.0) : pixels[i];
        }
        write_mask(cases[k].bitpix, cases[k].bzero, cases[k].compression, pixels);
        check_mask("any", pixels, UINT64_MAX, 0);
        check_mask("bits=5", pixels, 5, 0);
        check_mask("bits=0x80000000", pixels, 0x80000000U, 0);
        check_mask("bits=32770", pixels, 32770, 0);
        check_mask(NULL, pixels, UINT64_MAX, 0);
    }
}

static void mask_zero(void **state) {
    (void)state;
    double pixels[N] = {0.0, 1.0, -0.0, NAN, 0.5, -1.0};
    write_ramp();
    write_mask(-32, 0.0, 0, pixels);
    shear_input input = exposure_input(image(), NULL, other(), NULL);
    input.exposure.mask_bad = "zero";
    chip_arrays a = exposure_read_all(&input);
    static const int expected[] = {PIXEL_BAD, 0, PIXEL_BAD, PIXEL_BAD, 0, 0, PIXEL_BAD};
    for (int i = 0; i < 7; i++)
        assert_int_equal(a.defect[i], expected[i]);
    chip_arrays_free(&a);
    input.exposure.mask_bad = "bits=1";
    a = exposure_read_all(&input);
    static const int of_bits[] = {0, PIXEL_BAD, 0, PIXEL_BAD, PIXEL_BAD, PIXEL_BAD, 0};
    for (int i = 0; i < 7; i++)
        assert_int_equal(a.defect[i], of_bits[i]);
    chip_arrays_free(&a);
}

/* Put LSST's planes into the mask's header, in the order of an HSC file. */
static void write_planes(const char *path, const char *const *names) {
    fitsfile *f = NULL;
    int status = 0;
    fits_open_diskfile(&f, path, READWRITE, &status);
    fits_movabs_hdu(f, 2, NULL, &status);
    for (int i = 0; names[i] != NULL; i++) {
        char key[80];
        snprintf(key, sizeof key, "%sMP_%s", strlen(names[i]) > 5 ? "HIERARCH " : "", names[i]);
        fits_write_key_lng(f, key, i, NULL, &status);
    }
    fits_close_file(f, &status);
    assert_int_equal(status, 0);
}

static void mask_planes(void **state) {
    (void)state;
    static const char *const names[] = {
        "DETECTED", "BAD", "SAT", "INTRP", "CR", "NO_DATA", "DETECTED_NEGATIVE", "EDGE", NULL};
    double pixels[N];
    for (int i = 0; i < N; i++)
        pixels[i] = i % 256;
    write_ramp();
    write_mask(16, 32768.0, 0, pixels);
    write_planes(other(), names);
    check_mask(NULL, pixels, 1 << 1 | 1 << 4 | 1 << 5 | 1 << 7, 1 << 2);
    check_mask("any", pixels, 255, 0);
    check_mask("planes=CR", pixels, 1 << 4, 0);
    check_mask("planes=sat,detected_negative", pixels, 1 << 6, 1 << 2);
    shear_input input = exposure_input(image(), NULL, other(), NULL);
    input.exposure.mask_bad = "planes=BAD,EGDE";
    exposure_expect(&input, SHEAR_E_FORMAT, "other.fits", "MASK", "'EGDE'", "NO_DATA",
                    "DETECTED_NEGATIVE", "did you mean EDGE?", NULL);
    static const char *const strange[] = {"DETECTED", "OWN", NULL};
    write_mask(16, 32768.0, 0, pixels);
    input.exposure.mask_bad = "planes=BAD";
    exposure_expect(&input, SHEAR_E_FORMAT, "MP_BAD", "planes: none", "bits=N", NULL);
    write_planes(other(), strange);
    input.exposure.mask_bad = NULL;
    exposure_expect(&input, SHEAR_E_FORMAT, "none of BAD, SAT", "planes=NAME", NULL);
}

static void wrong_rules(void **state) {
    (void)state;
    static const char *const wrong[] = {"",
                                        "all",
                                        "bits=",
                                        "bits=0",
                                        "bits=-1",
                                        "bits=x",
                                        "bits=5x",
                                        "bits=0x",
                                        "planes=",
                                        "planes=,",
                                        "bits= 5",
                                        "any ",
                                        "bits=2251799813685248"};
    const double pixels[N] = {0.0};
    write_ramp();
    write_mask(16, 0.0, 0, pixels);
    shear_input input = exposure_input(image(), NULL, other(), NULL);
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        input.exposure.mask_bad = wrong[i];
        exposure_expect(&input, SHEAR_E_SETTING, "bad mask values", NULL);
    }
    input.parts[SHEAR_PART_MASK].path = NULL;
    input.exposure.mask_bad = "any";
    exposure_expect(&input, SHEAR_E_SETTING, "no mask", NULL);
}

/* ---- owners ---- */

static void segmentation(void **state) {
    (void)state;
    double pixels[N] = {0.0, 1.0, 2147483647.0, 2147483648.0, -1.0, NAN, 0.5, 1e300};
    static const int32_t expected[] = {0, 1, 2147483647, -1, -1, -1, -1, -1, 0};
    write_ramp();
    exposure_write(other(), "S", -64, NX, NY, pixels);
    const shear_input input = exposure_input(image(), NULL, NULL, other());
    chip_arrays a = exposure_read_all(&input);
    for (int i = 0; i < 9; i++)
        assert_int_equal(a.owner[i], expected[i]);
    chip_arrays_free(&a);
}

/* Return who owns a pixel: the shape that is nearest in units of its own radius. */
static int32_t owner_of(int x, int y, const object_shape *s, int n) {
    double best = 1.0;
    int32_t owner = 0;
    for (int i = 0; i < n; i++) {
        const double dx = x - s[i].x;
        const double dy = y - s[i].y;
        const double along = (dx * cos(s[i].theta) + dy * sin(s[i].theta)) / s[i].a;
        const double across = (dy * cos(s[i].theta) - dx * sin(s[i].theta)) / s[i].b;
        const double r2 = along * along + across * across;
        if (r2 < best) {
            best = r2;
            owner = s[i].owner;
        }
    }
    return owner;
}

static double uniform(unsigned *seed, double low, double high) {
    *seed = *seed * 1664525U + 1013904223U;
    return low + (high - low) * (*seed >> 8) / 16777216.0;
}

static void ellipses(void **state) {
    (void)state;
    enum { SIDE = 700, SHAPES = 60 }; /* two bands */
    object_shape shapes[SHAPES];
    unsigned seed = 1;
    for (int i = 0; i < SHAPES; i++) {
        const double a = uniform(&seed, 1.0, 60.0);
        shapes[i] = (object_shape){.x = uniform(&seed, -30.0, SIDE + 30.0),
                                   .y = uniform(&seed, -30.0, SIDE + 30.0),
                                   .a = a,
                                   .b = a * uniform(&seed, 0.1, 1.0) + 0.75,
                                   .theta = uniform(&seed, -4.0, 4.0),
                                   .owner = i + 7};
    }
    double *pixels = calloc((size_t)SIDE * SIDE, sizeof *pixels);
    exposure_write(image(), NULL, 16, SIDE, SIDE, pixels);
    free(pixels);
    const shear_input input = exposure_input(image(), NULL, NULL, NULL);
    exposure_images *e = exposure_open(&input);
    chip_arrays a = exposure_read(e, 0, shapes, SHAPES);
    int owned = 0;
    for (int y = 0; y < SIDE; y++) {
        for (int x = 0; x < SIDE; x++) {
            assert_int_equal(a.owner[y * SIDE + x], owner_of(x, y, shapes, SHAPES));
            owned += a.owner[y * SIDE + x] != 0 ? 1 : 0;
        }
    }
    assert_in_range(owned, SIDE * SIDE / 20, SIDE * SIDE);
    chip_arrays_free(&a);
    exposure_images_close(e);
}

/* Shapes that are none own nothing; tiny ones own a pixel; absurdly many large ones are refused. */
static void strange_ellipses(void **state) {
    (void)state;
    const double huge = 1e300;
    object_shape shapes[400] = {
        {5.1, 6.2, 1e-300, 1e-300, 0.0, 1}, {10.0, 10.0, NAN, 1.0, 0.0, 2},
        {10.0, 10.0, 1.0, NAN, 0.0, 3},     {NAN, 10.0, 1.0, 1.0, 0.0, 4},
        {10.0, INFINITY, 1.0, 1.0, 0.0, 5}, {10.0, 10.0, 1.0, 1.0, NAN, 6},
        {10.0, 10.0, -1.0, 1.0, 0.0, 7},    {10.0, 10.0, 1.0, 0.0, 0.0, 8},
        {10.0, 10.0, 1.0, 1.0, 0.0, 0},     {huge, -huge, huge, 1.0, huge, 9},
        {-huge, 10.0, 2.0, 1.0, huge, 10}};
    write_ramp();
    const shear_input input = exposure_input(image(), NULL, NULL, NULL);
    exposure_images *e = exposure_open(&input);
    chip_arrays a = exposure_read(e, 0, shapes, 11);
    for (int i = 0; i < N; i++)
        assert_int_equal(a.owner[i], i == 6 * NX + 5 ? 1 : 0);
    chip_arrays_free(&a);
    for (int i = 0; i < 400; i++)
        shapes[i] = (object_shape){10.0, 10.0, huge, huge, huge, 1 + i};
    a = exposure_read(e, 0, shapes, 1);
    for (int i = 0; i < N; i++)
        assert_int_equal(a.owner[i], 1);
    chip_arrays_free(&a);
    chip_pixels *c = NULL;
    shear_error err = {0};
    assert_int_equal(chip_pixels_open(&c, e, 0, shapes, 400, &err), SHEAR_E_FORMAT);
    assert_null(c);
    assert_non_null(strstr(err.message, "400 times"));
    exposure_images_close(e);
}

/* ---- boxes ---- */

/* Compare a box with the same pixels of the whole chip. */
static void check_box(const pixel_box *box, const chip_arrays *a) {
    for (int row = 0; row < box->ny; row++) {
        for (int k = 0; k < box->nx; k++) {
            const int x = box->x + k;
            const int y = box->y + row;
            const int at = row * box->nx + k;
            if (x < 0 || y < 0 || x >= a->nx || y >= a->ny) {
                assert_true(isnan(box->value[at]) && isnan(box->sigma[at]));
                assert_int_equal(box->defect[at], PIXEL_OUTSIDE);
                assert_int_equal(box->owner[at], 0);
                continue;
            }
            const size_t from = (size_t)y * (size_t)a->nx + (size_t)x;
            assert_memory_equal(&box->value[at], &a->value[from], sizeof(double));
            assert_memory_equal(&box->sigma[at], &a->sigma[from], sizeof(float));
            assert_int_equal(box->defect[at], a->defect[from]);
            assert_int_equal(box->owner[at], a->owner[from]);
        }
    }
}

/* Boxes anywhere, in any order, equal the whole, also where the cache cannot hold it. */
static void check_boxes(const exposure_images *e, const chip_arrays *a, int boxes) {
    enum { SIDE = 50 };
    static double value[SIDE * SIDE];
    static float sigma[SIDE * SIDE];
    static uint8_t defect[SIDE * SIDE];
    static int32_t owner[SIDE * SIDE];
    chip_pixels *c = NULL;
    shear_error err = {0};
    unsigned seed = 5;
    assert_int_equal(chip_pixels_open(&c, e, 0, NULL, 0, &err), SHEAR_OK);
    for (int i = 0; i < boxes; i++) {
        pixel_box box = {(int)uniform(&seed, -60.0, a->nx + 10.0),
                         (int)uniform(&seed, -60.0, a->ny + 10.0),
                         (int)uniform(&seed, 0.0, SIDE),
                         (int)uniform(&seed, 0.0, SIDE),
                         value,
                         sigma,
                         defect,
                         owner};
        assert_int_equal(chip_pixels_read(c, &box, &err), SHEAR_OK);
        check_box(&box, a);
    }
    const pixel_box none = {-2147483647, 2147483647, 1, 1, value, NULL, NULL, NULL};
    const pixel_box far = {2147483647, -2147483647, 1, 1, NULL, NULL, defect, NULL};
    assert_int_equal(chip_pixels_read(c, &none, &err), SHEAR_OK);
    assert_int_equal(chip_pixels_read(c, &far, &err), SHEAR_OK);
    assert_true(isnan(value[0]) && defect[0] == PIXEL_OUTSIDE);
    chip_pixels_close(c);
}

static void random_boxes(void **state) {
    (void)state;
    enum { WIDE = 900, HIGH = 700 };
    double *pixels = malloc(sizeof *pixels * WIDE * HIGH);
    for (int i = 0; i < WIDE * HIGH; i++)
        pixels[i] = i % 1013;
    exposure_write(image(), "A", -32, WIDE, HIGH, pixels);
    exposure_write(other(), "A", 16, WIDE, HIGH, pixels);
    shear_input input = exposure_input(image(), other(), other(), other());
    input.exposure.mask_bad = "bits=18";
    exposure_images *e = exposure_open(&input);
    chip_arrays a = exposure_read(e, 0, NULL, 0);
    check_boxes(e, &a, 1000);
    chip_arrays_free(&a);
    exposure_images_close(e);
    free(pixels);
}

static void cache_smaller_than_chip(void **state) {
    (void)state;
    enum { WIDE = 1900000, HIGH = 9, SIDE = 3 }; /* a band is a row, and the cache holds six */
    double *pixels = malloc(sizeof *pixels * WIDE * HIGH);
    for (int i = 0; i < WIDE * HIGH; i++)
        pixels[i] = i % 251;
    exposure_write(image(), "A", 8, WIDE, HIGH, pixels);
    exposure_write(other(), "A", 8, WIDE, HIGH, pixels);
    free(pixels);
    const shear_input input = exposure_input(image(), other(), NULL, other());
    exposure_images *e = exposure_open(&input);
    chip_pixels *c = NULL;
    shear_error err = {0};
    unsigned seed = 3;
    assert_int_equal(chip_pixels_open(&c, e, 0, NULL, 0, &err), SHEAR_OK);
    for (int k = 0; k < 60; k++) {
        double value[SIDE * SIDE];
        uint8_t defect[SIDE * SIDE];
        int32_t owner[SIDE * SIDE];
        const int x = (int)uniform(&seed, 0.0, WIDE - SIDE + 0.5);
        const int y = (int)uniform(&seed, 0.0, HIGH - SIDE + 0.5);
        const pixel_box box = {x, y, SIDE, SIDE, value, NULL, defect, owner};
        assert_int_equal(chip_pixels_read(c, &box, &err), SHEAR_OK);
        for (int i = 0; i < SIDE * SIDE; i++) {
            const int expected = ((y + i / SIDE) * WIDE + x + i % SIDE) % 251;
            assert_true(value[i] == expected && owner[i] == expected);
            assert_int_equal(defect[i], expected == 0 ? PIXEL_BAD : 0);
        }
    }
    chip_pixels_close(c);
    exposure_images_close(e);
}

/* ---- failures ---- */

/* Open an exposure and its chip, and read a pixel. */
static int open_and_read(const shear_input *input, shear_error *err) {
    const object_shape shape = {5.0, 5.0, 3.0, 2.0, 0.0, 1};
    double value = NAN;
    const pixel_box box = {3, 4, 1, 1, &value, NULL, NULL, NULL};
    exposure_images *e = NULL;
    chip_pixels *c = NULL;
    int code = exposure_images_open(&e, input, NULL, err);
    if (code == SHEAR_OK)
        code = chip_pixels_open(&c, e, 0, &shape, 1, err);
    if (code == SHEAR_OK)
        code = chip_pixels_read(c, &box, err);
    assert_true(code != SHEAR_OK || value == 4 * NX + 3 + 1.0);
    chip_pixels_close(c);
    exposure_images_close(e);
    return code;
}

static void memory_runs_out(void **state) {
    (void)state;
    const double pixels[N] = {0.0};
    write_ramp();
    write_mask(16, 0.0, RICE_1, pixels);
    shear_input input = exposure_input(image(), NULL, other(), NULL);
    input.exposure.mask_bad = "bits=1";
    bool refused = true;
    for (long n = 1; refused; n++) {
        shear_error err = {0};
        scarce_after(n, false);
        const int code = open_and_read(&input, &err);
        refused = scarce_end();
        assert_int_equal(code, refused ? SHEAR_E_NOMEM : SHEAR_OK);
        assert_true(n < 1000);
    }
}

/* Nothing of a damaged tile is taken for pixels; what could be read before can be read still. */
static void damaged_band(void **state) {
    (void)state;
    enum { SIDE = 700 };
    double *pixels = malloc(sizeof *pixels * SIDE * SIDE);
    for (int i = 0; i < SIDE * SIDE; i++)
        pixels[i] = (i % 1009) * 7919 % 10007;
    const fixture_image one = {
        .name = "A", .bitpix = 16, .naxis = 2, .axes = {SIDE, SIDE, 1}, .compression = GZIP_1};
    fitsfile *f = fixture_create(image());
    fixture_append(f, &one, pixels);
    fixture_close(f);
    free(pixels);
    size_t size = 0;
    unsigned char *bytes = fixture_load(image(), &size);
    for (size_t i = size - 40000; i < size - 3000; i++)
        bytes[i] = 0xff;
    fixture_save(image(), bytes, size);
    free(bytes);
    const shear_input input = exposure_input(image(), NULL, NULL, NULL);
    exposure_images *e = exposure_open(&input);
    chip_pixels *c = NULL;
    shear_error err = {0};
    assert_int_equal(chip_pixels_open(&c, e, 0, NULL, 0, &err), SHEAR_OK);
    for (int i = 0; i < 6; i++) {
        double value = NAN;
        const pixel_box box = {1, i % 2 == 0 ? 0 : SIDE - 1, 1, 1, &value, NULL, NULL, NULL};
        assert_int_equal(chip_pixels_read(c, &box, &err), i % 2 == 0 ? SHEAR_OK : SHEAR_E_FORMAT);
        assert_true(i % 2 == 0 ? value == 7919.0 : isnan(value));
        assert_true(i % 2 == 0 || strstr(err.message, "compressed tile") != NULL);
    }
    chip_pixels_close(c);
    exposure_images_close(e);
}

/* ---- real files ---- */

static void shared_hsc(void **state) {
    (void)state;
    const char *path = exposure_shared("exposures/HSC-0908120-056-small.fits");
    if (path == NULL)
        skip();
    shear_input input = exposure_input(path, NULL, path, NULL);
    int64_t counts[2] = {0, 0};
    const char *const rules[] = {NULL, "any"};
    for (int k = 0; k < 2; k++) {
        input.exposure.mask_bad = rules[k];
        chip_arrays a = exposure_read_all(&input);
        for (int i = 0; i < a.nx * a.ny; i++)
            counts[k] += a.defect[i] != 0 ? 1 : 0;
        chip_arrays_free(&a);
    }
    assert_int_equal(counts[0], 14);
    assert_int_equal(counts[1] - counts[0], 5390); /* pixels with DETECTED alone are good */
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(values_of_all_types),
        cmocka_unit_test(bad_values),
        cmocka_unit_test(blank_values),
        cmocka_unit_test(weights),
        cmocka_unit_test(mask_bits),
        cmocka_unit_test(mask_zero),
        cmocka_unit_test(mask_planes),
        cmocka_unit_test(wrong_rules),
        cmocka_unit_test(segmentation),
        cmocka_unit_test(ellipses),
        cmocka_unit_test(strange_ellipses),
        cmocka_unit_test(random_boxes),
        cmocka_unit_test(cache_smaller_than_chip),
        cmocka_unit_test(memory_runs_out),
        cmocka_unit_test(damaged_band),
        cmocka_unit_test(shared_hsc),
    };
    return cmocka_run_group_tests(tests, fixture_setup, fixture_teardown);
}
