/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How far galaxies reach: the response of a round one against the measurement itself, and the core
 * that is chosen for a sample. */
#include "gaussian.h"
#include "pair.h"
#include "test.h"

#include "measure/radial.h"
#include "measure/reach.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SIDE = 64 };
static const double r_psf = 1.5, beta = 3.0, size = 4.0;

/* A round source of scale `size` under g1, behind a round PSF. */
static gaussian lensed(double g1) {
    return (gaussian){.amplitude = 1.0,
                      .xx = pow(size * (1.0 + g1), 2) + r_psf * r_psf,
                      .yy = pow(size * (1.0 - g1), 2) + r_psf * r_psf,
                      .x0 = 0.5 * (SIDE - 1),
                      .y0 = 0.5 * (SIDE - 1)};
}

static double measured_shear(const char *core, double g1) {
    pair p;
    pair_init(&p, SIDE, SIDE, 33, 33, 1);
    const gaussian galaxy = lensed(g1);
    const gaussian psf = {
        .amplitude = 1.0, .xx = r_psf * r_psf, .yy = r_psf * r_psf, .x0 = 16.0, .y0 = 16.0};
    gaussian_draw(&galaxy, SIDE, SIDE, 1, p.galaxy);
    gaussian_draw(&psf, 33, 33, 1, p.psf);
    pair_set(&p, "beta", "3");
    pair_set(&p, "core", core);
    pair_set(&p, "filter", strcmp(core, "auto") == 0 ? "none" : "auto");
    const shear_row row = pair_measure(&p);
    pair_deinit(&p);
    return row.n1 / row.d;
}

/* The shear that a filter loses is what the measurement loses, to 3 % of it. */
static void test_response(void **state) {
    (void)state;
    static const char *const cores[] = {"6", "9", "12"};
    radial q;
    const double g = 1e-3;
    const gaussian round = lensed(0.0);
    assert_true(radial_init(&q, 45.0, r_psf, beta));
    for (int i = 0; i < q.n_r; i++)
        q.profile[i] = exp(-0.5 * q.r[i] * q.r[i] / round.xx);
    radial_load(&q);
    const double unfiltered = measured_shear("auto", g) - measured_shear("auto", -g);
    assert_near(unfiltered, 2.0 * g, 1e-4, 2.0 * g, "shear without a filter");
    for (int i = 0; i < 3; i++) {
        const double through = measured_shear(cores[i], g) - measured_shear(cores[i], -g);
        const double lost = 1.0 - radial_response(&q, strtod(cores[i], NULL), beta);
        assert_true(lost > 1e-4);
        assert_near(1.0 - through / unfiltered, lost, 0.03, lost, cores[i]);
    }
    assert_near(radial_response(&q, 40.0, beta), 1.0, 1e-9, 1.0, "response of a wide core");
    radial_deinit(&q);
}

/* A number of unit variance and zero mean: twelve uniform ones summed. */
static double normal(uint64_t *seed) {
    double sum = -6.0;
    for (int i = 0; i < 12; i++)
        sum += uniform(seed);
    return sum;
}

typedef struct sample {
    int side, count;
    double scale, sigma, sky;
    void (*spoil)(double *galaxy, int stamp);
} sample;

static double core_of(const sample *s) {
    const size_t pixels = (size_t)s->side * (size_t)s->side;
    double *galaxy = malloc(pixels * sizeof *galaxy);
    double *noise = malloc(pixels * sizeof *noise);
    uint64_t seed = 7;
    double core = 0.0;
    reach r;
    assert_true(galaxy != NULL && noise != NULL && reach_init(&r, s->side, s->side, s->count));
    for (int i = 0; i < s->count; i++) {
        const gaussian g = {.amplitude = 1.0,
                            .xx = s->scale * s->scale,
                            .yy = s->scale * s->scale,
                            .x0 = 0.5 * (s->side - 1) + uniform(&seed) - 0.5,
                            .y0 = 0.5 * (s->side - 1) + uniform(&seed) - 0.5};
        gaussian_draw(&g, s->side, s->side, 1, galaxy);
        for (size_t k = 0; k < pixels; k++) {
            galaxy[k] += s->sky + s->sigma * normal(&seed);
            noise[k] = s->sky + s->sigma * normal(&seed);
        }
        if (s->spoil != NULL)
            s->spoil(galaxy, i);
        reach_add(&r, galaxy, noise);
    }
    assert_true(reach_core(&r, r_psf, beta, beta, &core));
    reach_deinit(&r);
    free(galaxy);
    free(noise);
    return core;
}

/* Larger galaxies need a larger core; a sky that both stamps have changes nothing, and noise widens
 * it by little. */
static void test_core_follows_size(void **state) {
    (void)state;
    const double small = core_of(&(sample){.side = 64, .count = 128, .scale = 2.5, .sigma = 1e-4});
    const double large = core_of(&(sample){.side = 64, .count = 128, .scale = 4.0, .sigma = 1e-4});
    assert_true(small >= 2.0 * beta && large > small + 2.0 && large < 25.0);
    assert_true(4.0 * large == floor(4.0 * large));
    const double sky =
        core_of(&(sample){.side = 64, .count = 128, .scale = 4.0, .sigma = 1e-4, .sky = 1000.0});
    assert_true(sky == large);
    const double noisy = core_of(&(sample){.side = 64, .count = 128, .scale = 4.0, .sigma = 0.1});
    assert_true(noisy >= large && noisy < large + 5.0);
}

static void one_star(double *galaxy, int stamp) {
    for (int i = 0; stamp == 40 && i < SIDE * SIDE; i++)
        galaxy[i] += 1e4 * exp(-hypot(i % SIDE - 31.5, i / SIDE - 31.5) / 8.0);
}

static void one_hot_pixel(double *galaxy, int stamp) {
    if (stamp == 40)
        galaxy[20 * SIDE + 10] += 1e4;
}

static void one_not_finite(double *galaxy, int stamp) {
    if (stamp == 40)
        galaxy[5] = NAN;
}

static void test_nothing_decides_alone(void **state) {
    (void)state;
    sample s = {.side = SIDE, .count = 256, .scale = 3.0, .sigma = 0.02};
    const double clean = core_of(&s);
    void (*const spoilers[])(double *, int) = {one_star, one_hot_pixel, one_not_finite};
    for (int i = 0; i < 3; i++) {
        s.spoil = spoilers[i];
        assert_near(core_of(&s), clean, 0.75, 1.0, "core");
    }
}

/* Where nothing can be told, or nothing fits, there is no core. */
static void test_no_core(void **state) {
    (void)state;
    assert_true(isnan(core_of(&(sample){.side = 64, .count = 63, .scale = 3.0, .sigma = 1e-4})));
    assert_true(isnan(core_of(&(sample){.side = 64, .count = 128, .scale = 3.0, .sigma = 50.0})));
    assert_true(isnan(core_of(&(sample){.side = 20, .count = 128, .scale = 4.0, .sigma = 1e-4})));
    assert_true(isnan(core_of(&(sample){.side = 12, .count = 128, .scale = 2.0, .sigma = 1e-4})));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_response),
        cmocka_unit_test(test_core_follows_size),
        cmocka_unit_test(test_nothing_decides_alone),
        cmocka_unit_test(test_no_core),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
