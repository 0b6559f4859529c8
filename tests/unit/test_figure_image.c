/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Images: pixels at known places, with the colours of their values. */
#include "figure_fixture.h"
#include "test.h"

#include <math.h>
#include <stdlib.h>

static shear_image image_of(const double *pixels, int nx, int ny) {
    return (shear_image){
        .cell = {20, 20, 250, 250}, .pixels = pixels, .nx = nx, .ny = ny, .limits = {0.0, 4.0}};
}

/* The colour in the middle of pixel (i, j) of the open image. */
static uint32_t pixel_of(shear_figure *f, const shear_image *image, int i, int j) {
    const shear_rect r = shear_axes_frame(f);
    return shear_figure_pixel(f, (int)(r.x + r.w * (i + 0.5) / image->nx),
                              (int)(r.y + r.h * (1.0 - (j + 0.5) / image->ny)));
}

static void test_row_0_is_at_the_bottom(void **state) {
    (void)state;
    static const double pixels[2][3] = {{0.0, 1.0, 2.0}, {3.0, 4.0, NAN}};
    for (enum shear_map map = SHEAR_MAP_UNIFORM; map <= SHEAR_MAP_GREY; map++) {
        shear_figure *f = new_figure();
        shear_image image = image_of(&pixels[0][0], 3, 2);
        image.map = map;
        shear_image_begin(f, &image);
        for (int i = 0; i < 5; i++) {
            assert_int_equal(pixel_of(f, &image, i % 3, i / 3),
                             packed(shear_map_colour(map, i / 4.0)));
        }
        assert_int_equal(pixel_of(f, &image, 2, 1), packed(shear_map_not_finite()));
        const shear_rect r = shear_axes_frame(f);
        assert_true(fabs(r.w / 3.0 - r.h / 2.0) <= 1.0); /* square pixels */
        shear_axes_end(f);
        assert_saves(f);
    }
}

static void test_images_with_equal_units(void **state) {
    (void)state;
    static const double pixels[8] = {0.0, 1.0, 2.0, 3.0, 4.0, 0.0, 0.0, 0.0};
    shear_figure *f = new_figure();
    shear_image image = image_of(pixels, 4, 2);
    image.equal = true;
    image.x = image.y = (shear_range){-1.0, 1.0};
    shear_image_begin(f, &image);
    const shear_rect r = shear_axes_frame(f);
    assert_true(fabs(r.w - r.h) <= 1.0); /* frames end on whole pixels */
    assert_int_equal(pixel_of(f, &image, 0, 1), packed(shear_map_colour(SHEAR_MAP_UNIFORM, 1.0)));
    shear_axes_end(f);
    shear_figure_free(f);
}

/* Not smoothed: on both sides of an edge the full colours. */
static void test_pixels_are_not_smoothed(void **state) {
    (void)state;
    static const double pixels[2] = {0.0, 4.0};
    shear_figure *f = new_figure();
    const shear_image image = image_of(pixels, 2, 1);
    shear_image_begin(f, &image);
    const shear_rect r = shear_axes_frame(f);
    const int edge = (int)(r.x + r.w / 2.0);
    const int y = (int)(r.y + r.h / 2.0);
    assert_int_equal(shear_figure_pixel(f, edge - 1, y),
                     packed(shear_map_colour(SHEAR_MAP_UNIFORM, 0.0)));
    assert_int_equal(shear_figure_pixel(f, edge + 1, y),
                     packed(shear_map_colour(SHEAR_MAP_UNIFORM, 1.0)));
    shear_axes_end(f);
    shear_figure_free(f);
}

static void test_negatives_are_marked_if_asked(void **state) {
    (void)state;
    static const double pixels[4] = {-1.0, 0.0, 2.0, -1e-300};
    for (int marked = 0; marked < 2; marked++) {
        shear_figure *f = new_figure();
        shear_image image = image_of(pixels, 4, 1);
        image.mark_negative = marked;
        shear_image_begin(f, &image);
        const uint32_t lowest = packed(shear_map_colour(SHEAR_MAP_UNIFORM, 0.0));
        const uint32_t negative = marked != 0 ? packed(shear_map_negative()) : lowest;
        assert_int_equal(pixel_of(f, &image, 0, 0), negative);
        assert_int_equal(pixel_of(f, &image, 1, 0), lowest);
        assert_int_equal(pixel_of(f, &image, 3, 0), negative);
        shear_axes_end(f);
        shear_figure_free(f);
    }
}

static void test_automatic_limits_are_percentiles(void **state) {
    (void)state;
    double pixels[101];
    for (int i = 0; i <= 100; i++)
        pixels[i] = i;
    shear_figure *f = new_figure();
    shear_image image = image_of(pixels, 101, 1);
    image.limits = (shear_range){0};
    image.percentiles = (shear_range){20.0, 60.0};
    shear_image_begin(f, &image);
    assert_int_equal(pixel_of(f, &image, 10, 0), packed(shear_map_colour(SHEAR_MAP_UNIFORM, 0.0)));
    assert_int_equal(pixel_of(f, &image, 40, 0), packed(shear_map_colour(SHEAR_MAP_UNIFORM, 0.5)));
    assert_int_equal(pixel_of(f, &image, 80, 0), packed(shear_map_colour(SHEAR_MAP_UNIFORM, 1.0)));
    shear_axes_end(f);
    shear_figure_free(f);
}

static void test_colour_bar_runs_upward(void **state) {
    (void)state;
    static const double pixels[4] = {0.0, 1.0, 2.0, 4.0};
    shear_figure *f = new_figure();
    shear_image image = image_of(pixels, 2, 2);
    image.colour_bar = true;
    shear_image_begin(f, &image);
    const shear_rect r = shear_axes_frame(f);
    const int x = (int)(r.x + r.w) + 9;
    const uint32_t top = shear_figure_pixel(f, x, (int)r.y + 1);
    const uint32_t bottom = shear_figure_pixel(f, x, (int)(r.y + r.h) - 2);
    shear_axes_end(f);
    const uint32_t highest = packed(shear_map_colour(SHEAR_MAP_UNIFORM, 1.0));
    const uint32_t lowest = packed(shear_map_colour(SHEAR_MAP_UNIFORM, 0.0));
    assert_true(abs((int)(top >> 16) - (int)(highest >> 16)) < 8);
    assert_true(abs((int)(bottom >> 16) - (int)(lowest >> 16)) < 8);
    shear_figure_free(f);
}

static void test_images_of_nothing_but_nan(void **state) {
    (void)state;
    const double pixels[4] = {NAN, INFINITY, -INFINITY, NAN};
    for (enum shear_stretch_kind stretch = SHEAR_LINEAR; stretch <= SHEAR_LOG; stretch++) {
        shear_figure *f = new_figure();
        shear_image image = image_of(pixels, 2, 2);
        image.limits = (shear_range){0};
        image.stretch = stretch;
        image.colour_bar = image.ticks = true;
        shear_image_begin(f, &image);
        assert_int_equal(pixel_of(f, &image, 1, 1), packed(shear_map_not_finite()));
        shear_axes_end(f);
        assert_saves(f);
    }
}

static void test_images_without_pixels_fail(void **state) {
    (void)state;
    static const double pixel = 1.0;
    const shear_image bad[] = {image_of(&pixel, 0, 1), image_of(&pixel, 1, 0),
                               image_of(&pixel, 40000, 1), image_of(NULL, 1, 1)};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        shear_figure *f = new_figure();
        shear_image_begin(f, &bad[i]);
        shear_axes_end(f); /* what follows a failure is not drawn, and does no harm */
        shear_figure_text(f, 10, 10, "text", &(shear_text_style){0});
        assert_failed(f, SHEAR_E_INTERNAL);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_row_0_is_at_the_bottom),
        cmocka_unit_test(test_images_with_equal_units),
        cmocka_unit_test(test_pixels_are_not_smoothed),
        cmocka_unit_test(test_negatives_are_marked_if_asked),
        cmocka_unit_test(test_automatic_limits_are_percentiles),
        cmocka_unit_test(test_colour_bar_runs_upward),
        cmocka_unit_test(test_images_of_nothing_but_nan),
        cmocka_unit_test(test_images_without_pixels_fail),
    };
    return cmocka_run_group_tests(tests, make_directory, remove_directory);
}
