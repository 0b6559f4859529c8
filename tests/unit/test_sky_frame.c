/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Moments in the frame of the sky do not know how the pixels lie on it. */
#include "sky_scene.h"
#include "test.h"

#include <math.h>

/* A Jacobian: scale in arcsec, angle in radians, mirrored or not, and shear of the pixels. */
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

/* beta in pixels for a target of 0.6 arcsec. */
static double beta_px(const sky_scene *s) {
    const double *j = s->jacobian;
    return 0.6 / sqrt(fabs(j[0] * j[3] - j[1] * j[2]));
}

static void check_frames(bool model) {
    static sky_scene s;
    for (int i = 0; i < PIXELS; i++) {
        make(&s, i);
        shear_plan_info info;
        sky_way way = {.frame = SHEAR_FRAME_SKY, .model = model, .beta_px = beta_px(&s)};
        const shear_row sky = sky_scene_measure(&s, &way, &info);
        assert_near(info.beta, 0.6, 1e-12, 1.0, "beta");
        const shear_row exact = gaussian_row(&s.galaxy, &s.psf, 0.6);
        assert_int_equal(sky.flags, 0);
        assert_rows_near(&sky, &exact, 1e-9);
        way.frame = SHEAR_FRAME_SKY_EAST;
        const shear_row east = sky_scene_measure(&s, &way, NULL);
        gaussian mirror = s.galaxy;
        gaussian mirror_psf = s.psf;
        mirror.xy = -mirror.xy;
        mirror_psf.xy = -mirror_psf.xy;
        const shear_row mirrored = gaussian_row(&mirror, &mirror_psf, 0.6);
        assert_rows_near(&east, &mirrored, 1e-9);
    }
}

static void test_any_pixels_with_one_image(void **state) {
    (void)state;
    check_frames(false);
}

static void test_any_pixels_with_a_model(void **state) {
    (void)state;
    check_frames(true);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_any_pixels_with_one_image),
                                       cmocka_unit_test(test_any_pixels_with_a_model)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
