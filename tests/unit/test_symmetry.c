/* SPDX-License-Identifier: GPL-3.0-or-later */
/* PDF symmetrization: the response in closed form, fields whose shear is known, the same bits in
 * any order, correct errors. */
#include "gaussian.h"
#include "pair.h"
#include "test.h"

#include "measure/photometry.h"
#include "measure/score.h"
#include "measure/symmetry.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double true_g1 = 0.02;
static const double true_g2 = -0.03;

static shear_symmetry *new_terms(void) {
    shear_symmetry *s = NULL;
    assert_int_equal(shear_symmetry_new(&s, NULL), SHEAR_OK);
    return s;
}

static shear_symmetry *terms_of(const shear_row *rows, int n) {
    shear_symmetry *s = new_terms();
    for (int i = 0; i < n; i++)
        assert_int_equal(shear_symmetry_add(s, &rows[i], 1.5, NULL), SHEAR_OK);
    return s;
}

static shear_result solve(const shear_symmetry *s, int bins) {
    shear_result r = {.jackknife = 7, .n_used = 3};
    assert_int_equal(shear_symmetry_solve(s, bins, &r, NULL), SHEAR_OK);
    assert_int_equal(r.estimator, SHEAR_ESTIMATOR_PDF_SYM);
    assert_true(r.jackknife == 0 && r.n_used == 3);
    return r;
}

static shear_result solve_rows(const shear_row *rows, int n, int bins) {
    shear_symmetry *s = terms_of(rows, n);
    const shear_result r = solve(s, bins);
    shear_symmetry_free(s);
    return r;
}

static void assert_same(const shear_result *a, const shear_result *b) {
    assert_true(a->valid && b->valid);
    assert_true(a->g1 == b->g1 && a->g2 == b->g2 && a->g1_err == b->g1_err &&
                a->g2_err == b->g2_err && a->cov12 == b->cov12);
}

/* Gaussian scatter: the sum of twelve uniform numbers. */
static double scatter(uint64_t *seed) {
    double sum = -6.0;
    for (int i = 0; i < 12; i++)
        sum += uniform(seed);
    return sum;
}

/* Galaxies of scattered ellipticity, spin-4 terms and flux over a factor of `range`. */
static void draw_rows(shear_row *rows, int n, double range, uint64_t seed) {
    for (int i = 0; i < n; i++) {
        const double d = pow(range, 2.0 * uniform(&seed));
        const double u = 0.2 * d * scatter(&seed) / (-0.5 * 1.5 * 1.5);
        const double v = 0.2 * d * scatter(&seed) / (-2.0 * 1.5 * 1.5);
        const double up = -0.5 * 1.5 * 1.5 * u;
        const double vp = -2.0 * 1.5 * 1.5 * v;
        rows[i] = (shear_row){.n1 = 0.3 * d * scatter(&seed) + true_g1 * (d + up) + true_g2 * vp,
                              .n2 = 0.3 * d * scatter(&seed) + true_g2 * (d - up) + true_g1 * vp,
                              .d = d,
                              .u = u,
                              .v = v,
                              .weight = 1.0};
    }
}

/* The image of a Gaussian galaxy of covariance c, lensed and convolved with the PSF. */
static gaussian lensed(const gaussian *c, const gaussian *psf, double g1, double g2) {
    const double a = 1.0 + g1;
    const double b = 1.0 - g1;
    gaussian out = {.xx = a * a * c->xx + 2.0 * a * g2 * c->xy + g2 * g2 * c->yy + psf->xx,
                    .yy = b * b * c->yy + 2.0 * b * g2 * c->xy + g2 * g2 * c->xx + psf->yy,
                    .xy = a * g2 * c->xx + (a * b + g2 * g2) * c->xy + b * g2 * c->yy + psf->xy};
    const double flux = 5.0 * (1.0 - g1 * g1 - g2 * g2); /* surface brightness is conserved */
    out.amplitude = flux / sqrt(out.xx * out.yy - out.xy * out.xy);
    return out;
}

/* dN/dg by differences, of moments in closed form, against D + U', D - U' and V'. */
static void test_response(void **state) {
    (void)state;
    static const double h = 1e-4;
    static const double beta = 1.9;
    const gaussian psf = {.amplitude = 1.0, .xx = 2.4, .yy = 2.0, .xy = 0.3};
    const gaussian galaxies[] = {{.xx = 5.0, .yy = 5.0, .xy = 0.0},
                                 {.xx = 9.0, .yy = 3.0, .xy = 1.0},
                                 {.xx = 4.0, .yy = 6.0, .xy = -2.5}};
    for (int i = 0; i < 3; i++) {
        shear_row rows[5];
        for (int k = 0; k < 5; k++) { /* +g1, -g1, +g2, -g2, none */
            const double g = k == 4 ? 0.0 : k % 2 == 0 ? h : -h;
            const gaussian image = lensed(&galaxies[i], &psf, k < 2 ? g : 0.0, k >= 2 ? g : 0.0);
            rows[k] = gaussian_row(&image, &psf, beta);
            rows[k].weight = 1.0;
        }
        shear_symmetry *s = new_terms();
        assert_int_equal(shear_symmetry_add(s, &rows[4], beta, NULL), SHEAR_OK);
        const symmetry_terms *t = &s->stamps[0];
        assert_near((rows[0].n1 - rows[1].n1) / (2.0 * h), t->d + t->u, 1e-7, t->d, "N1, g1");
        assert_near((rows[2].n1 - rows[3].n1) / (2.0 * h), t->v, 1e-7, t->d, "N1, g2");
        assert_near((rows[2].n2 - rows[3].n2) / (2.0 * h), t->d - t->u, 1e-7, t->d, "N2, g2");
        assert_near((rows[0].n2 - rows[1].n2) / (2.0 * h), t->v, 1e-7, t->d, "N2, g1");
        shear_symmetry_free(s);
    }
}

/* Galaxies that are mirror images of each other: no scatter is left, whatever their flux, but for
 * the steps: over 0.1 sigma the few stamps that change bins count as much as the slope does. */
static void test_mirrored(void **state) {
    (void)state;
    enum { N = 400 };
    shear_row rows[2 * N];
    draw_rows(rows, N, 100.0, 1);
    for (int i = 0; i < N; i++) {
        shear_row *twin = &rows[N + i];
        const double up = -0.5 * 1.5 * 1.5 * rows[i].u;
        const double vp = -2.0 * 1.5 * 1.5 * rows[i].v;
        *twin = rows[i];
        twin->n1 = 2.0 * (true_g1 * (rows[i].d + up) + true_g2 * vp) - rows[i].n1;
        twin->n2 = 2.0 * (true_g2 * (rows[i].d - up) + true_g1 * vp) - rows[i].n2;
    }
    const shear_result r = solve_rows(rows, 2 * N, 0);
    assert_true(r.valid);
    assert_near(r.g1, true_g1, 0.1, r.g1_err, "g1");
    assert_near(r.g2, true_g2, 0.1, r.g2_err, "g2");
}

/* One galaxy that outshines all others, where the ratio of means would be 0.4: it counts as one of
 * a thousand, by at most about 3 sigma / sqrt(1000), and so does the one whose place it takes. */
static void test_bright_one(void **state) {
    (void)state;
    enum { N = 1000 };
    shear_row rows[N];
    draw_rows(rows, N, 1.0, 2);
    const shear_result without = solve_rows(rows, N, 0);
    rows[0].n1 = 4e5;
    rows[0].n2 = -5e5;
    rows[0].d = 1e6;
    const shear_result with = solve_rows(rows, N, 0);
    assert_near(with.g1, without.g1, 0.2, without.g1_err, "g1");
    assert_near(with.g2, without.g2, 0.2, without.g2_err, "g2");
}

/* Stamps shuffled, split, joined and sent as bytes: the same bits. */
static void test_any_order(void **state) {
    (void)state;
    enum { N = 1500 };
    shear_row rows[N];
    uint64_t seed = 4;
    draw_rows(rows, N, 10.0, 3);
    for (int i = 0; i < N; i++)
        rows[i].weight = 0.2 + uniform(&seed);
    const shear_result expected = solve_rows(rows, N, 0);
    for (int trial = 0; trial < 4; trial++) {
        for (int i = N - 1; i > 0; i--) {
            const int k = (int)(uniform(&seed) * (i + 1));
            const shear_row row = rows[i];
            rows[i] = rows[k];
            rows[k] = row;
        }
        unsigned char bytes[N * SHEAR_SYMMETRY_BYTES];
        shear_symmetry *head = terms_of(rows, 700);
        shear_symmetry *tail = terms_of(rows + 700, N - 700);
        shear_symmetry *read = new_terms();
        assert_int_equal(shear_symmetry_join(head, tail, 0, NULL), SHEAR_OK);
        assert_int_equal(shear_symmetry_count(head), N);
        shear_symmetry_bytes(head, 0, bytes);
        assert_int_equal(shear_symmetry_add_bytes(read, bytes, 300 * SHEAR_SYMMETRY_BYTES, NULL),
                         SHEAR_OK);
        shear_symmetry_bytes(head, 300, bytes);
        assert_int_equal(
            shear_symmetry_add_bytes(read, bytes, (N - 300) * SHEAR_SYMMETRY_BYTES, NULL),
            SHEAR_OK);
        const shear_result r = solve(head, 0);
        const shear_result again = solve(read, 0);
        assert_same(&r, &expected);
        assert_same(&again, &expected);
        shear_symmetry_free(head);
        shear_symmetry_free(tail);
        shear_symmetry_free(read);
    }
}

/* No weight is as good as not there, and only ratios of weights count. */
static void test_weights(void **state) {
    (void)state;
    enum { N = 800 };
    shear_row rows[N];
    draw_rows(rows, N, 10.0, 5);
    const shear_result half = solve_rows(rows, N / 2, 0);
    const shear_result all = solve_rows(rows, N, 0);
    for (int i = 0; i < N; i++)
        rows[i].weight = 3.5;
    const shear_result heavy = solve_rows(rows, N, 0);
    assert_same(&heavy, &all);
    for (int i = N / 2; i < N; i++)
        rows[i].weight = 0.0;
    const shear_result first = solve_rows(rows, N, 0);
    assert_same(&first, &half);
    for (int i = N / 2; i < N; i++) {
        rows[i].weight = 0.35; /* between the two */
    }
    const shear_result between = solve_rows(rows, N, 0);
    assert_true((between.g1 - half.g1) * (between.g1 - all.g1) < 0.0);
    for (int i = 0; i < N; i++)
        rows[i].weight = 0.0;
    assert_false(solve_rows(rows, N, 0).valid);
}

/* Noise in all terms, that of the square root of a galaxy's power. */
static void add_noise(shear_row *rows, int n, double noise, uint64_t seed) {
    for (int i = 0; i < n; i++) {
        const double part = noise * sqrt(rows[i].d);
        rows[i].n1 += part * scatter(&seed);
        rows[i].n2 += part * scatter(&seed);
        rows[i].d += part * scatter(&seed);
        rows[i].u += part * scatter(&seed) / (-0.5 * 1.5 * 1.5);
        rows[i].v += part * scatter(&seed) / (-2.0 * 1.5 * 1.5);
    }
}

/* Few stamps, where a bin's response is mostly noise: pulls are 1 wide within 0.05, and the scatter
 * is within 4 percent of `best` / sqrt(n). */
static void check_few(double range, double noise, double light, double best) {
    enum { N = 200, FIELDS = 1000 };
    shear_row rows[N];
    double squares = 0.0;
    double pull = 0.0;
    double scatter2 = 0.0;
    uint64_t seed = 77;
    for (int f = 0; f < FIELDS; f++) {
        draw_rows(rows, N, range, (uint64_t)(5000 + f));
        add_noise(rows, N, noise, (uint64_t)(9000 + f));
        for (int i = 0; i < N; i++)
            rows[i].weight = 1.0 - light * uniform(&seed);
        const shear_result r = solve_rows(rows, N, 0);
        assert_true(r.valid);
        const double d1 = r.g1 - true_g1;
        const double d2 = r.g2 - true_g2;
        const double p1 = d1 / r.g1_err;
        const double p2 = d2 / r.g2_err;
        squares += p1 * p1 + p2 * p2;
        pull += p1 + p2;
        scatter2 += d1 * d1 + d2 * d2;
    }
    const double m = 2.0 * FIELDS;
    assert_near(sqrt(squares / m), 1.0, 0.05 + 2.0 / sqrt(2.0 * m), 1.0, "width of the pulls");
    assert_near(pull / m, 0.0, 4.0, 1.0 / sqrt(m), "mean pull");
    assert_true(sqrt(scatter2 / m * N) < best * (1.04 + 2.0 / sqrt(2.0 * m)));
}

static void test_few(void **state) {
    (void)state;
    check_few(1.0, 0.0, 0.0, 0.302);
    check_few(10.0, 0.0, 0.0, 0.350);
    check_few(1.0, 0.3, 0.0, 0.43);
    check_few(10.0, 0.6, 0.0, 0.43);
    check_few(1.0, 0.3, 0.8, 0.46);
}

/* A curve is found from responses that lie on it, whatever the bins' sizes; empty bins and too few
 * bins leave out what nobody tells. */
static void test_curve(void **state) {
    (void)state;
    enum { BINS = 10 };
    double fall[BINS];
    double size[BINS];
    double score[BINS];
    for (int i = 0; i < BINS; i++) {
        const double t = (i + 0.5) / BINS;
        size[i] = 3.0 + 7.0 * (i % 4);
        fall[i] = size[i] * (2.0 * t - 0.7 * t * t + 0.4 * t * t * t);
    }
    score_curve(fall, size, BINS, 3, score);
    for (int i = 0; i < BINS; i++)
        assert_near(score[i], fall[i] / size[i], 1e-12, 1.0, "score");
    score_curve(fall, size, 1, 3, score);
    assert_near(score[0], fall[0] / size[0], 1e-12, 1.0, "one bin");
    for (int i = 0; i < BINS; i++)
        size[i] = fall[i] = i == 4 ? 2.0 : 0.0;
    score_curve(fall, size, BINS, 2, score);
    assert_near(score[4], 1.0, 1e-12, 1.0, "one bin that is not empty");
    score_curve(fall, size, 4, 2, score);
    assert_true(score[0] == 0.0 && score[3] == 0.0);
}

/* Scatter of many fields against the errors: pulls of width 1, no bias, no correlation; and the
 * Gaussian case loses next to nothing against the best there is, 0.3 / sqrt(n). */
static void check_pulls(double range, double best) {
    enum { N = 2000, FIELDS = 400 };
    static shear_row rows[N];
    double squares = 0.0;
    double pull = 0.0;
    double error = 0.0;
    double correlation = 0.0;
    for (int f = 0; f < FIELDS; f++) {
        draw_rows(rows, N, range, (uint64_t)(1000 + f));
        const shear_result r = solve_rows(rows, N, 0);
        const double p1 = (r.g1 - true_g1) / r.g1_err;
        const double p2 = (r.g2 - true_g2) / r.g2_err;
        assert_true(r.valid);
        squares += p1 * p1 + p2 * p2;
        pull += p1 + p2;
        error += r.g1_err + r.g2_err;
        correlation += r.cov12 / (r.g1_err * r.g2_err);
    }
    const double m = 2.0 * FIELDS;
    assert_near(squares / m, 1.0, 4.0, sqrt(2.0 / m), "squared width of the pulls");
    assert_near(pull / m, 0.0, 4.0, 1.0 / sqrt(m), "mean pull");
    assert_near(correlation / FIELDS, 0.0, 4.0, 1.0 / sqrt((double)N * FIELDS), "correlation");
    assert_true(error / m * sqrt((double)N) < best);
}

static void test_pulls(void **state) {
    (void)state;
    check_pulls(1.0, 0.3 * 1.03);
    check_pulls(10.0, 0.3 * 1.2);
}

/* Two components that scatter together have a covariance. */
static void test_covariance(void **state) {
    (void)state;
    enum { N = 4000 };
    static shear_row rows[N];
    uint64_t seed = 8;
    draw_rows(rows, N, 1.0, 6);
    for (int i = 0; i < N; i++) { /* correlation 0.6 */
        const double common = scatter(&seed);
        rows[i].n1 = true_g1 + 0.1 * (0.8 * scatter(&seed) + 0.6 * common);
        rows[i].n2 = true_g2 + 0.1 * common;
        rows[i].u = rows[i].v = 0.0;
    }
    const shear_result r = solve_rows(rows, N, 0);
    assert_near(r.cov12 / (r.g1_err * r.g2_err), 0.6, 0.05, 1.0, "correlation");
}

static void test_few_and_strange(void **state) {
    (void)state;
    enum { N = 64 };
    shear_row rows[N];
    draw_rows(rows, N, 1.0, 7);
    assert_false(solve_rows(rows, 0, 0).valid);
    assert_false(solve_rows(rows, 15, 0).valid);
    assert_true(isnan(solve_rows(rows, 15, 0).g1) && isnan(solve_rows(rows, 15, 0).cov12));
    assert_true(solve_rows(rows, 16, 0).valid);
    for (int i = 0; i < N; i++) { /* round and equal: all scatter is gone */
        rows[i].n1 = true_g1;
        rows[i].n2 = true_g2;
        rows[i].d = 1.0;
        rows[i].u = rows[i].v = 0.0;
    }
    const shear_result round = solve_rows(rows, N, 0);
    assert_true(!round.valid || fabs(round.g1 - true_g1) < 1e-5);
    for (int i = 0; i < N; i++)
        rows[i].d = -1.0;
    assert_false(solve_rows(rows, N, 0).valid);
    for (int i = 0; i < N; i++) {
        rows[i].n1 = 5.0; /* no |g| < 1 */
        rows[i].d = 1.0;
    }
    assert_false(solve_rows(rows, N, 0).valid);
}

static void test_refusals(void **state) {
    (void)state;
    shear_error err = {0};
    shear_result r = {0};
    shear_row row = {.n1 = 1.0, .d = 1.0, .weight = 1.0};
    shear_symmetry *s = new_terms();
    row.flags = SHEAR_FLAG_MASKED;
    assert_int_equal(shear_symmetry_add(s, &row, 1.5, &err), SHEAR_OK);
    row.flags = 0;
    row.n2 = 1e200;
    assert_int_equal(shear_symmetry_add(s, &row, 1.5, &err), SHEAR_OK);
    assert_int_equal(shear_symmetry_count(s), 0);
    row.n2 = 0.0;
    assert_int_equal(shear_symmetry_add(s, &row, 1.5, &err), SHEAR_OK);
    unsigned char bytes[2 * SHEAR_SYMMETRY_BYTES];
    shear_symmetry_bytes(s, 0, bytes);
    assert_int_equal(shear_symmetry_add_bytes(s, bytes, SHEAR_SYMMETRY_BYTES - 1, &err),
                     SHEAR_E_FORMAT);
    memset(bytes, 0xff, 8); /* a NaN */
    assert_int_equal(shear_symmetry_add_bytes(s, bytes, SHEAR_SYMMETRY_BYTES, &err),
                     SHEAR_E_FORMAT);
    assert_int_equal(shear_symmetry_count(s), 1);
    assert_int_equal(shear_symmetry_solve(s, SHEAR_SYMMETRY_MAX_BINS + 1, &r, &err),
                     SHEAR_E_SETTING);
    assert_int_equal(shear_symmetry_solve(s, -1, &r, &err), SHEAR_E_SETTING);
    shear_symmetry_free(s);
    shear_symmetry_free(NULL);
}

/* The cross terms are those of |F + N|^2 - |F - N|^2 = 4 Re(F N*), F and N the stamps of the pair
 * less the mean of the latter, for interpolations that are linear. */
static void check_cross(const char *method, int nx, int ny, const char *shot_noise,
                        double background) {
    static const double a = 0.3;
    pair p, sum;
    shear_plan_info info;
    pair_init(&p, nx, ny, 21, 21, 1);
    pair_init(&sum, nx, ny, 21, 21, 1);
    pair_draw(&p, 1.4, 5);
    pair_draw(&sum, 1.4, 5);
    pair *const both[] = {&p, &sum};
    for (int i = 0; i < 2; i++) {
        pair_set(both[i], "interpolation", method);
        pair_set(both[i], "core", "5");
    }
    pair_set(&p, "estimator", "pdf-sym-cross");
    pair_set(&sum, "background", "keep"); /* it has lost it below */
    pair_set(&p, "shot-noise", shot_noise);
    const sky_level level = photometry_level(p.noise, nx, ny, p.galaxy);
    for (int i = 0; i < nx * ny; i++) {
        sum.galaxy[i] = (p.galaxy[i] - level.mean) + (p.noise[i] - level.own);
        sum.noise[i] = (p.galaxy[i] - level.mean) - (p.noise[i] - level.own);
        p.galaxy[i] += background;
        p.noise[i] += background;
    }
    const shear_row row = pair_measure_info(&p, &info);
    const shear_row c = pair_measure(&sum);
    const double lower =
        info.beta_px * info.beta_px - info.r_psf_px * info.r_psf_px * (1.0 + a * a) / (2.0 * a * a);
    const double flatter = lower / (info.beta_px * info.beta_px);
    const double scale = fabs(row.d) + fabs(row.m4);
    assert_true(fabs(row.cross_n1) > 1e-6 * scale);
    assert_near(row.cross_n1, 0.5 * a * c.n1, 1e-12, scale, "N1");
    assert_near(row.cross_n2, 0.5 * a * c.n2, 1e-12, scale, "N2");
    assert_near(row.cross_d, 0.5 * a * (c.m20 + c.m02 - 0.5 * lower * c.m4), 1e-12, scale, "D");
    assert_near(row.cross_u, 0.5 * a * flatter * c.u, 1e-12, scale, "U");
    assert_near(row.cross_v, 0.5 * a * flatter * c.v, 1e-12, scale, "V");
    pair_set(&p, "estimator", "pdf-sym");
    pair_set(&p, "background", "noise-mean");
    shear_row plain = pair_measure(&p);
    assert_true(plain.cross_n1 == 0.0 && plain.cross_d == 0.0 && plain.cross_v == 0.0);
    assert_true(plain.n1 == row.n1 && plain.d == row.d && plain.v == row.v);
    pair_deinit(&p);
    pair_deinit(&sum);
}

static void test_cross_terms(void **state) {
    (void)state;
    check_cross("none", 32, 32, "none", 0.0);
    check_cross("none", 17, 24, "plateau", 0.0);
    check_cross("spline", 20, 16, "none", 0.0);
    check_cross("none", 32, 32, "none", 40.0);
}

/* They enter the symmetry, and nothing else. */
static void test_cross_is_added(void **state) {
    (void)state;
    enum { N = 64 };
    shear_row rows[N];
    shear_row sums[N];
    draw_rows(rows, N, 1.0, 3);
    for (int i = 0; i < N; i++) {
        rows[i].cross_n1 = 0.1 * rows[(i + 1) % N].n1;
        rows[i].cross_n2 = 0.1 * rows[(i + 1) % N].n2;
        rows[i].cross_d = 0.1 * rows[(i + 2) % N].d;
        rows[i].cross_u = 0.1 * rows[(i + 3) % N].u;
        rows[i].cross_v = 0.1 * rows[(i + 3) % N].v;
        sums[i] = rows[i];
        sums[i].n1 += rows[i].cross_n1;
        sums[i].n2 += rows[i].cross_n2;
        sums[i].d += rows[i].cross_d;
        sums[i].u += rows[i].cross_u;
        sums[i].v += rows[i].cross_v;
        sums[i].cross_n1 = sums[i].cross_n2 = sums[i].cross_d = 0.0;
        sums[i].cross_u = sums[i].cross_v = 0.0;
    }
    const shear_result with = solve_rows(rows, N, 0);
    const shear_result by_hand = solve_rows(sums, N, 0);
    assert_true(with.g1 == by_hand.g1 && with.g2 == by_hand.g2 && with.g1_err == by_hand.g1_err);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_response),       cmocka_unit_test(test_cross_terms),
        cmocka_unit_test(test_cross_is_added), cmocka_unit_test(test_mirrored),
        cmocka_unit_test(test_bright_one),     cmocka_unit_test(test_any_order),
        cmocka_unit_test(test_weights),        cmocka_unit_test(test_pulls),
        cmocka_unit_test(test_covariance),     cmocka_unit_test(test_few_and_strange),
        cmocka_unit_test(test_refusals),       cmocka_unit_test(test_few),
        cmocka_unit_test(test_curve),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
