/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A chip with several amplifiers: noise stamps and levels are those of the galaxy's own. */
#include "chip_fixture.h"
#include "pair.h"
#include "test.h"

#include "base/cleanup.h"
#include "survey/cutout/empty_sky.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { STAMP = 32, FRAME = CUTTER_FRAME, N = STAMP * STAMP };
static const double R_GAL = 4.0;

/* The parts of an axis follow each other without gap, are equal to a pixel, and every pixel is on
 * the one where it lies. */
static void test_the_parts_of_an_axis(void **state) {
    (void)state;
    for (int pixels = 1; pixels <= 300; pixels++) {
        for (int parts = 1; parts <= pixels && parts <= SHEAR_MAX_AMPLIFIERS; parts++) {
            const amplifier_axis a = {pixels, parts};
            int at = 0;
            for (int i = 0; i < parts; i++) {
                const int start = amplifier_axis_start(&a, i);
                const int end = amplifier_axis_start(&a, i + 1);
                assert_int_equal(start, at);
                assert_true(end - start == pixels / parts || end - start == pixels / parts + 1);
                for (; at < end; at++)
                    assert_int_equal(amplifier_axis_at(&a, at), i);
                assert_true(amplifier_axis_holds(&a, start, end));
                assert_false(amplifier_axis_holds(&a, start, end + 1));
                assert_false(amplifier_axis_holds(&a, start - 1, end));
            }
            assert_int_equal(at, pixels);
        }
    }
    const amplifier_axis large = {200000, SHEAR_MAX_AMPLIFIERS};
    assert_int_equal(amplifier_axis_start(&large, 64), 200000);
    assert_int_equal(amplifier_axis_at(&large, 199999), 63);
}

/* ---- the survey ---- */

/* Copy a part of a chip. */
static chip_pixels *copy_part(const chip_pixels *c, int x, int y, int nx, int ny) {
    chip_pixels *part = chip_new(nx, ny, 0.0, 1);
    for (int j = 0; j < ny; j++) {
        const size_t from = (size_t)(y + j) * (size_t)c->nx + (size_t)x;
        const size_t to = (size_t)j * (size_t)nx;
        memcpy(part->value + to, c->value + from, (size_t)nx * sizeof *c->value);
        memcpy(part->owner + to, c->owner + from, (size_t)nx * sizeof *c->owner);
        memcpy(part->defect + to, c->defect + from, (size_t)nx);
    }
    return part;
}

static void survey(empty_sky *s, chip_pixels *c, int columns, int rows) {
    *s = (empty_sky){
        .boxes = {.x = {c->nx, columns}, .y = {c->ny, rows}, .stamp = STAMP, .frame = FRAME}};
    assert_int_equal(empty_sky_init(s, c, NULL), SHEAR_OK);
}

/* The levels of a part are the same in the whole chip's survey. */
static void compare_levels(const empty_sky *whole, const empty_sky *part, int x, int y) {
    for (int j = 0; j < part->boxes.y.pixels; j++) {
        for (int i = 0; i < part->boxes.x.pixels; i++) {
            assert_true(whole->mesh.level[noise_mesh_at(&whole->mesh, x + i, y + j)] ==
                        part->mesh.level[noise_mesh_at(&part->mesh, i, j)]);
        }
    }
}

/* So are its free places. */
static void compare_boxes(const empty_sky *whole, const empty_sky *part, int x, int y) {
    int n = 0;
    for (int j = 0; j < part->boxes.rows; j++) {
        const uint8_t *a = box_map_row(&whole->boxes, y / BOX_CELL + j) + x / BOX_CELL;
        const uint8_t *b = box_map_row(&part->boxes, j);
        for (int i = 0; i < part->boxes.columns; i++) {
            assert_int_equal(a[i] & 1, b[i] & 1);
            n += b[i] & 1;
        }
    }
    assert_true(n > 300);
}

/* A chip of 2 x 2 amplifiers is surveyed like four chips. */
static void test_amplifiers_are_chips_of_their_own(void **state) {
    (void)state;
    enum { NX = 360, NY = 384 };
    chip_pixels *c = chip_new(NX, NY, 1.0, 41);
    for (int i = 0; i < NX * NY; i++)
        c->value[i] *= 1.0 + 0.5 * (i % NX >= NX / 2) + 1.5 * (i / NX >= NY / 2);
    for (int k = 0; k < 4; k++) { /* away from the borders, which grown objects would cross */
        chip_own(c, 40 + 180 * (k % 2), 30 + 192 * (double)(k / 2), 3.0 + k, k + 1);
        chip_damage(c, 100 + 180 * (k % 2), 100 + 192 * (k / 2), 30, 2, PIXEL_BAD);
    }
    empty_sky whole;
    survey(&whole, c, 2, 2);
    for (int k = 0; k < 4; k++) {
        const int x = k % 2 * NX / 2;
        const int y = k / 2 * NY / 2;
        chip_pixels *part = copy_part(c, x, y, NX / 2, NY / 2);
        empty_sky alone;
        survey(&alone, part, 1, 1);
        compare_levels(&whole, &alone, x, y);
        compare_boxes(&whole, &alone, x, y);
        empty_sky_deinit(&alone);
        chip_free(part);
    }
    empty_sky_deinit(&whole);
    chip_free(c);
}

/* Levels change at the border to the pixel, also where it is in the middle of meshes and cells; and
 * where a row of meshes is too low for a level, it is that of its amplifier. */
static void test_levels_change_at_borders(void **state) {
    (void)state;
    enum { NX = 500, NY = 390 };
    static const shear_amplifiers grids[] = {{2, 1}, {1, 2}, {3, 3}, {7, 5}};
    for (size_t g = 0; g < sizeof grids / sizeof grids[0]; g++) {
        const amplifier_axis x = {NX, grids[g].columns};
        const amplifier_axis y = {NY, grids[g].rows};
        chip_pixels *c = chip_new(NX, NY, 1.0, 42 + g);
        for (int i = 0; i < NX * NY; i++)
            c->value[i] *=
                1 << (amplifier_axis_at(&x, i % NX) % 3 + 3 * (amplifier_axis_at(&y, i / NX) % 2));
        empty_sky s;
        survey(&s, c, x.parts, y.parts);
        for (int i = 0; i < NX * NY; i++) {
            const double truth =
                1 << (amplifier_axis_at(&x, i % NX) % 3 + 3 * (amplifier_axis_at(&y, i / NX) % 2));
            const double level = s.mesh.level[noise_mesh_at(&s.mesh, i % NX, i / NX)];
            assert_true(fabs(level / truth - 1.0) < 0.15);
        }
        empty_sky_deinit(&s);
        chip_free(c);
    }
}

/* ---- pairs of stamps ---- */

/* Return the correlation of neighbouring pixels in x. */
static double correlation(const double *v) {
    double product = 0.0;
    double square = 0.0;
    for (int i = 0; i < N; i++) {
        product += i % STAMP < STAMP - 1 ? v[i] * v[i + 1] : 0.0;
        square += v[i] * v[i];
    }
    return product / square;
}

/* All noise stamps of a galaxy, wherever it is, have the correlation of its own amplifier: every
 * second one's noise is smooth, but as strong. */
static void test_noise_is_of_the_galaxys_amplifier(void **state) {
    (void)state;
    enum { NX = 640, NY = 500, K = 4 };
    const amplifier_axis x = {NX, 4};
    const amplifier_axis y = {NY, 2};
    chip_pixels *c = chip_new(NX, NY, 1.0, 50);
    for (int i = NX * NY - 1; i > 0; i--) {
        if ((amplifier_axis_at(&x, i % NX) + amplifier_axis_at(&y, i / NX)) % 2 == 1)
            c->value[i] = (c->value[i] + c->value[i - 1]) / sqrt(2.0);
    }
    cutter_options options = chip_options(c);
    options.noise_stamps = K;
    options.amplifiers = (shear_amplifiers){x.parts, y.parts};
    cut_fixture f;
    cut_init(&f, c, NULL, &options);
    uint64_t seed = 3;
    for (int id = 0; id < 1000; id++) {
        const int px = STAMP + (int)((NX - 2 * STAMP) * uniform(&seed));
        const int py = STAMP + (int)((NY - 2 * STAMP) * uniform(&seed));
        const bool smooth = (amplifier_axis_at(&x, px) + amplifier_axis_at(&y, py)) % 2 == 1;
        assert_int_equal(cut_at(&f, px, py, R_GAL, id), 0);
        for (int k = 0; k < K; k++)
            assert_true(fabs(correlation(f.pair.noise + (ptrdiff_t)k * N) - 0.5 * smooth) < 0.2);
    }
    cut_deinit(&f);
    /* without being told, some have another one */
    options.amplifiers = (shear_amplifiers){0, 0};
    cut_init(&f, c, NULL, &options);
    int other = 0;
    for (int id = 0; id < 100; id++) {
        assert_int_equal(cut_at(&f, 240, 120, R_GAL, id), 0);
        other += correlation(f.pair.noise) < 0.25;
    }
    assert_true(other > 20);
    cut_deinit(&f);
    chip_free(c);
}

static double mean_square(const double *v) {
    double sum = 0.0;
    for (int i = 0; i < N; i++)
        sum += v[i] * v[i] / N;
    return sum;
}

/* Galaxies across a border have too much noise on its one side, too little on the other, and as
 * much as their noise stamps on average. */
static void test_errors_at_a_border_cancel(void **state) {
    (void)state;
    enum { SIDE = 480, HIGH = 4000, GALAXIES = 4000 };
    chip_pixels *c = chip_new(SIDE, HIGH, 1.0, 51);
    for (int i = 0; i < SIDE * HIGH; i++)
        c->value[i] *= i % SIDE < SIDE / 2 ? 1.0 : 1.2;
    cutter_options options = chip_options(c);
    options.amplifiers = (shear_amplifiers){2, 1};
    cut_fixture f;
    cut_init(&f, c, NULL, &options);
    double sum[2] = {0.0, 0.0};
    int n[2] = {0, 0};
    uint64_t seed = 4;
    for (int id = 0; id < GALAXIES; id++) {
        const int x = SIDE / 2 - STAMP / 2 + (int)(STAMP * uniform(&seed));
        const int right = x >= SIDE / 2;
        const double y = 60 + (HIGH - 120) * uniform(&seed);
        assert_int_equal(cut_at(&f, x, y, R_GAL, id), 0);
        sum[right] += mean_square(f.pair.galaxy) - mean_square(f.pair.noise);
        n[right]++;
    }
    print_message("variance, galaxy less noise: left %+.4f right %+.4f mean %+.4f\n", sum[0] / n[0],
                  sum[1] / n[1], (sum[0] + sum[1]) / GALAXIES);
    assert_true(sum[0] / n[0] > 0.07 && sum[1] / n[1] < -0.07);
    assert_true(fabs(sum[0] + sum[1]) / GALAXIES < 0.02);
    cut_deinit(&f);
    chip_free(c);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_the_parts_of_an_axis),
        cmocka_unit_test(test_amplifiers_are_chips_of_their_own),
        cmocka_unit_test(test_levels_change_at_borders),
        cmocka_unit_test(test_noise_is_of_the_galaxys_amplifier),
        cmocka_unit_test(test_errors_at_a_border_cancel),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
