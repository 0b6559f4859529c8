/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The simulator of the experiments survey and precision: closed forms and laws. */
#include "engine/flaw.h"
#include "engine/light.h"
#include "engine/population.h"
#include "test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SIDE = 64, N = SIDE * SIDE };

static void assert_near(double measured, double known, double tolerance) {
    if (!(fabs(measured - known) <= tolerance))
        fail_msg("%.8g, not %.8g +- %.2g", measured, known, tolerance);
}

static light *new_light(enum light_psf_kind kind, double size, double e1, double e2, int reach) {
    const light_psf psf = {kind, size, {e1, e2}};
    light *l = NULL;
    shear_error err = {0};
    if (light_new(&l, &psf, SIDE, reach, 1.0, &err) != 0)
        fail_msg("%s", err.message);
    return l;
}

static double sum_of(const double *image) {
    double sum = 0.0;
    for (int i = 0; i < N; i++)
        sum += image[i];
    return sum;
}

/* ---- PSFs ---- */

/* Moffat's function, sheared, integrated over the pixel at (x, y) from the peak. */
static double moffat_pixel(double fwhm, double e1, double e2, int x, int y) {
    enum { FINE = 300 };
    const double rd = 0.5 * fwhm / sqrt(pow(2.0, 1.0 / 3.5) - 1.0);
    const double norm = sqrt(1.0 - e1 * e1 - e2 * e2);
    double sum = 0.0;
    for (int i = 0; i < FINE * FINE; i++) {
        const double dx = x - 0.5 + (i % FINE + 0.5) / FINE;
        const double dy = y - 0.5 + (i / FINE + 0.5) / FINE;
        const double u = ((1.0 - e1) * dx - e2 * dy) / norm;
        const double v = ((1.0 + e1) * dy - e2 * dx) / norm;
        sum += pow(1.0 + (u * u + v * v) / (rd * rd), -3.5);
    }
    return 2.5 / (M_PI * rd * rd) * sum / (FINE * FINE);
}

static void test_moffat(void **state) {
    (void)state;
    static double image[N];
    light *l = new_light(LIGHT_MOFFAT, 3.5, 0.1, 0.05, 4);
    light_draw_psf(l, image);
    for (int i = 0; i < 36; i++) {
        const int x = i % 6;
        const int y = i / 6 - 3;
        const double known = moffat_pixel(3.5, 0.1, 0.05, x, y);
        const double drawn = image[(SIDE / 2 + y) * SIDE + SIDE / 2 + x];
        if (!(fabs(drawn - known) < 1e-5 * moffat_pixel(3.5, 0.1, 0.05, 0, 0)))
            fail_msg("at (%d, %d): %.8f, not %.8f", x, y, drawn, known);
    }
    light_free(l);
}

static void test_struts_hold_all_light(void **state) {
    (void)state;
    static double image[N];
    light *l = new_light(LIGHT_STRUTS, 0.7, 0.0, 0.0, 8);
    light_draw_psf(l, image);
    assert_near(sum_of(image), 1.0, 1e-9);
    for (int i = 0; i < N; i++)
        assert_true(image[i] > -1e-12);
    light_free(l);
}

/* ---- galaxies ---- */

static light_galaxy round_galaxy(double bulge, double disk_px, double bulge_px) {
    return (light_galaxy){
        .bulge = bulge, .disk_px = disk_px, .bulge_px = bulge_px, .map = {{1.0, 0.0}, {0.0, 1.0}}};
}

static double light_within(const double *image, double radius) {
    double sum = 0.0;
    for (int i = 0; i < N; i++) {
        const double x = i % SIDE - 0.5 * (SIDE - 1);
        const double y = (double)(i / SIDE) - 0.5 * (SIDE - 1);
        sum += hypot(x, y) < radius ? image[i] : 0.0;
    }
    return sum;
}

/* Half of the light is within the radius that the population goes by; all of it in the image. */
static void test_half_light(void **state) {
    (void)state;
    static double image[N];
    light *l = new_light(LIGHT_MOFFAT, 0.5, 0.0, 0.0, 8);
    const light_galaxy disk = round_galaxy(0.0, 5.0 / 1.67834, 1.0);
    const light_galaxy bulge = round_galaxy(1.0, 1.0, 5.0 / 0.54771);
    light_draw(l, &disk, 0.0, 0.0, image);
    assert_near(light_within(image, 5.0), 0.5, 0.01);
    assert_near(sum_of(image), 1.0, 1e-3);
    light_draw(l, &bulge, 0.0, 0.0, image);
    assert_near(light_within(image, 5.0), 0.5, 0.02);
    light_free(l);
}

struct moments {
    double x, y, xx, yy, xy;
};

static struct moments moments_of(const double *image) {
    struct moments m = {0};
    const double sum = sum_of(image);
    for (int i = 0; i < N; i++) {
        m.x += image[i] * (i % SIDE - 0.5 * (SIDE - 1)) / sum;
        m.y += image[i] * ((double)(i / SIDE) - 0.5 * (SIDE - 1)) / sum;
    }
    for (int i = 0; i < N; i++) {
        const double dx = i % SIDE - 0.5 * (SIDE - 1) - m.x;
        const double dy = (double)(i / SIDE) - 0.5 * (SIDE - 1) - m.y;
        m.xx += image[i] * dx * dx / sum;
        m.yy += image[i] * dy * dy / sum;
        m.xy += image[i] * dx * dy / sum;
    }
    return m;
}

/* A disk of scale h has 3 h^2 along each axis; a map A makes that 3 h^2 A A^T; PSF and pixel add
 * theirs, which a round galaxy shows. */
static void test_map_and_place(void **state) {
    (void)state;
    static double image[N];
    light *l = new_light(LIGHT_STRUTS, 0.7, 0.0, 0.0, 8);
    light_galaxy g = round_galaxy(0.0, 2.0, 1.0);
    light_draw(l, &g, 0.0, 0.0, image);
    const struct moments before = moments_of(image);
    const double a = 0.2;
    const double b = 0.1;
    g.map[0][0] = 1.0 + a;
    g.map[1][1] = 1.0 - a;
    g.map[0][1] = g.map[1][0] = b;
    light_draw(l, &g, 0.3, -0.4, image);
    const struct moments after = moments_of(image);
    const double h2 = 3.0 * 2.0 * 2.0;
    assert_near(after.x, 0.3, 1e-3);
    assert_near(after.y, -0.4, 1e-3);
    assert_near(after.xx - before.xx, h2 * ((1.0 + a) * (1.0 + a) + b * b - 1.0), 0.01);
    assert_near(after.yy - before.yy, h2 * ((1.0 - a) * (1.0 - a) + b * b - 1.0), 0.01);
    assert_near(after.xy - before.xy, h2 * 2.0 * b, 0.01);
    light_free(l);
}

/* ---- population ---- */

static void ellipticity(const light_galaxy *g, double e[2]) {
    const double xx = g->map[0][0] * g->map[0][0] + g->map[0][1] * g->map[0][1];
    const double yy = g->map[1][0] * g->map[1][0] + g->map[1][1] * g->map[1][1];
    const double xy = g->map[0][0] * g->map[1][0] + g->map[0][1] * g->map[1][1];
    e[0] = (xx - yy) / (xx + yy);
    e[1] = 2.0 * xy / (xx + yy);
}

static void test_fours_are_round_together(void **state) {
    (void)state;
    const population p = {.seed = 3, .copies = 4};
    for (int galaxy = 0; galaxy < 20; galaxy++) {
        double sum[2] = {0.0};
        double size = 0.0;
        for (int i = 0; i < 4; i++) {
            double e[2];
            const light_galaxy g = population_galaxy(&p, 4 * galaxy + i);
            ellipticity(&g, e);
            sum[0] += e[0];
            sum[1] += e[1];
            size += hypot(e[0], e[1]);
        }
        assert_near(sum[0], 0.0, 1e-12);
        assert_near(sum[1], 0.0, 1e-12);
        assert_true(size > 0.0);
    }
}

/* ---- noise ---- */

static const struct flaw *named(const char *name) {
    for (int i = 0; i < flaw_count(); i++) {
        if (strcmp(flaws[i].name, name) == 0)
            return &flaws[i];
    }
    fail_msg("no flaw is called %s", name);
    return NULL;
}

/* Mean product of pixels `lag` apart in a row, of many noise images. */
static double product(const struct flaw *f, int lag) {
    static double galaxy[N];
    static double noise[N];
    double sum = 0.0;
    int n = 0;
    for (int index = 0; index < 50; index++) {
        flaw_draw_noise(f, 7, index, galaxy, noise);
        for (int i = 0; i + lag < N; i++) {
            if (i % SIDE + lag < SIDE) {
                sum += galaxy[i] * galaxy[i + lag] + noise[i] * noise[i + lag];
                n += 2;
            }
        }
    }
    return sum / n;
}

static void test_noises(void **state) {
    (void)state;
    assert_near(product(named("reference"), 0), 1.0, 0.02);
    assert_near(product(named("reference"), 1), 0.0, 0.02);
    assert_near(product(named("correlated-excess"), 0), 1.0, 0.02);
    assert_near(product(named("correlated-excess"), 1), 2.0 / 3.0, 0.02);
    assert_near(product(named("photons"), 0), 100.0, 2.0);
}

/* A galaxy's photons come on top of the sky's, as many as there should be. */
static void test_photons(void **state) {
    (void)state;
    static double sky[2][N];
    static double galaxy[N];
    static double noise[N];
    const struct flaw *f = named("photons");
    double mean = 0.0;
    double square = 0.0;
    flaw_draw_noise(f, 7, 0, sky[0], sky[1]);
    for (int i = 0; i < N; i++) {
        galaxy[i] = 0.7; /* in units of the sky's noise, which is 10 photons */
    }
    flaw_apply(f, 7, 0, sky[0], sky[1], galaxy, noise);
    for (int i = 0; i < N; i++) {
        const double own = galaxy[i] - sky[0][i];
        mean += own / N;
        square += own * own / N;
    }
    assert_near(mean, 7.0, 0.2);
    assert_near(square - mean * mean, 7.0, 0.6);
}

/* What is spoilt differs from what is not, and is as often as it should be. */
static void test_artefacts(void **state) {
    (void)state;
    static double none[N];
    static double galaxy[N];
    static double noise[N];
    const struct flaw *f = named("cosmics");
    int spoilt = 0;
    for (int index = 0; index < 2000; index++) {
        memset(galaxy, 0, sizeof galaxy);
        flaw_apply(f, 5, index, none, none, galaxy, noise);
        const double sum = sum_of(galaxy);
        assert_true(sum == 0.0 || (sum >= 40.0 && sum <= 120.0));
        assert_true((sum != 0.0) == flaw_spoils(f, 5, index));
        spoilt += sum != 0.0;
    }
    assert_true(spoilt > 150 && spoilt < 250);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_moffat),
        cmocka_unit_test(test_struts_hold_all_light),
        cmocka_unit_test(test_half_light),
        cmocka_unit_test(test_map_and_place),
        cmocka_unit_test(test_fours_are_round_together),
        cmocka_unit_test(test_noises),
        cmocka_unit_test(test_photons),
        cmocka_unit_test(test_artefacts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
