/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Noise stamps of a cutter: which boxes, with which chance; the local standard deviation; white
 * noise, and a noise image. */
#include "chip_fixture.h"
#include "pair.h"
#include "test.h"

#include "base/cleanup.h"
#include "shear/stamp.h"
#include "survey/cutout/noise_boxes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SIDE = 480, STAMP = 32, FRAME = 8, N = STAMP * STAMP };
enum { GRID = 4, ACROSS = SIDE / GRID };
static const double R_GAL = 4.0;

static double mean_square(const double *v, size_t n) {
    double sum = 0.0;
    for (size_t i = 0; i < n; i++)
        sum += v[i] * v[i];
    return sum / (double)n;
}

/* Return whether a pixel of an object is within 4 px of the stamp, or more than 2 % are defects. */
static bool spoiled(const chip_pixels *c, int x, int y) {
    int defects = 0;
    for (int j = y - 4; j < y + STAMP + 4; j++) {
        for (int i = x - 4; i < x + STAMP + 4; i++) {
            const int dx = i < x ? x - i : i >= x + STAMP ? i - x - STAMP + 1 : 0;
            const int dy = j < y ? y - j : j >= y + STAMP ? j - y - STAMP + 1 : 0;
            const size_t at = (size_t)j * (size_t)c->nx + (size_t)i;
            if (c->owner[at] != 0 && dx * dx + dy * dy <= 16)
                return true;
            defects += dx == 0 && dy == 0 && c->defect[at] != 0;
        }
    }
    return defects > N * 2 / 100;
}

/* Return the amplifier of a pixel, of `parts` along an axis. */
static int amplifier_of(int pixel, int parts) {
    int i = 0;
    while (i + 1 < parts && (i + 1) * SIDE / parts <= pixel)
        i++;
    return i;
}

/* Fill the map of stamps that may serve a galaxy whose stamp is centred on (x, y), pixel by pixel,
 * without gate. Return their number. */
static int all_boxes(const chip_pixels *c, int x, int y, shear_amplifiers grid, uint8_t *map) {
    int n = 0;
    for (int i = 0; i < ACROSS * ACROSS; i++) {
        const int bx = i % ACROSS * GRID;
        const int by = i / ACROSS * GRID;
        const int dx = abs(bx + STAMP / 2 - x);
        const int dy = abs(by + STAMP / 2 - y);
        bool same =
            bx >= FRAME && bx + STAMP + FRAME <= SIDE && by >= FRAME && by + STAMP + FRAME <= SIDE;
        for (int k = -FRAME; k < STAMP + FRAME; k++) {
            same = same && amplifier_of(bx + k, grid.columns) == amplifier_of(x, grid.columns) &&
                   amplifier_of(by + k, grid.rows) == amplifier_of(y, grid.rows);
        }
        map[i] = same && dx * dx + dy * dy <= 200 * 200 &&
                 (dx >= STAMP + FRAME || dy >= STAMP + FRAME) && !spoiled(c, bx, by);
        n += map[i];
    }
    return n;
}

/* A chip with objects and defects all over it, but none where x and y are both 160 to 320. */
static chip_pixels *busy_chip(uint64_t seed) {
    chip_pixels *c = chip_new(SIDE, SIDE, 1.0, seed);
    for (int i = 0; i < 40; i++) {
        const double x = SIDE * uniform(&seed);
        const double y = SIDE * uniform(&seed);
        const bool middle = x > 160 && x < 320 && y > 160 && y < 320;
        if (!middle && i % 4 == 0)
            chip_own(c, x, y, 6.0 * uniform(&seed), i + 1);
        if (!middle && i % 4 != 0)
            chip_damage(c, (int)(x * 0.95), (int)(y * 0.95), 1 + i % 15, 1 + i % 3, PIXEL_BAD);
    }
    return c;
}

/* Exactly the boxes that the law allows are drawn, each once. */
static void check_boxes(int px, int py, shear_amplifiers grid, int least) {
    static uint8_t allowed[ACROSS * ACROSS];
    chip_pixels *c = busy_chip(21);
    const int n = all_boxes(c, px, py, grid, allowed);
    empty_sky sky = {
        .boxes = {
            .x = {SIDE, grid.columns}, .y = {SIDE, grid.rows}, .stamp = STAMP, .frame = FRAME}};
    assert_int_equal(empty_sky_init(&sky, c, NULL), SHEAR_OK);
    noise_boxes boxes;
    arena a = {0};
    noise_boxes_place(&boxes, &sky, &a);
    CLEANUP(release_free) void *memory = arena_allocate(&a);
    noise_boxes_place(&boxes, &sky, &a);
    noise_boxes_find(&boxes, px - STAMP / 2, py - STAMP / 2, (draw_key){1, 1});
    int found = 0;
    int x;
    int y;
    for (; noise_boxes_draw(&boxes, &x, &y); found++) {
        assert_true(x % GRID == 0 && y % GRID == 0);
        assert_int_equal(allowed[y / GRID * ACROSS + x / GRID], 1);
        allowed[y / GRID * ACROSS + x / GRID] = 0;
    }
    assert_int_equal(found, n);
    assert_true(n > least);
    empty_sky_deinit(&sky);
    chip_free(c);
}

static void test_exactly_the_free_boxes_are_drawn(void **state) {
    (void)state;
    check_boxes(240, 240, (shear_amplifiers){1, 1}, 1000);
}

static void test_boxes_stay_on_the_amplifier(void **state) {
    (void)state;
    check_boxes(239, 240, (shear_amplifiers){2, 1}, 500);
    check_boxes(240, 240, (shear_amplifiers){2, 1}, 500);
    check_boxes(240, 239, (shear_amplifiers){1, 2}, 500);
    check_boxes(240, 240, (shear_amplifiers){1, 2}, 500);
    check_boxes(274, 240, (shear_amplifiers){7, 1}, 100); /* of which the borders are no cells */
    check_boxes(273, 240, (shear_amplifiers){7, 1}, 100);
    check_boxes(240, 274, (shear_amplifiers){1, 7}, 100);
    check_boxes(240, 273, (shear_amplifiers){1, 7}, 100);
    check_boxes(239, 160, (shear_amplifiers){2, 3}, 100);
}

/* Each of them is as likely as any other to be the first, and the second. */
static void test_every_box_has_the_same_chance(void **state) {
    (void)state;
    enum { KEYS = 100000, BINS = 50 };
    int count[2][BINS] = {0};
    for (int id = 0; id < KEYS; id++) {
        for (uint32_t i = 0; i < 2; i++)
            count[i][draw_index((draw_key){7, id}, i, BINS)]++;
    }
    for (int i = 0; i < 2; i++) {
        double chi2 = 0.0;
        for (int k = 0; k < BINS; k++)
            chi2 += pow(count[i][k] - KEYS / BINS, 2) / (KEYS / BINS);
        assert_true(fabs(chi2 - (BINS - 1)) < 4.0 * sqrt(2.0 * (BINS - 1)));
    }
    assert_int_equal(draw_index((draw_key){7, 1}, 5, 1), 0);
}

/* The noise stamps have the variance of all free boxes, though it varies from box to box. */
static void test_the_choice_is_unbiased(void **state) {
    (void)state;
    static uint8_t allowed[ACROSS * ACROSS];
    enum { DRAWS = 4000 };
    chip_pixels *c = chip_new(SIDE, SIDE, 1.0, 22);
    uint64_t seed = 9;
    for (int i = 0; i < 300; i++) { /* faint sources that nobody has found */
        const int at = (int)(uniform(&seed) * (SIDE * SIDE - 4 * SIDE));
        for (int k = 0; k < 9; k++)
            c->value[at + k % 3 + k / 3 * SIDE] += 2.0 + 2.0 * uniform(&seed);
    }
    cutter_options options = chip_options(c);
    cut_fixture f;
    cut_init(&f, c, NULL, &options);
    double sum = 0.0;
    double squares = 0.0;
    for (int id = 0; id < DRAWS; id++) {
        assert_int_equal(cut_at(&f, 240, 240, R_GAL, id), 0);
        const double v = mean_square(f.pair.noise, N);
        sum += v / DRAWS;
        squares += v * v / DRAWS;
    }
    const int n = all_boxes(c, 240, 240, (shear_amplifiers){1, 1}, allowed);
    double all = 0.0;
    for (int i = 0; i < ACROSS * ACROSS; i++) {
        if (allowed[i] == 0)
            continue;
        /* cut it as a galaxy that has no light */
        options.r_psf_px = 0.0;
        const double x = i % ACROSS * GRID + 0.5 * STAMP;
        const double y = (double)(i / ACROSS) * GRID + 0.5 * STAMP;
        assert_int_equal(cut_at(&f, x, y, 0.1, i), 0);
        all += mean_square(f.pair.galaxy, N) / n;
    }
    const double error = sqrt((squares - sum * sum) / DRAWS);
    print_message("variance %.5f (%.5f), of all %d boxes %.5f\n", sum, error, n, all);
    assert_true(fabs(sum - all) < 3.0 * error);
    assert_true(error < 0.1 * all);
    cut_deinit(&f);
    chip_free(c);
}

/* A noise stamp is the chip's pixels at its place, less a plane. */
static void check_place(const chip_pixels *c, const double *stamp, int x, int y) {
    double rest[N];
    for (int i = 0; i < N; i++)
        rest[i] = c->value[(y + i / STAMP) * SIDE + x + i % STAMP] - stamp[i];
    for (int i = 0; i < N; i++) {
        const double plane = rest[i % STAMP] + rest[i / STAMP * STAMP] - rest[0];
        assert_true(fabs(rest[i] - plane) < 1e-9);
    }
}

static void test_several_noise_stamps_are_different_boxes(void **state) {
    (void)state;
    enum { K = 64 };
    chip_pixels *c = chip_new(SIDE, SIDE, 1.0, 23);
    cutter_options options = chip_options(c);
    options.noise_stamps = K;
    cut_fixture f;
    cut_init(&f, c, NULL, &options);
    for (int id = 0; id < 50; id++) {
        assert_int_equal(cut_at(&f, 240, 240, R_GAL, id), 0);
        assert_int_equal(f.pair.n_noise, K);
        for (int k = 0; k < K; k++)
            check_place(c, f.pair.noise + (size_t)k * N, f.pair.noise_x[k], f.pair.noise_y[k]);
        for (int i = 0; i < K * K; i++) {
            const double *a = f.pair.noise + (size_t)(i / K) * N;
            const double *b = f.pair.noise + (size_t)(i % K) * N;
            assert_true(i / K == i % K || memcmp(a, b, N * sizeof *a) != 0);
        }
    }
    /* the first one is the same as with fewer */
    options.noise_stamps = 1;
    const int x = f.pair.noise_x[0];
    const int y = f.pair.noise_y[0];
    cut_fixture one;
    cut_init(&one, c, NULL, &options);
    assert_int_equal(cut_at(&one, 240, 240, R_GAL, 49), 0);
    assert_true(one.pair.noise_x[0] == x && one.pair.noise_y[0] == y);
    cut_deinit(&one);
    cut_deinit(&f);
    chip_free(c);
}

/* ---- the local standard deviation ---- */

/* A slope, bright pixels that no map knows, and a part without sky change little. */
static void test_sigma_is_robust(void **state) {
    (void)state;
    chip_pixels *c = chip_new(SIDE, SIDE, 2.0, 24);
    uint64_t seed = 3;
    double mean = 0.0;
    for (int i = 0; i < SIDE * SIDE; i++) {
        c->value[i] += 1000.0 + 0.05 * (i % SIDE) - 0.1 * (double)(i / SIDE);
        c->value[i] += uniform(&seed) < 0.005 ? 500.0 : 0.0;
    }
    chip_own(c, 80, 80, 100, 1);
    const cutter_options options = chip_options(c);
    cut_fixture f;
    cut_init(&f, c, NULL, &options);
    for (int i = 0; i < 25; i++) {
        cut_at(&f, 40 + 99 * (i % 5), 40 + 99 * (double)(i / 5), R_GAL, i);
        mean += f.pair.sigma / 25;
        assert_true(fabs(f.pair.sigma / 2.0 - 1.0) < 0.07);
    }
    assert_true(fabs(mean / 2.0 - 1.0) < 0.015);
    cut_deinit(&f);
    chip_free(c);
}

static void test_noise_is_like_the_galaxys(void **state) {
    (void)state;
    chip_pixels *c = chip_new(SIDE, SIDE, 1.0, 25);
    for (int i = 0; i < SIDE * SIDE; i++)
        c->value[i] *= i % SIDE < 320 ? 1.0 : 1.6;
    const cutter_options options = chip_options(c);
    cut_fixture f;
    cut_init(&f, c, NULL, &options);
    for (int id = 0; id < 500; id++) {
        assert_int_equal(cut_at(&f, 220, 240, R_GAL, id), 0);
        assert_true(fabs(f.pair.sigma - 1.0) < 0.1);
        assert_true(f.pair.noise_x[0] + STAMP / 2 < 384);
    }
    cut_deinit(&f);
    chip_free(c);
}

/* A weight map that is wrong by a factor, and right about a gradient. */
static void test_a_weight_map_is_scaled(void **state) {
    (void)state;
    chip_pixels *c = chip_new(SIDE, SIDE, 1.0, 26);
    for (int i = 0; i < SIDE * SIDE; i++) {
        const double sigma = 1.0 + 0.002 * (i % SIDE);
        c->value[i] *= sigma;
        c->sigma[i] = (float)(3.0 * sigma);
    }
    chip_damage(c, 205, 235, 2, 2, PIXEL_BAD);
    c->sigma[235 * SIDE + 205] = NAN;
    cutter_options options = chip_options(c);
    options.noise = SHEAR_NOISE_WHITE;
    options.noise_stamps = 64;
    cut_fixture f;
    cut_init(&f, c, NULL, &options);
    assert_int_equal(cut_at(&f, 220, 240, R_GAL, 1), 0);
    assert_true(fabs(f.pair.sigma / 1.44 - 1.0) < 0.05);
    const double power = mean_square(f.pair.noise, 64 * N);
    assert_true(fabs(power / (f.pair.sigma * f.pair.sigma) - 1.0) < 0.02);
    double left = 0.0;
    double right = 0.0;
    for (int i = 0; i < 64 * N; i++) {
        const double square = f.pair.noise[i] * f.pair.noise[i];
        left += i % STAMP < STAMP / 2 ? square : 0.0;
        right += i % STAMP < STAMP / 2 ? 0.0 : square;
    }
    assert_true(fabs(right / left / pow(1.456 / 1.424, 2) - 1.0) < 0.035);
    cut_deinit(&f);
    chip_free(c);
}

static void test_without_noise(void **state) {
    (void)state;
    chip_pixels *c = chip_new(SIDE, SIDE, 0.0, 1);
    chip_damage(c, 230, 230, 1, 1, PIXEL_BAD);
    const cutter_options options = chip_options(c);
    cut_fixture f;
    cut_init(&f, c, NULL, &options);
    assert_int_equal(cut_at(&f, 240, 240, R_GAL, 1), 0);
    assert_true(f.pair.sigma == 0.0);
    assert_true(mean_square(f.pair.galaxy, N) == 0.0 && mean_square(f.pair.noise, N) == 0.0);
    cut_deinit(&f);
    chip_free(c);
}

/* ---- noise that is not the chip's ---- */

static void test_white_noise(void **state) {
    (void)state;
    enum { K = 8 };
    chip_pixels *c = chip_new(SIDE, SIDE, 2.0, 27);
    cutter_options options = chip_options(c);
    options.noise = SHEAR_NOISE_WHITE;
    options.noise_stamps = K;
    cut_fixture f;
    cut_init(&f, c, NULL, &options);
    assert_int_equal(cut_at(&f, 240, 240, R_GAL, 1), 0);
    assert_int_equal(f.pair.n_noise, 0);
    const double sigma2 = f.pair.sigma * f.pair.sigma;
    for (int k = 0; k < K; k++) {
        const double *a = f.pair.noise + (size_t)k * N;
        const double *b = k > 0 ? a - N : f.pair.galaxy;
        double product = 0.0;
        double next = 0.0;
        for (int i = 0; i < N - 1; i++) {
            product += a[i] * b[i] / sigma2;
            next += a[i] * a[i + 1] / sigma2;
        }
        assert_true(fabs(mean_square(a, N) / sigma2 - 1.0) < 4.0 * sqrt(2.0 / N));
        assert_true(fabs(product) < 4.0 * sqrt(N) && fabs(next) < 4.0 * sqrt(N));
    }
    cut_deinit(&f);
    chip_free(c);
}

static void test_a_noise_image(void **state) {
    (void)state;
    chip_pixels *c = chip_new(SIDE, SIDE, 2.0, 28);
    chip_pixels *noise = chip_new(SIDE, SIDE, 2.0, 29);
    cutter_options options = chip_options(c);
    options.noise = SHEAR_NOISE_IMAGE;
    cut_fixture plain;
    cut_init(&plain, c, noise, &options);
    assert_int_equal(cut_at(&plain, 240, 240, R_GAL, 1), 0);
    for (int i = 0; i < SIDE * SIDE; i++)
        noise->value[i] += 5.0 - 0.1 * (i % SIDE);
    chip_damage(c, 230, 230, 1, 1, PIXEL_BAD);
    chip_damage(noise, 250, 231, 1, 1, PIXEL_BAD);
    cut_fixture f;
    cut_init(&f, c, noise, &options);
    assert_int_equal(cut_at(&f, 240, 240, R_GAL, 1), 0);
    for (int i = 0; i < N; i++) {
        const bool masked = i == 6 * STAMP + 6 || i == 7 * STAMP + 26;
        assert_int_equal(fabs(f.pair.galaxy[i] - plain.pair.galaxy[i]) > 1e-9, masked);
        assert_int_equal(fabs(f.pair.noise[i] - plain.pair.noise[i]) > 1e-9, masked);
    }
    assert_true(f.pair.noise_x[0] == f.pair.x && f.pair.noise_y[0] == f.pair.y);
    chip_damage(noise, 240, 240, 1, 1, PIXEL_BAD); /* where the galaxy has its light */
    assert_int_equal(cut_at(&f, 240, 240, R_GAL, 1), SHEAR_FLAG_NO_NOISE);
    cut_deinit(&plain);
    cut_deinit(&f);
    chip_free(noise);
    chip_free(c);
}

/* A noise stamp's hole is never put into the galaxy's light. */
static void test_holes_of_noise_stamps(void **state) {
    (void)state;
    chip_pixels *c = chip_new(SIDE, SIDE, 1.0, 30);
    for (int i = 0; i < SIDE; i += 24) { /* one in a hundred */
        for (int j = 0; j < SIDE; j += 24) {
            if (abs(i - 240) > 30 || abs(j - 240) > 30)
                chip_damage(c, i, j, 3, 2, PIXEL_BAD);
        }
    }
    const cutter_options options = chip_options(c);
    cut_fixture f;
    cut_init(&f, c, NULL, &options);
    for (int id = 0; id < 300; id++) {
        assert_int_equal(cut_at(&f, 240, 240, 3.0, id), 0);
        assert_true(f.pair.filled > 0.0);
        for (int i = 0; i < N; i++) {
            const int dx = i % STAMP - STAMP / 2;
            const int dy = i / STAMP - STAMP / 2;
            const size_t at = (size_t)(i / STAMP + f.pair.noise_y[0]) * SIDE +
                              (size_t)(i % STAMP + f.pair.noise_x[0]);
            assert_true(hypot(dx, dy) > 6.9 || c->defect[at] == 0);
        }
    }
    cut_deinit(&f);
    chip_free(c);
}

/* Bright objects in a noise stamp's frame do not tilt its plane. */
static void test_objects_in_frames(void **state) {
    (void)state;
    chip_pixels *c = chip_new(SIDE, SIDE, 1.0, 31);
    for (int i = 20; i < SIDE; i += 60) {
        for (int j = 20; j < SIDE; j += 60) {
            if (abs(i - 240) > 30 || abs(j - 240) > 30)
                chip_own(c, i, j, 5.0, i * SIDE + j);
        }
    }
    for (int i = 0; i < SIDE * SIDE; i++)
        c->value[i] += c->owner[i] != 0 ? 1e4 : 0.0;
    const cutter_options options = chip_options(c);
    cut_fixture f;
    cut_init(&f, c, NULL, &options);
    int touched = 0;
    for (int id = 0; id < 300; id++) {
        assert_int_equal(cut_at(&f, 240, 240, R_GAL, id), 0);
        double mean = 0.0;
        for (int i = 0; i < N; i++)
            mean += f.pair.noise[i] / N;
        assert_true(fabs(mean) < 0.3);
        const int x = f.pair.noise_x[0] - FRAME;
        const int y = f.pair.noise_y[0] - FRAME;
        for (int i = 0; i < (STAMP + 2 * FRAME) * (STAMP + 2 * FRAME); i++) {
            const int at = (y + i / (STAMP + 2 * FRAME)) * SIDE + x + i % (STAMP + 2 * FRAME);
            touched += c->owner[at] != 0;
        }
    }
    assert_true(touched > 100);
    cut_deinit(&f);
    chip_free(c);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_exactly_the_free_boxes_are_drawn),
        cmocka_unit_test(test_boxes_stay_on_the_amplifier),
        cmocka_unit_test(test_every_box_has_the_same_chance),
        cmocka_unit_test(test_the_choice_is_unbiased),
        cmocka_unit_test(test_several_noise_stamps_are_different_boxes),
        cmocka_unit_test(test_sigma_is_robust),
        cmocka_unit_test(test_noise_is_like_the_galaxys),
        cmocka_unit_test(test_a_weight_map_is_scaled),
        cmocka_unit_test(test_without_noise),
        cmocka_unit_test(test_white_noise),
        cmocka_unit_test(test_a_noise_image),
        cmocka_unit_test(test_holes_of_noise_stamps),
        cmocka_unit_test(test_objects_in_frames),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
