/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The chips of an exposure: what belongs to each, places of stamps, pixels, and the PSF's shape. */
#include "psf_fixture.h"
#include "scarce.h"
#include "shear/chip.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NX = 420, NY = 380, CHIPS = 2, STAMP = 32, PSF = 33, MANY = 80, PIXELS = NX * NY };

/* Positions from 1: in the middle, at the edge, on the mask, beyond the chip. */
enum { MIDDLE, EDGE, MASKED, BEYOND, SOURCES };
static const double source_x[SOURCES] = {200.3, 10.0, 300.0, 1e300};
static const double source_y[SOURCES] = {150.6, 10.0, 250.0, -5.0};
static const double psf_cov[3] = {4.0, 0.7, 3.0};

static double pixels[PIXELS], cube[MANY * PSF * PSF], places[2][MANY];

static void assert_near(double a, double b, double tolerance) {
    if (!(fabs(a - b) <= tolerance))
        fail_msg("%.12g is not %.12g within %g", a, b, tolerance);
}

static double pixel_of(int chip, int x, int y) {
    const double dx = x + 1 - source_x[MIDDLE];
    const double dy = y + 1 - source_y[MIDDLE];
    return 100.0 * chip + sin(0.7 * x + 1.3 * y * y) + 300.0 * exp(-0.1 * (dx * dx + dy * dy));
}

static bool is_masked(int x, int y) {
    return x >= 296 && x < 302 && y >= 246 && y < 252;
}

static void append_image(fitsfile *f, const char *name, int bitpix) {
    const fixture_image image = {.name = name, .bitpix = bitpix, .naxis = 2, .axes = {NX, NY, 1}};
    fixture_append(f, &image, pixels);
}

/* Coordinates turned by 30 degrees, 0.25 arcsec per pixel; saturation at 350 + 100 chip. */
static void write_image(const char *path) {
    static const char *const cards[] = {
        "CTYPE1  = 'RA---TAN'",    "CTYPE2  = 'DEC--TAN'",   "CRVAL1  = 150.1",
        "CRVAL2  = 2.2",           "CRPIX1  = 200.0",        "CRPIX2  = 200.0",
        "CD1_1   = -6.0140653e-5", "CD1_2   = 3.4722222e-5", "CD2_1   = 3.4722222e-5",
        "CD2_2   = 6.0140653e-5",  "SATURATE= 480.0",        NULL};
    fitsfile *f = fixture_create(path);
    for (int chip = 0; chip < CHIPS; chip++) {
        for (int i = 0; i < PIXELS; i++)
            pixels[i] = pixel_of(chip, i % NX, i / NX);
        append_image(f, chip == 0 ? "N1" : "N2", -64);
        psf_fixture_keys(f, cards);
    }
    fixture_close(f);
}

static void write_mask(const char *path) {
    fitsfile *f = fixture_create(path);
    for (int i = 0; i < PIXELS; i++)
        pixels[i] = is_masked(i % NX, i / NX);
    append_image(f, "N2", 16); /* by name, not by order */
    append_image(f, "N1", 16);
    fixture_close(f);
}

static void write_sources(const char *path) {
    static const double size[SOURCES] = {4.0, 4.0, 4.0, 4.0};
    static const double angle[SOURCES] = {0};
    const psf_fixture_column columns[] = {
        {"X", "1D", NULL, source_x, NULL},        {"Y", "1D", NULL, source_y, NULL},
        {"A_IMAGE", "1D", NULL, size, NULL},      {"B_IMAGE", "1D", NULL, size, NULL},
        {"THETA_IMAGE", "1D", NULL, angle, NULL}, {0}};
    fitsfile *f = fixture_create(path);
    for (int chip = 0; chip < CHIPS; chip++)
        psf_fixture_table(f, "", SOURCES, columns);
    fixture_close(f);
}

/* `n` Gaussians, of which a model is made: one is an image, many are |W|^2. */
static void write_psf(const char *path, int n) {
    const fixture_image image = {
        .name = "PSF", .bitpix = -64, .naxis = n > 1 ? 3 : 2, .axes = {PSF, PSF, n}};
    const psf_fixture_column columns[] = {
        {"X", "1D", NULL, places[0], NULL}, {"Y", "1D", NULL, places[1], NULL}, {0}};
    const double det = psf_cov[0] * psf_cov[2] - psf_cov[1] * psf_cov[1];
    for (int i = 0; i < n * PSF * PSF; i++) {
        const double x = i % PSF - PSF / 2;
        const double y = i / PSF % PSF - PSF / 2;
        const double r2 = psf_cov[2] * x * x - 2.0 * psf_cov[1] * x * y + psf_cov[0] * y * y;
        cube[i] = exp(-0.5 * r2 / det);
    }
    for (int i = 0; i < n; i++) {
        places[0][i] = 20.0 + 50.0 * (i % 8);
        places[1][i] = 20.0 + 40.0 * (i / 8);
    }
    fitsfile *f = fixture_create(path);
    fixture_append(f, &image, cube);
    if (n > 1)
        psf_fixture_table(f, "PLACES", n, columns);
    fixture_close(f);
}

static shear_input input_of(const char *psf) {
    shear_input input = shear_input_of_file(NULL);
    static char paths[4][512];
    const char *const names[] = {"image.fits", "mask.fits", "sources.fits", psf};
    const enum shear_part parts[] = {SHEAR_PART_IMAGE, SHEAR_PART_MASK, SHEAR_PART_CATALOG,
                                     SHEAR_PART_PSF};
    for (int i = 0; i < 4; i++) {
        snprintf(paths[i], sizeof paths[i], "%s", fixture_path(names[i]));
        input.parts[parts[i]].path = paths[i];
    }
    for (int i = 0; i < SHEAR_N_PARTS; i++)
        input.parts[i].hdu = -1;
    input.exposure = (shear_exposure){.origin = 1, .stamp = STAMP};
    return input;
}

static shear_field *open_with(const char *psf) {
    const shear_input input = input_of(psf);
    shear_field *field = NULL;
    shear_error err = {0};
    if (shear_field_open_input(&field, &input, NULL, &err) != SHEAR_OK)
        fail_msg("%s (%s)", err.message, err.advice);
    return field;
}

static int setup(void **state) {
    fixture_setup(state);
    write_image(fixture_path("image.fits"));
    write_mask(fixture_path("mask.fits"));
    write_sources(fixture_path("sources.fits"));
    write_psf(fixture_path("one.fits"), 1);
    write_psf(fixture_path("many.fits"), MANY);
    return 0;
}

static void test_what_belongs_to_a_chip(void **state) {
    shear_field *field = open_with("one.fits");
    (void)state;
    assert_int_equal(shear_field_chips(field), CHIPS);
    for (int i = 0; i < CHIPS; i++) {
        shear_chip c;
        assert_int_equal(shear_field_get_chip(field, i, &c, NULL), SHEAR_OK);
        assert_string_equal(c.name, i == 0 ? "N1" : "N2");
        assert_true(c.nx == NX && c.ny == NY && c.has_wcs && c.table == i && c.model == 0);
        assert_true(c.first == i * SOURCES && c.n_stamps == SOURCES);
        assert_int_equal(c.n_sources, SOURCES - 1);
        assert_true(isnan(c.nearest_source_deg)); /* a table of its own */
        assert_int_equal(c.hdu[SHEAR_PART_IMAGE], 1 + i);
        assert_int_equal(c.hdu[SHEAR_PART_MASK], 2 - i);
        assert_int_equal(c.hdu[SHEAR_PART_WEIGHT], -1);
        assert_true(c.psf[0] != '\0' && c.psf_terms == 1 && c.psf_stars == -1);
    }
    shear_field_close(field);
}

static void test_places(void **state) {
    shear_field *field = open_with("one.fits");
    shear_block *block = NULL;
    (void)state;
    assert_int_equal(shear_block_new(&block, shear_field_get_info(field), 1, NULL), SHEAR_OK);
    for (int i = 0; i < CHIPS * SOURCES; i++) {
        shear_chip_place p;
        assert_int_equal(shear_chip_find(field, i, &p, NULL), SHEAR_OK);
        assert_int_equal(shear_field_read(field, i, 1, block, NULL), SHEAR_OK);
        assert_int_equal(p.flags, block->dropped[0]);
        assert_true(p.chip == i / SOURCES && p.x == source_x[i % SOURCES]);
    }
    shear_chip_place middle;
    shear_chip_place edge;
    shear_chip_place masked;
    shear_chip_place beyond;
    assert_int_equal(shear_chip_find(field, MIDDLE, &middle, NULL), SHEAR_OK);
    assert_int_equal(shear_chip_find(field, EDGE, &edge, NULL), SHEAR_OK);
    assert_int_equal(shear_chip_find(field, MASKED, &masked, NULL), SHEAR_OK);
    assert_int_equal(shear_chip_find(field, BEYOND, &beyond, NULL), SHEAR_OK);
    assert_int_equal(middle.flags, 0);
    assert_true(middle.box_x + STAMP / 2 == 199 && middle.box_y + STAMP / 2 == 150);
    assert_true(middle.noise_x[0] >= 0 && middle.noise_x[0] + STAMP <= NX &&
                middle.noise_y[0] >= 0 && middle.noise_y[0] + STAMP <= NY);
    assert_true(abs(middle.noise_x[0] - middle.box_x) >= STAMP ||
                abs(middle.noise_y[0] - middle.box_y) >= STAMP);
    assert_true(edge.flags & SHEAR_FLAG_EDGE);
    assert_true(masked.flags & SHEAR_FLAG_HOLE);
    assert_true(beyond.flags & SHEAR_FLAG_NO_POSITION);
    assert_int_equal(beyond.box_x, -1);
    shear_block_free(block);
    shear_field_close(field);
}

static void test_pixels(void **state) {
    enum { W = 60, H = 50, X = NX - 40, Y = -10 };
    static double value[W * H];
    static uint8_t defect[W * H];
    static int32_t owner[W * H];
    shear_field *field = open_with("one.fits");
    (void)state;
    const shear_chip_box corner = {X, Y, W, H, value, defect, NULL, NULL};
    assert_int_equal(shear_chip_read(field, 1, &corner, NULL), SHEAR_OK);
    for (int i = 0; i < W * H; i++) {
        const int x = X + i % W;
        const int y = Y + i / W;
        const bool outside = x >= NX || y < 0;
        assert_int_equal(defect[i] & SHEAR_DEFECT_OUTSIDE, outside ? SHEAR_DEFECT_OUTSIDE : 0);
        assert_true(outside ? isnan(value[i]) : value[i] == pixel_of(1, x, y));
    }
    const shear_chip_box hole = {290, 240, W, H, NULL, defect, owner, NULL};
    assert_int_equal(shear_chip_read(field, 0, &hole, NULL), SHEAR_OK);
    for (int i = 0; i < W * H; i++)
        assert_int_equal(defect[i] != 0, is_masked(290 + i % W, 240 + i / W));
    assert_int_equal(owner[9 * W + 9], MASKED + 1); /* the ellipse about the third source */
    assert_int_equal(owner[(H - 1) * W + W - 1], 0);
    const shear_chip_box peak = {199, 150, 1, 1, value, defect, NULL, NULL};
    assert_int_equal(shear_chip_read(field, 1, &peak, NULL), SHEAR_OK);
    assert_int_equal(defect[0], value[0] >= 480.0 ? SHEAR_DEFECT_SATURATED : 0);
    shear_field_close(field);
}

static void check_psf(const char *psf, double tolerance) {
    shear_field *field = open_with(psf);
    double cov[3];
    for (int chip = 0; chip < CHIPS; chip++) {
        assert_int_equal(shear_chip_psf(field, chip * SOURCES + MIDDLE, cov, NULL), SHEAR_OK);
        for (int i = 0; i < 3; i++)
            assert_near(cov[i], psf_cov[i], tolerance);
    }
    assert_int_equal(shear_chip_psf(field, BEYOND, cov, NULL), SHEAR_OK);
    assert_true(isnan(cov[0])); /* it has no PSF */
    shear_field_close(field);
}

static void test_psf(void **state) {
    (void)state;
    check_psf("one.fits", 1e-4);
    check_psf("many.fits", 0.02); /* by its power */
}

static void identify(const shear_input *input, char sum[SHEAR_CHECKSUM_SIZE]) {
    shear_field *field = NULL;
    shear_error err = {0};
    if (shear_field_open_input(&field, input, NULL, &err) != SHEAR_OK)
        fail_msg("%s (%s)", err.message, err.advice);
    assert_int_equal(shear_input_checksum(input, NULL, shear_field_get_info(field), sum, &err),
                     SHEAR_OK);
    shear_field_close(field);
}

/* The text whose hash services have stored, for HDUs that were chosen by number; -1: none was. */
static void stored_identity(const shear_input *input, char sum[SHEAR_CHECKSUM_SIZE]) {
    char text[1000] = "";
    for (int i = 0; i < SHEAR_N_PARTS; i++) {
        char file[SHEAR_CHECKSUM_SIZE];
        const size_t used = strlen(text);
        if (input->parts[i].path == NULL)
            continue;
        assert_int_equal(shear_file_checksum(input->parts[i].path, file, NULL), SHEAR_OK);
        snprintf(text + used, sizeof text - used, "%s %s %lld \n", shear_part_name(i), file,
                 (long long)input->parts[i].hdu);
    }
    shear_bytes_checksum(text, strlen(text), sum);
}

/* It is made from the HDUs that are meant: name or number, they are the same; other HDUs are not.
 */
static void test_identity(void **state) {
    char stored[SHEAR_CHECKSUM_SIZE];
    char sum[CHIPS + 1][SHEAR_CHECKSUM_SIZE];
    shear_input input = input_of("one.fits");
    (void)state;
    identify(&input, sum[CHIPS]);
    stored_identity(&input, stored);
    assert_string_equal(sum[CHIPS], stored);
    for (int chip = 0; chip < CHIPS; chip++) {
        static const char *const names[2][CHIPS] = {{"N1", "N2"}, {"n1", "n2"}};
        char other[SHEAR_CHECKSUM_SIZE];
        input.parts[SHEAR_PART_IMAGE].hdu = 1 + chip;
        input.parts[SHEAR_PART_MASK].hdu = 2 - chip;
        input.parts[SHEAR_PART_CATALOG].hdu = 1;
        input.parts[SHEAR_PART_PSF].hdu = 1;
        identify(&input, sum[chip]);
        stored_identity(&input, stored);
        assert_string_equal(sum[chip], stored);
        for (int k = 0; k < 2; k++) {
            shear_input named = input;
            named.parts[SHEAR_PART_IMAGE].extname = names[k][chip];
            named.parts[SHEAR_PART_MASK].extname = names[1 - k][chip];
            named.parts[SHEAR_PART_PSF].extname = "PSF";
            named.parts[SHEAR_PART_IMAGE].hdu = named.parts[SHEAR_PART_MASK].hdu =
                named.parts[SHEAR_PART_PSF].hdu = -1;
            identify(&named, other);
            assert_string_equal(other, sum[chip]);
        }
    }
    assert_string_not_equal(sum[0], sum[1]);
    assert_string_not_equal(sum[0], sum[CHIPS]);
}

static void test_what_is_not_there(void **state) {
    shear_field *field = open_with("one.fits");
    const shear_chip_box box = {.nx = 1, .ny = 1};
    shear_chip chip;
    shear_chip_place place;
    double cov[3];
    (void)state;
    for (int k = 0; k < 2; k++) {
        const int i = k == 0 ? -1 : CHIPS;
        const int64_t stamp = k == 0 ? -1 : CHIPS * SOURCES;
        assert_int_equal(shear_field_get_chip(field, i, &chip, NULL), SHEAR_E_SETTING);
        assert_int_equal(shear_chip_read(field, i, &box, NULL), SHEAR_E_SETTING);
        assert_int_equal(shear_chip_find(field, stamp, &place, NULL), SHEAR_E_SETTING);
        assert_int_equal(shear_chip_psf(field, stamp, cov, NULL), SHEAR_E_SETTING);
    }
    shear_field_close(field);
    fixture_write_good(fixture_path("field.fits"));
    assert_int_equal(shear_field_open(&field, fixture_path("field.fits"), NULL), SHEAR_OK);
    assert_int_equal(shear_field_chips(field), 0);
    assert_int_equal(shear_chip_find(field, 0, &place, NULL), SHEAR_E_SETTING);
    assert_int_equal(shear_chip_psf(field, 0, cov, NULL), SHEAR_E_SETTING);
    shear_field_close(field);
}

static void test_memory_that_runs_out(void **state) {
    bool refused = true;
    (void)state;
    for (long n = 1; refused; n++) {
        shear_field *field = open_with("one.fits");
        shear_chip_place place;
        double cov[3];
        scarce_after(n, false);
        int code = shear_chip_find(field, MIDDLE, &place, NULL);
        code = code == SHEAR_OK ? shear_chip_psf(field, MIDDLE, cov, NULL) : code;
        refused = scarce_end();
        assert_int_equal(code, refused ? SHEAR_E_NOMEM : SHEAR_OK);
        shear_field_close(field);
        assert_true(n < 500);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_what_belongs_to_a_chip),
        cmocka_unit_test(test_places),
        cmocka_unit_test(test_pixels),
        cmocka_unit_test(test_psf),
        cmocka_unit_test(test_identity),
        cmocka_unit_test(test_what_is_not_there),
        cmocka_unit_test(test_memory_that_runs_out),
    };
    return cmocka_run_group_tests(tests, setup, fixture_teardown);
}
