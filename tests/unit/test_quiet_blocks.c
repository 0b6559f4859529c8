/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Patches without noise are no empty sky, and no noise is mistaken for one. */
#include "chip_fixture.h"
#include "pair.h"
#include "test.h"

#include "base/sort.h"
#include "survey/cutout/empty_sky.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SIDE = 1024, STAMP = 32, FRAME = CUTTER_FRAME, PATCH = 30, APART = 128 };

/* Return how many cells cannot serve. */
static int count_touched(chip_pixels *c) {
    empty_sky s = {.boxes = {.x = {c->nx, 1}, .y = {c->ny, 1}, .stamp = STAMP, .frame = FRAME}};
    int n = 0;
    assert_int_equal(empty_sky_init(&s, c, NULL), SHEAR_OK);
    for (int i = 0; i < s.boxes.rows * s.boxes.columns; i++)
        n += s.boxes.cells[i] >= BOX_QUIET;
    empty_sky_deinit(&s);
    return n;
}

/* ---- kinds of noise ---- */

static double at(const double *v, int x, int y) {
    return v[(size_t)((y + SIDE) % SIDE) * SIDE + (size_t)((x + SIDE) % SIDE)];
}

/* Convolve the noise with a Gaussian, cut at 3 sigma. */
static void smooth(chip_pixels *c, double sigma) {
    const int reach = (int)ceil(3.0 * sigma);
    double weight[64];
    assert_in_range(reach, 1, 31);
    for (int k = -reach; k <= reach; k++)
        weight[k + reach] = exp(-0.5 * k * k / (sigma * sigma));
    double *from = malloc(sizeof(double) * SIDE * SIDE);
    assert_non_null(from);
    for (int pass = 0; pass < 2; pass++) {
        memcpy(from, c->value, sizeof(double) * SIDE * SIDE);
        for (int i = 0; i < SIDE * SIDE; i++) {
            c->value[i] = 0.0;
            for (int k = -reach; k <= reach; k++) {
                c->value[i] += weight[k + reach] * (pass == 0 ? at(from, i % SIDE + k, i / SIDE)
                                                              : at(from, i % SIDE, i / SIDE + k));
            }
        }
    }
    free(from);
}

static void scale_by_place(chip_pixels *c) {
    for (int i = 0; i < SIDE * SIDE; i++)
        c->value[i] *= 1.0 + (double)(i % SIDE) / SIDE;
}

/* Whole numbers, of noise of `sigma`. */
static void round_to(chip_pixels *c, double sigma) {
    for (int i = 0; i < SIDE * SIDE; i++)
        c->value[i] = round(sigma * c->value[i]);
}

/* A weight map knows that half of the chip has a hundredth of the variance. */
static void deepen(chip_pixels *c) {
    for (int i = 0; i < SIDE * SIDE; i++) {
        const double sigma = i % SIDE < SIDE / 2 + 100 ? 1.0 : 0.1;
        c->value[i] *= sigma;
        c->sigma[i] = (float)(3.0 * sigma);
    }
}

static void add_faint_sources(chip_pixels *c) {
    uint64_t seed = 5;
    for (int i = 0; i < SIDE * SIDE / 800; i++) {
        const size_t k = (size_t)(uniform(&seed) * (SIDE * SIDE - 4 * SIDE));
        for (size_t j = 0; j < 9; j++)
            c->value[k + j % 3 + j / 3 * SIDE] += 2.0 + 2.0 * uniform(&seed);
    }
}

/* Noise of gain 4: counts of few photons. */
static void count_photons(chip_pixels *c) {
    uint64_t seed = 6;
    for (int i = 0; i < SIDE * SIDE; i++) {
        double left = exp(-2.0);
        c->value[i] = -1.0;
        for (double p = 1.0; p > left; p *= uniform(&seed))
            c->value[i]++;
    }
}

/* No noise at all, but the wings of bright objects. */
static void draw_wings(chip_pixels *c) {
    for (int i = 0; i < SIDE * SIDE; i++)
        c->value[i] = 1e4 * exp(-0.05 * hypot(i % SIDE - 300.0, (double)(i / SIDE) - 500.0));
}

static void keep(chip_pixels *c) {
    (void)c;
}

static void test_no_noise_is_mistaken(void **state) {
    static void (*const kinds[])(chip_pixels *) = {keep,          scale_by_place, add_faint_sources,
                                                   count_photons, deepen,         draw_wings};
    static const double digits[] = {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8, 1.0, 3.0};
    static const double widths[] = {0.5, 0.8, 1.0, 1.5, 3.0};
    (void)state;
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++) {
        chip_pixels *c = chip_new(SIDE, SIDE, 1.0, 60 + i);
        kinds[i](c);
        assert_int_equal(count_touched(c), 0);
        chip_free(c);
    }
    for (size_t i = 0; i < sizeof digits / sizeof digits[0]; i++) {
        chip_pixels *c = chip_new(SIDE, SIDE, 1.0, 70 + i);
        round_to(c, digits[i]);
        assert_int_equal(count_touched(c), 0);
        chip_free(c);
    }
    for (size_t i = 0; i < sizeof widths / sizeof widths[0]; i++) {
        chip_pixels *c = chip_new(SIDE, SIDE, 1.0, 80 + i);
        smooth(c, widths[i]);
        assert_int_equal(count_touched(c), 0);
        chip_free(c);
    }
}

/* ---- patches ---- */

static double zero(const double *v, int x, int y, int left) {
    (void)v, (void)x, (void)y, (void)left;
    return 0.0;
}

static double constant(const double *v, int x, int y, int left) {
    (void)x;
    return at(v, left, y / APART * APART);
}

static double median(const double *v, int x, int y, int left) {
    double near[25];
    (void)left;
    for (int i = 0; i < 25; i++)
        near[i] = at(v, x + i % 5 - 2, y + i / 5 - 2);
    sort_doubles(near, 25);
    return near[12];
}

static double mean(const double *v, int x, int y, int left) {
    double sum = 0.0;
    (void)left;
    for (int i = 0; i < 9; i++)
        sum += at(v, x + i % 3 - 1, y + i / 3 - 1) / 9.0;
    return sum;
}

/* From the last pixel before the patch to the first behind it, row by row. */
static double linear(const double *v, int x, int y, int left) {
    const double part = (double)(x - left + 1) / (PATCH + 1);
    return (1.0 - part) * at(v, left - 1, y) + part * at(v, left + PATCH, y);
}

typedef double patch_pixel(const double *v, int x, int y, int left);

/* Fill a patch of PATCH x PATCH px in every square of APART px. */
static void patch_up(chip_pixels *c, patch_pixel *kind, int x0, int y0) {
    double *from = malloc(sizeof(double) * SIDE * SIDE);
    assert_non_null(from);
    memcpy(from, c->value, sizeof(double) * SIDE * SIDE);
    for (int i = 0; i < SIDE * SIDE; i++) {
        const int x = i % SIDE;
        const int y = i / SIDE;
        if (x % APART >= x0 && x % APART < x0 + PATCH && y % APART >= y0 && y % APART < y0 + PATCH)
            c->value[i] = kind(from, x, y, x / APART * APART + x0);
    }
    free(from);
}

/* Return the mean variance of the noise stamps of many galaxies. */
static double variance(chip_pixels *c) {
    enum { GALAXIES = 1500 };
    const cutter_options options = chip_options(c);
    cut_fixture f;
    uint64_t seed = 8;
    double sum = 0.0;
    cut_init(&f, c, NULL, &options);
    for (int id = 0; id < GALAXIES; id++) {
        const double x = 100 + (SIDE - 200) * uniform(&seed);
        const double y = 100 + (SIDE - 200) * uniform(&seed);
        assert_int_equal(cut_at(&f, x, y, 4.0, id), 0);
        for (int i = 0; i < STAMP * STAMP; i++)
            sum += f.pair.noise[i] * f.pair.noise[i] / (STAMP * STAMP) / GALAXIES;
    }
    cut_deinit(&f);
    return sum;
}

/* All cells of a patch are touched, and noise stamps have the noise of the sky. */
static void test_patches_are_no_sky(void **state) {
    static patch_pixel *const kinds[] = {zero, constant, median, mean, linear};
    (void)state;
    for (size_t k = 0; k < sizeof kinds / sizeof kinds[0]; k++) {
        const int x0 = 37 + (int)k;
        const int y0 = 51 + (int)k;
        chip_pixels *c = chip_new(SIDE, SIDE, 1.0, 90 + k);
        const double whole = variance(c);
        patch_up(c, kinds[k], x0, y0);
        empty_sky s = {.boxes = {.x = {SIDE, 1}, .y = {SIDE, 1}, .stamp = STAMP, .frame = FRAME}};
        assert_int_equal(empty_sky_init(&s, c, NULL), SHEAR_OK);
        int free_cells = 0;
        for (int i = 0; i < SIDE * SIDE; i++) {
            const int x = i % SIDE % APART - x0;
            const int y = i / SIDE % APART - y0;
            const bool inside = x >= 1 && x < PATCH - 1 && y >= 1 && y < PATCH - 1;
            const bool away = x < -16 || x >= PATCH + 16 || y < -16 || y >= PATCH + 16;
            const bool touched = box_map_touched(&s.boxes, i % SIDE, i / SIDE);
            free_cells += inside && !touched;
            assert_false(away && touched);
        }
        assert_int_equal(free_cells, 0);
        empty_sky_deinit(&s);
        const double now = variance(c);
        print_message("kind %zu: variance of noise stamps %.4f, without patches %.4f\n", k, now,
                      whole);
        assert_true(fabs(now / whole - 1.0) < 0.01);
        chip_free(c);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_no_noise_is_mistaken),
        cmocka_unit_test(test_patches_are_no_sky),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
