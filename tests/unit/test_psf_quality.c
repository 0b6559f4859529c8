/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The quality of PSF images: each flaw is found, measured, and about as harmful as reported;
 * there is no message about images without any. */
#include "gaussian.h"
#include "pair.h"
#include "test.h"

#include "shear/plan.h"
#include "shear/psf.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double betas[] = {1.5, 2.3}; /* of R_PSF */

typedef double (*profile)(double r2); /* of the distance squared, in units of the scale */

static double gauss(double r2) {
    return exp(-0.5 * r2);
}

static double moffat35(double r2) {
    return pow(1.0 + r2 / 6.5, -3.5);
}

static double moffat25(double r2) {
    return pow(1.0 + r2 / 4.5, -2.5);
}

/* A core with the wings of a turbulent atmosphere. */
static double kolmogorov(double r2) {
    return 0.9 * exp(-0.5 * r2) + 0.1 * pow(1.0 + r2 / 3.3, -11.0 / 6.0);
}

static double airy(double r2) {
    const double v = 1.37 * sqrt(r2);
    const double a = v > 1e-6 ? 2.0 * j1(v) / v : 1.0;
    return a * a;
}

/* The image [ny][nx] of an elliptical PSF of about radius r samples. */
static double *draw(profile f, int nx, int ny, double r, double dx, double dy) {
    double *psf = calloc((size_t)nx * (size_t)ny, sizeof *psf);
    assert_non_null(psf);
    for (int y = 0; y < ny; y++) {
        for (int x = 0; x < nx; x++) {
            const double u = (x - nx / 2 - dx) / r;
            const double v = (y - ny / 2 - dy) / r;
            psf[y * nx + x] = f(1.05 * u * u + 0.96 * v * v + 0.06 * u * v);
        }
    }
    return psf;
}

static shear_psf_quality look(const double *psf, int nx, int ny, int oversample) {
    shear_psf_quality q;
    shear_error err = {0};
    if (shear_psf_examine(&q, psf, nx, ny, oversample, &err) != SHEAR_OK)
        fail_msg("%s", err.message);
    return q;
}

static unsigned flaws_of(const double *psf, int nx, int ny, int oversample, double ratio) {
    const shear_psf_quality q = look(psf, nx, ny, oversample);
    return shear_psf_flaws(&q, ratio * q.r_psf_px);
}

/* ---- silence ---- */

/* Images 12 R_PSF and more from centre to edge, odd and even, coarse and fine. */
static void test_good_psfs_are_silent(void **state) {
    (void)state;
    static const profile all[] = {gauss, moffat35, moffat25, kolmogorov, airy};
    static const int oversamples[] = {1, 2, 3, 4, 8, 16};
    for (int p = 0; p < 5; p++) {
        for (int o = 0; o < 6; o++) {
            for (int odd = 0; odd < 2; odd++) {
                const double r = 1.5 * oversamples[o];
                const int n = (int)(2.0 * 14.0 * r) / 2 * 2 + odd;
                double *psf = draw(all[p], n, n + 3, r, 0.3, -0.4);
                for (int b = 0; b < 2; b++)
                    assert_int_equal(flaws_of(psf, n, n + 3, oversamples[o], betas[b]), 0);
                free(psf);
            }
        }
    }
}

/* A Gaussian has no wings: 5 R_PSF suffice. */
static void test_small_images(void **state) {
    (void)state;
    for (int n = 16; n <= 33; n++) {
        double *psf = draw(gauss, n, n, 1.5, 0.0, 0.0);
        assert_int_equal(flaws_of(psf, n, n, 1, 2.3), 0);
        free(psf);
    }
}

/* Ringing and rounding below zero, as models of PSFs have it; and noise of a star of S/N 10^4. */
static void test_tiny_flaws_are_silent(void **state) {
    (void)state;
    uint64_t seed = 5;
    double *psf = draw(moffat35, 48, 48, 1.5, 0.0, 0.0);
    for (int i = 0; i < 48 * 48; i++)
        psf[i] += 5e-5 * sin(2.9 * (i % 48)) * sin(2.5 * (i / 48)) + 1e-5 * (uniform(&seed) - 0.5);
    assert_int_equal(flaws_of(psf, 48, 48, 1, 2.3), 0);
    free(psf);
}

/* ---- what is refused ---- */

static void refused(const double *psf, int nx, int ny, const char *message, const char *advice) {
    shear_error err = {0};
    shear_psf_quality q;
    assert_int_equal(shear_psf_usable(psf, nx, ny, NULL), SHEAR_E_PSF);
    assert_int_equal(shear_psf_examine(&q, psf, nx, ny, 1, &err), SHEAR_E_PSF);
    if (strstr(err.message, message) == NULL || strstr(err.advice, advice) == NULL)
        fail_msg("%s; %s", err.message, err.advice);
}

/* to(x, y) = from(x - dx, y - dy), periodic. */
static void roll(const double *from, double *to, int nx, int ny, int dx, int dy) {
    for (int y = 0; y < ny; y++) {
        for (int x = 0; x < nx; x++)
            to[(y + dy) % ny * nx + (x + dx) % nx] = from[y * nx + x];
    }
}

/* As ifftshift and fftshift leave a centred PSF, and either axis alone. */
static void test_wrapped(void **state) {
    (void)state;
    static const profile all[] = {gauss, moffat25, airy};
    for (int p = 0; p < 3; p++) {
        for (int n = 16; n <= 33; n++) {
            double *psf = draw(all[p], n, n, 1.2, 0.2, -0.1);
            double *rolled = calloc((size_t)n * (size_t)n, sizeof *rolled);
            assert_non_null(rolled);
            for (int back = 0; back < 2; back++) {
                const int shift = back != 0 ? (n + 1) / 2 : n / 2;
                roll(psf, rolled, n, n, shift, shift);
                refused(rolled, n, n, "corners", "fftshift");
                roll(psf, rolled, n, n, shift, 0);
                refused(rolled, n, n, "edges", "fftshift");
                roll(psf, rolled, n, n, 0, shift);
                refused(rolled, n, n, "edges", "fftshift");
            }
            free(psf);
            free(rolled);
        }
    }
}

static void test_no_psf(void **state) {
    (void)state;
    double *psf = draw(moffat35, 25, 25, 1.5, 0.0, 0.0);
    refused(psf + 12 * 25, 25, 13, "cut through its core", "further around");
    for (int i = 0; i < 625; i++)
        psf[i] += 2.0;
    refused(psf, 25, 25, "edge is as bright as 0.67", "background");
    for (int i = 0; i < 625; i++)
        psf[i] = 3.0;
    refused(psf, 25, 25, "flat", "image of the PSF");
    psf[30] = NAN;
    refused(psf, 25, 25, "not finite", "image");
    free(psf);
}

/* ---- flaws ---- */

/* A pedestal's level is found, and is one from a bias of 2e-3 on; nothing else is said. */
static void test_pedestal(void **state) {
    (void)state;
    static const double levels[] = {-1e-2, -1e-3, 1e-4, 3e-4, 1e-3, 1e-2, 0.1};
    for (int i = 0; i < 7; i++) {
        double *psf = draw(gauss, 33, 33, 1.5, 0.0, 0.0);
        for (int j = 0; j < 33 * 33; j++)
            psf[j] += levels[i];
        const shear_psf_quality q = look(psf, 33, 33, 1);
        assert_near(q.border, levels[i] / (1.0 + levels[i]), 1e-3, levels[i], "pedestal");
        for (int b = 0; b < 2; b++) {
            const bool harmful = shear_psf_border_bias(&q, betas[b] * q.r_psf_px) > 2e-3;
            assert_int_equal(shear_psf_flaws(&q, betas[b] * q.r_psf_px),
                             harmful ? 1u << SHEAR_PSF_PEDESTAL : 0u);
        }
        free(psf);
    }
}

/* Wings that go on like r^-5 and r^-11/3: slope and missing light, about, and no pedestal. */
static void test_cut(void **state) {
    (void)state;
    for (int p = 0; p < 2; p++) {
        const profile f = p != 0 ? kolmogorov : moffat25;
        double *whole = draw(f, 601, 601, 1.5, 0.0, 0.0);
        double all = 0.0;
        for (int i = 0; i < 601 * 601; i++)
            all += whole[i];
        for (int n = p != 0 ? 19 : 11; n <= (p != 0 ? 23 : 19); n += 2) {
            double *psf = draw(f, n, n, 1.5, 0.0, 0.0);
            double sum = 0.0;
            for (int i = 0; i < n * n; i++)
                sum += psf[i];
            const shear_psf_quality q = look(psf, n, n, 1);
            const double cut = 1.0 - sum / all;
            assert_true(q.cut > 0.5 * cut && q.cut < 2.5 * cut);
            assert_true(q.border_slope > 2.2 && q.border_slope < 5.0);
            assert_int_equal(shear_psf_flaws(&q, 2.3 * q.r_psf_px), 1u << SHEAR_PSF_CUT);
            free(psf);
        }
        free(whole);
    }
}

/* A Gaussian number of variance 1, nearly. */
static double normal(uint64_t *seed) {
    double sum = -6.0;
    for (int i = 0; i < 12; i++)
        sum += uniform(seed);
    return sum;
}

static double flux_of_gaussian(double r) {
    return 2.0 * M_PI * r * r;
}

/* White noise is measured within a fifth, whatever the size and the sampling, and is no border and
 * no negative sample, however strong. */
static void test_noise(void **state) {
    (void)state;
    uint64_t seed = 12;
    for (int oversample = 1; oversample <= 4; oversample *= 2) {
        for (int n = 25 * oversample; n < 65 * oversample; n += 13 * oversample) {
            for (double rms = 1e-6; rms < 0.02; rms *= 10.0) {
                const double r = 1.5 * oversample;
                double *psf = draw(gauss, n, n, r, 0.2, 0.1);
                for (int i = 0; i < n * n; i++)
                    psf[i] += rms * normal(&seed);
                const shear_psf_quality q = look(psf, n, n, oversample);
                const double noise = rms * oversample / flux_of_gaussian(r);
                assert_near(q.noise, noise, 0.2, noise, "noise");
                const bool harmful = shear_psf_noise_bias(&q, 1.5 * q.r_psf_px) > 2e-3;
                assert_int_equal(shear_psf_flaws(&q, 1.5 * q.r_psf_px),
                                 harmful ? 1u << SHEAR_PSF_NOISY : 0u);
                free(psf);
            }
        }
    }
}

static void test_undersampled(void **state) {
    (void)state;
    for (int oversample = 1; oversample <= 4; oversample *= 2) {
        const int n = 32 * oversample;
        double *psf = draw(gauss, n, n, 0.56 * oversample, 0.0, 0.0);
        const shear_psf_quality q = look(psf, n, n, oversample);
        assert_int_equal(shear_psf_flaws(&q, 1.2),
                         oversample == 1 ? 1u << SHEAR_PSF_UNDERSAMPLED : 0u);
        free(psf);
    }
}

static void test_negative_sample(void **state) {
    (void)state;
    double *psf = draw(moffat35, 41, 41, 1.5, 0.0, 0.0);
    psf[41 * 24 + 20] = -0.019;
    assert_int_equal(flaws_of(psf, 41, 41, 1, 1.5), 0);
    psf[41 * 24 + 20] = -0.021;
    assert_int_equal(flaws_of(psf, 41, 41, 1, 1.5), 1u << SHEAR_PSF_NEGATIVE);
    assert_near(look(psf, 41, 41, 1).lowest, -0.021, 1e-12, 1.0, "lowest");
    free(psf);
}

/* Zeros around a circle are no border: the rim is where they begin. */
static void test_masked(void **state) {
    (void)state;
    double *psf = draw(moffat25, 49, 49, 1.5, 0.0, 0.0);
    double *small = draw(moffat25, 25, 25, 1.5, 0.0, 0.0);
    for (int i = 0; i < 49 * 49; i++)
        psf[i] = hypot(i % 49 - 24, i / 49 - 24) <= 12.0 ? psf[i] : 0.0;
    const shear_psf_quality masked = look(psf, 49, 49, 1);
    const shear_psf_quality whole = look(small, 25, 25, 1);
    assert_near(masked.border, whole.border, 1e-12, whole.border, "rim");
    assert_int_equal(shear_psf_flaws(&masked, 2.3 * masked.r_psf_px), 1u << SHEAR_PSF_CUT);
    free(psf);
    free(small);
}

/* ---- how harmful ---- */

enum { STAMP = 48 };
static const double r_psf = 1.5;

/* g of a round galaxy as large as the PSF, sheared by (g, 0), as this PSF image has it measured. */
static double shear_with(const double *psf, double g, double beta) {
    pair p;
    pair_init(&p, STAMP, STAMP, STAMP, STAMP, 1);
    const double r2 = r_psf * r_psf;
    const gaussian galaxy = {
        100.0,    r2 * (1.0 + g) * (1.0 + g) + r2, r2 * (1.0 - g) * (1.0 - g) + r2, 0.0, STAMP / 2,
        STAMP / 2};
    char text[32];
    gaussian_draw(&galaxy, STAMP, STAMP, 1, p.galaxy);
    memcpy(p.psf, psf, STAMP * STAMP * sizeof *psf);
    snprintf(text, sizeof text, "%.17g", beta);
    pair_set(&p, "beta", text);
    pair_set(&p, "interpolation", "none");
    const shear_row row = pair_measure(&p);
    pair_deinit(&p);
    return row.n1 / row.d;
}

/* m, and c in *c. */
static double bias_with(const double *psf, double beta, double *c) {
    const double g = 0.02;
    const double plus = shear_with(psf, g, beta);
    const double minus = shear_with(psf, -g, beta);
    *c = 0.5 * (plus + minus);
    return 0.5 * (plus - minus) / g - 1.0;
}

/* The scatter of m and c over noisy images is what the formula says: the formula's integrals
 * against the library. */
static void test_noise_bias(void **state) {
    (void)state;
    enum { IMAGES = 40 };
    uint64_t seed = 3;
    const gaussian round = {1.0, r_psf * r_psf, r_psf * r_psf, 0.0, STAMP / 2, STAMP / 2};
    double clean[STAMP * STAMP];
    double psf[STAMP * STAMP];
    gaussian_draw(&round, STAMP, STAMP, 1, clean);
    const double rms = 1e-5 * flux_of_gaussian(r_psf);
    for (int b = 0; b < 2; b++) {
        const double beta = betas[b] * r_psf;
        const shear_psf_quality q = {.r_psf_px = r_psf, .noise = 1e-5};
        double c;
        double m2 = 0.0;
        double c2 = 0.0;
        const double m0 = bias_with(clean, beta, &c);
        for (int i = 0; i < IMAGES; i++) {
            for (int j = 0; j < STAMP * STAMP; j++)
                psf[j] = clean[j] + rms * normal(&seed);
            const double m = bias_with(psf, beta, &c) - m0;
            m2 += m * m / IMAGES;
            c2 += c * c / IMAGES;
        }
        const double told = shear_psf_noise_bias(&q, beta);
        assert_true(sqrt(m2) > 0.7 * told && sqrt(m2) < 1.5 * told);
        assert_true(sqrt(c2) > 0.5 * told && sqrt(c2) < told);
    }
}

/* ---- several ---- */

static void test_summary(void **state) {
    (void)state;
    shear_psf_summary s = {0};
    const shear_psf_quality good = {.r_psf_px = 1.5,
                                    .sampling = 1.5,
                                    .border = 1e-6,
                                    .border_slope = 4.0,
                                    .cut = NAN,
                                    .noise = NAN};
    shear_psf_quality bad = good;
    bad.border = -0.01;
    bad.border_slope = INFINITY;
    bad.noise = 1e-3;
    bad.lowest = -0.5;
    shear_psf_summary_add(&s, NULL, 3.0);
    shear_psf_summary_add(&s, &good, 3.0);
    shear_psf_summary_add(&s, &bad, 3.0);
    shear_psf_summary_add(&s, &good, 3.0);
    assert_int_equal(s.looked_at, 4);
    assert_int_equal(s.unusable, 1);
    assert_int_equal(s.flawed[SHEAR_PSF_PEDESTAL], 1);
    assert_int_equal(s.flawed[SHEAR_PSF_NOISY], 1);
    assert_int_equal(s.flawed[SHEAR_PSF_NEGATIVE], 1);
    assert_int_equal(s.flawed[SHEAR_PSF_CUT] + s.flawed[SHEAR_PSF_UNDERSAMPLED], 0);
    assert_true(s.worst.border == -0.01 && s.worst.noise == 1e-3 && s.worst.lowest == -0.5);
    for (int i = 0; i < SHEAR_N_PSF_FLAWS; i++)
        assert_non_null(shear_psf_flaw_name(i));
    assert_null(shear_psf_flaw_name(-1));
    assert_null(shear_psf_flaw_name(SHEAR_N_PSF_FLAWS));
}

/* The plan looks at its one PSF; of others it is told. */
static void test_plan(void **state) {
    (void)state;
    pair p;
    shear_plan *plan = NULL;
    pair_init(&p, 32, 32, 33, 33, 1);
    double *psf = draw(gauss, 33, 33, 1.5, 0.0, 0.0);
    for (int i = 0; i < 33 * 33; i++)
        p.psf[i] = psf[i] + 0.01;
    shear_plan_info info;
    draw_blobs(p.galaxy, 32, 32, 3, 3.0, 1);
    pair_measure_info(&p, &info);
    assert_int_equal(info.psf.looked_at, 1);
    assert_int_equal(info.psf.flawed[SHEAR_PSF_PEDESTAL], 1);
    const shear_psf_quality q = look(p.psf, 33, 33, 1);
    assert_int_equal(
        shear_plan_new(
            &plan,
            &(shear_plan_request){.settings = &p.settings, .geometry = p.geometry, .r_psf_px = 1.5},
            NULL),
        SHEAR_OK);
    assert_int_equal(shear_plan_get_info(plan)->psf.looked_at, 0);
    shear_plan_note_psfs(plan, &q, 1, 2);
    assert_int_equal(shear_plan_get_info(plan)->psf.looked_at, 3);
    assert_int_equal(shear_plan_get_info(plan)->psf.unusable, 2);
    assert_int_equal(shear_plan_get_info(plan)->psf.flawed[SHEAR_PSF_PEDESTAL], 1);
    shear_plan_free(plan);
    free(psf);
    pair_deinit(&p);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_good_psfs_are_silent),
        cmocka_unit_test(test_small_images),
        cmocka_unit_test(test_tiny_flaws_are_silent),
        cmocka_unit_test(test_wrapped),
        cmocka_unit_test(test_no_psf),
        cmocka_unit_test(test_pedestal),
        cmocka_unit_test(test_cut),
        cmocka_unit_test(test_noise),
        cmocka_unit_test(test_undersampled),
        cmocka_unit_test(test_negative_sample),
        cmocka_unit_test(test_masked),
        cmocka_unit_test(test_noise_bias),
        cmocka_unit_test(test_summary),
        cmocka_unit_test(test_plan),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
