/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pixel types, scaling, BLANK, tile compression and gzip, in files that CFITSIO wrote by itself. */
#include "fits_fixture.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* All galaxy pixels, then all noise pixels, read in chunks. The caller frees. */
static double *read_pixels(const char *path, int chunk, shear_field_info *info) {
    shear_field *field = NULL;
    shear_block *b = NULL;
    shear_error err = {0};
    if (shear_field_open(&field, path, &err) != SHEAR_OK)
        fail_msg("%s", err.message);
    *info = *shear_field_get_info(field);
    const int64_t stamp = (int64_t)info->geometry.nx * info->geometry.ny;
    double *out = calloc((size_t)(2 * info->n_stamps * stamp), sizeof *out);
    assert_int_equal(shear_block_new(&b, info, chunk, &err), SHEAR_OK);
    for (int64_t i = 0; i < info->n_stamps; i += chunk) {
        const int64_t rest = info->n_stamps - i;
        const int count = rest < chunk ? (int)rest : chunk;
        if (shear_field_read(field, i, count, b, &err) != SHEAR_OK)
            fail_msg("%s", err.message);
        const size_t bytes = (size_t)(count * stamp) * sizeof *out;
        memcpy(out + i * stamp, b->stamps.galaxy, bytes);
        memcpy(out + (info->n_stamps + i) * stamp, b->stamps.noise, bytes);
    }
    shear_block_free(b);
    shear_field_close(field);
    return out;
}

/* What fixture_write_like puts there. */
static double written(int bitpix, int kind, int64_t i, int y, int x) {
    const double v = fixture_pixel(kind, i, y, x);
    if (bitpix < 0)
        return v;
    return bitpix == 8 ? fmod(floor(fabs(v)), 200.0) : floor(fabs(v));
}

/* Read the file in several chunkings; every pixel must be within `tolerance` of what was written.
 */
static void check(const char *path, const fixture_image *image, int n, double tolerance) {
    static const int chunks[] = {1, 3, 7, 64};
    for (size_t c = 0; c < sizeof chunks / sizeof chunks[0]; c++) {
        shear_field_info info;
        double *pixels = read_pixels(path, chunks[c], &info);
        assert_int_equal(info.n_stamps, n);
        assert_int_equal(info.bitpix, image->bitpix);
        assert_int_equal(info.compressed, image->compression != 0);
        const double *p = pixels;
        for (int64_t i = 0; i < 2 * n; i++) {
            const int kind = i < n ? FIXTURE_GALAXY : FIXTURE_NOISE;
            for (int y = 0; y < info.geometry.ny; y++) {
                for (int x = 0; x < info.geometry.nx; x++, p++) {
                    const double wanted = written(image->bitpix, kind, i % n, y, x);
                    if (!(fabs(*p - wanted) <= tolerance))
                        fail_msg("stamp %d, pixel (%d, %d): %g, not %g", (int)i, x, y, *p, wanted);
                }
            }
        }
        free(pixels);
    }
}

static void every_bitpix(void **state) {
    (void)state;
    static const int bitpix[] = {8, 16, 32, 64, -32, -64};
    const char *path = fixture_path("type.fits");
    for (size_t i = 0; i < sizeof bitpix / sizeof bitpix[0]; i++) {
        const fixture_image image = {.bitpix = bitpix[i], .axes = {13, 9}};
        fixture_write_like(path, &image, 7);
        check(path, &image, 7, 0.0);
    }
}

static void scaled_integers(void **state) {
    (void)state;
    static const int bitpix[] = {16, 32, 64};
    const char *path = fixture_path("scaled.fits");
    for (size_t i = 0; i < sizeof bitpix / sizeof bitpix[0]; i++) {
        const fixture_image image = {
            .bitpix = bitpix[i], .axes = {8, 8}, .bscale = 1.0, .bzero = 5};
        fixture_write_like(path, &image, 3);
        check(path, &image, 3, 0.0);
    }
    /* The unsigned types of FITS, scaled integers, scaled floating numbers. */
    const fixture_image signed8 = {.bitpix = 8, .axes = {8, 8}, .bscale = 2.0, .bzero = -128.0};
    fixture_write_like(path, &signed8, 3);
    check(path, &signed8, 3, 1.0); /* odd numbers are rounded */
    const fixture_image unsigned16 = {
        .bitpix = 16, .axes = {8, 8}, .bscale = 1.0, .bzero = 32768.0};
    fixture_write_like(path, &unsigned16, 3);
    check(path, &unsigned16, 3, 0.0);
    const fixture_image halves = {.bitpix = 16, .axes = {8, 8}, .bscale = 0.5, .bzero = -100.0};
    fixture_write_like(path, &halves, 3);
    check(path, &halves, 3, 0.0);
    const fixture_image floating = {.bitpix = -64, .axes = {8, 8}, .bscale = 0.25, .bzero = 3.0};
    fixture_write_like(path, &floating, 3);
    check(path, &floating, 3, 0.0);
}

/* A field of one 8 x 8 stamp whose first pixels are special. */
static void write_special(const char *path, int bitpix, const double *special, int n, long blank) {
    double pixels[64];
    for (int i = 0; i < 64; i++)
        pixels[i] = i < n ? special[i] : i;
    fitsfile *f = fixture_create(path);
    static const char *const names[] = {"GALAXY", "NOISE", "PSF"};
    for (int i = 0; i < 3; i++) {
        const fixture_image image = {.name = names[i],
                                     .bitpix = bitpix,
                                     .naxis = 2,
                                     .axes = {8, 8},
                                     .has_blank = bitpix > 0,
                                     .blank = blank};
        fixture_append(f, &image, pixels);
    }
    fixture_close(f);
}

static void blank_becomes_nan(void **state) {
    (void)state;
    static const int bitpix[] = {8, 16, 32, 64};
    static const double special[] = {7.0, NAN, 8.0};
    const char *path = fixture_path("blank.fits");
    for (size_t i = 0; i < 4; i++) {
        shear_field_info info;
        write_special(path, bitpix[i], special, 3, 255);
        double *p = read_pixels(path, 1, &info);
        assert_true(p[0] == 7.0 && isnan(p[1]) && p[2] == 8.0 && p[63] == 63.0);
        assert_true(isnan(p[64 + 1]));
        free(p);
    }
}

static void floating_pixels_arrive_as_they_are(void **state) {
    (void)state;
    const char *path = fixture_path("special.fits");
    for (int bitpix = -64; bitpix <= -32; bitpix += 32) {
        const double tiny = bitpix == -32 ? 0x1p-140 : 0x1p-1060; /* subnormal in that type */
        const double special[] = {NAN, INFINITY, -INFINITY, tiny, -0.0};
        shear_field_info info;
        write_special(path, bitpix, special, 5, 0);
        double *p = read_pixels(path, 1, &info);
        assert_true(isnan(p[0]) && p[1] == INFINITY && p[2] == -INFINITY && p[3] == tiny);
        assert_true(p[4] == 0.0 && signbit(p[4]));
        free(p);
    }
}

static void lossless_compression(void **state) {
    (void)state;
    static const struct {
        int algorithm, bitpix;
    } cases[] = {{RICE_1, 8},      {RICE_1, 16},      {RICE_1, 32},     {GZIP_1, 8},  {GZIP_1, 16},
                 {GZIP_1, 32},     {GZIP_1, -32},     {GZIP_1, -64},    {GZIP_2, 16}, {GZIP_2, 32},
                 {GZIP_2, -32},    {GZIP_2, -64},     {PLIO_1, 8},      {PLIO_1, 16}, {PLIO_1, 32},
                 {HCOMPRESS_1, 8}, {HCOMPRESS_1, 16}, {HCOMPRESS_1, 32}};
    static const long tiles[][3] = {{0, 0, 0}, {13, 9, 1}, {5, 4, 2}, {13, 9, 7}};
    const char *path = fixture_path("packed.fits.fz");
    for (size_t i = 0; i < 4 * sizeof cases / sizeof cases[0]; i++) {
        fixture_image image = {
            .bitpix = cases[i / 4].bitpix, .axes = {13, 9}, .compression = cases[i / 4].algorithm};
        memcpy(image.tile, tiles[i % 4], sizeof image.tile);
        if (image.compression == HCOMPRESS_1 && i % 4 > 1) {
            continue; /* it wants tiles of 4 pixels at least, and of two axes */
        }
        fixture_write_like(path, &image, 7);
        check(path, &image, 7, 0.0);
    }
}

/* Quantized by 1/64 of the noise (about 300): within a few units of what was written. */
static void quantized_compression(void **state) {
    (void)state;
    static const int algorithms[] = {RICE_1, GZIP_1, HCOMPRESS_1};
    const char *path = fixture_path("quantized.fits.fz");
    for (int i = 0; i < 6; i++) {
        const fixture_image image = {.bitpix = i % 2 == 0 ? -32 : -64,
                                     .axes = {13, 9},
                                     .compression = algorithms[i / 2],
                                     .lossy = true,
                                     .tile = {13, 9, 1}};
        fixture_write_like(path, &image, 7);
        check(path, &image, 7, 6.0);
    }
}

static void compressed_nan(void **state) {
    (void)state;
    const char *path = fixture_path("nan.fits.fz");
    double pixels[3 * 64];
    for (int lossy = 0; lossy < 2; lossy++) {
        for (int i = 0; i < 3 * 64; i++)
            pixels[i] = i == 70 || i == 71 ? NAN : sin(i * i);
        fitsfile *f = fixture_create(path);
        fixture_image image = {.name = "GALAXY",
                               .bitpix = -32,
                               .naxis = 3,
                               .axes = {8, 8, 3},
                               .compression = lossy != 0 ? RICE_1 : GZIP_1,
                               .lossy = lossy != 0,
                               .tile = {8, 8, 1}};
        fixture_append(f, &image, pixels);
        image.name = "NOISE";
        fixture_append(f, &image, pixels);
        fixture_append(
            f, &(fixture_image){.name = "PSF", .bitpix = -32, .naxis = 2, .axes = {8, 8}}, pixels);
        fixture_close(f);
        shear_field_info info;
        double *p = read_pixels(path, 3, &info);
        for (int i = 0; i < 3 * 64; i++) {
            assert_int_equal(isnan(p[i]), i == 70 || i == 71);
            assert_true(isnan(p[i]) || fabs(p[i] - sin(i * i)) < 0.1);
        }
        free(p);
    }
}

static void gzipped_files(void **state) {
    (void)state;
    const char *plain = fixture_path("whole.fits");
    const char *packed = fixture_path("whole.fits.gz");
    fixture_write_good(plain);
    fixture_gzip(plain, packed);
    shear_field_info info;
    shear_field_info packed_info;
    double *a = read_pixels(plain, 3, &info);
    double *b = read_pixels(packed, 4, &packed_info);
    const size_t n = 2 * 10 * 12 * 10;
    assert_memory_equal(a, b, n * sizeof *a);
    assert_true(packed_info.gzipped && !info.gzipped);
    assert_true(packed_info.file_bytes < info.file_bytes);
    assert_string_equal(packed_info.name, "whole");
    free(b);

    /* Two gzip members, one after the other, and zero padding, are one file. */
    size_t size = 0;
    unsigned char *bytes = fixture_load(plain, &size);
    const char *half = fixture_path("half");
    const char *half_gz = fixture_path("half.gz");
    unsigned char *joined = NULL;
    size_t length = 0;
    for (int i = 0; i < 2; i++) {
        fixture_save(half, bytes + (i == 0 ? 0 : 5000), i == 0 ? 5000 : size - 5000);
        fixture_gzip(half, half_gz);
        size_t part = 0;
        unsigned char *member = fixture_load(half_gz, &part);
        joined = realloc(joined, length + part + 100);
        memcpy(joined + length, member, part);
        length += part;
        free(member);
    }
    memset(joined + length, 0, 100);
    fixture_save(packed, joined, length + 100);
    b = read_pixels(packed, 5, &packed_info);
    assert_memory_equal(a, b, n * sizeof *a);
    free(b);
    free(a);
    free(bytes);
    free(joined);
}

/* A compressed file that is gzipped as well, as some archives do. */
static void gzip_of_compressed(void **state) {
    (void)state;
    const char *plain = fixture_path("both.fits.fz");
    const char *packed = fixture_path("both.fits.fz.gz");
    const fixture_image image = {.bitpix = 16, .axes = {13, 9}, .compression = RICE_1};
    fixture_write_like(plain, &image, 4);
    fixture_gzip(plain, packed);
    check(packed, &image, 4, 0.0);
}

/* Columns of any numeric type, with undefined values. */
static void columns_of_other_types(void **state) {
    (void)state;
    const char *path = fixture_path("columns.fits");
    const fixture_image image = {.bitpix = -32, .axes = {8, 8}};
    fixture_write_like(path, &image, 3);
    fitsfile *f = NULL;
    int status = 0;
    fits_open_diskfile(&f, path, READWRITE, &status);
    char *names[] = {"id", "x", "Y", "flags", "WEIGHT", "RA", "NAME", "LIST"};
    char *forms[] = {"J", "I", "E", "D", "B", "D", "20A", "1PD"};
    fits_create_tbl(f, BINARY_TBL, 3, 8, names, forms, NULL, "catalog", &status);
    fits_write_key_lng(f, "TNULL1", -99, NULL, &status);
    fits_write_key_lng(f, "TNULL2", -99, NULL, &status);
    fits_write_key_lng(f, "TZERO2", 1000, NULL, &status);
    fits_write_key_lng(f, "TSCAL2", 2, NULL, &status);
    fits_set_hdustruc(f, &status);
    int id[3] = {5, -99, 7};
    double x[3] = {1000, 1002, 1004};
    float y[3] = {0.5f, NAN, 2.5f};
    double flags[3] = {0, NAN, 1e10};
    unsigned char weight[3] = {1, 2, 255};
    fits_write_col(f, TINT, 1, 1, 1, 3, id, &status);
    fits_write_col(f, TDOUBLE, 2, 1, 1, 3, x, &status);
    fits_write_col(f, TFLOAT, 3, 1, 1, 3, y, &status);
    fits_write_col(f, TDOUBLE, 4, 1, 1, 3, flags, &status);
    fits_write_col(f, TBYTE, 5, 1, 1, 3, weight, &status);
    double ra[3] = {NAN, 10.5, INFINITY};
    fits_write_col(f, TDOUBLE, 6, 1, 1, 3, ra, &status);
    fits_close_file(f, &status);
    assert_int_equal(status, 0);

    shear_field *field = NULL;
    shear_block *b = NULL;
    shear_error err = {0};
    assert_int_equal(shear_field_open(&field, path, &err), SHEAR_OK);
    assert_int_equal(shear_field_get_info(field)->columns, SHEAR_COL_ID | SHEAR_COL_X |
                                                               SHEAR_COL_Y | SHEAR_COL_RA |
                                                               SHEAR_COL_FLAGS | SHEAR_COL_WEIGHT);
    assert_int_equal(shear_block_new(&b, shear_field_get_info(field), 3, &err), SHEAR_OK);
    assert_int_equal(shear_field_read(field, 0, 3, b, &err), SHEAR_OK);
    assert_true(b->id[0] == 5 && b->id[1] == -1 && b->id[2] == 7);
    assert_true(b->x[0] == 1000.0 && b->x[1] == 1002.0 && b->x[2] == 1004.0);
    assert_true(b->y[0] == 0.5 && isnan(b->y[1]) && b->y[2] == 2.5);
    assert_true(b->mask[0] == 0 && b->mask[1] == 1 && b->mask[2] == INT32_MAX);
    assert_true(isnan(b->ra[0]) && b->ra[1] == 10.5 && !isfinite(b->ra[2]));
    assert_true(b->weight[0] == 1.0 && b->weight[1] == 2.0 && b->weight[2] == 255.0);
    shear_block_free(b);
    shear_field_close(field);
}

/* A field of 4 stamps whose catalog has one column. */
static void write_column(const char *path, const char *name, const char *form, const char *zero,
                         int type, const void *values) {
    const fixture_image image = {.bitpix = -32, .axes = {8, 8}};
    char *names[] = {(char *)(uintptr_t)name};
    char *forms[] = {(char *)(uintptr_t)form};
    fitsfile *f = NULL;
    int status = 0;
    fixture_write_like(path, &image, 4);
    fits_open_diskfile(&f, path, READWRITE, &status);
    fits_create_tbl(f, BINARY_TBL, 4, 1, names, forms, NULL, "CATALOG", &status);
    fits_write_col(f, type, 1, 1, 1, 4, (void *)(uintptr_t)values, &status);
    fits_close_file(f, &status);
    assert_int_equal(status, 0);
    if (zero != NULL)
        fixture_patch(path, "CATALOG", "TZERO1", zero);
}

/* Read it; *info and the block, which the caller frees. */
static shear_block *read_column(const char *path, shear_field_info *info) {
    shear_field *field = NULL;
    shear_block *b = NULL;
    shear_error err = {0};
    if (shear_field_open(&field, path, &err) != SHEAR_OK)
        fail_msg("%s", err.message);
    *info = *shear_field_get_info(field);
    assert_int_equal(shear_block_new(&b, info, 4, NULL), SHEAR_OK);
    assert_int_equal(shear_field_read(field, 0, 4, b, &err), SHEAR_OK);
    shear_field_close(field);
    return b;
}

/* Above 2^53 a double is not enough. */
static void ids_are_exact(void **state) {
    (void)state;
    static const LONGLONG stored[4] = {9007199254740993, -9007199254740995, INT64_MAX - 1,
                                       INT64_MIN};
    const char *path = fixture_path("ids.fits");
    shear_field_info info;
    write_column(path, "ID", "K", "1", TLONGLONG, stored);
    shear_block *b = read_column(path, &info);
    assert_false(info.id_unsigned);
    for (int i = 0; i < 4; i++)
        assert_true(b->id[i] == stored[i] + 1);
    shear_block_free(b);
    write_column(path, "ID", "K", "9223372036854775808", TLONGLONG, stored);
    b = read_column(path, &info);
    assert_true(info.id_unsigned);
    for (int i = 0; i < 4; i++)
        assert_true((uint64_t)b->id[i] == (uint64_t)stored[i] + (UINT64_C(1) << 63));
    shear_block_free(b);
    write_column(path, "ID", "K", "1E3", TLONGLONG, stored);
    b = read_column(path, &info);
    assert_true(b->id[0] == stored[0] + 1000);
    assert_true(b->id[2] == -1); /* beyond 64 bits */
    shear_block_free(b);
}

/* Only 0 is good: neither a part of 1, nor what is neither true nor false. */
static void flags_of_all_kinds(void **state) {
    (void)state;
    static const double fractions[4] = {0.0, 0.5, -0.25, -0.0};
    static const float small[4] = {1e-30f, 0.0f, 1.0f, 0.0f};
    static const char logical[4] = {0, 1, 0, 1};
    static const char unknown[4] = {'F', 'T', 0, 'F'};
    const char *path = fixture_path("flags.fits");
    shear_field_info info;
    write_column(path, "FLAGS", "D", NULL, TDOUBLE, fractions);
    shear_block *b = read_column(path, &info);
    assert_true(b->mask[0] == 0 && b->mask[1] != 0 && b->mask[2] != 0 && b->mask[3] == 0);
    shear_block_free(b);
    write_column(path, "FLAGS", "E", NULL, TFLOAT, small);
    b = read_column(path, &info);
    assert_true(b->mask[0] != 0 && b->mask[1] == 0 && b->mask[2] != 0 && b->mask[3] == 0);
    shear_block_free(b);
    write_column(path, "FLAGS", "L", NULL, TLOGICAL, logical);
    b = read_column(path, &info);
    assert_true(b->mask[0] == 0 && b->mask[1] != 0 && b->mask[2] == 0 && b->mask[3] != 0);
    shear_block_free(b);
    write_column(path, "FLAGS", "B", NULL, TBYTE, unknown);
    fixture_patch(path, "CATALOG", "TFORM1", "'L'");
    b = read_column(path, &info);
    assert_true(b->mask[0] == 0 && b->mask[1] != 0 && b->mask[2] != 0 && b->mask[3] == 0);
    shear_block_free(b);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_bitpix),
        cmocka_unit_test(scaled_integers),
        cmocka_unit_test(blank_becomes_nan),
        cmocka_unit_test(floating_pixels_arrive_as_they_are),
        cmocka_unit_test(lossless_compression),
        cmocka_unit_test(quantized_compression),
        cmocka_unit_test(compressed_nan),
        cmocka_unit_test(gzipped_files),
        cmocka_unit_test(gzip_of_compressed),
        cmocka_unit_test(columns_of_other_types),
        cmocka_unit_test(ids_are_exact),
        cmocka_unit_test(flags_of_all_kinds),
    };
    return cmocka_run_group_tests(tests, fixture_setup, fixture_teardown);
}
