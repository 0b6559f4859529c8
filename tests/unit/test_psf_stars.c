/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Stamps of stars: |W|^2 from noisy stars of any flux, background and sub-pixel place; outliers. */
#include "psf_fixture.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { N = 31, PLANE = N * N, STARS = 60, STAMP = 48 };

#define END ((const char *)NULL)

static double stamps[STARS * PLANE];
static double weights[STARS * PLANE];
static double places[2][STARS];
static double flags[STARS];

static uint64_t seed = 11;

/* Variances of the Gaussian at a place. */
static void shape_at(double x, double y, double *xx, double *yy) {
    *xx = 3.0 + 0.5 * x / 2000.0;
    *yy = 3.0 - 0.4 * y / 2000.0;
}

/* A star with a background of 37 and noise of standard deviation `noise`; one of `size` times the
 * variance is no star. */
static void draw(int i, double noise, double size) {
    const double flux = 1000.0 * (1.0 + psf_fixture_uniform(&seed));
    const double x0 = N / 2 - 0.5 + psf_fixture_uniform(&seed);
    const double y0 = N / 2 - 0.5 + psf_fixture_uniform(&seed);
    double xx = 0.0;
    double yy = 0.0;
    places[0][i] = 2000.0 * psf_fixture_uniform(&seed);
    places[1][i] = 2000.0 * psf_fixture_uniform(&seed);
    flags[i] = 0.0;
    shape_at(places[0][i], places[1][i], &xx, &yy);
    for (int k = 0; k < PLANE; k++) {
        const double dx = k % N - x0;
        const double dy = (double)(k / N) - y0;
        const double light = exp(-0.5 / size * (dx * dx / xx + dy * dy / yy));
        stamps[i * PLANE + k] = 37.0 + flux * light / (6.2832 * size * sqrt(xx * yy)) +
                                (noise > 0.0 ? noise * psf_fixture_normal(&seed) : 0.0);
        weights[i * PLANE + k] = 1.0;
    }
}

static void draw_all(int n, double noise) {
    for (int i = 0; i < n; i++)
        draw(i, noise, 1.0);
}

static const char *path_of(void) {
    return fixture_path("stars.fits");
}

/* A row per star. */
static const char *write_rows(int n) {
    const psf_fixture_column columns[] = {{"VIGNET", "961E", "(31,31)", stamps, NULL},
                                          {"XWIN_IMAGE", "D", NULL, places[0], NULL},
                                          {"YWIN_IMAGE", "D", NULL, places[1], NULL},
                                          {"FLAGS", "I", NULL, flags, NULL},
                                          {0}};
    fitsfile *f = fixture_create(path_of());
    psf_fixture_table(f, "LDAC_OBJECTS", n, columns);
    fixture_close(f);
    return path_of();
}

/* All stars in one row. */
static const char *write_cell(int n) {
    char form[16];
    char one[16];
    char dim[32];
    snprintf(form, sizeof form, "%dD", n * PLANE);
    snprintf(one, sizeof one, "%dD", n);
    snprintf(dim, sizeof dim, "(31,31,%d)", n);
    const psf_fixture_column columns[] = {{"IMAGE", form, dim, stamps, NULL},
                                          {"WEIGHT", form, dim, weights, NULL},
                                          {"X", one, NULL, places[0], NULL},
                                          {"Y", one, NULL, places[1], NULL},
                                          {0}};
    fitsfile *f = fixture_create(path_of());
    psf_fixture_table(f, "stars_data", 1, columns);
    fixture_close(f);
    return path_of();
}

/* Return the largest difference from |W|^2 of the Gaussian at nine places. */
static double error_of(const psf_models *p, int stamp) {
    double *power = calloc((size_t)stamp * (size_t)stamp, sizeof *power);
    double worst = 0.0;
    for (int i = 0; i < 9; i++) {
        const psf_place place = {300.0 + 700.0 * (i % 3), 300.0 + 700.0 * (double)(i / 3), NAN, NAN,
                                 NULL};
        double xx = 0.0;
        double yy = 0.0;
        shape_at(place.x, place.y, &xx, &yy);
        psf_fixture_samples(p, 0, &place, power);
        for (int j = 0; j < stamp * stamp; j++) {
            const double kx = 2.0 * acos(-1.0) / stamp * (j % stamp - stamp / 2);
            const double ky = 2.0 * acos(-1.0) / stamp * (j / stamp - stamp / 2);
            worst = fmax(worst, fabs(power[j] - exp(-kx * kx * xx - ky * ky * yy)));
        }
    }
    free(power);
    return worst;
}

static void check(const char *path, int stamp, const char *text, double tolerance) {
    psf_models *p = psf_fixture_open(path, SHEAR_PSF_KIND_AUTO, stamp);
    const shear_psf_model *m = psf_models_get(p, 0);
    assert_true(m->axes == SHEAR_PSF_AXES_MODES && m->nx == stamp && m->ny == stamp);
    if (strncmp(psf_models_text(p, 0), text, strlen(text)) != 0)
        fail_msg("\"%s\" does not begin with \"%s\"", psf_models_text(p, 0), text);
    psf_fixture_near(error_of(p, stamp), 0.0, tolerance);
    psf_models_close(p);
}

/* The stamp of the galaxies is larger or smaller than that of the stars. */
static void test_without_noise(void **state) {
    (void)state;
    draw_all(STARS, 0.0);
    check(write_rows(STARS), STAMP,
          "power of stars, 31 x 31 px, degree 2 in x, y, 60 of 60 stars (0 outliers)", 1e-4);
    check(write_cell(STARS), 24,
          "power of stars, 31 x 31 px, degree 2 in x, y, 60 of 60 stars (0 outliers)", 1e-4);
    check(write_cell(20), STAMP,
          "power of stars, 31 x 31 px, degree 1 in x, y, 20 of 20 stars (0 outliers)", 1e-2);
}

/* The noise's power is subtracted: 1 % of that of the star at k = 0. */
static void test_noise(void **state) {
    (void)state;
    draw_all(STARS, 2.0);
    check(write_cell(STARS), STAMP,
          "power of stars, 31 x 31 px, degree 2 in x, y, 60 of 60 stars (0 outliers)", 0.15);
}

static void test_outliers(void **state) {
    (void)state;
    draw_all(STARS, 0.3);
    for (int i = 0; i < 8; i++)
        draw(7 * i, 0.3, 1.6);
    flags[1] = 4.0;
    flags[2] = 2.0;
    stamps[3 * PLANE + PLANE / 2] = -1e30; /* in the middle */
    stamps[4 * PLANE + 5] = -1e30;         /* at the edge */
    check(write_rows(STARS), STAMP,
          "power of stars, 31 x 31 px, degree 2 in x, y, 50 of 60 stars (8 outliers)", 0.03);
}

/* Most are galaxies, of any size. */
static void test_catalog(void **state) {
    (void)state;
    draw_all(STARS, 0.3);
    for (int i = 0; i < 40; i++)
        draw(i, 0.3, 1.5 + 4.0 * psf_fixture_uniform(&seed));
    psf_fixture_refuse(write_rows(STARS), SHEAR_PSF_KIND_AUTO, SHEAR_E_PSF, "galaxies among them",
                       "better selected", END);
}

static void test_refused(void **state) {
    (void)state;
    draw_all(STARS, 0.0);
    for (int i = 0; i < STARS * PLANE; i++)
        stamps[i] = 37.0;
    psf_fixture_refuse(write_rows(STARS), SHEAR_PSF_KIND_AUTO, SHEAR_E_PSF, "only 0 of 60", END);
    for (int i = 0; i < STARS * PLANE; i++)
        stamps[i] = NAN;
    psf_fixture_refuse(write_cell(STARS), SHEAR_PSF_KIND_STARS, SHEAR_E_PSF, "only 0 of 60", END);
    for (int i = 0; i < STARS * PLANE; i++)
        stamps[i] = i % 2 == 0 ? 1e300 : -1e28;
    psf_fixture_refuse(write_cell(STARS), SHEAR_PSF_KIND_STARS, SHEAR_E_PSF, "only 0 of 60", END);
    draw_all(STARS, 0.0);
    write_rows(STARS);
    fixture_patch(path_of(), "LDAC_OBJECTS", "TTYPE2", "'OTHER'");
    psf_fixture_refuse(path_of(), SHEAR_PSF_KIND_AUTO, SHEAR_E_FORMAT, "XWIN_IMAGE", "partner",
                       END);
    write_rows(STARS);
    fixture_patch(path_of(), "LDAC_OBJECTS", "TDIM1", "'(961)'");
    psf_fixture_refuse(path_of(), SHEAR_PSF_KIND_AUTO, SHEAR_E_FORMAT, "VIGNET", END);
}

static void test_robust(void **state) {
    (void)state;
    draw_all(12, 1.0);
    const char *path = write_cell(12);
    psf_fixture_spoil(path, 400);
    psf_fixture_starve(path);
}

/* ---- real stars ---- */

/* Return |W|^2 of an image of 101 x 101 samples of half a pixel, at k along an axis. */
static double power_at(const double *image, double k, int axis) {
    double re = 0.0;
    double im = 0.0;
    double flux = 0.0;
    for (int i = 0; i < 101 * 101; i++) {
        const double r = 0.5 * (axis == 0 ? i % 101 : i / 101);
        re += image[i] * cos(k * r);
        im += image[i] * sin(k * r);
        flux += image[i];
    }
    return (re * re + im * im) / flux / flux;
}

/* PSFEx's model of a chip, and the power of the stars that it was made from, at two modes. The
 * ratio is free of the fluxes. */
static void test_real(void **state) {
    (void)state;
    static const char name[] =
        "ldac/DECam_00241238_01_psfcat_tb_maxmag_17.0_magcut_3.0_findstars.fits";
    double sums[2][2] = {{0.0}};
    if (psf_fixture_real(name) == NULL)
        skip();
    psf_models *p = psf_fixture_open(psf_fixture_real(name), SHEAR_PSF_KIND_AUTO, 64);
    psf_models *q = psf_fixture_open(psf_fixture_real("psfex/DECam_00241238_01_psfcat.psf"),
                                     SHEAR_PSF_KIND_AUTO, 64);
    for (int i = 0; i < 9; i++) {
        const psf_place place = {300.0 + 700.0 * (i % 3), 600.0 + 1400.0 * (double)(i / 3), NAN,
                                 NAN, NULL};
        double power[64 * 64];
        double image[101 * 101];
        psf_fixture_samples(p, 0, &place, power);
        psf_fixture_samples(q, 0, &place, image);
        for (int mode = 0; mode < 2; mode++) {
            const int j = mode == 0 ? 4 : 7;
            sums[0][mode] += power[32 * 64 + 32 + j] + power[(32 + j) * 64 + 32];
            for (int axis = 0; axis < 2; axis++)
                sums[1][mode] += power_at(image, 2.0 * acos(-1.0) / 64 * j, axis);
        }
    }
    psf_fixture_near(sums[0][1] / sums[0][0], sums[1][1] / sums[1][0], 0.01);
    psf_models_close(p);
    psf_models_close(q);
    p = psf_fixture_open(psf_fixture_real("piff/testStarsRubin.fits"), SHEAR_PSF_KIND_AUTO, 64);
    assert_string_equal(
        psf_models_text(p, 0),
        "power of stars, 25 x 25 px, degree 2 in x, y, 30 of 31 stars (0 outliers), "
        "chi2/dof 0.65");
    psf_models_close(p);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_robust),  cmocka_unit_test(test_without_noise),
        cmocka_unit_test(test_noise),   cmocka_unit_test(test_outliers),
        cmocka_unit_test(test_catalog), cmocka_unit_test(test_refused),
        cmocka_unit_test(test_real),
    };
    return cmocka_run_group_tests(tests, fixture_setup, fixture_teardown);
}
