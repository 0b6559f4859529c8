/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Laws for the same sky recorded in another way: shifted, turned, mirrored. beta
 * is set, because the PSF's measured radius may differ by its own small error between an image and
 * its mirror image. */
#include "gaussian.h"
#include "pair.h"
#include "test.h"

#include <math.h>
#include <stdlib.h>

/* out[ny][nx] = in moved by (dx, dy) pixels, around the edges. */
static void roll(const double *in, int nx, int ny, int dx, int dy, double *out) {
    for (int y = 0; y < ny; y++) {
        for (int x = 0; x < nx; x++) {
            const int to_x = ((x + dx) % nx + nx) % nx;
            const int to_y = ((y + dy) % ny + ny) % ny;
            out[to_y * nx + to_x] = in[y * nx + x];
        }
    }
}

/* Without interpolation the stamp is periodic: any whole shift, also around the edge, is a phase.
 * The FFT rounds otherwise at 1e-16 of the brightest mode; T reaches 1e8 only where its Gaussian
 * has fallen by as much. */
static void test_periodic_shift(void **state) {
    (void)state;
    const int sizes[][2] = {{32, 32}, {31, 40}, {48, 33}};
    uint64_t seed = 8;
    for (int i = 0; i < 3; i++) {
        const int nx = sizes[i][0];
        const int ny = sizes[i][1];
        pair p;
        pair moved;
        pair_init(&p, nx, ny, 25, 25, 1);
        pair_init(&moved, nx, ny, 25, 25, 1);
        pair_draw(&p, 1.5, seed);
        pair_draw(&moved, 1.5, seed);
        const int dx = (int)(200.0 * uniform(&seed)) - 100;
        const int dy = (int)(200.0 * uniform(&seed)) - 100;
        roll(p.galaxy, nx, ny, dx, dy, moved.galaxy);
        roll(p.noise, nx, ny, 3 - dy, dx, moved.noise);
        const shear_row a = pair_measure(&p);
        const shear_row b = pair_measure(&moved);
        assert_rows_near(&b, &a, 1e-12);
        pair_deinit(&p);
        pair_deinit(&moved);
    }
}

/* A bump of random pixels on a constant ground, far from the edges. */
static void draw_bump(double *out, int nx, int ny, int x0, int y0, uint64_t seed) {
    for (int i = 0; i < nx * ny; i++)
        out[i] = 0.5;
    for (int y = 0; y < 8; y++) {
        for (int x = 0; x < 8; x++)
            out[(y0 + y) * nx + x0 + x] += uniform(&seed);
    }
}

/* Every interpolation commutes with whole shifts while only the constant ground touches the edges.
 * Bilinear and bicubic are local; a spline's memory falls by 0.27 a pixel: 1e-8 after 14 pixels. */
static void test_shift_of_a_bump(void **state) {
    (void)state;
    for (int m = 0; m < PAIR_METHODS; m++) {
        pair p;
        pair moved;
        pair_init(&p, 40, 44, 15, 15, 1);
        pair_init(&moved, 40, 44, 15, 15, 1);
        pair_draw(&p, 0.9, 1);
        pair_draw(&moved, 0.9, 1);
        draw_bump(p.galaxy, 40, 44, 16, 18, 42);
        draw_bump(moved.galaxy, 40, 44, 18, 15, 42);
        draw_bump(p.noise, 40, 44, 15, 17, 43);
        draw_bump(moved.noise, 40, 44, 16, 19, 43);
        pair_set(&p, "interpolation", pair_methods[m]);
        pair_set(&moved, "interpolation", pair_methods[m]);
        const shear_row a = pair_measure(&p);
        const shear_row b = pair_measure(&moved);
        assert_rows_near(&b, &a, m == 3 || m == 6 ? 1e-7 : 1e-12);
        pair_deinit(&p);
        pair_deinit(&moved);
    }
}

/* Well sampled and far from the edges, a shift by any part of a pixel changes nothing: what a
 * Gaussian of 2.5 px leaves beyond Nyquist is exp(-(2.5 pi)^2), and at the edge exp(-0.5
 * (14/2.5)^2) = 1.5e-7, which enters squared. */
static void test_sub_pixel_shift(void **state) {
    (void)state;
    uint64_t seed = 5;
    shear_row first = {0};
    for (int i = 0; i < 6; i++) {
        pair p;
        pair_init(&p, 40, 40, 31, 30, 1);
        const gaussian galaxy = {2.0, 6.5, 5.0, 1.0, 19.0 + uniform(&seed), 19.0 + uniform(&seed)};
        const gaussian psf = {exp(uniform(&seed)),  2.6, 2.2, -0.3, 14.0 + uniform(&seed),
                              14.0 + uniform(&seed)};
        gaussian_draw(&galaxy, 40, 40, 1, p.galaxy);
        gaussian_draw(&psf, 31, 30, 1, p.psf);
        pair_set(&p, "beta", "2.3");
        const shear_row row = pair_measure(&p);
        first = i == 0 ? row : first;
        assert_rows_near(&row, &first, 1e-9);
        pair_deinit(&p);
    }
}

/* The stamp turned by 90 degrees, (x, y) -> (-y, x), or mirrored on the diagonal. */
static void turn(const double *in, int nx, int ny, bool mirror, double *out) {
    for (int y = 0; y < ny; y++) {
        for (int x = 0; x < nx; x++)
            out[x * ny + (mirror ? y : ny - 1 - y)] = in[y * nx + x];
    }
}

static void pair_turn(const pair *p, bool mirror, pair *out) {
    const shear_geometry *g = &p->geometry;
    pair_init(out, g->ny, g->nx, g->psf_ny, g->psf_nx, (int)g->psf_oversample);
    out->settings = p->settings;
    turn(p->galaxy, g->nx, g->ny, mirror, out->galaxy);
    turn(p->noise, g->nx, g->ny, mirror, out->noise);
    turn(p->psf, g->psf_nx, g->psf_ny, mirror, out->psf);
}

/* Turning by 90 degrees flips N1 and N2 (spin 2) and keeps D, U, V (spins 0 and 4). The mirror on
 * the diagonal flips N1 and V (the sines and cosines that are odd under phi -> 90 - phi) and keeps
 * N2, D, U. Rounding only: 1e-11. */
static void check_turned(const pair *p, double tolerance) {
    const shear_row a = pair_measure(p);
    for (int mirror = 0; mirror < 2; mirror++) {
        const double sign = mirror != 0 ? 1.0 : -1.0;
        pair turned;
        pair_turn(p, mirror, &turned);
        const shear_row b = pair_measure(&turned);
        const shear_row expected = {.m20 = a.m02,
                                    .m02 = a.m20,
                                    .m11 = sign * a.m11,
                                    .m4 = a.m4,
                                    .u = a.u,
                                    .v = -sign * a.v,
                                    .n1 = -a.n1,
                                    .n2 = sign * a.n2,
                                    .d = a.d};
        assert_rows_near(&b, &expected, tolerance);
        assert_near(b.flux, a.flux, 1e-12, a.flux, "flux");
        assert_near(b.flux_removed, a.flux_removed, 1e-12, a.flux, "flux_removed");
        assert_near(b.border_var, a.border_var, 1e-12, a.border_var_noise, "border_var");
        pair_deinit(&turned);
    }
}

static void test_turns(void **state) {
    (void)state;
    const int sizes[][4] = {{32, 32, 21, 21}, {33, 33, 24, 21}, {32, 41, 20, 25}, {37, 24, 21, 16}};
    for (int i = 0; i < 4; i++) {
        for (int m = 0; m < PAIR_METHODS; m++) {
            pair p;
            pair_init(&p, sizes[i][0], sizes[i][1], sizes[i][2], sizes[i][3], 1);
            pair_draw(&p, 1.1, 100u + (uint64_t)i);
            pair_set(&p, "interpolation", pair_methods[m]);
            pair_set(&p, "beta", "2");
            check_turned(&p, 1e-11);
            pair_set(&p, "filter", "edge");
            pair_set(&p, "width", "1.5");
            check_turned(&p, 1e-11);
            pair_deinit(&p);
        }
    }
}

/* With zeros=skip the log-bilinear cells are symmetric too. */
static void test_turns_with_zeros(void **state) {
    (void)state;
    uint64_t seed = 4;
    for (int policy = 0; policy < 2; policy++) {
        for (int m = 4; m < PAIR_METHODS; m++) {
            pair p;
            pair_init(&p, 24, 27, 15, 15, 1);
            pair_draw(&p, 1.1, 11);
            for (int i = 0; i < 24 * 27; i++) {
                p.galaxy[i] = uniform(&seed) < 0.1 ? 0.0 : p.galaxy[i];
                p.noise[i] = uniform(&seed) < 0.1 ? 0.0 : p.noise[i];
            }
            pair_set(&p, "interpolation", pair_methods[m]);
            pair_set(&p, "zeros", policy == 0 ? "skip" : "floor");
            pair_set(&p, "beta", "2");
            check_turned(&p, 1e-11);
            pair_deinit(&p);
        }
    }
}

/* Turned by any angle a, (N1, N2) turn by 2 a and (U, 4 V) by 4 a. */
static void test_any_angle(void **state) {
    (void)state;
    shear_row first = {0};
    for (int i = 0; i <= 8; i++) {
        const double a = i * M_PI / 8.0;
        const double c = cos(2.0 * a);
        const double s = sin(2.0 * a);
        const double c4 = cos(4.0 * a);
        const double s4 = sin(4.0 * a);
        const gaussian galaxy = {3.0, 8.0 + 2.0 * c, 8.0 - 2.0 * c, 2.0 * s, 24.1, 23.7};
        const gaussian psf = {1.0, 2.5 + 0.4 * c, 2.5 - 0.4 * c, 0.4 * s, 15.0, 15.0};
        pair p;
        pair_init(&p, 48, 48, 31, 31, 1);
        gaussian_draw(&galaxy, 48, 48, 1, p.galaxy);
        gaussian_draw(&psf, 31, 31, 1, p.psf);
        pair_set(&p, "beta", "2.4");
        const shear_row row = pair_measure(&p);
        first = i == 0 ? row : first;
        const double m4 = first.m4;
        assert_near(row.d, first.d, 1e-8, first.d, "d");
        assert_near(row.n1, c * first.n1 - s * first.n2, 1e-8, first.d, "n1");
        assert_near(row.n2, s * first.n1 + c * first.n2, 1e-8, first.d, "n2");
        assert_near(row.u, c4 * first.u - s4 * 4.0 * first.v, 1e-8, m4, "u");
        assert_near(4.0 * row.v, s4 * first.u + c4 * 4.0 * first.v, 1e-8, m4, "v");
        pair_deinit(&p);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_periodic_shift),   cmocka_unit_test(test_shift_of_a_bump),
        cmocka_unit_test(test_sub_pixel_shift),  cmocka_unit_test(test_turns),
        cmocka_unit_test(test_turns_with_zeros), cmocka_unit_test(test_any_angle),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
