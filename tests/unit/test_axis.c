/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Interpolation along one axis: splines against GSL's, what linear and cubic must reproduce, the
 * closing cell, broken lines. */
#include "gaussian.h"
#include "pair.h"
#include "test.h"

#include "base/cleanup.h"
#include "measure/axis.h"

#include <gsl/gsl_spline.h>
#include <math.h>
#include <string.h>

enum { MAX_N = 64, MAX_S = 16 };

/* One line through axis_slopes and axis_between_marks. */
static void expand(enum axis_kind kind, int n, int s, const double *f, bool marked, double *fine) {
    double e[MAX_N];
    axis ax;
    arena a = {.used = 1 << 18};
    CLEANUP(release_free) void *memory = arena_allocate(&a);
    axis_place(&ax, kind, n, s, &a);
    if (marked) {
        axis_slopes_marked(&ax, f, f, e, 1);
    } else {
        axis_slopes(&ax, f, e, 1, 1);
    }
    for (int i = 0; i < n * s; i++) {
        const axis_point *p = &ax.points[i];
        fine[i] = axis_between_marks(p, f[p->left], f[p->right], e[p->left], e[p->right]);
    }
}

/* Numbers of order 1, so that tolerances are absolute. */
static void draw_line(double *f, int n, uint64_t *seed) {
    for (int i = 0; i < n; i++)
        f[i] = 2.0 * uniform(seed) - 1.0;
}

/* GSL's natural spline through f[0..n), at the s n fine points of its n - 1 cells. */
static void gsl_fine(int n, int s, const double *f, double *fine) {
    double x[MAX_N];
    for (int i = 0; i < n; i++)
        x[i] = i;
    gsl_spline *spline =
        gsl_spline_alloc(n > 2 ? gsl_interp_cspline : gsl_interp_linear, (size_t)n);
    gsl_spline_init(spline, x, f, (size_t)n);
    for (int i = 0; i <= (n - 1) * s; i++)
        fine[i] = gsl_spline_eval(spline, (double)i / s, NULL);
    gsl_spline_free(spline);
}

static void test_spline_is_gsls(void **state) {
    (void)state;
    uint64_t seed = 1;
    for (int n = 2; n <= MAX_N; n = n < 12 ? n + 1 : n + 13) {
        for (int s = 1; s <= MAX_S; s *= 2) {
            double f[MAX_N];
            double fine[MAX_N * MAX_S];
            double expected[MAX_N * MAX_S];
            draw_line(f, n, &seed);
            expand(AXIS_SPLINE, n, s, f, false, fine);
            gsl_fine(n, s, f, expected);
            for (int i = 0; i <= (n - 1) * s; i++)
                assert_near(fine[i], expected[i], 1e-13, 1.0, "spline");
        }
    }
}

/* A polynomial a + b x + c x^2 + d x^3. */
static double polynomial(const double *c, double x) {
    return c[0] + x * (c[1] + x * (c[2] + x * c[3]));
}

/* Whether `kind` reproduces polynomials of this degree in the cells [from, to). */
static void check_reproduces(enum axis_kind kind, int degree, int n, int from, int to) {
    uint64_t seed = 3u + (uint64_t)degree;
    double c[4] = {0};
    double f[MAX_N];
    double fine[MAX_N * MAX_S];
    draw_line(c, degree + 1, &seed);
    for (int i = 0; i < n; i++)
        f[i] = polynomial(c, i);
    expand(kind, n, 8, f, false, fine);
    for (int i = 8 * from; i < 8 * to; i++)
        assert_near(fine[i], polynomial(c, i / 8.0), 1e-13, 1.0 + fabs(f[n - 1]), "polynomial");
}

static void test_polynomials(void **state) {
    (void)state;
    for (int n = 4; n < 20; n++) {
        check_reproduces(AXIS_LINEAR, 1, n, 0, n - 1);
        check_reproduces(AXIS_CUBIC, 1, n, 0, n - 1);
        check_reproduces(AXIS_CUBIC, 2, n, 1,
                         n - 2); /* central differences are exact for parabolas */
        check_reproduces(AXIS_SPLINE, 1, n, 0, n - 1);
    }
}

/* The border cell of the cubic by hand: f = 1, 3, 2, ...: slopes 2 (one-sided) and 1/2 at its ends;
 * at t = 1/2 f = (1 + 3)/2 + (2 - 1/2)/8. */
static void test_cubic_at_the_border(void **state) {
    (void)state;
    const double f[] = {1.0, 3.0, 2.0, 5.0};
    double fine[8];
    expand(AXIS_CUBIC, 4, 2, f, false, fine);
    assert_true(fine[1] == 2.0 + 1.5 / 8.0);
    assert_true(fine[5] == 3.5 + (1.0 - 3.0) / 8.0); /* slopes 1 and 3 (one-sided) */
}

static void test_through_the_points(void **state) {
    (void)state;
    uint64_t seed = 9;
    double f[MAX_N];
    double fine[MAX_N * MAX_S];
    for (enum axis_kind kind = AXIS_LINEAR; kind <= AXIS_SPLINE; kind++) {
        draw_line(f, MAX_N, &seed);
        expand(kind, MAX_N, MAX_S, f, false, fine);
        for (int i = 0; i < MAX_N; i++)
            assert_true(fine[i * MAX_S] == f[i]);
    }
}

/* Linear from the last point back to the first; a line read backwards gives the fine line read
 * backwards. */
static void test_closing_cell(void **state) {
    (void)state;
    enum { N = 13, S = 8 };
    uint64_t seed = 10;
    double f[N];
    double back[N];
    double fine[N * S];
    double fine_back[N * S];
    for (enum axis_kind kind = AXIS_LINEAR; kind <= AXIS_SPLINE; kind++) {
        draw_line(f, N, &seed);
        for (int i = 0; i < N; i++)
            back[i] = f[N - 1 - i];
        expand(kind, N, S, f, false, fine);
        expand(kind, N, S, back, false, fine_back);
        for (int p = 0; p < S; p++) {
            const double t = (double)p / S;
            assert_near(fine[(N - 1) * S + p], (1.0 - t) * f[N - 1] + t * f[0], 1e-15, 1.0,
                        "closing cell");
        }
        for (int i = 0; i < N * S; i++) {
            assert_near(fine_back[((N - 1) * S - i + N * S) % (N * S)], fine[i], 1e-14, 1.0,
                        "backwards");
        }
    }
}

/* Many lanes at once are the same lines one by one. */
static void test_lanes(void **state) {
    (void)state;
    enum { N = 11, S = 4, LANES = 7, STRIDE = 9 };
    uint64_t seed = 12;
    double f[N * STRIDE];
    double e[N * STRIDE];
    draw_line(f, N * STRIDE, &seed);
    for (enum axis_kind kind = AXIS_LINEAR; kind <= AXIS_SPLINE; kind++) {
        axis ax;
        arena tables = {.used = 1 << 18};
        CLEANUP(release_free) void *memory = arena_allocate(&tables);
        axis_place(&ax, kind, N, S, &tables);
        memset(e, 0, sizeof e);
        axis_slopes(&ax, f, e, STRIDE, LANES);
        for (int lane = 0; lane < LANES; lane++) {
            double line[N];
            double fine[N * S];
            for (int i = 0; i < N; i++)
                line[i] = f[i * STRIDE + lane];
            expand(kind, N, S, line, false, fine);
            for (int i = 0; i < N * S; i++) {
                const axis_weights w = ax.points[i].w;
                const int a = ax.points[i].left;
                const int b = ax.points[i].right;
                const double *at = f + lane;
                const double *slope = e + lane;
                assert_near(w.a * at[a * STRIDE] + w.b * at[b * STRIDE] + w.c * slope[a * STRIDE] +
                                w.d * slope[b * STRIDE],
                            fine[i], 1e-14, 1.0, "lane");
            }
        }
    }
}

/* Runs of a broken line: points [from, to). */
static void check_run(enum axis_kind kind, int s, const double *f, const double *fine, int from,
                      int to) {
    double expected[MAX_N * MAX_S];
    if (kind == AXIS_SPLINE && to - from > 1) {
        gsl_fine(to - from, s, f + from, expected);
    } else {
        expand(kind, to - from, s, f + from, false, expected);
    }
    for (int i = 0; i <= (to - from - 1) * s; i++)
        assert_near(fine[from * s + i], expected[i], 1e-13, 1.0, "run");
}

/* 3 points, a mark, 1 point, two marks, 6 points, a mark, 2 points; then the closing cell to the
 * first point. */
static void test_broken_lines(void **state) {
    (void)state;
    enum { N = 16, S = 8 };
    static const int runs[][2] = {{0, 3}, {7, 13}, {14, 16}};
    uint64_t seed = 77;
    for (enum axis_kind kind = AXIS_LINEAR; kind <= AXIS_SPLINE; kind++) {
        double f[N];
        double fine[N * S];
        draw_line(f, N, &seed);
        f[3] = f[5] = f[6] = f[13] = -INFINITY;
        expand(kind, N, S, f, true, fine);
        for (int r = 0; r < 3; r++)
            check_run(kind, S, f, fine, runs[r][0], runs[r][1]);
        for (int i = 0; i < N * S; i++) {
            const int cell = i / S;
            const bool broken = isinf(f[cell]) || (i % S != 0 && isinf(f[(cell + 1) % N]));
            assert_true(broken == (fine[i] == -INFINITY));
        }
        assert_true(fine[4 * S] == f[4]); /* the point alone */
        assert_near(fine[15 * S + 4], 0.5 * (f[15] + f[0]), 1e-15, 1.0, "closing cell");
    }
}

/* A mark at either end breaks the closing cell; nothing but marks stays so. */
static void test_marks_at_the_ends(void **state) {
    (void)state;
    double fine[16];
    const double first[] = {-INFINITY, 1.0, 2.0, 4.0};
    const double last[] = {1.0, 2.0, 4.0, -INFINITY};
    const double none[] = {-INFINITY, -INFINITY, -INFINITY, -INFINITY};
    for (enum axis_kind kind = AXIS_LINEAR; kind <= AXIS_SPLINE; kind++) {
        expand(kind, 4, 4, first, true, fine);
        assert_true(isinf(fine[0]) && isinf(fine[3]) && fine[4] == 1.0 && fine[12] == 4.0 &&
                    isinf(fine[13]));
        expand(kind, 4, 4, last, true, fine);
        assert_true(fine[0] == 1.0 && fine[8] == 4.0 && isinf(fine[9]) && isinf(fine[12]) &&
                    isinf(fine[15]));
        expand(kind, 4, 4, none, true, fine);
        for (int i = 0; i < 16; i++)
            assert_true(fine[i] == -INFINITY);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_spline_is_gsls),      cmocka_unit_test(test_polynomials),
        cmocka_unit_test(test_cubic_at_the_border), cmocka_unit_test(test_through_the_points),
        cmocka_unit_test(test_closing_cell),        cmocka_unit_test(test_lanes),
        cmocka_unit_test(test_broken_lines),        cmocka_unit_test(test_marks_at_the_ends),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
