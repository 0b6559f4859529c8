/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The law of masks: with the same galaxies and noise, the shear is the same with defects and
 * neighbours, once these are masked and filled, as without. */
#include "chip_fixture.h"
#include "pair.h"
#include "test.h"

#include "shear/arrays.h"
#include "shear/stamp.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ACROSS = 18, PITCH = 120, SIDE = ACROSS * PITCH, N = ACROSS * ACROSS, STAMP = 48 };
enum { PIXELS = STAMP * STAMP, GROUPS = 6, PSF_SIDE = 25, REACH = 20 };
static const double R_PSF = 1.5;
static const double SIGMA = 1.0;
static const double ISOPHOTE = 1.5; /* in SIGMA */
static const double G[2] = {0.03, -0.02};

/* A round Gaussian profile, or a sum of three that is nearly exponential. */
typedef struct profile {
    int n;
    double weight[3], variance[3];
} profile;
static const profile profiles[2] = {
    {1, {1.0}, {4.0}},
    {3, {0.3, 0.5, 0.2}, {1.0, 3.5, 9.0}},
};

typedef struct galaxy {
    double x, y, peak;
    double e1, e2; /* of its matrix of second moments: 1 + e1, 1 - e1, e2 */
    const profile *profile;
} galaxy;

typedef struct scene {
    int n;
    galaxy all[2 * N]; /* N that are measured, and their neighbours */
    double r_gal[N];
} scene;

/* Twice the radius with half of the light, PSF included, of a round galaxy. */
static double r_gal_of(const profile *p) {
    double r = 0.0;
    double outside = 1.0;
    for (; outside > 0.5; r += 0.01) {
        outside = 0.0;
        for (int k = 0; k < p->n; k++)
            outside += p->weight[k] * exp(-0.5 * r * r / (p->variance[k] + R_PSF * R_PSF));
    }
    return 2.0 * r;
}

/* Every two galaxies are one and the same, turned by 90 degrees. */
static void scene_init(scene *s, bool crowded, uint64_t seed) {
    s->n = N;
    for (int i = 0; i < N; i++) {
        galaxy *g = &s->all[i];
        const double phi = 6.283185307179586 * uniform(&seed);
        const double e = 0.4 * uniform(&seed);
        const double peak = 8.0 + 12.0 * uniform(&seed);
        g->e1 = i % 2 == 0 ? e * cos(phi) : -s->all[i - 1].e1;
        g->e2 = i % 2 == 0 ? e * sin(phi) : -s->all[i - 1].e2;
        g->peak = i % 2 == 0 ? peak : s->all[i - 1].peak;
        g->profile = &profiles[i / 2 % 2];
        g->x = PITCH * (i % ACROSS + 0.5) + uniform(&seed);
        g->y = PITCH * (double)(i / ACROSS) + 0.5 * PITCH + uniform(&seed);
        s->r_gal[i] = r_gal_of(g->profile);
        const double angle = 6.283185307179586 * uniform(&seed);
        const double distance = 12.0 + 20.0 * uniform(&seed);
        if (crowded) {
            s->all[s->n] = s->all[i / 3];
            s->all[s->n].x = g->x + distance * cos(angle);
            s->all[s->n++].y = g->y + distance * sin(angle);
        }
    }
}

/* Value of a galaxy's Gaussian k at (dx, dy), sheared by (g1, g2) and convolved with the PSF. */
static double value_of(const galaxy *o, int k, double g1, double g2, double dx, double dy) {
    const double s = o->profile->variance[k];
    const double a[2][2] = {{1.0 + g1, g2}, {g2, 1.0 - g1}};
    const double q[2][2] = {{s * (1.0 + o->e1), s * o->e2}, {s * o->e2, s * (1.0 - o->e1)}};
    double c[2][2] = {{R_PSF * R_PSF, 0.0}, {0.0, R_PSF * R_PSF}};
    for (int i = 0; i < 2; i++) {
        for (int j = 0; j < 2; j++) {
            for (int m = 0; m < 4; m++)
                c[i][j] += a[i][m / 2] * q[m / 2][m % 2] * a[j][m % 2];
        }
    }
    const double det = c[0][0] * c[1][1] - c[0][1] * c[0][1];
    const double r2 = (c[1][1] * dx * dx - 2.0 * c[0][1] * dx * dy + c[0][0] * dy * dy) / det;
    return o->profile->weight[k] * 6.25 / sqrt(det) * exp(-0.5 * r2);
}

/* Draw a galaxy; mark its pixels by the isophote of the unsheared one. */
static void draw(chip_pixels *c, const galaxy *o, int32_t owner, double g1, double g2) {
    for (int y = (int)o->y - REACH; y <= (int)o->y + REACH; y++) {
        for (int x = (int)o->x - REACH; x <= (int)o->x + REACH; x++) {
            double value = 0.0;
            double round = 0.0;
            for (int k = 0; k < o->profile->n; k++) {
                value += o->peak * value_of(o, k, g1, g2, x - o->x, y - o->y);
                round += o->peak * value_of(o, k, 0.0, 0.0, x - o->x, y - o->y);
            }
            const size_t at = (size_t)y * SIDE + (size_t)x;
            c->value[at] += value;
            if (round > ISOPHOTE * SIGMA)
                c->owner[at] = owner;
        }
    }
}

/* White noise, or noise that its neighbours share. */
static chip_pixels *noise_new(bool correlated) {
    chip_pixels *c = chip_new(SIDE, SIDE, SIGMA, 77);
    for (int i = 0; correlated && i + SIDE + 1 < SIDE * SIDE; i++)
        c->value[i] =
            0.5 * (c->value[i] + c->value[i + 1] + c->value[i + SIDE] + c->value[i + SIDE + 1]);
    return c;
}

/* Pieces of bad columns, and holes like those of cosmic rays. */
static void damage(chip_pixels *c) {
    uint64_t seed = 5;
    for (int i = 0; i < N; i++) {
        chip_damage(c, (int)(SIDE * uniform(&seed)), (int)((SIDE - PITCH) * uniform(&seed)), 1,
                    PITCH, PIXEL_BAD);
    }
    for (int i = 0; i < SIDE * SIDE / 6000; i++) {
        chip_damage(c, (int)((SIDE - 4) * uniform(&seed)), (int)((SIDE - 4) * uniform(&seed)), 4, 2,
                    i % 2 == 0 ? PIXEL_BAD : PIXEL_SATURATED);
    }
}

/* The stamps of one chip. */
typedef struct stamps {
    double *galaxy, *noise; /* [N][PIXELS] */
    int32_t flags[N];
    double filled;
    shear_row rows[N];
} stamps;

static void cut_all(stamps *s, const scene *drawn, const chip_pixels *noise, bool damaged,
                    double g1, double g2) {
    chip_pixels *c = chip_new(SIDE, SIDE, 0.0, 1);
    memcpy(c->value, noise->value, (size_t)SIDE * SIDE * sizeof(double));
    for (int i = 0; i < drawn->n; i++)
        draw(c, &drawn->all[i], i + 1, g1, g2);
    if (damaged)
        damage(c);
    cutter_options options = chip_options(c);
    options.stamp = STAMP;
    options.r_psf_px = R_PSF;
    cut_fixture f;
    cut_init(&f, c, NULL, &options);
    s->galaxy = calloc((size_t)N * PIXELS, sizeof(double));
    s->noise = calloc((size_t)N * PIXELS, sizeof(double));
    s->filled = 0.0;
    for (int i = 0; i < N; i++) {
        const galaxy *o = &drawn->all[i];
        s->flags[i] = (int32_t)cut_at(&f, o->x, o->y, drawn->r_gal[i], i);
        memcpy(s->galaxy + (size_t)i * PIXELS, f.pair.galaxy, PIXELS * sizeof(double));
        memcpy(s->noise + (size_t)i * PIXELS, f.pair.noise, PIXELS * sizeof(double));
        s->filled += f.pair.filled / N;
    }
    cut_deinit(&f);
    chip_free(c);
}

static void stamps_deinit(stamps *s) {
    free(s->galaxy);
    free(s->noise);
}

static void measure(stamps *s) {
    double psf[PSF_SIDE * PSF_SIDE];
    for (int i = 0; i < PSF_SIDE * PSF_SIDE; i++) {
        const double x = i % PSF_SIDE - PSF_SIDE / 2;
        const double y = (double)(i / PSF_SIDE) - PSF_SIDE / 2;
        psf[i] = exp(-0.5 * (x * x + y * y) / (R_PSF * R_PSF));
    }
    const shear_arrays arrays = {.n_stamps = N,
                                 .geometry = {.nx = STAMP,
                                              .ny = STAMP,
                                              .psf_nx = PSF_SIDE,
                                              .psf_ny = PSF_SIDE,
                                              .psf_oversample = 1},
                                 .galaxy = {.pixels = s->galaxy},
                                 .noise = {.pixels = s->noise},
                                 .psf = {.pixels = psf},
                                 .mask = s->flags};
    const shear_arrays_options options = {.rows = s->rows};
    shear_settings settings;
    shear_result result;
    shear_error err;
    shear_settings_init(&settings);
    assert_int_equal(shear_settings_set(&settings, "filter", "none", &err), SHEAR_OK);
    assert_int_equal(shear_settings_set(&settings, "artefacts", "keep", &err), SHEAR_OK);
    if (shear_measure_arrays(&result, &arrays, &settings, &options, &err) != SHEAR_OK)
        fail_msg("%s", err.message);
}

/* Clean chips at +g and -g, and masked ones. */
enum { CHIPS = 4 };

/* Return whether a galaxy and its turned copy are good in all chips. */
static bool is_good(const stamps chips[CHIPS], int i) {
    uint32_t flags = 0;
    for (int k = 0; k < CHIPS; k++)
        flags |= chips[k].rows[i].flags | chips[k].rows[i ^ 1].flags;
    return flags == 0;
}

/* Set m of both components, from the same galaxies at +g and -g, of a group (-1: all). Return the
 * number of galaxies. */
static int m_of(const stamps chips[CHIPS], int first, int group, double m[2]) {
    double g[2][2];
    int n = 0;
    for (int k = 0; k < 2; k++) {
        double sum[3] = {0.0};
        n = 0;
        for (int i = 0; i < N; i++) {
            if ((group >= 0 && i / 2 % GROUPS != group) || !is_good(chips, i))
                continue;
            sum[0] += chips[first + k].rows[i].n1;
            sum[1] += chips[first + k].rows[i].n2;
            sum[2] += chips[first + k].rows[i].d;
            n++;
        }
        g[k][0] = sum[0] / sum[2];
        g[k][1] = sum[1] / sum[2];
    }
    for (int k = 0; k < 2; k++)
        m[k] = (g[0][k] - g[1][k]) / (2.0 * G[k]) - 1.0;
    return n;
}

/* Compare the difference of m that masks make with its error, from groups of galaxies. */
static void compare(const stamps chips[CHIPS]) {
    double sum2[2] = {0.0};
    double m[2];
    double reference[2];
    const int n = m_of(chips, 2, -1, m);
    m_of(chips, 0, -1, reference);
    const double all[2] = {m[0] - reference[0], m[1] - reference[1]};
    for (int group = 0; group < GROUPS; group++) {
        assert_true(m_of(chips, 2, group, m) > 4);
        m_of(chips, 0, group, reference);
        for (int k = 0; k < 2; k++)
            sum2[k] += pow(m[k] - reference[k] - all[k], 2);
    }
    for (int k = 0; k < 2; k++) {
        const double error = sqrt(sum2[k] / (GROUPS * (GROUPS - 1)));
        print_message("m%d %+.5f (%.5f) by masks; %d of %d, %.3f filled\n", k + 1, all[k], error, n,
                      N, chips[2].filled);
        assert_true(fabs(all[k]) < 3.0 * error + 0.001);
        assert_true(error < 0.01);
    }
}

static void check(bool crowded, bool damaged, bool correlated) {
    static scene alone;
    static scene others;
    static stamps chips[CHIPS];
    scene_init(&alone, false, 42);
    scene_init(&others, crowded, 42);
    chip_pixels *noise = noise_new(correlated);
    for (int k = 0; k < CHIPS; k++) {
        const double sign = k % 2 == 0 ? 1.0 : -1.0;
        const bool masked = k >= 2;
        cut_all(&chips[k], masked ? &others : &alone, noise, masked && damaged, sign * G[0],
                sign * G[1]);
        measure(&chips[k]);
    }
    compare(chips);
    for (int k = 0; k < CHIPS; k++)
        stamps_deinit(&chips[k]);
    chip_free(noise);
}

static void test_defects(void **state) {
    (void)state;
    check(false, true, false);
}

static void test_neighbours(void **state) {
    (void)state;
    check(true, false, false);
}

static void test_both_in_correlated_noise(void **state) {
    (void)state;
    check(true, true, true);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_defects),
        cmocka_unit_test(test_neighbours),
        cmocka_unit_test(test_both_in_correlated_noise),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
