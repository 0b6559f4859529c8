/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Interpolation of whole images: the paper's formulas, the logarithms, and the treatment of zeros
 * and negative pixels. */
#include "gaussian.h"
#include "oracle.h"
#include "pair.h"
#include "test.h"

#include "base/cleanup.h"
#include "fft/fft.h"
#include "measure/surface.h"

#include <math.h>
#include <stdlib.h>

enum { MAX_POINTS = 128 * 128 };

/* The fine image of pixels [ny][nx]; false where a log method meets a negative one. */
static bool refine(const double *pixels, int nx, int ny, enum shear_interpolation method, int s,
                   enum shear_zeros zeros, double pedestal, double *fine, int *bad_x, int *bad_y) {
    surface_grid grid;
    surface im;
    static double strip[MAX_POINTS];
    arena a = {.used = 1 << 22};
    CLEANUP(release_free) void *memory = arena_allocate(&a);
    surface_grid_place(&grid, nx, ny, method, s, zeros, pedestal, &a);
    surface_place(&im, &grid, &a);
    assert_true((size_t)grid.fine_nx * (size_t)grid.fine_ny <= MAX_POINTS);
    const bool good = surface_load(&im, &grid, pixels, bad_x, bad_y);
    for (int x0 = 0; good && x0 < grid.fine_nx; x0 += FFT_LANES) {
        surface_strip(&im, &grid, x0, 0, grid.fine_ny, strip);
        for (int i = 0; i < grid.fine_ny * FFT_LANES; i++) {
            const int x = x0 + i % FFT_LANES;
            if (x < grid.fine_nx)
                fine[i / FFT_LANES * grid.fine_nx + x] = strip[i];
        }
    }
    return good;
}

static void refine_good(const double *pixels, int nx, int ny, enum shear_interpolation method,
                        int s, enum shear_zeros zeros, double pedestal, double *fine) {
    int x;
    int y;
    assert_true(refine(pixels, nx, ny, method, s, zeros, pedestal, fine, &x, &y));
}

static void draw(double *out, int n, uint64_t seed) {
    for (int i = 0; i < n; i++)
        out[i] = 0.05 + uniform(&seed);
}

static void test_bilinear(void **state) {
    (void)state;
    enum { NX = 9, NY = 8, S = 8 };
    double a[NX * NY];
    static double fine[MAX_POINTS];
    draw(a, NX * NY, 1);
    refine_good(a, NX, NY, SHEAR_INTERP_BILINEAR, S, 0, 0.0, fine);
    for (int y = 0; y < (NY - 1) * S; y++) {
        for (int x = 0; x < (NX - 1) * S; x++) { /* Zhang (2010), eq. (12) */
            const double t = (x % S) / (double)S;
            const double u = (y % S) / (double)S;
            const double *p = a + (y / S) * NX + x / S;
            const double expected = t * u * p[NX + 1] + (1 - t) * u * p[NX] + t * (1 - u) * p[1] +
                                    (1 - t) * (1 - u) * p[0];
            assert_near(fine[y * NX * S + x], expected, 1e-15, 1.0, "bilinear");
        }
    }
}

/* The estimates of eq. (14), one-sided at the borders: value, d/dx, d/dy, d2/dxdy at pixel (x,
 * y). */
static void estimates(const double *a, int nx, int ny, int x, int y, double *out) {
    const int x0 = x > 0 ? x - 1 : x;
    const int x1 = x < nx - 1 ? x + 1 : x;
    const int y0 = y > 0 ? y - 1 : y;
    const int y1 = y < ny - 1 ? y + 1 : y;
    out[0] = a[y * nx + x];
    out[1] = (a[y * nx + x1] - a[y * nx + x0]) / (x1 - x0);
    out[2] = (a[y1 * nx + x] - a[y0 * nx + x]) / (y1 - y0);
    out[3] = (a[y1 * nx + x1] + a[y0 * nx + x0] - a[y0 * nx + x1] - a[y1 * nx + x0]) /
             ((x1 - x0) * (y1 - y0));
}

/* The c_mn of one cell, row (m-1), column (n-1): t^(m-1) u^(n-1). They follow from the sixteen
 * conditions of eqs. (15) and (16) in closed form: c = H F H^T, F the values and
 * derivatives at the four corners, H the cubic with given ends. */
static void coefficients(const double *a, int nx, int ny, int x, int y, double c[4][4]) {
    static const double h[4][4] = {{1, 0, 0, 0}, {0, 0, 1, 0}, {-3, 3, -2, -1}, {2, -2, 1, 1}};
    double f[4][4];
    for (int i = 0; i < 2; i++) {
        for (int j = 0; j < 2; j++) {
            double e[4];
            estimates(a, nx, ny, x + i, y + j, e);
            f[i][j] = e[0];
            f[2 + i][j] = e[1];
            f[i][2 + j] = e[2];
            f[2 + i][2 + j] = e[3];
        }
    }
    for (int m = 0; m < 4; m++) {
        for (int n = 0; n < 4; n++) {
            c[m][n] = 0.0;
            for (int i = 0; i < 16; i++)
                c[m][n] += h[m][i / 4] * f[i / 4][i % 4] * h[n][i % 4];
        }
    }
}

static void test_bicubic(void **state) {
    (void)state;
    enum { NX = 8, NY = 10, S = 8 };
    double a[NX * NY];
    static double fine[MAX_POINTS];
    draw(a, NX * NY, 2);
    refine_good(a, NX, NY, SHEAR_INTERP_BICUBIC, S, 0, 0.0, fine);
    for (int y = 0; y < (NY - 1) * S; y++) {
        for (int x = 0; x < (NX - 1) * S; x++) {
            double c[4][4];
            double expected = 0.0;
            coefficients(a, NX, NY, x / S, y / S, c);
            for (int m = 0; m < 4; m++) {
                for (int n = 0; n < 4; n++)
                    expected += c[m][n] * pow((x % S) / (double)S, m) * pow((y % S) / (double)S, n);
            }
            assert_near(fine[y * NX * S + x], expected, 1e-13, 1.0, "bicubic");
        }
    }
}

/* Every log method is exp of its plain twin on the logarithms. */
static void test_logs(void **state) {
    (void)state;
    enum { NX = 9, NY = 7, S = 4 };
    double a[NX * NY];
    double logs[NX * NY];
    static double fine[MAX_POINTS];
    static double fine_logs[MAX_POINTS];
    draw(a, NX * NY, 3);
    for (int i = 0; i < NX * NY; i++)
        logs[i] = log(a[i] + 0.25);
    static const enum shear_interpolation methods[] = {SHEAR_INTERP_BILINEAR, SHEAR_INTERP_BICUBIC,
                                                       SHEAR_INTERP_SPLINE};
    static const enum shear_interpolation log_methods[] = {
        SHEAR_INTERP_LOG_BILINEAR, SHEAR_INTERP_LOG_BICUBIC, SHEAR_INTERP_LOG_SPLINE};
    for (int m = 0; m < 3; m++) {
        for (enum shear_zeros zeros = SHEAR_ZEROS_SKIP; zeros <= SHEAR_ZEROS_FLOOR; zeros++) {
            refine_good(a, NX, NY, log_methods[m], S, zeros, 0.25, fine);
            refine_good(logs, NX, NY, methods[m], S, 0, 0.0, fine_logs);
            for (int i = 0; i < NX * NY * S * S; i++)
                assert_near(fine[i], exp(fine_logs[i]) - 0.25, 1e-14, 1.0, "log");
        }
    }
}

/* All of an image, strip by strip, equals the oracle's; parts of a strip, wherever it begins, equal
 * the whole. */
static void test_strips_and_parts(void **state) {
    (void)state;
    enum { NX = 9, NY = 8, S = 4, X0 = 13, Y0 = 5, Y1 = 30 };
    double a[NX * NY];
    static double fine[MAX_POINTS];
    double part[NY * S * FFT_LANES];
    draw(a, NX * NY, 4);
    for (enum shear_interpolation method = SHEAR_INTERP_BILINEAR; method <= SHEAR_INTERP_LOG_SPLINE;
         method++) {
        for (int holes = 0; holes < 2; holes++) {
            a[20] = holes != 0 ? 0.0 : 0.5;
            double *expected = oracle_interpolate(a, NX, NY, method, S, SHEAR_ZEROS_SKIP, 0.0);
            surface_grid grid;
            surface im;
            int bad;
            refine_good(a, NX, NY, method, S, SHEAR_ZEROS_SKIP, 0.0, fine);
            arena tables = {.used = 1 << 22};
            CLEANUP(release_free) void *memory = arena_allocate(&tables);
            surface_grid_place(&grid, NX, NY, method, S, SHEAR_ZEROS_SKIP, 0.0, &tables);
            surface_place(&im, &grid, &tables);
            assert_true(surface_load(&im, &grid, a, &bad, &bad));
            surface_strip(&im, &grid, X0, Y0, Y1, part);
            for (int i = 0; i < NX * S * NY * S; i++) {
                const int x = i % (NX * S) - X0;
                const int y = i / (NX * S);
                assert_near(fine[i], expected[i], 1e-13, 1.0, "strip");
                if (x >= 0 && x < FFT_LANES && y >= Y0 && y < Y1) {
                    /* a vector's exp and the scalar one differ in the last bits */
                    assert_near(part[y * FFT_LANES + x], fine[i], 1e-14, 1.0, "part");
                }
            }
            free(expected);
        }
    }
}

/* 4 x 3 pixels, s = 2, log-bilinear, zeros=skip, worked by hand: the geometric mean between two
 * pixels, zero wherever a corner of the cell is zero, and the closing cells to the first column and
 * row. */
static void test_skip_by_hand(void **state) {
    (void)state;
    const double a[] = {1, 4, 16, 0, /**/ 4, 16, 1, 4, /**/ 9, 1, 4, 16};
    const double expected[] = {
        1,  2,
        4,  8,
        16, 0,
        0,  0, /* beside the zero nothing is known */
        2,  4,
        8,  5.6568542494923806,
        4,  0,
        0,  0, /* row 1/2 */
        4,  8,
        16, 4,
        1,  2,
        4,  4, /* row 1; the closing cell: sqrt(4 4) */
        6,  4.8989794855663558,
        4,  2.8284271247461903,
        2,  4,
        8,  6.928203230275509,
        9,  3,
        1,  2,
        4,  8,
        16, 12, /* row 2; sqrt(16 9) */
        3,  2.449489742783178,
        2,  4,
        8,  0,
        0,  0, /* the closing row meets row 0 and its zero */
    };
    static double fine[MAX_POINTS];
    refine_good(a, 4, 3, SHEAR_INTERP_LOG_BILINEAR, 2, SHEAR_ZEROS_SKIP, 0.0, fine);
    for (int i = 0; i < 8 * 6; i++)
        assert_near(fine[i], expected[i], 1e-14, 16.0, "skip");
}

/* A zero row cuts the columns in two: above and below, log-spline is that of the part by itself. */
static void test_zero_row(void **state) {
    (void)state;
    enum { NX = 8, NY = 11, S = 4, CUT = 4 };
    double a[NX * NY];
    static double fine[MAX_POINTS];
    static double part[MAX_POINTS];
    draw(a, NX * NY, 5);
    for (int x = 0; x < NX; x++)
        a[CUT * NX + x] = 0.0;
    for (enum shear_interpolation method = SHEAR_INTERP_LOG_BILINEAR;
         method <= SHEAR_INTERP_LOG_SPLINE; method++) {
        refine_good(a, NX, NY, method, S, SHEAR_ZEROS_SKIP, 0.0, fine);
        refine_good(a, NX, CUT, method, S, SHEAR_ZEROS_SKIP, 0.0, part);
        for (int i = 0; i <= (CUT - 1) * S * NX * S + NX * S - 1; i++)
            assert_near(fine[i], part[i], 1e-13, 1.0, "above");
        refine_good(a + (CUT + 1) * NX, NX, NY - CUT - 1, method, S, SHEAR_ZEROS_SKIP, 0.0, part);
        for (int i = 0; i < (NY - CUT - 2) * S * NX * S + NX * S; i++)
            assert_near(fine[(CUT + 1) * S * NX * S + i], part[i], 1e-13, 1.0, "below");
        for (int i = ((CUT - 1) * S + 1) * NX * S; i < (CUT + 1) * S * NX * S; i++)
            assert_true(fine[i] == 0.0);
    }
}

/* A pixel alone among zeros stays a single point. */
static void test_isolated_pixel(void **state) {
    (void)state;
    double a[81] = {0};
    static double fine[MAX_POINTS];
    a[4 * 9 + 3] = 7.0;
    for (enum shear_interpolation method = SHEAR_INTERP_LOG_BILINEAR;
         method <= SHEAR_INTERP_LOG_SPLINE; method++) {
        refine_good(a, 9, 9, method, 4, SHEAR_ZEROS_SKIP, 0.0, fine);
        for (int i = 0; i < 36 * 36; i++)
            assert_near(fine[i], i == 16 * 36 + 12 ? 7.0 : 0.0, 1e-15, 7.0, "alone");
    }
}

/* zeros=floor: a zero is 1e-12 of the brightest pixel; an image of zeros has none, and stays zero.
 */
static void test_floor(void **state) {
    (void)state;
    enum { N = 8, S = 4 };
    double a[N * N];
    double b[N * N];
    static double fine[MAX_POINTS];
    static double expected[MAX_POINTS];
    draw(a, N * N, 6);
    a[9] = 3.0;
    for (int i = 0; i < N * N; i++) {
        a[i] = i % 7 == 0 ? 0.0 : a[i];
        b[i] = i % 7 == 0 ? 3e-12 : a[i];
    }
    for (enum shear_interpolation method = SHEAR_INTERP_LOG_BILINEAR;
         method <= SHEAR_INTERP_LOG_SPLINE; method++) {
        refine_good(a, N, N, method, S, SHEAR_ZEROS_FLOOR, 0.0, fine);
        refine_good(b, N, N, method, S, SHEAR_ZEROS_SKIP, 0.0, expected);
        for (int i = 0; i < N * N * S * S; i++)
            assert_near(fine[i], expected[i], 1e-12, expected[i], "floor");
        const double zeros[N * N] = {0};
        refine_good(zeros, N, N, method, S, SHEAR_ZEROS_FLOOR, 0.0, fine);
        for (int i = 0; i < N * N * S * S; i++)
            assert_true(fine[i] == 0.0);
    }
}

/* A constant stays constant, with any pedestal, in the closing cells too. */
static void test_constant(void **state) {
    (void)state;
    double a[64];
    static double fine[MAX_POINTS];
    for (int i = 0; i < 64; i++)
        a[i] = -0.375;
    for (enum shear_interpolation method = SHEAR_INTERP_BILINEAR; method <= SHEAR_INTERP_LOG_SPLINE;
         method++) {
        for (enum shear_zeros zeros = SHEAR_ZEROS_SKIP; zeros <= SHEAR_ZEROS_FLOOR; zeros++) {
            refine_good(a, 8, 8, method, 8, zeros, 0.5, fine);
            for (int i = 0; i < 64 * 64; i++)
                assert_near(fine[i], -0.375, 1e-15, 1.0, "constant");
            refine_good(a, 8, 8, method, 8, zeros, 0.375,
                        fine); /* every pixel is the pedestal's zero */
            for (int i = 0; i < 64 * 64; i++)
                assert_near(fine[i], -0.375, 1e-15, 1.0, "constant zero");
        }
    }
}

static void test_negative(void **state) {
    (void)state;
    double a[9 * 8];
    static double fine[MAX_POINTS];
    draw(a, 72, 8);
    a[5 * 9 + 2] = -0.125;
    a[6 * 9 + 1] = -0.0625;
    for (enum shear_interpolation method = SHEAR_INTERP_LOG_BILINEAR;
         method <= SHEAR_INTERP_LOG_SPLINE; method++) {
        int x = -1;
        int y = -1;
        assert_false(refine(a, 9, 8, method, 2, SHEAR_ZEROS_SKIP, 0.0, fine, &x, &y));
        assert_true(x == 2 && y == 5); /* the first in reading order */
        assert_false(refine(a, 9, 8, method, 2, SHEAR_ZEROS_FLOOR, 0.124, fine, &x, &y));
        assert_true(refine(a, 9, 8, method, 2, SHEAR_ZEROS_FLOOR, 0.125, fine, &x, &y));
    }
    int none;
    for (enum shear_interpolation method = SHEAR_INTERP_BILINEAR; method <= SHEAR_INTERP_SPLINE;
         method++) {
        assert_true(refine(a, 9, 8, method, 2, SHEAR_ZEROS_SKIP, 0.0, fine, &none, &none));
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_bilinear),       cmocka_unit_test(test_bicubic),
        cmocka_unit_test(test_logs),           cmocka_unit_test(test_strips_and_parts),
        cmocka_unit_test(test_skip_by_hand),   cmocka_unit_test(test_zero_row),
        cmocka_unit_test(test_isolated_pixel), cmocka_unit_test(test_floor),
        cmocka_unit_test(test_constant),       cmocka_unit_test(test_negative),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
