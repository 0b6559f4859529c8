/* SPDX-License-Identifier: GPL-3.0-or-later */
/* PSFEx models: the polynomial of every kind of file, and fits that failed. */
#include "psf_fixture.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NX = 7, NY = 5, PLANE = NX * NY, TERMS = 12 };

#define END ((const char *)NULL)

static double planes[2 * TERMS * PLANE];

/* Planes of any numbers, with a peak in the middle of those that a model begins with. */
static void fill_planes(void) {
    for (int i = 0; i < 2 * TERMS * PLANE; i++)
        planes[i] = sin(1.7 * i) / (1 + i / PLANE);
    planes[PLANE / 2] = planes[TERMS / 2 * PLANE + PLANE / 2] = 30.0;
}

/* Coefficients of X (group 1, with Y, degree 2) and MAG_AUTO (group 2, degree 1). */
static const char *const three[] = {"LOADED  = 60",     "ACCEPTED= 51",
                                    "CHI2    = 1.05",   "POLNAXIS= 3",
                                    "POLGRP1 = 1",      "POLNAME1= 'X_IMAGE'",
                                    "POLZERO1= 1000.0", "POLSCAL1= 2000.0",
                                    "POLGRP2 = 1",      "POLNAME2= 'YWIN_IMAGE'",
                                    "POLZERO2= 2000.0", "POLSCAL2= 4000.0",
                                    "POLGRP3 = 2",      "POLNAME3= 'MAG_AUTO'",
                                    "POLZERO3= 19.0",   "POLSCAL3= 4.0",
                                    "POLNGRP = 2",      "POLDEG1 = 2",
                                    "POLDEG2 = 1",      "PSF_FWHM= 4.5",
                                    "PSF_SAMP= 0.597",  "PSFNAXIS= 3",
                                    "PSFAXIS1= 7",      "PSFAXIS2= 5",
                                    "PSFAXIS3= 12",     NULL};
static const char *const constant[] = {"POLNAXIS= 0", "POLNGRP = 0", "PSF_SAMP= 1.3", NULL};

static fitsfile *begin(void) {
    return fixture_create(fixture_path("model.psf"));
}

static void append(fitsfile *f, const char *form, const char *dim, const char *const *cards) {
    const psf_fixture_column columns[] = {{"PSF_MASK", form, dim, planes, NULL}, {0}};
    psf_fixture_table(f, "PSF_DATA", 1, columns);
    psf_fixture_keys(f, cards);
}

static const char *model(const char *form, const char *dim, const char *const *cards) {
    fitsfile *f = begin();
    append(f, form, dim, cards);
    fixture_close(f);
    return fixture_path("model.psf");
}

/* Check model `i` against the sum over exponents, term by term. */
static void check(const psf_models *p, int i, const double *expected, const double *u) {
    const double mag = 19.0 + 4.0 * u[2];
    const psf_place place = {1000.0 + 2000.0 * u[0], 2000.0 + 4000.0 * u[1], NAN, NAN, &mag};
    double out[PLANE];
    psf_fixture_samples(p, i, &place, out);
    for (int k = 0; k < PLANE; k++) {
        const double *c = expected + k;
        double sum = 0.0;
        for (int m = 0; m < 2; m++) {
            const double a = c[0] + u[0] * (c[PLANE] + u[0] * c[2 * PLANE]);
            const double b = c[3 * PLANE] + u[0] * c[4 * PLANE] + u[1] * c[5 * PLANE];
            sum += (m == 0 ? 1.0 : u[2]) * (a + u[1] * b);
            c += 6 * PLANE;
        }
        psf_fixture_near(out[k], sum, 1e-5);
    }
}

static void test_groups(void **state) {
    (void)state;
    const char *const *names = NULL;
    psf_models *p = psf_fixture_open(model("420E", "(7,5,12)", three), SHEAR_PSF_KIND_AUTO, 32);
    const shear_psf_model *m = psf_models_get(p, 0);
    assert_int_equal(psf_models_count(p), 1);
    assert_string_equal(psf_models_chip(p, 0), "");
    assert_string_equal(psf_models_text(p, 0),
                        "PSFEx, 7 x 5 samples of 0.60 px, degree 2 in X_IMAGE, YWIN_IMAGE and 1 in "
                        "MAG_AUTO, 51 of 60 stars, chi2/dof 1.05");
    assert_int_equal(psf_models_contexts(p, 0, &names), 1);
    assert_string_equal(names[0], "MAG_AUTO");
    assert_true(m->nx == NX && m->ny == NY && m->terms == TERMS);
    assert_true(m->axes == SHEAR_PSF_AXES_PIXEL && m->step == 0.597);
    check(p, 0, planes, (double[]){0.0, 0.0, 0.0});
    check(p, 0, planes, (double[]){0.5, -0.25, 0.125});
    check(p, 0, planes, (double[]){-0.9, 1.0, 3.0});
    psf_models_close(p);
}

static void check_kernels(const char *path, int lanczos, double smoothed_px) {
    psf_models *p = psf_fixture_open(path, SHEAR_PSF_KIND_AUTO, 32);
    const shear_psf_model *m = psf_models_get(p, 0);
    assert_int_equal(m->lanczos, lanczos);
    assert_true(m->smoothed_px == smoothed_px);
    psf_models_close(p);
}

/* Samples were interpolated from pixels, or steps that are wider; or they were fitted to the stars:
 * those of a PSF below 3 px, and those on a basis of functions. */
static void test_kernels(void **state) {
    (void)state;
    const psf_fixture_column columns[] = {
        {"PSF_MASK", "35E", "(7,5)", planes, NULL}, {"PSF_COEFFS", "3E", NULL, planes, NULL}, {0}};
    const char *path = model("420E", "(7,5,12)", three);
    check_kernels(path, 0, 1.0);
    fixture_patch(path, "PSF_DATA", "PSF_FWHM", "3.0");
    check_kernels(path, 0, 1.0);
    fixture_patch(path, "PSF_DATA", "PSF_FWHM", "2.9");
    check_kernels(path, 3, 0.0);
    check_kernels(model("35E", "(7,5)", constant), 0, 1.3);
    fitsfile *f = begin();
    psf_fixture_table(f, "PSF_DATA", 1, columns);
    psf_fixture_keys(f, constant);
    fixture_close(f);
    check_kernels(fixture_path("model.psf"), 3, 0.0);
}

static void test_reach(void **state) {
    (void)state;
    psf_models *p = psf_fixture_open(model("420E", "(7,5,12)", three), SHEAR_PSF_KIND_PSFEX, 32);
    double c[TERMS];
    static const struct {
        double x, y, mag;
    } cases[] = {{3001.0, 2000.0, 19.0}, {1000.0, -2001.0, 19.0},  {1000.0, 2000.0, 31.5},
                 {NAN, 2000.0, 19.0},    {1000.0, INFINITY, 19.0}, {1000.0, 2000.0, NAN},
                 {1e300, 2000.0, 19.0}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const psf_place place = {cases[i].x, cases[i].y, NAN, NAN, &cases[i].mag};
        assert_false(psf_models_terms(p, 0, &place, c));
        assert_true(c[0] == 0.0 && c[TERMS - 1] == 0.0);
    }
    psf_models_close(p);
}

/* A constant model has neither POLDEG1 nor POLNAME1; its plane may be a matrix. With TDIM or
 * without. */
static void test_constant(void **state) {
    (void)state;
    static const char *const axes[] = {"POLNAXIS= 0", "PSF_SAMP= 1.3", "PSFAXIS1= 7",
                                       "PSFAXIS2= 5", "PSFAXIS3= 1",   NULL};
    const char *const *names = NULL;
    for (int kind = 0; kind < 3; kind++) {
        psf_models *p = psf_fixture_open(model("35E",
                                               kind == 0   ? "(7,5)"
                                               : kind == 1 ? "(7,5,1)"
                                                           : NULL,
                                               kind == 2 ? axes : constant),
                                         SHEAR_PSF_KIND_AUTO, 32);
        double out[PLANE];
        psf_fixture_samples(p, 0, &(psf_place){NAN, NAN, NAN, NAN, NULL}, out);
        for (int k = 0; k < PLANE; k++)
            psf_fixture_near(out[k], planes[k], 1e-6);
        assert_int_equal(psf_models_contexts(p, 0, &names), 0);
        assert_string_equal(psf_models_text(p, 0), "PSFEx, 7 x 5 samples of 1.30 px, constant");
        psf_models_close(p);
    }
}

/* An HDU per chip; the shorter model is padded, and one that failed has no coefficients. */
static void test_chips(void **state) {
    (void)state;
    static const char *const failed[] = {"ACCEPTED= 0", "POLNAXIS= 0", "PSF_SAMP= 0.0", NULL};
    const double mag = 19.0;
    const psf_place place = {1000.0, 2000.0, NAN, NAN, &mag};
    double c[TERMS];
    fitsfile *f = begin();
    append(f, "35E", "(7,5)", failed);
    append(f, "35E", "(7,5)", constant);
    append(f, "420D", "(7,5,12)", three);
    fixture_close(f);
    psf_models *p = psf_fixture_open(fixture_path("model.psf"), SHEAR_PSF_KIND_AUTO, 32);
    assert_int_equal(psf_models_count(p), 3);
    for (int i = 0; i < 3; i++)
        assert_int_equal(psf_models_get(p, i)->terms, TERMS);
    assert_false(psf_models_terms(p, 0, &place, c));
    assert_non_null(strstr(psf_models_text(p, 0), "ACCEPTED is 0"));
    assert_true(psf_models_terms(p, 1, &place, c));
    assert_true(c[0] == 1.0 && c[1] == 0.0 && c[TERMS - 1] == 0.0);
    assert_true(psf_models_get(p, 1)->samples[TERMS * PLANE - 1] == 0.0);
    check(p, 2, planes, (double[]){0.5, -0.25, 0.125});
    psf_models_close(p);
}

/* The Legacy Survey's tables: a row per chip, parameters in columns. */
static void test_rows(void **state) {
    (void)state;
    static const double zero[] = {1000.0, 1000.0};
    static const double y_zero[] = {2000.0, 2000.0};
    static const double scale[] = {2000.0, 2000.0};
    static const double y_scale[] = {4000.0, 4000.0};
    static const double one[] = {1.0, 1.0};
    static const double two[] = {2.0, 2.0};
    static const double six[] = {6.0, 6.0};
    static const double step[] = {1.0, 0.75};
    const psf_fixture_column columns[] = {{"polzero1", "D", NULL, zero, NULL},
                                          {"polscal1", "D", NULL, scale, NULL},
                                          {"polname1", "7A", NULL, NULL, "X_IMAGE"},
                                          {"polgrp1", "K", NULL, one, NULL},
                                          {"polzero2", "D", NULL, y_zero, NULL},
                                          {"polscal2", "D", NULL, y_scale, NULL},
                                          {"polname2", "7A", NULL, NULL, "Y_IMAGE"},
                                          {"polgrp2", "K", NULL, one, NULL},
                                          {"polnaxis", "K", NULL, two, NULL},
                                          {"poldeg1", "K", NULL, two, NULL},
                                          {"psfaxis3", "K", NULL, six, NULL},
                                          {"psf_samp", "D", NULL, step, NULL},
                                          {"ccdname", "5A", NULL, NULL, "N15"},
                                          {"psf_mask", "210E", "(7,5,6)", planes, NULL},
                                          {0}};
    fitsfile *f = begin();
    psf_fixture_table(f, "", 2, columns);
    fixture_close(f);
    psf_models *p = psf_fixture_open(fixture_path("model.psf"), SHEAR_PSF_KIND_AUTO, 32);
    assert_int_equal(psf_models_count(p), 2);
    for (int i = 0; i < 2; i++) {
        assert_string_equal(psf_models_chip(p, i), "N15");
        assert_true(psf_models_get(p, i)->step == step[i]);
    }
    check(p, 0, planes, (double[]){0.5, -0.25, 0.0});
    check(p, 1, planes + 6 * (size_t)PLANE, (double[]){0.5, -0.25, 0.0});
    psf_models_close(p);
}

static void test_bad_keywords(void **state) {
    (void)state;
    static const struct {
        const char *key, *value;
        int code;
        const char *word;
    } cases[] = {{"ACCEPTED", "0", SHEAR_E_PSF, "accepted no star"},
                 {"ACCEPTED", "11", SHEAR_E_PSF, "fewer stars"},
                 {"PSF_SAMP", "0.0", SHEAR_E_PSF, "PSF_SAMP"},
                 {"PSF_SAMP", "-1.0", SHEAR_E_PSF, "PSF_SAMP"},
                 {"PSF_SAMP", "1E300", SHEAR_E_PSF, "PSF_SAMP"},
                 {"PSF_SAMP", "'one'", SHEAR_E_FORMAT, "PSF_SAMP"},
                 {"CHI2", "1E9", SHEAR_E_PSF, "CHI2"},
                 {"CHI2", "-nan", SHEAR_E_PSF, "CHI2"},
                 {"PSF_SAMP", "inf", SHEAR_E_PSF, "PSF_SAMP"},
                 {"CHI2", "one", SHEAR_E_FORMAT, "CHI2"},
                 {"POLNAXIS", "9", SHEAR_E_FORMAT, "POLNAXIS is 9"},
                 {"POLNAXIS", "2", SHEAR_E_FORMAT, "12 planes, but its polynomial"},
                 {"POLNAXIS", "2.5", SHEAR_E_FORMAT, "POLNAXIS is 2.5"},
                 {"POLDEG1", "3", SHEAR_E_FORMAT, "has 20 terms"},
                 {"POLDEG1", "-1", SHEAR_E_FORMAT, "POLDEG1"},
                 {"POLDEG1", "1000000000", SHEAR_E_FORMAT, "POLDEG1"},
                 {"POLDEG1", "1E300", SHEAR_E_FORMAT, "POLDEG1"},
                 {"POLGRP3", "3", SHEAR_E_FORMAT, "POLDEG3 is missing"},
                 {"POLGRP3", "0", SHEAR_E_FORMAT, "POLGRP3"},
                 {"POLNAME3", "''", SHEAR_E_FORMAT, "POLNAME3"},
                 {"POLSCAL1", "0.0", SHEAR_E_FORMAT, "POLSCAL1"},
                 {"POLZERO2", "'x'", SHEAR_E_FORMAT, "POLZERO2"},
                 {"PSFAXIS3", "6", SHEAR_E_FORMAT, "PSFAXIS3 is 6"},
                 {"PSFAXIS1", "5", SHEAR_E_FORMAT, "PSFAXIS1 is 5"},
                 {"TDIM1", "'(7,5,11)'", SHEAR_E_FORMAT, "TDIM1"},
                 {"TDIM1", "'(0,5,12)'", SHEAR_E_FORMAT, "TDIM1"},
                 {"TDIM1", "'(4294967296,4294967296,12)'", SHEAR_E_FORMAT, "TDIM1"},
                 {"TDIM1", "'(1,35,12)'", SHEAR_E_FORMAT, "PSF"},
                 {"TFORM1", "'210D'", SHEAR_E_FORMAT, "TDIM1"},
                 {"TFORM1", "'1680A'", SHEAR_E_FORMAT, "holds strings"}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const char *path = model("420E", "(7,5,12)", three);
        fixture_patch(path, "PSF_DATA", cases[i].key, cases[i].value);
        psf_fixture_refuse(path, SHEAR_PSF_KIND_AUTO, cases[i].code, "model.psf", cases[i].word,
                           END);
    }
}

static void test_bad_samples(void **state) {
    (void)state;
    const double before = planes[3];
    planes[3] = NAN;
    psf_fixture_refuse(model("35E", "(7,5)", constant), SHEAR_PSF_KIND_AUTO, SHEAR_E_PSF,
                       "not finite", END);
    planes[3] = -1e6;
    psf_fixture_refuse(model("35E", "(7,5)", constant), SHEAR_PSF_KIND_AUTO, SHEAR_E_PSF,
                       "flux is not positive", END);
    planes[3] = before;
}

static void test_robust(void **state) {
    (void)state;
    const char *path = model("420E", "(7,5,12)", three);
    psf_fixture_spoil(path, 400);
    psf_fixture_starve(path);
}

/* ---- files of PSFEx itself ---- */

/* PSFEx writes its own evaluation on a grid of n^variables places, u = -4/9 ... 4/9 for n = 9. */
static void compare_snapshots(const char *name, int variables, int n) {
    char path[64];
    int width = 0;
    int height = 0;
    snprintf(path, sizeof path, "psfex/%s.snapshots.fits", name);
    double *tiles = psf_fixture_image(psf_fixture_real(path), 1, &width, &height);
    snprintf(path, sizeof path, "psfex/%s.psf", name);
    psf_models *p = psf_fixture_open(psf_fixture_real(path), SHEAR_PSF_KIND_AUTO, 64);
    const shear_psf_model *m = psf_models_get(p, 0);
    const int columns = width / m->nx;
    double *out = calloc((size_t)m->nx * (size_t)m->ny, sizeof *out);
    assert_true(columns == (variables > 0 ? n : 1));
    for (int tile = 0; tile < columns * (height / m->ny); tile++) {
        const int at[3] = {tile % n, tile / n % n, tile / n / n};
        double u[3];
        for (int i = 0; i < 3; i++) /* the middle tile is 0 */
            u[i] = (at[i] - (n - 1) / 2) / (double)n;
        const double mag = 1.911662006378e+01 + 4.803037643433e+00 * u[2];
        const psf_place place = {7.695114583969e+02 + 1.480231477737e+03 * u[0],
                                 7.678360328674e+02 + 1.477761283875e+03 * u[1], NAN, NAN, &mag};
        double peak = 0.0;
        double worst = 0.0;
        psf_fixture_samples(p, 0, &place, out);
        for (int y = 0; y < m->ny; y++) {
            for (int x = 0; x < m->nx; x++) {
                const int row = tile / columns * m->ny + y;
                const double theirs = tiles[row * width + tile % columns * m->nx + x];
                peak = fmax(peak, theirs);
                worst = fmax(worst, fabs(theirs - out[y * m->nx + x]));
            }
        }
        if (!(worst < 1e-6 * peak))
            fail_msg("%s, tile %d: %g of the peak", name, tile, worst / peak);
    }
    free(out);
    free(tiles);
    psf_models_close(p);
}

static void test_snapshots(void **state) {
    (void)state;
    if (psf_fixture_real("psfex/sim_ldac.psf") == NULL)
        skip();
    compare_snapshots("sim_ldac", 2, 9);
    compare_snapshots("sim_ldac_s05", 2, 9);
    compare_snapshots("sim_ldac_mag", 3, 5);
    compare_snapshots("sim_ldac_const", 0, 1);
}

/* Of another implementation, HDU by HDU: the samples, divided by their sum or not. */
static void test_evaluated(void **state) {
    (void)state;
    char truth[512];
    int hdus = 0;
    int status = 0;
    int compared = 0;
    fitsfile *f = NULL;
    if (psf_fixture_real("psfex/truth_evaluated.fits") == NULL)
        skip();
    snprintf(truth, sizeof truth, "%s", psf_fixture_real("psfex/truth_evaluated.fits"));
    fits_open_diskfile(&f, truth, READONLY, &status);
    fits_get_num_hdus(f, &hdus, &status);
    for (int hdu = 2; hdu <= hdus; hdu++) {
        char file[80] = "psfex/";
        double value[4] = {NAN, NAN, NAN, NAN};
        fits_movabs_hdu(f, hdu, NULL, &status);
        fits_read_key_str(f, "PSFFILE", file + strlen(file), NULL, &status);
        assert_int_equal(status, 0);
        static const char *const keys[] = {"CTX1", "CTX2", "CTX3", "SUM"};
        for (int i = 0; i < 4; i++) {
            int missing = 0;
            fits_read_key_dbl(f, keys[i], &value[i], NULL, &missing);
            value[i] = missing != 0 ? NAN : value[i];
        }
        if (isnan(value[3]))
            continue; /* rendered to pixels */
        int nx = 0;
        int ny = 0;
        double sum = 0.0;
        double *theirs = psf_fixture_image(truth, hdu, &nx, &ny);
        psf_models *p = psf_fixture_open(psf_fixture_real(file), SHEAR_PSF_KIND_AUTO, 64);
        double *ours = calloc((size_t)nx * (size_t)ny, sizeof *ours);
        assert_int_equal(psf_models_get(p, 0)->nx, nx);
        psf_fixture_samples(p, 0, &(psf_place){value[0], value[1], NAN, NAN, &value[2]}, ours);
        for (int i = 0; i < nx * ny; i++) {
            sum += ours[i];
            psf_fixture_near(ours[i], theirs[i], 1e-12);
        }
        psf_fixture_near(sum, value[3], 1e-10);
        compared++;
        free(ours);
        free(theirs);
        psf_models_close(p);
    }
    fits_close_file(f, &status);
    assert_int_equal(compared, 17);
}

static void test_legacy_survey(void **state) {
    (void)state;
    if (psf_fixture_real("psfex/decam-5742149339-ccd2.fits") == NULL)
        skip();
    psf_models *p = psf_fixture_open(psf_fixture_real("psfex/decam-5742149339-ccd2.fits"),
                                     SHEAR_PSF_KIND_AUTO, 64);
    assert_string_equal(psf_models_text(p, 0),
                        "PSFEx, 25 x 25 samples of 0.71 px, degree 2 in X_IMAGE, Y_IMAGE");
    psf_models_close(p);
    p = psf_fixture_open(psf_fixture_real("psfex/c4d_170916_045042_ooi_r_ls9-N15-psfex.fits"),
                         SHEAR_PSF_KIND_AUTO, 64);
    assert_string_equal(psf_models_chip(p, 0), "N15");
    assert_string_equal(psf_models_text(p, 0),
                        "PSFEx, 63 x 63 samples of 1.00 px, degree 2 in X_IMAGE, Y_IMAGE, 311 of "
                        "320 stars, chi2/dof 0.99");
    psf_models_close(p);
    psf_fixture_refuse(psf_fixture_real("psfex/invalid_psfcat.psf"), SHEAR_PSF_KIND_AUTO,
                       SHEAR_E_FORMAT, "PSFAXIS3 is 3", "6 planes", END);
}

static int setup(void **state) {
    fill_planes();
    return fixture_setup(state);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_robust),      cmocka_unit_test(test_groups),
        cmocka_unit_test(test_kernels),     cmocka_unit_test(test_reach),
        cmocka_unit_test(test_constant),    cmocka_unit_test(test_chips),
        cmocka_unit_test(test_rows),        cmocka_unit_test(test_bad_keywords),
        cmocka_unit_test(test_bad_samples), cmocka_unit_test(test_snapshots),
        cmocka_unit_test(test_evaluated),   cmocka_unit_test(test_legacy_survey),
    };
    return cmocka_run_group_tests(tests, setup, fixture_teardown);
}
