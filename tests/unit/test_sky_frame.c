/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Moments in the frame of the sky do not know how the pixels lie on it. */
#include "pair.h"
#include "sky_scene.h"
#include "test.h"

#include <math.h>
#include <string.h>

/* A Jacobian: scale in arcsec, angle in radians, mirrored or not, and shear of the pixels. The last
 * ones are a distortion of 4 % and 28 % of area. */
static const struct {
    double scale, angle;
    bool mirrored;
    double g1, g2;
} pixels[] = {{0.2, 0.0, false, 0.0, 0.0},      {0.2, M_PI / 2, false, 0.0, 0.0},
              {0.2, 0.7, false, 0.0, 0.0},      {0.2, -2.4, true, 0.0, 0.0},
              {0.2, 0.0, true, 0.0, 0.0},       {0.2, 0.3, false, 0.03, -0.026},
              {0.226, 1.1, true, -0.02, 0.034}, {0.17, 2.9, false, 0.2, 0.1}};
enum { PIXELS = sizeof pixels / sizeof *pixels };

static void make(sky_scene *s, int i) {
    sky_scene_init(s, pixels[i].scale, pixels[i].angle, pixels[i].mirrored, pixels[i].g1,
                   pixels[i].g2);
}

static const double beta = 0.6; /* arcsec */

static void check_frames(const shear_psf_model *model, bool own_psf) {
    static sky_scene s;
    for (int i = 0; i < PIXELS; i++) {
        make(&s, i);
        shear_psf_model with_samples;
        if (model != NULL) {
            with_samples = *model;
            with_samples.samples = s.samples;
        }
        shear_plan_info info;
        sky_way way = {.frame = SHEAR_FRAME_SKY,
                       .model = model != NULL ? &with_samples : NULL,
                       .oversample = 2.0,
                       .own_psf = own_psf,
                       .beta_px = beta / sky_scene_pixel_scale(&s)};
        const shear_row sky = sky_scene_measure(&s, &way, &info);
        const shear_row exact = gaussian_row(&s.galaxy, &s.psf, beta);
        assert_near(info.beta, beta, 1e-12, 1.0, "beta");
        assert_int_equal(info.frame, SHEAR_FRAME_SKY);
        assert_int_equal(sky.flags, 0);
        assert_int_equal(sky.frame, SHEAR_FRAME_SKY);
        assert_rows_near(&sky, &exact, 1e-9);
        way.frame = SHEAR_FRAME_SKY_EAST;
        const shear_row east = sky_scene_measure(&s, &way, NULL);
        gaussian mirror = s.galaxy;
        gaussian mirror_psf = s.psf;
        mirror.xy = -mirror.xy;
        mirror_psf.xy = -mirror_psf.xy;
        const shear_row mirrored = gaussian_row(&mirror, &mirror_psf, beta);
        assert_rows_near(&east, &mirrored, 1e-9);
    }
}

static void test_any_pixels_with_one_image(void **state) {
    (void)state;
    check_frames(NULL, false);
}

static void test_any_pixels_with_images_of_stamps(void **state) {
    (void)state;
    check_frames(NULL, true);
}

static void test_any_pixels_with_a_model(void **state) {
    (void)state;
    const shear_psf_model model = {
        .nx = SCENE_PSF_SIDE, .ny = SCENE_PSF_SIDE, .terms = 1, .step = 0.5};
    check_frames(&model, false);
}

/* With pixels of one arcsec that lie as the frame does, both frames are the same, noise, cross
 * spectrum and all. */
static void test_pixels_are_a_frame(void **state) {
    (void)state;
    static sky_scene s;
    sky_scene_init(&s, 1.0, 0.0, false, 0.0, 0.0);
    uint64_t seed = 5;
    draw_blobs(s.pixels, SCENE_SIDE, SCENE_SIDE, 9, 3.0, 8);
    for (int i = 0; i < SCENE_SIDE * SCENE_SIDE; i++) {
        s.noise[i] = 1e-3 * uniform(&seed);
        s.pixels[i] += 1e-3 * uniform(&seed);
    }
    s.psf.xx = 2.4;
    s.psf.yy = 2.0;
    sky_scene_draw_psf(&s, 0.5, 0.0, 0.0);
    sky_way way = {.oversample = 2.0, .beta_px = 3.2, .shot_noise = "plateau"};
    const shear_row pixel_plateau = sky_scene_measure(&s, &way, NULL);
    way.frame = SHEAR_FRAME_SKY;
    const shear_row sky_plateau = sky_scene_measure(&s, &way, NULL);
    assert_rows_near(&sky_plateau, &pixel_plateau, 1e-12);
    way = (sky_way){.oversample = 2.0, .beta_px = 3.2, .estimator = "pdf-sym-cross"};
    const shear_row pixel = sky_scene_measure(&s, &way, NULL);
    way.frame = SHEAR_FRAME_SKY;
    const shear_row sky = sky_scene_measure(&s, &way, NULL);
    const double scale = fabs(pixel.d);
    assert_rows_near(&sky, &pixel, 1e-13);
    assert_near(sky.cross_n1, pixel.cross_n1, 1e-13, scale, "cross_n1");
    assert_near(sky.cross_n2, pixel.cross_n2, 1e-13, scale, "cross_n2");
    assert_near(sky.cross_d, pixel.cross_d, 1e-13, scale, "cross_d");
    assert_near(sky.cross_u, pixel.cross_u, 1e-13, fabs(pixel.m4), "cross_u");
    assert_near(sky.cross_v, pixel.cross_v, 1e-13, fabs(pixel.m4), "cross_v");
    assert_near(sky.noise_d, pixel.noise_d, 1e-12, fabs(pixel.noise_d), "noise_d");
    assert_near(sky.noise_u, pixel.noise_u, 1e-12, fabs(pixel.noise_d), "noise_u");
    assert_near(sky.noise_v, pixel.noise_v, 1e-12, fabs(pixel.noise_d), "noise_v");
    assert_near(sky.high_noise, pixel.high_noise, 0.0, 1.0, "high_noise");
    assert_near(sky.flux, pixel.flux, 0.0, 1.0, "flux");
}

/* Turn an image by 90 degrees: the new x is the old y, the new y is the old -x. (An even side has
 * no middle pixel; a shift changes no moment.) */
static void turn(double *image) {
    static double old[SCENE_SIDE * SCENE_SIDE];
    memcpy(old, image, sizeof old);
    for (int y = 0; y < SCENE_SIDE; y++) {
        for (int x = 0; x < SCENE_SIDE; x++)
            image[(SCENE_SIDE - 1 - x) * SCENE_SIDE + y] = old[y * SCENE_SIDE + x];
    }
}

/* A noisy scene whose camera is turned by 90 degrees has the same row. */
static void test_turned_camera(void **state) {
    (void)state;
    static sky_scene s;
    sky_scene_init(&s, 0.2, 0.4, false, 0.02, 0.01);
    uint64_t seed = 6;
    for (int i = 0; i < SCENE_SIDE * SCENE_SIDE; i++) {
        s.noise[i] = 1e-3 * uniform(&seed);
        s.pixels[i] += 1e-3 * uniform(&seed);
    }
    const sky_way way = {.frame = SHEAR_FRAME_SKY,
                         .oversample = 2.0,
                         .beta_px = beta / sky_scene_pixel_scale(&s),
                         .estimator = "pdf-sym-cross"};
    const shear_row before = sky_scene_measure(&s, &way, NULL);
    turn(s.pixels);
    turn(s.noise);
    const double j[4] = {s.jacobian[1], -s.jacobian[0], s.jacobian[3], -s.jacobian[2]};
    memcpy(s.jacobian, j, sizeof j);
    sky_scene_draw_psf(&s, 0.5, 0.17, 0.0);
    const shear_row after = sky_scene_measure(&s, &way, NULL);
    assert_rows_near(&after, &before, 1e-11);
    assert_near(after.cross_n1, before.cross_n1, 1e-11, fabs(before.d), "cross_n1");
    assert_near(after.cross_n2, before.cross_n2, 1e-11, fabs(before.d), "cross_n2");
    /* It depends on R_PSF, whose contour was found on other samples. */
    assert_near(after.cross_v, before.cross_v, 1e-4, before.cross_v, "cross_v");
    assert_near(after.noise_n1, before.noise_n1, 1e-10, fabs(before.noise_d), "noise_n1");
    assert_near(after.noise_n2, before.noise_n2, 1e-10, fabs(before.noise_d), "noise_n2");
}

/* Round galaxies under a shear, each on pixels of its own: their sums have the sky's shear. */
static void test_random_pixels(void **state) {
    (void)state;
    enum { GALAXIES = 40 };
    static const double g1 = 0.03;
    static const double g2 = -0.02;
    static sky_scene s;
    uint64_t seed = 11;
    double n1 = 0.0;
    double n2 = 0.0;
    double d = 0.0;
    double first_d = 0.0;
    for (int i = 0; i < GALAXIES; i++) {
        sky_scene_init(&s, 0.17 + 0.05 * uniform(&seed), 7.0 * uniform(&seed), uniform(&seed) > 0.5,
                       0.08 * uniform(&seed) - 0.04, 0.08 * uniform(&seed) - 0.04);
        const double r2 = 0.3;
        s.galaxy = (gaussian){.amplitude = 1.0,
                              .xx = r2 * ((1 + g1) * (1 + g1) + g2 * g2) + s.psf.xx,
                              .yy = r2 * ((1 - g1) * (1 - g1) + g2 * g2) + s.psf.yy,
                              .xy = r2 * 2.0 * g2 + s.psf.xy};
        s.shift_x = uniform(&seed);
        s.shift_y = uniform(&seed);
        sky_scene_draw(&s);
        const sky_way way = {.frame = SHEAR_FRAME_SKY,
                             .oversample = 2.0,
                             .beta_px = beta / sky_scene_pixel_scale(&s)};
        const shear_row row = sky_scene_measure(&s, &way, NULL);
        assert_int_equal(row.flags, 0);
        n1 += row.n1;
        n2 += row.n2;
        d += row.d;
        first_d = i == 0 ? row.d : first_d;
        assert_near(row.d, first_d, 1e-9, first_d, "every galaxy counts alike");
    }
    const shear_row exact = gaussian_row(&s.galaxy, &s.psf, beta);
    assert_near(n1 / d, exact.n1 / exact.d, 1e-9, 1.0, "g1");
    assert_near(n2 / d, exact.n2 / exact.d, 1e-9, 1.0, "g2");
    assert_near(n1 / d, g1, 1e-3, 1.0, "g1, to third order");
    assert_near(n2 / d, g2, 1e-3, 1.0, "g2, to third order");
}

/* Numbers that are no Jacobian flag the stamp. */
static void test_bad_jacobians(void **state) {
    (void)state;
    static const double bad[][4] = {{NAN, 0.0, 0.0, 0.2},     {0.2, INFINITY, 0.0, 0.2},
                                    {0.0, 0.0, 0.0, 0.0},     {0.2, 0.2, 0.2, 0.2},
                                    {0.2, 0.0, 0.0, 0.01},    {1e300, 0.0, 0.0, 1e300},
                                    {1e-300, 0.0, 0, 1e-300}, {-NAN, NAN, 1e308, -1e308}};
    static sky_scene s;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        sky_scene_init(&s, 0.2, 0.4, false, 0.0, 0.0);
        sky_way way = {.frame = SHEAR_FRAME_SKY, .oversample = 2.0, .beta_px = 3.0};
        way.jacobian = bad[i];
        const shear_row row = sky_scene_measure(&s, &way, NULL);
        assert_int_equal(row.flags, SHEAR_FLAG_NO_POSITION);
        assert_true(isnan(row.d));
    }
    /* A map, but of pixels so large that nothing of the target is seen. */
    sky_way way = {.frame = SHEAR_FRAME_SKY, .oversample = 2.0, .beta_px = 3.0};
    way.jacobian = (const double[]){1e100, 0.0, 0.0, 1e100};
    assert_int_equal(sky_scene_measure(&s, &way, NULL).flags, SHEAR_FLAG_PSF_UNUSABLE);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_any_pixels_with_one_image),
                                       cmocka_unit_test(test_any_pixels_with_images_of_stamps),
                                       cmocka_unit_test(test_any_pixels_with_a_model),
                                       cmocka_unit_test(test_pixels_are_a_frame),
                                       cmocka_unit_test(test_turned_camera),
                                       cmocka_unit_test(test_random_pixels),
                                       cmocka_unit_test(test_bad_jacobians)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
