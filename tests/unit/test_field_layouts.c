/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Field files written and read back, in every layout: pixels are read as written, to the last
 * bit. */
#include "fits_fixture.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const unsigned all_columns = SHEAR_COL_ID | SHEAR_COL_X | SHEAR_COL_Y | SHEAR_COL_RA |
                                    SHEAR_COL_DEC | SHEAR_COL_WEIGHT | SHEAR_COL_R_GAL |
                                    SHEAR_COL_FLAGS;

static void check_image(const double *image, int kind, int64_t i, int nx, int ny) {
    for (int y = 0; y < ny; y++) {
        for (int x = 0; x < nx; x++) {
            if (image[y * nx + x] != fixture_pixel(kind, i, y, x))
                fail_msg("image %d of kind %d, pixel (%d, %d)", (int)i, kind, x, y);
        }
    }
}

static void check_psf(const shear_block *b, const shear_field_spec *s,
                      enum shear_psf_layout psf_layout, int k) {
    const int64_t i = b->stamps.first + k;
    const shear_geometry *g = &s->geometry;
    if (psf_layout == SHEAR_PSF_ONE) {
        assert_null(b->stamps.psf);
        assert_null(b->stamps.psf_index);
        assert_int_equal(b->stamps.n_psf, 0);
        return;
    }
    const int64_t wanted =
        psf_layout == SHEAR_PSF_PER_STAMP ? i : (int64_t)fixture_psf_id(i, s->n_psf);
    const int32_t index = b->stamps.psf_index[k];
    assert_in_range(index, 0, b->stamps.n_psf - 1);
    assert_int_equal(b->psf_id[index], wanted);
    check_image(b->stamps.psf + (int64_t)index * g->psf_nx * g->psf_ny, FIXTURE_PSF, wanted,
                g->psf_nx, g->psf_ny);
}

static void check_doubles(const double *values, unsigned columns, unsigned bit, int64_t i, int k) {
    assert_int_equal(values != NULL, (columns & bit) != 0);
    if (values != NULL && values[k] != fixture_column(bit, i))
        fail_msg("column %u of row %d", bit, (int)i);
}

static void check_columns(const shear_block *b, unsigned columns, int k) {
    const int64_t i = b->stamps.first + k;
    check_doubles(b->x, columns, SHEAR_COL_X, i, k);
    check_doubles(b->y, columns, SHEAR_COL_Y, i, k);
    check_doubles(b->ra, columns, SHEAR_COL_RA, i, k);
    check_doubles(b->dec, columns, SHEAR_COL_DEC, i, k);
    check_doubles(b->stamps.weight, columns, SHEAR_COL_WEIGHT, i, k);
    check_doubles(b->stamps.r_gal, columns, SHEAR_COL_R_GAL, i, k);
    assert_int_equal(b->id != NULL, (columns & SHEAR_COL_ID) != 0);
    assert_int_equal(b->stamps.mask != NULL, (columns & SHEAR_COL_FLAGS) != 0);
    if (b->id != NULL)
        assert_int_equal(b->id[k], i * 3000000000);
    if (b->stamps.mask != NULL)
        assert_int_equal(b->stamps.mask[k], i % 3);
}

/* Read the file in chunks of `chunk` stamps. */
static void check_stamps(shear_field *field, const shear_field_spec *s,
                         enum shear_psf_layout psf_layout, int chunk) {
    shear_error err = {0};
    shear_block *b = NULL;
    const shear_geometry *g = &s->geometry;
    const int planes = s->noise_planes > 1 ? s->noise_planes : 1;
    assert_int_equal(shear_block_new(&b, shear_field_get_info(field), chunk, &err), SHEAR_OK);
    for (int64_t first = 0; first < s->n_stamps; first += chunk) {
        const int64_t rest = s->n_stamps - first;
        const int count = rest < chunk ? (int)rest : chunk;
        if (shear_field_read(field, first, count, b, &err) != SHEAR_OK)
            fail_msg("%s", err.message);
        assert_int_equal(b->stamps.first, first);
        assert_int_equal(b->stamps.count, count);
        assert_int_equal(b->stamps.noise_planes, planes);
        for (int k = 0; k < count; k++) {
            check_image(b->stamps.galaxy + (int64_t)k * g->nx * g->ny, FIXTURE_GALAXY, first + k,
                        g->nx, g->ny);
            for (int p = 0; p < planes; p++) {
                const int64_t noise = (int64_t)planes * k + p;
                check_image(b->stamps.noise + noise * g->nx * g->ny, FIXTURE_NOISE,
                            planes * first + noise, g->nx, g->ny);
            }
            check_psf(b, s, psf_layout, k);
            check_columns(b, s->columns & ~(unsigned)SHEAR_COL_PSF_ID, k);
        }
    }
    shear_block_free(b);
}

static void check_info(const shear_field_info *info, const shear_field_spec *s,
                       enum shear_psf_layout psf_layout) {
    assert_memory_equal(&info->geometry, &s->geometry, sizeof info->geometry);
    assert_int_equal(info->n_stamps, s->n_stamps);
    assert_int_equal(info->n_psf, s->n_psf);
    assert_int_equal(info->noise_planes, s->noise_planes > 1 ? s->noise_planes : 1);
    assert_int_equal(info->layout, s->layout);
    assert_int_equal(info->psf_layout, psf_layout);
    assert_int_equal(info->columns, s->columns);
    assert_int_equal(info->bitpix, s->bitpix);
    assert_false(info->compressed);
    assert_false(info->gzipped);
}

static void round_trip(const shear_field_spec *s, enum shear_psf_layout psf_layout) {
    static const int chunks[] = {1, 3, 7, 16};
    const char *path = fixture_path("round.fits");
    shear_error err = {0};
    shear_field *field = NULL;
    fixture_write(path, s);
    if (shear_field_open(&field, path, &err) != SHEAR_OK)
        fail_msg("%s", err.message);
    check_info(shear_field_get_info(field), s, psf_layout);
    for (size_t i = 0; i < sizeof chunks / sizeof chunks[0]; i++)
        check_stamps(field, s, psf_layout, chunks[i]);
    double psf[9 * 7];
    for (int64_t i = 0; i < s->n_psf; i++) {
        assert_int_equal(shear_field_read_psf(field, i, psf, &err), SHEAR_OK);
        check_image(psf, FIXTURE_PSF, i, 9, 7);
    }
    assert_int_equal(shear_field_read_psf(field, s->n_psf, psf, &err), SHEAR_E_INTERNAL);
    assert_int_equal(shear_field_read_psf(field, -1, psf, &err), SHEAR_E_INTERNAL);
    shear_field_close(field);
}

static void every_layout(void **state) {
    (void)state;
    static const struct {
        int64_t n_psf;
        unsigned column;
        enum shear_psf_layout layout;
    } psfs[] = {{1, 0, SHEAR_PSF_ONE},
                {1, SHEAR_COL_PSF_ID, SHEAR_PSF_ONE},
                {10, 0, SHEAR_PSF_PER_STAMP},
                {10, SHEAR_COL_PSF_ID, SHEAR_PSF_BY_ID},
                {4, SHEAR_COL_PSF_ID, SHEAR_PSF_BY_ID}};
    const unsigned columns[] = {0, SHEAR_COL_R_GAL, all_columns};
    for (int i = 0; i < 2 * 2 * 5 * 3; i++) {
        shear_field_spec s = fixture_spec();
        s.layout = i % 2 == 0 ? SHEAR_LAYOUT_CUBE : SHEAR_LAYOUT_MOSAIC;
        s.bitpix = i / 2 % 2 == 0 ? -32 : -64;
        s.n_psf = psfs[i / 4 % 5].n_psf;
        s.columns = columns[i / 20] | psfs[i / 4 % 5].column;
        round_trip(&s, psfs[i / 4 % 5].layout);
    }
}

static void mosaics_of_all_widths(void **state) {
    (void)state;
    for (int columns = 0; columns <= 10; columns++) {
        shear_field_spec s = fixture_spec();
        s.layout = SHEAR_LAYOUT_MOSAIC;
        s.mosaic_columns = columns;
        round_trip(&s, SHEAR_PSF_ONE);
    }
}

/* Several noise stamps per galaxy lie behind each other. */
static void several_noise_stamps(void **state) {
    (void)state;
    static const int planes[] = {1, 2, 3, 64};
    for (size_t i = 0; i < 2 * sizeof planes / sizeof planes[0]; i++) {
        shear_field_spec s = fixture_spec();
        s.layout = i % 2 == 0 ? SHEAR_LAYOUT_CUBE : SHEAR_LAYOUT_MOSAIC;
        s.noise_planes = planes[i / 2];
        round_trip(&s, SHEAR_PSF_ONE);
    }
}

static void odd_and_extreme_shapes(void **state) {
    (void)state;
    static const int sides[][2] = {{8, 8},   {9, 8},    {8, 9},   {13, 11},
                                   {64, 63}, {1024, 8}, {8, 1024}};
    for (size_t i = 0; i < sizeof sides / sizeof sides[0]; i++) {
        for (enum shear_layout layout = SHEAR_LAYOUT_CUBE; layout <= SHEAR_LAYOUT_MOSAIC;
             layout++) {
            shear_field_spec s = fixture_spec();
            s.geometry.nx = sides[i][0];
            s.geometry.ny = sides[i][1];
            s.layout = layout;
            s.n_stamps = 5;
            round_trip(&s, SHEAR_PSF_ONE);
        }
    }
}

static void the_rows_of_a_mosaic_run_upwards(void **state) {
    (void)state;
    const char *path = fixture_path("order.fits");
    double pixels[16 * 24];
    for (int y = 0; y < 24; y++) { /* 2 x 3 stamps of 8 x 8, each filled with its number */
        for (int x = 0; x < 16; x++)
            pixels[y * 16 + x] = y / 8 * 2 + x / 8;
    }
    fitsfile *f = fixture_create(path);
    int status = 0;
    fixture_image image = {.bitpix = -32, .naxis = 2, .axes = {16, 24}};
    static const char *const names[] = {"GALAXY", "NOISE"};
    for (int i = 0; i < 2; i++) {
        image.name = names[i];
        fixture_append(f, &image, pixels);
        fits_write_key_lng(f, "STAMPNX", 8, NULL, &status);
        fits_write_key_lng(f, "STAMPNY", 8, NULL, &status);
        fits_write_key_lng(f, "NSTAMP", 5, NULL, &status);
    }
    assert_int_equal(status, 0);
    fixture_append(f, &(fixture_image){.name = "psf", .bitpix = -32, .naxis = 2, .axes = {3, 3}},
                   pixels); /* EXTNAME in any case */
    fixture_close(f);
    shear_field *field = NULL;
    shear_block *b = NULL;
    shear_error err = {0};
    assert_int_equal(shear_field_open(&field, path, &err), SHEAR_OK);
    assert_int_equal(shear_field_get_info(field)->n_stamps, 5);
    assert_int_equal(shear_field_get_info(field)->geometry.psf_oversample, 1);
    assert_int_equal(shear_block_new(&b, shear_field_get_info(field), 5, &err), SHEAR_OK);
    assert_int_equal(shear_field_read(field, 0, 5, b, &err), SHEAR_OK);
    for (int i = 0; i < 5 * 64; i++)
        assert_true(b->stamps.galaxy[i] == i / 64);
    shear_block_free(b);
    shear_field_close(field);
}

/* NOISE may be laid out in another way than GALAXY; a 2-D image without STAMPNX is one stamp. */
static void layouts_may_differ(void **state) {
    (void)state;
    const char *path = fixture_path("mixed.fits");
    double pixels[16 * 8];
    for (int i = 0; i < 16 * 8; i++)
        pixels[i] = i;
    fitsfile *f = fixture_create(path);
    fixture_append(
        f, &(fixture_image){.name = "GALAXY", .bitpix = -32, .naxis = 2, .axes = {16, 8}}, pixels);
    fixture_append(
        f, &(fixture_image){.name = "NOISE", .bitpix = 16, .naxis = 3, .axes = {16, 8, 1}}, pixels);
    fixture_append(f, &(fixture_image){.name = "PSF", .bitpix = -32, .naxis = 2, .axes = {3, 3}},
                   pixels);
    fixture_close(f);
    shear_field *field = NULL;
    shear_block *b = NULL;
    shear_error err = {0};
    assert_int_equal(shear_field_open(&field, path, &err), SHEAR_OK);
    assert_int_equal(shear_field_get_info(field)->n_stamps, 1);
    assert_int_equal(shear_block_new(&b, shear_field_get_info(field), 1, &err), SHEAR_OK);
    assert_int_equal(shear_field_read(field, 0, 1, b, &err), SHEAR_OK);
    for (int i = 0; i < 16 * 8; i++)
        assert_true(b->stamps.galaxy[i] == i && b->stamps.noise[i] == i);
    shear_block_free(b);
    shear_field_close(field);
}

static void names_scales_and_truth(void **state) {
    (void)state;
    static const char longest[] =
        "a name of the greatest length, and with a quote: it's 71 characters ....";
    static const char *const history[] = {"made by a test", "in two lines", NULL};
    const char *path = fixture_path("field 7.fits");
    shear_field_spec s = fixture_spec();
    shear_field *field = NULL;
    shear_error err = {0};
    char name[72];
    snprintf(name, sizeof name, "%.71s", longest);
    s.name = name;
    s.pixscale = 0.2;
    s.has_truth = true;
    s.sim_g1 = 0.1;
    s.sim_g2 = -0.3;
    s.history = history;
    fixture_write(path, &s);
    assert_int_equal(shear_field_open(&field, path, &err), SHEAR_OK);
    const shear_field_info *info = shear_field_get_info(field);
    assert_string_equal(info->name, name);
    assert_true(info->pixscale == 0.2 && info->has_truth);
    assert_true(info->sim_g1 == 0.1 && info->sim_g2 == -0.3);
    shear_field_close(field);

    s = fixture_spec();
    fixture_write(path, &s);
    assert_int_equal(shear_field_open(&field, path, &err), SHEAR_OK);
    info = shear_field_get_info(field);
    assert_string_equal(info->name, "field 7");
    assert_true(isnan(info->pixscale) && !info->has_truth);
    shear_field_close(field);
}

static void equal_input_makes_equal_files(void **state) {
    (void)state;
    char sums[2][SHEAR_CHECKSUM_SIZE];
    for (int i = 0; i < 2; i++) {
        shear_field_spec s = fixture_spec();
        s.columns = all_columns;
        s.layout = SHEAR_LAYOUT_MOSAIC;
        const char *path = fixture_path(i == 0 ? "one.fits" : "two.fits");
        fixture_write(path, &s);
        assert_int_equal(shear_file_checksum(path, sums[i], NULL), SHEAR_OK);
    }
    assert_string_equal(sums[0], sums[1]);
}

static void ids_of_no_psf(void **state) {
    (void)state;
    const char *path = fixture_path("ids.fits");
    shear_field_spec s = fixture_spec();
    s.n_psf = 4;
    s.n_stamps = 3;
    s.columns = SHEAR_COL_PSF_ID;
    fixture_write(path, &s);
    const size_t at = fixture_data_offset(path, "CATALOG");
    size_t size = 0;
    unsigned char *bytes = fixture_load(path, &size);
    memset(bytes + at, 0xff, 4);           /* row 0: -1 */
    memcpy(bytes + at + 4, "\0\0\0\4", 4); /* row 1: beyond the last */
    fixture_save(path, bytes, size);
    free(bytes);
    shear_field *field = NULL;
    shear_block *b = NULL;
    assert_int_equal(shear_field_open(&field, path, NULL), SHEAR_OK);
    assert_int_equal(shear_block_new(&b, shear_field_get_info(field), 3, NULL), SHEAR_OK);
    assert_int_equal(shear_field_read(field, 0, 3, b, NULL), SHEAR_OK);
    assert_int_equal(b->stamps.psf_index[0], -1);
    assert_int_equal(b->stamps.psf_index[1], -1);
    assert_int_equal(b->stamps.psf_index[2], 0);
    assert_int_equal(b->stamps.n_psf, 1);
    shear_block_free(b);
    shear_field_close(field);
}

static void ranges_outside_of_the_field(void **state) {
    (void)state;
    const char *path = fixture_path("range.fits");
    fixture_write_good(path);
    shear_field *field = NULL;
    shear_block *b = NULL;
    shear_error err = {0};
    assert_int_equal(shear_field_open(&field, path, NULL), SHEAR_OK);
    assert_int_equal(shear_block_new(&b, shear_field_get_info(field), 0, &err), SHEAR_E_INTERNAL);
    assert_null(b);
    assert_int_equal(shear_block_new(&b, shear_field_get_info(field), 4, &err), SHEAR_OK);
    static const int64_t bad[][2] = {{-1, 2}, {0, 5}, {0, 0}, {9, 2}, {10, 1}, {INT64_MAX, 1}};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        assert_int_equal(shear_field_read(field, bad[i][0], (int)bad[i][1], b, &err),
                         SHEAR_E_INTERNAL);
    }
    assert_int_equal(shear_field_read(field, 9, 1, b, &err), SHEAR_OK);
    shear_block_free(b);
    shear_field_close(field);
    shear_block_free(NULL);
    shear_field_close(NULL);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_layout),
        cmocka_unit_test(mosaics_of_all_widths),
        cmocka_unit_test(several_noise_stamps),
        cmocka_unit_test(odd_and_extreme_shapes),
        cmocka_unit_test(the_rows_of_a_mosaic_run_upwards),
        cmocka_unit_test(layouts_may_differ),
        cmocka_unit_test(names_scales_and_truth),
        cmocka_unit_test(equal_input_makes_equal_files),
        cmocka_unit_test(ids_of_no_psf),
        cmocka_unit_test(ranges_outside_of_the_field),
    };
    return cmocka_run_group_tests(tests, fixture_setup, fixture_teardown);
}
