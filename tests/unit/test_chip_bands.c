/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The bands of a chip that does not fit into memory at first: whatever was read before, a box has
 * its own pixels. */
#include "exposure_fixture.h"

#include <math.h>
#include <stdlib.h>

enum { SIDE = 90 };

static double value_at(int x, int y) {
    return (x * 31 + y * 17) % 30000;
}

static double weight_at(int x, int y) {
    return (x + y) % 7;
}

static double owner_at(int x, int y) {
    return (x / 50 + y / 30) % 100;
}

static const char *write_layer(const char *name, int nx, int ny, double (*at)(int, int)) {
    const char *path = fixture_path(name);
    double *pixels = malloc((size_t)nx * (size_t)ny * sizeof *pixels);
    assert_non_null(pixels);
    for (int y = 0; y < ny; y++) {
        for (int x = 0; x < nx; x++)
            pixels[(size_t)y * (size_t)nx + (size_t)x] = at(x, y);
    }
    exposure_write(path, NULL, 16, nx, ny, pixels);
    free(pixels);
    return path;
}

static void check(chip_pixels *c, int x, int y, int nx, int ny) {
    static double value[SIDE * SIDE];
    static float sigma[SIDE * SIDE];
    static uint8_t defect[SIDE * SIDE];
    static int32_t owner[SIDE * SIDE];
    const pixel_box box = {.x = x,
                           .y = y,
                           .nx = nx,
                           .ny = ny,
                           .value = value,
                           .sigma = sigma,
                           .defect = defect,
                           .owner = owner};
    shear_error err;
    assert_int_equal(chip_pixels_read(c, &box, &err), SHEAR_OK);
    for (int i = 0; i < nx * ny; i++) {
        const int at_x = x + i % nx;
        const int at_y = y + i / nx;
        const double weight = weight_at(at_x, at_y);
        assert_true(value[i] == value_at(at_x, at_y));
        assert_int_equal(owner[i], owner_at(at_x, at_y));
        assert_int_equal(defect[i], weight > 0.0 ? 0 : PIXEL_BAD);
        assert_true(weight > 0.0 ? sigma[i] == (float)(1.0 / sqrt(weight)) : isnan(sigma[i]));
    }
}

static int random_below(unsigned *seed, int n) {
    *seed = *seed * 1664525U + 1013904223U;
    return (int)((*seed >> 8) % (unsigned)n);
}

/* A survey of rows, then boxes in the order of rows with steps back, then boxes anywhere. */
static void read_in_any_order(int nx, int ny) {
    const shear_input input = exposure_input(write_layer("image.fits", nx, ny, value_at),
                                             write_layer("weight.fits", nx, ny, weight_at), NULL,
                                             write_layer("owner.fits", nx, ny, owner_at));
    exposure_images *e = exposure_open(&input);
    chip_pixels *c = NULL;
    shear_error err;
    unsigned seed = 5;
    assert_int_equal(chip_pixels_open(&c, e, 0, NULL, 0, &err), SHEAR_OK);
    for (int y = 0; y + 72 <= ny; y += 64)
        check(c, random_below(&seed, nx - SIDE), y, SIDE, 72);
    for (int i = 0; i < 400; i++) {
        const int y = (int)((int64_t)i * ny / 400) - random_below(&seed, 500);
        check(c, random_below(&seed, nx - SIDE),
              y < 0           ? 0
              : y > ny - SIDE ? ny - SIDE
                              : y,
              SIDE, SIDE);
    }
    for (int i = 0; i < 100; i++)
        check(c, random_below(&seed, nx - SIDE), random_below(&seed, ny - SIDE), SIDE, SIDE);
    chip_pixels_close(c);
    exposure_images_close(e);
}

static void high_chip(void **state) {
    (void)state;
    read_in_any_order(1200, 4000);
}

/* A few rows a band: fewer than a survey looks at together. */
static void wide_chip(void **state) {
    (void)state;
    read_in_any_order(16000, 300);
}

/* A box needs more bands than are in memory at first. */
static void widest_chip(void **state) {
    (void)state;
    read_in_any_order(60000, SIDE + 1);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(high_chip),
        cmocka_unit_test(wide_chip),
        cmocka_unit_test(widest_chip),
    };
    return cmocka_run_group_tests(tests, fixture_setup, fixture_teardown);
}
