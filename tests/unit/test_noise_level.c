/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a pair shows of its noise: the noise's own moments, of one noise stamp or several, and the
 * power at high k. */
#include "gaussian.h"
#include "pair.h"
#include "test.h"

#include "shear/symmetry.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const int sides[][2] = {{16, 16}, {24, 17}, {31, 40}, {64, 64}, {9, 8}};
enum { N_SIDES = sizeof sides / sizeof sides[0] };

static void draw(pair *p, const int *side, const char *interpolation) {
    pair_init(p, side[0], side[1], 21, 21, 1);
    pair_draw(p, 1.6, 11);
    pair_set(p, "interpolation", interpolation);
}

static size_t pixels_of(const pair *p) {
    return (size_t)p->geometry.nx * (size_t)p->geometry.ny;
}

/* What a noise stamp has of its own is what it has as a galaxy stamp without noise. */
static void test_noise_has_its_own_moments(void **state) {
    (void)state;
    static const char *const methods[] = {"none", "log-bicubic"};
    for (int k = 0; k < 2 * N_SIDES; k++) {
        pair p;
        draw(&p, sides[k / 2], methods[k % 2]);
        const double beta2 = 1.9 * 1.9;
        pair_set(&p, "beta", "1.9");
        const shear_row both = pair_measure(&p);
        memcpy(p.galaxy, p.noise, pixels_of(&p) * sizeof *p.galaxy);
        memset(p.noise, 0, pixels_of(&p) * sizeof *p.noise);
        const shear_row quiet = pair_measure(&p); /* no noise; the galaxy's counts all the same */
        assert_true(quiet.noise_d == 0.0 && quiet.high_noise == 0.0);
        assert_near(quiet.high_galaxy, both.high_noise, 1e-12, both.high_noise, "galaxy");
        p.noise[0] = 1e-9;
        const shear_row alone = pair_measure(&p);
        assert_near(both.noise_n1, alone.n1, 1e-12, alone.d, "n1");
        assert_near(both.noise_n2, alone.n2, 1e-12, alone.d, "n2");
        assert_near(both.noise_d, alone.d, 1e-12, alone.d, "d");
        assert_near(both.noise_u, -0.5 * beta2 * alone.u, 1e-12, beta2 * alone.m4, "u");
        assert_near(both.noise_v, -2.0 * beta2 * alone.v, 1e-12, beta2 * alone.m4, "v");
        assert_near(both.high_noise, alone.high_galaxy, 1e-12, alone.high_galaxy, "high");
        assert_near(both.corner_noise, alone.corner_galaxy, 1e-12, alone.high_galaxy, "corner");
        assert_true((alone.high_galaxy > 0.0) == (k % 2 == 0)); /* interpolated: not looked at */
        pair_deinit(&p);
    }
}

/* A wave of mode (jx, jy) has all its power there: nx ny / 2 of it in a stamp of amplitude 1. */
static shear_row measure_wave(const int *side, int jx, int jy) {
    pair p;
    draw(&p, side, "none");
    for (int y = 0; y < side[1]; y++) {
        for (int x = 0; x < side[0]; x++) {
            p.galaxy[y * side[0] + x] =
                cos(2.0 * M_PI * ((double)jx * x / side[0] + (double)jy * y / side[1]));
            p.noise[y * side[0] + x] = 0.0;
        }
    }
    p.noise[0] = 1e-3; /* noise of a known power at every mode */
    const shear_row row = pair_measure(&p);
    pair_deinit(&p);
    return row;
}

/* Modes count that are 3/4 of Nyquist away from 0 or more, each once, Nyquist's own row and column
 * aside; and those beyond Nyquist are the corners. */
static void test_bands(void **state) {
    (void)state;
    for (int k = 0; k < 3; k++) {
        const int *side = sides[k];
        const double all = (double)side[0] * side[1];
        int n = 0;
        for (int jy = -(side[1] - 1) / 2; jy <= (side[1] - 1) / 2; jy++) {
            for (int jx = -(side[0] - 1) / 2; jx <= (side[0] - 1) / 2; jx++) {
                const double k2 = 4.0 * ((double)jx * jx / side[0] / side[0] +
                                         (double)jy * jy / side[1] / side[1]);
                n += k2 >= 9.0 / 16.0 - 1e-12;
            }
        }
        for (int jy = 0; jy <= (side[1] - 1) / 2; jy++) {
            for (int jx = 0; jx <= (side[0] - 1) / 2; jx++) {
                if (jx + jy == 0) {
                    continue; /* constant: flagged */
                }
                const shear_row row = measure_wave(side, jx, jy);
                const double k2 = 4.0 * ((double)jx * jx / side[0] / side[0] +
                                         (double)jy * jy / side[1] / side[1]);
                const double power = all * all / 2.0 / n / all;
                assert_near(row.high_galaxy, k2 >= 9.0 / 16.0 - 1e-12 ? power : 0.0, 1e-12, power,
                            "high");
                assert_near(row.corner_galaxy, k2 >= 1.0 - 1e-12 ? power : 0.0, 1e-12, power,
                            "corner");
                assert_near(row.high_noise, 1e-6 / all, 1e-12, 1e-6 / all, "one pixel");
            }
        }
    }
}

/* Noise stamps over a bright sky whose pixels are random multiples of `step`, up to `most` of them;
 * `narrow`: as a file of floats holds them. Is there noise in it? */
static bool is_noise(double sky, double step, int most, bool narrow) {
    pair p;
    uint64_t seed = 5;
    draw(&p, sides[1], "none");
    pair_set(&p, "artefacts", "keep");
    for (size_t i = 0; i < pixels_of(&p); i++) {
        const double pixel = sky + step * floor((most + 1) * uniform(&seed));
        p.noise[i] = narrow ? (double)(float)pixel : pixel;
    }
    const shear_row row = pair_measure(&p);
    pair_deinit(&p);
    assert_true((row.high_noise > 0.0) == (row.noise_d != 0.0));
    return row.high_noise > 0.0;
}

/* What rounding makes of constant pixels is no noise; what is above it counts. */
static void test_rounding_is_no_noise(void **state) {
    (void)state;
    const double narrow = ldexp(1.0, -10); /* what lies between floats at 10,000, and ... */
    const double wide = ldexp(1.0, -39);   /* ... doubles */
    assert_false(is_noise(1e4, 0.0, 1, false));
    assert_false(is_noise(1e4, wide, 5, false));
    assert_true(is_noise(1e4, wide, 500, false));
    assert_false(is_noise(1e4, narrow, 1, true));
    assert_false(is_noise(1e4, 0.2 * narrow, 10, true));
    assert_true(is_noise(1e4, narrow, 20, true));
    assert_true(is_noise(1e4, 0.2 * narrow, 10, false)); /* doubles hold it */
    assert_true(is_noise(0.0, 1.0, 1, true));            /* counts of photons */
    assert_true(is_noise(100.0, 1.0, 1, true));
}

/* Of large stamps not all rows of modes are read, but enough: a lone pixel has the same power at
 * each, and a wave counts in some of them, along each axis. */
static void test_bands_of_large_stamps(void **state) {
    (void)state;
    static const int large[][2] = {{96, 96}, {131, 70}, {64, 256}, {256, 256}};
    for (int k = 0; k < 4; k++) {
        const double all = (double)large[k][0] * large[k][1];
        pair p;
        draw(&p, large[k], "none");
        pair_set(&p, "artefacts", "keep");
        memset(p.galaxy, 0, pixels_of(&p) * sizeof *p.galaxy);
        memset(p.noise, 0, pixels_of(&p) * sizeof *p.noise);
        p.galaxy[1000] = 2.0;
        p.noise[77] = 1e-3;
        const shear_row row = pair_measure(&p);
        assert_near(row.high_galaxy, 4.0 / all, 1e-12, 4.0 / all, "galaxy");
        assert_near(row.high_noise, 1e-6 / all, 1e-12, 1e-6 / all, "noise");
        assert_true(row.corner_galaxy > 0.2 * row.high_galaxy);
        pair_deinit(&p);
        assert_true(measure_wave(large[k], large[k][0] / 2 - 2, 1).high_galaxy > 0.0);
        assert_true(measure_wave(large[k], 1, (large[k][1] - 1) / 2).high_galaxy > 0.0);
        assert_true(measure_wave(large[k], large[k][0] / 3, large[k][1] / 6).high_galaxy < 1e-20);
    }
}

/* Pairs whose galaxies have `planes` noise stamps each. */
enum { NX = 24, NY = 20, PIXELS = NX * NY, PAIRS = 2, MOST = 5 };
typedef struct scene {
    double galaxy[PAIRS][PIXELS], noise[PAIRS * MOST][PIXELS];
} scene;

static void scene_draw(scene *s, const pair *p) {
    uint64_t seed = 5;
    for (int i = 0; i < PAIRS * MOST; i++) {
        for (int k = 0; k < PIXELS; k++)
            s->noise[i][k] = uniform(&seed) - 0.5;
    }
    for (int i = 0; i < PAIRS; i++) {
        for (int k = 0; k < PIXELS; k++)
            s->galaxy[i][k] = p->galaxy[k] * (1.0 + 0.5 * i);
    }
}

/* Pair i with the first `planes` of its noise stamps, `all` of which lie together. */
static shear_row measure_pair(const shear_plan *plan, const double *galaxy, const double *noise,
                              int planes) {
    shear_row row;
    shear_workspace *ws = NULL;
    const shear_stamps stamps = {
        .count = 1, .nx = NX, .ny = NY, .galaxy = galaxy, .noise = noise, .noise_planes = planes};
    assert_int_equal(shear_workspace_new(&ws, plan, NULL), SHEAR_OK);
    assert_int_equal(shear_measure(plan, ws, &stamps, 0, &row, NULL), SHEAR_OK);
    assert_int_equal(row.flags, 0);
    shear_workspace_free(ws);
    return row;
}

/* Of pair i, measured with each of `planes` noise stamps alone: the means; and with the first. */
static shear_row mean_of_planes(const shear_plan *plan, const scene *s, int i, int planes,
                                shear_row *first) {
    shear_row mean = {0};
    for (int k = planes - 1; k >= 0; k--) {
        *first = measure_pair(plan, s->galaxy[i], s->noise[i * planes + k], 1);
        mean.d += first->d / planes;
        mean.n1 += first->n1 / planes;
        mean.noise_d += first->noise_d / planes;
        mean.noise_n1 += first->noise_n1 / planes;
        mean.noise_v += first->noise_v / planes;
        mean.high_noise += first->high_noise / planes;
        mean.corner_noise += first->corner_noise / planes;
    }
    return mean;
}

static void check_planes(const shear_plan *plan, const scene *s, int planes, bool background) {
    shear_row rows[PAIRS];
    const shear_stamps stamps = {.count = PAIRS,
                                 .nx = NX,
                                 .ny = NY,
                                 .galaxy = s->galaxy[0],
                                 .noise = s->noise[0],
                                 .noise_planes = planes};
    assert_int_equal(shear_measure_batch(plan, &stamps, 1, NULL, rows, NULL), SHEAR_OK);
    for (int i = 0; i < PAIRS; i++) {
        shear_row one;
        const shear_row mean = mean_of_planes(plan, s, i, planes, &one);
        const double d = fabs(one.d) + one.noise_d;
        /* the galaxy stamp loses the first noise stamp's mean only */
        const double wanted_d = background ? one.d + one.noise_d - mean.noise_d : mean.d;
        const double wanted_n1 = background ? one.n1 + one.noise_n1 - mean.noise_n1 : mean.n1;
        assert_int_equal(rows[i].flags, 0);
        assert_near(rows[i].noise_d, mean.noise_d, 1e-12, d, "noise d");
        assert_near(rows[i].noise_v, mean.noise_v, 1e-12, d, "noise v");
        assert_near(rows[i].d, wanted_d, 1e-12, d, "d");
        assert_near(rows[i].n1, wanted_n1, 1e-12, d, "n1");
        assert_near(rows[i].high_noise, mean.high_noise, 1e-12, mean.high_noise, "high");
        assert_near(rows[i].corner_noise, mean.corner_noise, 1e-12, mean.high_noise, "corner");
        assert_true(rows[i].high_galaxy == one.high_galaxy);
    }
}

/* Several noise stamps count as the mean of what each of them gives, wherever they lie: with any
 * settings, above any background, and where the first of them has no noise. */
static void test_planes_are_averaged(void **state) {
    (void)state;
    static const int side[2] = {NX, NY};
    static const char *const settings[][2] = {{"filter", "none"},
                                              {"core", "5"},
                                              {"shot-noise", "plateau"},
                                              {"noise-correction", "no"},
                                              {"interpolation", "bicubic"}};
    static scene s;
    for (int k = 0; k < 10; k++) {
        shear_plan *plan = NULL;
        pair p;
        draw(&p, side, "none");
        pair_set(&p, "artefacts", "keep");
        pair_set(&p, settings[k / 2][0], settings[k / 2][1]);
        scene_draw(&s, &p);
        for (int pixel = 0; pixel < PIXELS; pixel++) {
            s.noise[1][pixel] += 3.0; /* a brighter sky there */
            s.noise[0][pixel] = k % 2 == 0 ? s.noise[0][pixel] : 0.0;
        }
        assert_int_equal(shear_plan_new(&plan,
                                        &(shear_plan_request){.settings = &p.settings,
                                                              .geometry = p.geometry,
                                                              .psf = p.psf},
                                        NULL),
                         0);
        for (int planes = 1; planes <= MOST; planes++)
            check_planes(plan, &s, planes, k / 2 == 1);
        shear_plan_free(plan);
        pair_deinit(&p);
    }
}

/* The second plane of the second pair cannot be used: also where no other has any noise. */
static void test_every_plane_is_looked_at(void **state) {
    (void)state;
    static const int side[2] = {NX, NY};
    static scene s;
    for (int quiet = 0; quiet < 2; quiet++) {
        shear_plan *plan = NULL;
        shear_row rows[2];
        pair p;
        draw(&p, side, "none");
        scene_draw(&s, &p);
        if (quiet != 0)
            memset(s.noise, 0, sizeof s.noise);
        s.noise[3][7] = NAN;
        const shear_stamps stamps = {.count = 2,
                                     .nx = NX,
                                     .ny = NY,
                                     .galaxy = s.galaxy[0],
                                     .noise = s.noise[0],
                                     .noise_planes = 2};
        assert_int_equal(shear_plan_new(&plan,
                                        &(shear_plan_request){.settings = &p.settings,
                                                              .geometry = p.geometry,
                                                              .psf = p.psf},
                                        NULL),
                         0);
        assert_int_equal(shear_measure_batch(plan, &stamps, 1, NULL, rows, NULL), SHEAR_OK);
        assert_int_equal(rows[0].flags, 0);
        assert_int_equal(rows[1].flags, SHEAR_FLAG_NOISE_NOT_FINITE);
        shear_plan_free(plan);
        pair_deinit(&p);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_noise_has_its_own_moments),
        cmocka_unit_test(test_rounding_is_no_noise),
        cmocka_unit_test(test_bands),
        cmocka_unit_test(test_bands_of_large_stamps),
        cmocka_unit_test(test_planes_are_averaged),
        cmocka_unit_test(test_every_plane_is_looked_at),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
