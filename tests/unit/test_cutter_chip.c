/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A cutter on the pixels of files: what it cuts are the file's, but for a plane and the fills. */
#include "exposure_fixture.h"
#include "survey/cutout/cutter.h"

#include "shear/stamp.h"

#include <math.h>
#include <stdlib.h>

enum { NX = 420, NY = 300, STAMP = 32, N = STAMP * STAMP, COLUMN = 213 };

static double sky[NX * NY], weight[NX * NY], mask[NX * NY], objects[NX * NY];

static double value_at(int x, int y) {
    return 100.0 + 0.25 * ((x * 7919 + y * 104729 + x * y * 31) % 61) + 0.125 * x;
}

/* Galaxy 1 is good, 2 and 3 are neighbours, 4 lies on the bad column; weights are 1/16. */
static void write_exposure(void) {
    static const double at[4][2] = {{225, 150}, {100, 200}, {112, 200}, {COLUMN, 60}};
    for (int i = 0; i < NX * NY; i++) {
        sky[i] = value_at(i % NX, i / NX);
        weight[i] = 0.0625;
        mask[i] = i % NX == COLUMN;
        for (int k = 0; k < 4; k++) {
            if (hypot(i % NX - at[k][0], (double)(i / NX) - at[k][1]) <= 5.0)
                objects[i] = k + 1;
        }
    }
    exposure_write(fixture_path("image.fits"), NULL, -64, NX, NY, sky);
    exposure_write(fixture_path("weight.fits"), NULL, -32, NX, NY, weight);
    exposure_write(fixture_path("mask.fits"), NULL, 16, NX, NY, mask);
    exposure_write(fixture_path("objects.fits"), NULL, 32, NX, NY, objects);
}

/* The stamp at (x, y) differs from the image by a plane, but for the filled columns. Return how
 * many pixels are filled. */
static int check_stamp(const double *stamp, int x, int y, int filled) {
    double d[N];
    int n = 0;
    for (int i = 0; i < N; i++)
        d[i] = sky[(y + i / STAMP) * NX + x + i % STAMP] - stamp[i];
    for (int i = 0; i < N; i++) {
        const int j = i % STAMP;
        const double plane = d[0] + (d[1] - d[0]) * j + (d[STAMP] - d[0]) * (double)(i / STAMP);
        if (j == filled) {
            assert_true(fabs(d[i] - plane) > 1e-6);
            n++;
        } else {
            assert_true(fabs(d[i] - plane) < 1e-8);
        }
    }
    return n;
}

static void stamps_are_the_files(void **state) {
    (void)state;
    write_exposure();
    const shear_input input =
        exposure_input(fixture_path("image.fits"), fixture_path("weight.fits"),
                       fixture_path("mask.fits"), fixture_path("objects.fits"));
    exposure_images *e = exposure_open(&input);
    chip_pixels *pixels;
    cutter *c;
    double galaxy[N];
    double noise[N];
    cutter_pair pair = {.galaxy = galaxy, .noise = noise};
    const cutter_options options = {.nx = NX,
                                    .ny = NY,
                                    .stamp = STAMP,
                                    .noise_stamps = 1,
                                    .noise = SHEAR_NOISE_NEAR,
                                    .r_psf_px = 1.0};
    assert_int_equal(chip_pixels_open(&pixels, e, 0, NULL, 0, NULL), SHEAR_OK);
    assert_int_equal(cutter_new(&c, pixels, NULL, &options, NULL), SHEAR_OK);
    const struct {
        double x, y;
        uint32_t flags;
    } sources[] = {{225.2, 149.8, 0},
                   {100, 200, SHEAR_FLAG_NEIGHBOUR},
                   {COLUMN, 60, SHEAR_FLAG_HOLE},
                   {10, 10, SHEAR_FLAG_EDGE},
                   {NX, 10, SHEAR_FLAG_NO_POSITION}};
    for (int id = 0; id < 100; id++) {
        const int k = id % 5;
        const cutter_source s = {.x = sources[k].x, .y = sources[k].y, .r_gal = 5.0, .id = id};
        assert_int_equal(cutter_cut(c, &s, &pair, NULL), SHEAR_OK);
        assert_int_equal(pair.flags, sources[k].flags);
        if (pair.flags != 0)
            continue;
        assert_true(pair.x == 225 - STAMP / 2 && pair.y == 150 - STAMP / 2);
        /* a whole column is more than 2 % of a stamp */
        assert_true(pair.noise_x[0] > COLUMN || pair.noise_x[0] + STAMP <= COLUMN);
        assert_int_equal(check_stamp(galaxy, pair.x, pair.y, COLUMN - pair.x), STAMP);
        assert_int_equal(check_stamp(noise, pair.noise_x[0], pair.noise_y[0], COLUMN - pair.x),
                         STAMP);
        assert_true(pair.sigma > 3.9 && pair.sigma < 5.2); /* 61 steps of 0.25: 4.4 */
    }
    cutter_free(c);
    chip_pixels_close(pixels);
    exposure_images_close(e);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(stamps_are_the_files),
    };
    return cmocka_run_group_tests(tests, fixture_setup, fixture_teardown);
}
