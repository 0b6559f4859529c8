/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pictures: pixels at known places, files that appear whole or not at all, and what cannot be
 * drawn. */
#include "test.h"

#include "shear_figures/figure.h"

#include <dirent.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

enum { SIDE = 300 };
static char directory[64];

static int make_directory(void **state) {
    (void)state;
    snprintf(directory, sizeof directory, "%s", "/tmp/test_figure_XXXXXX");
    return mkdtemp(directory) != NULL ? 0 : -1;
}

static int remove_directory(void **state) {
    (void)state;
    return rmdir(directory);
}

/* A name in the test's directory; good until the next call. */
static const char *in_directory(const char *name) {
    static char path[128];
    snprintf(path, sizeof path, "%s/%s", directory, name);
    return path;
}

static int entries(void) {
    int n = 0;
    DIR *d = opendir(directory);
    while (d != NULL && readdir(d) != NULL)
        n++;
    closedir(d);
    return n - 2; /* . and .. */
}

static shear_figure *new_figure(void) {
    shear_figure *f = NULL;
    assert_int_equal(shear_figure_new(&f, SIDE, SIDE, NULL), SHEAR_OK);
    return f;
}

static uint32_t packed(shear_colour c) {
    return (uint32_t)lround(255.0 * c.r) << 16 | (uint32_t)lround(255.0 * c.g) << 8 |
           (uint32_t)lround(255.0 * c.b);
}

static int darkness(shear_figure *f, double x, double y) {
    const uint32_t p = shear_figure_pixel(f, (int)x, (int)y);
    return 765 - (int)((p >> 16 & 255) + (p >> 8 & 255) + (p & 255));
}

/* The figure has failed with this code, and nothing is written. */
static void assert_failed(shear_figure *f, int code) {
    shear_error err = {0};
    assert_int_equal(shear_figure_save(f, in_directory("never.png"), true, &err), code);
    assert_int_equal(err.code, code);
    assert_true(err.message[0] != '\0');
    assert_int_equal(entries(), 0);
    shear_figure_free(f);
}

/* Nothing went wrong: the picture can be written. */
static void assert_saves(shear_figure *f) {
    shear_error err = {0};
    assert_int_equal(shear_figure_save(f, in_directory("fine.png"), true, &err), SHEAR_OK);
    assert_int_equal(unlink(in_directory("fine.png")), 0);
    shear_figure_free(f);
}

/* ---- canvas and files ---- */

static uint32_t big_endian(const unsigned char *p) {
    return (uint32_t)p[0] << 24 | (uint32_t)p[1] << 16 | (uint32_t)p[2] << 8 | p[3];
}

static void test_png_has_the_size_and_an_end(void **state) {
    (void)state;
    shear_figure *f = NULL;
    assert_int_equal(shear_figure_new(&f, 123, 45, NULL), SHEAR_OK);
    assert_int_equal(shear_figure_pixel(f, 122, 44), 0xffffff);
    assert_int_equal(shear_figure_pixel(f, 123, -1), 0xffffff);
    assert_int_equal(shear_figure_save(f, in_directory("a.png"), false, NULL), SHEAR_OK);
    shear_figure_free(f);
    unsigned char bytes[4096];
    FILE *file = fopen(in_directory("a.png"), "rb");
    assert_non_null(file);
    const size_t n = fread(bytes, 1, sizeof bytes, file);
    fclose(file);
    assert_in_range(n, 45, sizeof bytes - 1);
    assert_memory_equal(bytes, "\x89PNG\r\n\x1a\n", 8);
    assert_memory_equal(bytes + 12, "IHDR", 4);
    assert_int_equal(big_endian(bytes + 16), 123);
    assert_int_equal(big_endian(bytes + 20), 45);
    assert_memory_equal(bytes + n - 8, "IEND", 4);
    assert_int_equal(entries(), 1); /* no temporary file is left */
    assert_int_equal(unlink(in_directory("a.png")), 0);
}

static void test_sizes_that_cannot_be(void **state) {
    (void)state;
    static const int bad[][2] = {{0, 10}, {10, 0}, {-5, 5}, {20001, 10}, {10, 2147483647}};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        shear_error err = {0};
        shear_figure *f = (shear_figure *)&err;
        assert_int_equal(shear_figure_new(&f, bad[i][0], bad[i][1], &err), SHEAR_E_SETTING);
        assert_null(f);
        assert_true(err.advice[0] != '\0');
    }
    shear_figure_free(NULL);
}

static off_t size_of(const char *path) {
    struct stat st;
    return stat(path, &st) == 0 ? st.st_size : -1;
}

static void test_an_existing_file_is_replaced_only_if_asked(void **state) {
    (void)state;
    shear_figure *f = new_figure();
    shear_error err = {0};
    FILE *file = fopen(in_directory("b.png"), "wb");
    assert_non_null(file);
    fputs("mine", file);
    fclose(file);
    assert_int_equal(shear_figure_save(f, in_directory("b.png"), false, &err), SHEAR_E_EXISTS);
    assert_int_equal(size_of(in_directory("b.png")), 4);
    assert_int_equal(shear_figure_save(f, in_directory("b.png"), true, &err), SHEAR_OK);
    assert_true(size_of(in_directory("b.png")) > 40);
    assert_int_equal(entries(), 1);
    assert_int_equal(unlink(in_directory("b.png")), 0);
    shear_figure_free(f);
}

static void test_places_that_cannot_be_written(void **state) {
    (void)state;
    shear_figure *f = new_figure();
    const char *const bad[] = {"/nonexistent/x.png", "/dev/null", "/dev/null/x.png", directory, ""};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        shear_error err = {0};
        assert_int_equal(shear_figure_save(f, bad[i], true, &err), SHEAR_E_IO);
        assert_non_null(strstr(err.message, bad[i]));
        assert_true(err.advice[0] != '\0');
    }
    assert_int_equal(entries(), 0);
    shear_figure_free(f);
}

static void test_a_full_disk_leaves_nothing(void **state) {
    (void)state;
    struct rlimit before;
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
    const struct rlimit small = {.rlim_cur = 64, .rlim_max = before.rlim_max};
    void (*handler)(int) = signal(SIGXFSZ, SIG_IGN);
    shear_figure *f = new_figure();
    shear_error err = {0};
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &small), 0);
    const int code = shear_figure_save(f, in_directory("c.png"), false, &err);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &before), 0);
    signal(SIGXFSZ, handler);
    assert_int_equal(code, SHEAR_E_IO);
    assert_int_equal(entries(), 0);
    shear_figure_free(f);
}

/* ---- layout ---- */

static void test_cells_tile_the_area(void **state) {
    (void)state;
    static const double weights[3] = {1.0, 2.0, 1.0};
    const shear_grid g = {.area = {10, 20, 420, 210},
                          .rows = 2,
                          .columns = 3,
                          .gap_x = 10,
                          .gap_y = 10,
                          .column_weights = weights};
    const shear_rect first = shear_grid_cell(&g, 0, 0, 1, 1);
    const shear_rect middle = shear_grid_cell(&g, 1, 1, 1, 1);
    const shear_rect last = shear_grid_cell(&g, 1, 2, 1, 1);
    const shear_rect all = shear_grid_cell(&g, 0, 0, 2, 3);
    assert_true(first.x == 10 && first.y == 20 && first.w == 100 && first.h == 100);
    assert_true(middle.x == 120 && middle.y == 130 && middle.w == 200);
    assert_true(last.x == 330 && last.x + last.w == 430 && last.y + last.h == 230);
    assert_memory_equal(&all, &g.area, sizeof all);
    assert_true(shear_grid_cell(&g, 0, 2, 1, 2).w == 0.0);
    assert_true(shear_grid_cell(&g, -1, 0, 1, 1).w == 0.0);
    assert_true(shear_grid_cell(&g, 0, 0, 0, 1).w == 0.0);
}

/* ---- images ---- */

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

/* ---- axes ---- */

static void begin(shear_figure *f, shear_range x, shear_range y, bool log) {
    const shear_axes axes = {
        .cell = {0, 0, SIDE, SIDE}, .x = {.range = x, .log = log}, .y = {.range = y, .log = log}};
    shear_axes_begin(f, &axes);
}

static void test_marks_are_where_the_data_are(void **state) {
    (void)state;
    shear_figure *f = new_figure();
    begin(f, (shear_range){0, 10}, (shear_range){-1, 1}, false);
    const shear_rect r = shear_axes_frame(f);
    shear_axes_vline(f, 2.5, &(shear_style){.width = 3.0});
    const double x = 7.5;
    const double y = 0.5;
    shear_axes_points(f, 1, &x, &y, NULL, NULL, &(shear_style){.size = 10.0});
    assert_true(darkness(f, r.x + 0.25 * r.w, r.y + 0.9 * r.h) > 500);
    assert_true(darkness(f, r.x + 0.75 * r.w, r.y + 0.25 * r.h) > 500);
    assert_int_equal(darkness(f, r.x + 0.75 * r.w, r.y + 0.75 * r.h), 0);
    assert_int_equal(darkness(f, r.x + 0.5 * r.w, r.y + 0.5 * r.h), 0);
    shear_axes_end(f);
    assert_true(darkness(f, r.x + 0.5 * r.w, r.y - 0.5) > 300); /* the frame */
    assert_saves(f);
}

static void test_log_axes(void **state) {
    (void)state;
    shear_figure *f = new_figure();
    begin(f, (shear_range){1, 1e4}, (shear_range){1e-4, 1}, true);
    const shear_rect r = shear_axes_frame(f);
    shear_axes_vband(f, 90.0, 110.0, &(shear_style){.fill = 1.0});
    shear_axes_hline(f, 1e-3, &(shear_style){.width = 3.0});
    assert_true(darkness(f, r.x + 0.5 * r.w, r.y + 0.5 * r.h) > 500);
    assert_true(darkness(f, r.x + 0.1 * r.w, r.y + 0.75 * r.h) > 500);
    assert_int_equal(darkness(f, r.x + 0.1 * r.w, r.y + 0.5 * r.h), 0);
    const double x[3] = {-1.0, 0.0, 10.0}; /* without a place, but the last */
    const double y[3] = {1e-2, 1e-2, 1e-2};
    const double bars[3] = {5.0, 5.0, 50.0};
    shear_axes_points(f, 3, x, y, bars, bars, &(shear_style){0});
    shear_axes_line(f, 3, x, y, &(shear_style){0});
    assert_true(darkness(f, r.x + 0.25 * r.w, r.y + 0.5 * r.h) > 500);
    shear_axes_end(f);
    assert_saves(f);
}

static void test_error_bars_have_their_length(void **state) {
    (void)state;
    shear_figure *f = new_figure();
    begin(f, (shear_range){0, 1}, (shear_range){0, 1}, false);
    const shear_rect r = shear_axes_frame(f);
    const double x = 0.5;
    const double error = 0.25;
    shear_axes_points(f, 1, &x, &x, NULL, &error, &(shear_style){.width = 3.0, .size = 4.0});
    assert_true(darkness(f, r.x + r.w / 2, r.y + 0.27 * r.h) > 500);
    assert_true(darkness(f, r.x + r.w / 2, r.y + 0.73 * r.h) > 500);
    assert_int_equal(darkness(f, r.x + r.w / 2, r.y + 0.22 * r.h), 0);
    assert_int_equal(darkness(f, r.x + 0.4 * r.w, r.y + r.h / 2), 0); /* none along x */
    shear_axes_end(f);
    shear_figure_free(f);
}

static void test_histogram_and_bars_are_as_high_as_their_counts(void **state) {
    (void)state;
    static const double counts[2] = {4.0, 1.0};
    shear_figure *f = new_figure();
    begin(f, (shear_range){0, 4}, (shear_range){0, 5}, false);
    const shear_rect r = shear_axes_frame(f);
    const shear_style solid = {.fill = 1.0, .width = 1.0};
    shear_axes_histogram(f, 2, (shear_range){0, 2}, counts, &solid);
    shear_axes_bar(f, false, 3.0, 0.5, 0.0, 3.0, &solid);
    assert_true(darkness(f, r.x + r.w / 8, r.y + 0.25 * r.h) > 500);
    assert_int_equal(darkness(f, r.x + r.w / 8, r.y + 0.15 * r.h), 0);
    assert_true(darkness(f, r.x + 3 * r.w / 8, r.y + 0.9 * r.h) > 500);
    assert_int_equal(darkness(f, r.x + 3 * r.w / 8, r.y + 0.7 * r.h), 0);
    assert_true(darkness(f, r.x + 6 * r.w / 8, r.y + 0.45 * r.h) > 500);
    assert_int_equal(darkness(f, r.x + 6 * r.w / 8, r.y + 0.35 * r.h), 0);
    shear_axes_end(f);
    assert_saves(f);
}

/* On the line x = y = t the ellipse ends at t^2 (1, 1) C^-1 (1, 1)^T = n^2. */
static void test_ellipse_follows_the_covariance(void **state) {
    (void)state;
    static const double cov[3] = {1.0, 0.8, 1.0};
    shear_figure *f = new_figure();
    begin(f, (shear_range){-4, 4}, (shear_range){-4, 4}, false);
    const shear_rect r = shear_axes_frame(f);
    shear_axes_ellipse(f, 0.0, 0.0, cov, 2.0, &(shear_style){.fill = 1.0, .width = 1.0});
    const double along = 2.0 * sqrt((1.0 + 0.8) / 2.0);
    const double across = 2.0 * sqrt((1.0 - 0.8) / 2.0);
    for (int i = 0; i < 2; i++) {
        const double t = i != 0 ? across : along;
        const double sign = i != 0 ? -1.0 : 1.0;
        for (int outside = 0; outside < 2; outside++) {
            const double at = t * (outside != 0 ? 1.12 : 0.88);
            const int dark =
                darkness(f, r.x + r.w * (0.5 + at / 8.0), r.y + r.h * (0.5 - sign * at / 8.0));
            assert_true(outside ? dark == 0 : dark > 500);
        }
    }
    shear_axes_end(f);
    shear_figure_free(f);
}

static void test_impossible_ellipses_draw_nothing(void **state) {
    (void)state;
    static const double bad[][3] = {{1, 2, 1}, {0, 0, 0}, {-1, 0, 1}, {NAN, 0, 1}};
    shear_figure *f = new_figure();
    begin(f, (shear_range){-4, 4}, (shear_range){-4, 4}, false);
    const shear_rect r = shear_axes_frame(f);
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
        shear_axes_ellipse(f, 0.0, 0.0, bad[i], 1.0, &(shear_style){.fill = 1.0});
    for (int x = 0; x < (int)r.w; x++)
        assert_int_equal(darkness(f, r.x + x, r.y + r.h / 2), 0);
    shear_axes_end(f);
    assert_saves(f);
}

static void test_equal_axes_have_equal_units(void **state) {
    (void)state;
    shear_figure *f = new_figure();
    const shear_axes axes = {
        .cell = {0, 0, SIDE, SIDE}, .equal = true, .x = {.range = {0, 4}}, .y = {.range = {0, 1}}};
    shear_axes_begin(f, &axes);
    const shear_rect r = shear_axes_frame(f);
    assert_true(fabs(r.w / r.h - 4.0) < 0.1); /* frames end on whole pixels */
    shear_axes_end(f);
    shear_figure_free(f);
}

static void test_wild_numbers_do_no_harm(void **state) {
    (void)state;
    static const double wild[] = {0.5, 1e300, -1e300, NAN, INFINITY, -INFINITY, 0.5, 1e-300};
    enum { N = sizeof wild / sizeof wild[0] };
    const shear_range ranges[] = {{0, 1}, {NAN, NAN}, {1, 1}, {-1e308, 1e308}, {5, 2}, {0, 1e-310}};
    const shear_style style = {.fill = 0.5, .label = "\xff\xfe odd \xc3"};
    for (size_t i = 0; i < sizeof ranges / sizeof ranges[0]; i++) {
        for (int log = 0; log < 2; log++) {
            shear_figure *f = new_figure();
            begin(f, ranges[i], ranges[i], log);
            shear_axes_line(f, N, wild, wild, &style);
            shear_axes_points(f, N, wild, wild, wild, wild, &style);
            shear_axes_band(f, N, wild, wild, wild, &style);
            shear_axes_vband(f, NAN, 1.0, &style);
            shear_axes_hline(f, INFINITY, &style);
            shear_axes_circle(f, NAN, 0.0, 1e300, &style);
            shear_axes_text(f, NAN, 0.5, false, "nowhere", &(shear_text_style){0});
            shear_axes_end(f);
            assert_saves(f);
        }
    }
}

static void test_calls_in_the_wrong_order_are_told(void **state) {
    (void)state;
    shear_figure *f = new_figure();
    shear_axes_hline(f, 0.5, &(shear_style){0});
    assert_failed(f, SHEAR_E_INTERNAL);
    f = new_figure();
    begin(f, (shear_range){0, 1}, (shear_range){0, 1}, false);
    begin(f, (shear_range){0, 1}, (shear_range){0, 1}, false);
    assert_failed(f, SHEAR_E_INTERNAL);
    f = new_figure();
    begin(f, (shear_range){0, 1}, (shear_range){0, 1}, false);
    shear_axes_histogram(f, 0, (shear_range){0, 1}, NULL, &(shear_style){0});
    assert_failed(f, SHEAR_E_INTERNAL);
}

static void test_more_labels_than_the_legend_holds(void **state) {
    (void)state;
    static const char long_label[] =
        "a label that is much longer than the legend keeps, with a character of two bytes just "
        "where it is cut: \xc3\xa9\xc3\xa9\xc3\xa9\xc3\xa9\xc3\xa9\xc3\xa9\xc3\xa9\xc3\xa9";
    shear_figure *f = new_figure();
    begin(f, (shear_range){0, 1}, (shear_range){0, 1}, false);
    for (int i = 0; i < 40; i++)
        shear_axes_hline(f, i / 40.0, &(shear_style){.label = long_label});
    shear_axes_end(f);
    assert_saves(f);
}

/* ---- text ---- */

static int ink(shear_figure *f, int x0, int y0, int x1, int y1) {
    int sum = 0;
    for (int y = y0; y < y1; y++) {
        for (int x = x0; x < x1; x++)
            sum += darkness(f, x, y) > 200;
    }
    return sum;
}

static void test_text_is_where_it_should_be(void **state) {
    (void)state;
    shear_figure *f = new_figure();
    const shear_text_style right = {.size = 14.0, .align = 1.0};
    const shear_text_style upward = {.size = 14.0, .upward = true};
    shear_figure_text(f, 150, 50, "HHHH", &right);
    assert_true(ink(f, 90, 40, 150, 60) > 50);
    assert_int_equal(ink(f, 151, 0, SIDE, 100), 0);
    shear_figure_text(f, 250, 250, "HHHH", &upward);
    assert_true(ink(f, 240, 190, 260, 250) > 50);
    assert_int_equal(ink(f, 200, 252, SIDE, SIDE), 0);
    assert_saves(f);
}

static void test_scripts_are_small_and_shifted(void **state) {
    (void)state;
    shear_figure *f = new_figure();
    const double plain = shear_figure_text_width(f, "ab", 20.0);
    const double script = shear_figure_text_width(f, "a_{b}", 20.0);
    assert_true(script < plain && script > shear_figure_text_width(f, "a", 20.0));
    assert_true(shear_figure_text_width(f, "a_b", 20.0) > plain); /* no brace: a character */
    const shear_text_style style = {.size = 40.0};
    shear_figure_text(f, 20, 100, "^{H}", &style);
    shear_figure_text(f, 120, 100, "_{H}", &style);
    assert_true(ink(f, 20, 60, 60, 85) > 0);
    assert_int_equal(ink(f, 120, 60, 160, 90), 0);
    assert_saves(f);
}

static void test_any_bytes_can_be_text(void **state) {
    (void)state;
    static const char *const odd[] = {
        "\xff", "\xc3", "\xe2\x88", "\xed\xa0\x80", "\xf5\x80\x80\x80",
        "_{",   "^{a",  "_",        "\x01\n",       ""};
    shear_figure *f = new_figure();
    for (size_t i = 0; i < sizeof odd / sizeof odd[0]; i++)
        shear_figure_text(f, 10, 20.0 * (double)i, odd[i], &(shear_text_style){0});
    shear_figure_text(f, 10, 10, NULL, &(shear_text_style){0});
    char longest[1000];
    for (size_t i = 0; i + 2 < sizeof longest; i += 2)
        memcpy(longest + i, "\xc3\xa9", 2);
    longest[sizeof longest - 2] = longest[sizeof longest - 1] = '\0';
    const double width = shear_figure_text_width(f, longest, 10.0);
    const double one = shear_figure_text_width(f, "\xc3\xa9", 10.0);
    assert_true(fabs(width - 499.0 * one) < 1e-6 * width); /* no character is lost between pieces */
    assert_saves(f);
}

static void test_tables(void **state) {
    (void)state;
    static const char *const keys[] = {"first", "", "third"};
    static const char *const values[] = {"1", "2", "3"};
    shear_figure *f = new_figure();
    shear_figure_table(f, (shear_rect){20, 20, 200, 200}, "title", 3, keys, values);
    assert_true(ink(f, 20, 20, 200, 120) > 50);
    assert_int_equal(ink(f, 20, 130, SIDE, SIDE), 0);
    assert_saves(f);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_png_has_the_size_and_an_end),
        cmocka_unit_test(test_sizes_that_cannot_be),
        cmocka_unit_test(test_an_existing_file_is_replaced_only_if_asked),
        cmocka_unit_test(test_places_that_cannot_be_written),
        cmocka_unit_test(test_a_full_disk_leaves_nothing),
        cmocka_unit_test(test_cells_tile_the_area),
        cmocka_unit_test(test_row_0_is_at_the_bottom),
        cmocka_unit_test(test_images_with_equal_units),
        cmocka_unit_test(test_pixels_are_not_smoothed),
        cmocka_unit_test(test_negatives_are_marked_if_asked),
        cmocka_unit_test(test_automatic_limits_are_percentiles),
        cmocka_unit_test(test_colour_bar_runs_upward),
        cmocka_unit_test(test_images_of_nothing_but_nan),
        cmocka_unit_test(test_images_without_pixels_fail),
        cmocka_unit_test(test_marks_are_where_the_data_are),
        cmocka_unit_test(test_log_axes),
        cmocka_unit_test(test_error_bars_have_their_length),
        cmocka_unit_test(test_histogram_and_bars_are_as_high_as_their_counts),
        cmocka_unit_test(test_ellipse_follows_the_covariance),
        cmocka_unit_test(test_impossible_ellipses_draw_nothing),
        cmocka_unit_test(test_equal_axes_have_equal_units),
        cmocka_unit_test(test_wild_numbers_do_no_harm),
        cmocka_unit_test(test_calls_in_the_wrong_order_are_told),
        cmocka_unit_test(test_more_labels_than_the_legend_holds),
        cmocka_unit_test(test_text_is_where_it_should_be),
        cmocka_unit_test(test_scripts_are_small_and_shifted),
        cmocka_unit_test(test_any_bytes_can_be_text),
        cmocka_unit_test(test_tables),
    };
    return cmocka_run_group_tests(tests, make_directory, remove_directory);
}
