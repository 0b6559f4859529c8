/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cubes of PSF images: the nearest of a few, the power spectrum of many, and what is no PSF. */
#include "psf_fixture.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { N = 24, PLANE = N * N, MANY = 80, STAMP = 32 };

#define END ((const char *)NULL)

static double images[MANY * PLANE];
static double places[2][MANY];

static uint64_t seed = 5;
static double uniform(void) {
    seed = seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (double)(seed >> 11) * 0x1p-53;
}

/* Variances of the Gaussian at a place, samples. */
static void shape_at(double x, double y, double *xx, double *yy) {
    *xx = 5.0 + x / 2000.0;
    *yy = 4.5 - y / 4000.0;
}

static void draw(double *out, double xx, double yy, double x0, double y0, double flux) {
    for (int y = 0; y < N; y++) {
        for (int x = 0; x < N; x++) {
            const double dx = x - x0;
            const double dy = y - y0;
            out[y * N + x] = flux * exp(-0.5 * (dx * dx / xx + dy * dy / yy));
        }
    }
}

/* Images of any flux, centred anywhere within a sample of the middle. */
static void fill_images(int n) {
    for (int i = 0; i < n; i++) {
        double xx = 0.0;
        double yy = 0.0;
        places[0][i] = 2000.0 * uniform();
        places[1][i] = 2000.0 * uniform();
        shape_at(places[0][i], places[1][i], &xx, &yy);
        draw(images + (ptrdiff_t)i * PLANE, xx, yy, N / 2 - 1 + 2.0 * uniform(),
             N / 2 - 1 + 2.0 * uniform(), 0.5 + uniform());
    }
}

static const char *path_of(void) {
    return fixture_path("cube.fits");
}

static const char *write_cube(int n, const char *x, const char *y, const char *oversample) {
    const fixture_image image = {
        .name = "PSF", .bitpix = DOUBLE_IMG, .naxis = n == 1 ? 2 : 3, .axes = {N, N, n}};
    const psf_fixture_column columns[] = {
        {x, "D", NULL, places[0], NULL}, {y, "D", NULL, places[1], NULL}, {0}};
    fitsfile *f = fixture_create(path_of());
    fixture_append(f, &image, images);
    if (oversample != NULL)
        psf_fixture_keys(f, (const char *const[]){oversample, NULL});
    if (x != NULL)
        psf_fixture_table(f, "", n, columns);
    fixture_close(f);
    return path_of();
}

static void test_one(void **state) {
    (void)state;
    double out[PLANE];
    fill_images(1);
    psf_models *p =
        psf_fixture_open(write_cube(1, NULL, NULL, "OVERSAMP= 2.5"), SHEAR_PSF_KIND_AUTO, STAMP);
    const shear_psf_model *m = psf_models_get(p, 0);
    assert_true(m->terms == 1 && m->nx == N && m->ny == N && m->step == 0.4 && m->lanczos == 0);
    assert_true(m->axes == SHEAR_PSF_AXES_PIXEL);
    psf_fixture_samples(p, 0, &(psf_place){NAN, NAN, NAN, NAN, NULL}, out);
    for (int i = 0; i < PLANE; i++)
        assert_true(out[i] == images[i]);
    assert_string_equal(psf_models_text(p, 0), "an image of 24 x 24 samples of 0.40 px, constant");
    psf_models_close(p);
}

/* Each place lies nearest to its own image. */
static void test_nearest(void **state) {
    (void)state;
    double out[PLANE];
    double c[64];
    fill_images(64);
    for (int sky = 0; sky < 2; sky++) {
        for (int i = 0; i < 64 && sky == 1; i++) { /* across RA = 0 */
            places[0][i] = fmod(359.9 + places[0][i] / 10000.0, 360.0);
            places[1][i] /= -10000.0;
        }
        psf_models *p = psf_fixture_open(
            write_cube(64, sky == 1 ? "ra" : "X_IMAGE", sky == 1 ? "dec" : "Y_IMAGE", NULL),
            SHEAR_PSF_KIND_CUBE, STAMP);
        assert_int_equal(psf_models_get(p, 0)->terms, 64);
        for (int i = 0; i < 64; i++) {
            const psf_place place = {sky == 1 ? NAN : places[0][i], sky == 1 ? NAN : places[1][i],
                                     sky == 0 ? NAN : places[0][i], sky == 0 ? NAN : places[1][i],
                                     NULL};
            psf_fixture_samples(p, 0, &place, out);
            for (int k = 0; k < PLANE; k++)
                assert_true(out[k] == images[i * PLANE + k]);
        }
        assert_false(psf_models_terms(p, 0, &(psf_place){NAN, NAN, NAN, NAN, NULL}, c));
        psf_models_close(p);
    }
}

/* |W|^2 of a Gaussian, wherever its images are centred. */
static void test_many(void **state) {
    (void)state;
    fill_images(MANY);
    psf_models *p =
        psf_fixture_open(write_cube(MANY, "X", "Y", "OVERSAMP= 2"), SHEAR_PSF_KIND_AUTO, STAMP);
    const shear_psf_model *m = psf_models_get(p, 0);
    double power[STAMP * STAMP];
    assert_true(m->axes == SHEAR_PSF_AXES_MODES && m->nx == STAMP && m->ny == STAMP);
    assert_int_equal(m->terms, 10);
    assert_string_equal(psf_models_text(p, 0),
                        "power of 80 images of 24 x 24 samples of 0.50 px, degree 3 in x, y");
    for (int i = 0; i < 9; i++) {
        const psf_place place = {200.0 + 800.0 * (i % 3), 200.0 + 800.0 * (double)(i / 3), NAN, NAN,
                                 NULL};
        double xx = 0.0;
        double yy = 0.0;
        shape_at(place.x, place.y, &xx, &yy);
        psf_fixture_samples(p, 0, &place, power);
        for (int j = 0; j < STAMP * STAMP; j++) {
            const double kx = 2.0 * acos(-1.0) / STAMP * (j % STAMP - STAMP / 2);
            const double ky = 2.0 * acos(-1.0) / STAMP * (j / STAMP - STAMP / 2);
            psf_fixture_near(power[j], exp(-0.25 * (kx * kx * xx + ky * ky * yy)), 3e-5);
        }
    }
    psf_models_close(p);
}

/* Places on a line determine no polynomial in y. */
static void test_line(void **state) {
    (void)state;
    fill_images(MANY);
    for (int i = 0; i < MANY; i++)
        places[1][i] = 7.0;
    psf_models *p = psf_fixture_open(write_cube(MANY, "X", "Y", NULL), SHEAR_PSF_KIND_AUTO, STAMP);
    assert_int_equal(psf_models_get(p, 0)->terms, 1);
    psf_models_close(p);
}

static void test_refused(void **state) {
    (void)state;
    fill_images(3);
    psf_fixture_refuse(write_cube(3, NULL, NULL, NULL), SHEAR_PSF_KIND_AUTO, SHEAR_E_FORMAT,
                       "cube.fits", "need their positions", "X and Y", END);
    psf_fixture_refuse(write_cube(3, "X", "OTHER", NULL), SHEAR_PSF_KIND_AUTO, SHEAR_E_FORMAT, "Y",
                       "partner", END);
    write_cube(3, "X", "Y", NULL);
    fixture_patch(path_of(), "PSF", "NAXIS3", "2");
    psf_fixture_refuse(path_of(), SHEAR_PSF_KIND_AUTO, SHEAR_E_FORMAT, END);
    static const char *const bad[] = {"OVERSAMP= 0.0", "OVERSAMP= -1", "OVERSAMP= 1E300",
                                      "OVERSAMP= 'two'"};
    for (size_t i = 0; i < 4; i++) {
        psf_fixture_refuse(write_cube(3, "X", "Y", bad[i]), SHEAR_PSF_KIND_AUTO, SHEAR_E_FORMAT,
                           "OVERSAMP", END);
    }
    places[0][1] = NAN;
    psf_fixture_refuse(write_cube(3, "X", "Y", NULL), SHEAR_PSF_KIND_AUTO, SHEAR_E_FORMAT, "X",
                       "no position", END);
    fill_images(3);
    images[PLANE + 7] = NAN;
    psf_fixture_refuse(write_cube(3, "X", "Y", NULL), SHEAR_PSF_KIND_AUTO, SHEAR_E_PSF, "image 1",
                       "cube.fits", END);
    for (int i = 0; i < PLANE; i++)
        images[2 * PLANE + i] = 0.0;
    fill_images(2);
    psf_fixture_refuse(write_cube(3, "X", "Y", NULL), SHEAR_PSF_KIND_AUTO, SHEAR_E_PSF, "image 2",
                       END);
    psf_fixture_refuse(write_cube(3, "X", "Y", NULL), SHEAR_PSF_KIND_PSFEX, SHEAR_E_PSF, "PSFEx",
                       END);
    psf_fixture_refuse(write_cube(3, "X", "Y", NULL), SHEAR_PSF_KIND_PIFF, SHEAR_E_PSF, "Piff",
                       END);
}

/* Several images, and nothing that says which of them is meant. */
static void test_which(void **state) {
    (void)state;
    const fixture_image image = {
        .name = "ONE", .bitpix = DOUBLE_IMG, .naxis = 2, .axes = {N, N, 1}};
    fill_images(1);
    fitsfile *f = fixture_create(path_of());
    fixture_append(f, &image, images);
    fixture_append(f, &image, images);
    fixture_close(f);
    psf_fixture_refuse(path_of(), SHEAR_PSF_KIND_AUTO, SHEAR_E_FORMAT, "has 2 images",
                       "choose the HDU", END);
    const shear_input_part part = {.path = path_of(), .hdu = 2};
    psf_models *p = NULL;
    assert_int_equal(psf_models_open(&p, &part, -1, SHEAR_PSF_KIND_AUTO, STAMP, NULL), SHEAR_OK);
    psf_models_close(p);
}

static void test_sky_image(void **state) {
    (void)state;
    const fixture_image image = {
        .name = "SCI", .bitpix = BYTE_IMG, .naxis = 2, .axes = {2000, 30, 1}};
    double *pixels = calloc((size_t)2000 * 30, sizeof *pixels);
    fitsfile *f = fixture_create(path_of());
    fixture_append(f, &image, pixels);
    fixture_close(f);
    free(pixels);
    psf_fixture_refuse(path_of(), SHEAR_PSF_KIND_AUTO, SHEAR_E_FORMAT, "not of the sky",
                       "2000 x 30", END);
}

static void test_robust(void **state) {
    (void)state;
    fill_images(3);
    const char *path = write_cube(3, "X", "Y", NULL);
    psf_fixture_spoil(path, 400);
    psf_fixture_starve(path);
    fill_images(MANY);
    psf_fixture_starve(write_cube(MANY, "X", "Y", NULL));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_robust),  cmocka_unit_test(test_one),
        cmocka_unit_test(test_nearest), cmocka_unit_test(test_many),
        cmocka_unit_test(test_line),    cmocka_unit_test(test_refused),
        cmocka_unit_test(test_which),   cmocka_unit_test(test_sky_image),
    };
    return cmocka_run_group_tests(tests, fixture_setup, fixture_teardown);
}
