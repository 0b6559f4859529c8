/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Damaged tile-compressed files: refused before CFITSIO unpacks them, because it trusts what it
 * unpacks. */
#include "fits_fixture.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define END ((const char *)NULL)

static const char *bad(void) {
    return fixture_path("bad.fits.fz");
}

/* 5 stamps of 13 x 9, one a tile. */
static void packed(int algorithm, int bitpix, bool lossy) {
    const fixture_image image = {.bitpix = bitpix,
                                 .axes = {13, 9},
                                 .compression = algorithm,
                                 .lossy = lossy,
                                 .tile = {13, 9, 1}};
    fixture_write_like(bad(), &image, 5);
}

/* Give a column of GALAXY another name. */
static void rename_column(const char *name) {
    for (int i = 1; i < 9; i++) {
        char key[16];
        char value[80] = "";
        snprintf(key, sizeof key, "TTYPE%d", i);
        if (fixture_string(bad(), "GALAXY", key, value) && strcmp(value, name) == 0)
            fixture_patch(bad(), "GALAXY", key, "'ELSE'");
    }
}

static void header_keywords(void **state) {
    (void)state;
    static const struct {
        const char *key, *value, *word;
    } cases[] = {{"ZTILE1", "0", "ZTILE1 is 0, but must be an integer from 1"},
                 {"ZTILE2", "-9", "ZTILE2 is -9"},
                 {"ZTILE3", "2", "3 tiles, but the table has 5 rows"},
                 {"ZTILE1", "9223372036854775807", "ZTILE1"},
                 {"ZNAXIS", "4", "ZNAXIS"},
                 {"ZNAXIS", "1", "ZNAXIS"},
                 {"ZNAXIS", "'3'", "ZNAXIS"},
                 {"ZNAXIS1", "0", "ZNAXIS1"},
                 {"ZNAXIS1", "100000000", "1 GiB"},
                 {"ZNAXIS1", "130000", "tiles, but the table has 5 rows"},
                 {"ZNAXIS2", "9223372036854775807", "ZNAXIS2"},
                 {"ZNAXIS2", "2147483647", "tiles"},
                 {"ZNAXIS3", "6", "6 tiles, but the table has 5 rows"},
                 {"ZBITPIX", "64", "ZBITPIX"},
                 {"ZBITPIX", "12", "ZBITPIX"},
                 {"ZCMPTYPE", "'LZW'", "ZCMPTYPE is 'LZW'"},
                 {"ZCMPTYPE", "''", "ZCMPTYPE"},
                 {"ZVAL1", "0", "from 16 to 32"},
                 {"ZVAL1", "-32", "from 16 to 32"},
                 {"ZVAL1", "1000000", "from 16 to 32"},
                 {"ZVAL2", "3", "bytes per pixel"},
                 {"ZVAL2", "8", "from 1 to 4"},
                 {"ZNAME1", "'BYTEPIX'", "belongs there"},
                 {"ZDITHER0", "0", "from 1 to 10000"},
                 {"ZDITHER0", "10001", "from 1 to 10000"},
                 {"ZDITHER0", "2147483647", "from 1 to 10000"},
                 {"ZQUANTIZ", "'SOMEHOW'", "must be one of NO_DITHER"},
                 {"ZBLANK", "2147483648", "ZBLANK"},
                 {"ZSCALE", "0", "ZSCALE is 0"},
                 {"ZZERO", "'0'", "ZZERO"},
                 {"GCOUNT", "2", "GCOUNT"},
                 {"ZQUANTIZ", "'NONE'", "ZQUANTIZ"},
                 {"TFORM1", "'1PI(99)'", "wrong type"},
                 {"TTYPE1", "'OTHER'", "COMPRESSED_DATA"},
                 {"NAXIS2", "4", "5 tiles, but the table has 4 rows"},
                 {"PCOUNT", "100000000", "end at byte"},
                 {"THEAP", "39", "THEAP"},
                 {"THEAP", "100000000", "THEAP"}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        packed(RICE_1, 16, false);
        fixture_patch(bad(), "GALAXY", cases[i].key, cases[i].value);
        fixture_expect_open(bad(), SHEAR_E_FORMAT, "HDU GALAXY", cases[i].word, END);
    }
    packed(RICE_1, -32, true);
    fixture_patch(bad(), "GALAXY", "ZVAL2", "2");
    fixture_expect_open(bad(), SHEAR_E_FORMAT, "HDU GALAXY", "4 for floating", END);
}

/* CFITSIO takes floating pixels without the columns ZSCALE and ZZERO for unquantized ones: the
 * integers behind them for floating numbers. */
static void quantized_without_scale(void **state) {
    (void)state;
    packed(RICE_1, -32, true);
    rename_column("ZSCALE");
    fixture_expect_open(bad(), SHEAR_E_FORMAT, "HDU GALAXY", "only one of the columns", END);
    rename_column("ZZERO");
    fixture_expect_open(bad(), SHEAR_E_FORMAT, "HDU GALAXY", "need GZIP, or the columns", END);
}

/* Read all stamps, which must fail and say where. */
static void expect_read(const char *word) {
    shear_field *field = NULL;
    shear_block *b = NULL;
    shear_error err = {0};
    if (shear_field_open(&field, bad(), &err) != SHEAR_OK)
        fail_msg("%s", err.message);
    assert_int_equal(shear_block_new(&b, shear_field_get_info(field), 5, NULL), SHEAR_OK);
    assert_int_equal(shear_field_read(field, 0, 5, b, &err), SHEAR_E_FORMAT);
    if (strstr(err.message, word) == NULL || strstr(err.message, "HDU GALAXY") == NULL)
        fail_msg("no '%s' in: %s", word, err.message);
    assert_int_equal(shear_field_read(field, 0, 2, b, &err), SHEAR_OK); /* the tiles before it */
    shear_block_free(b);
    shear_field_close(field);
}

static int64_t big_endian_32(const unsigned char *b) {
    return (int64_t)b[0] << 24 | b[1] << 16 | b[2] << 8 | b[3];
}

/* Write 4 big-endian bytes into a descriptor of GALAXY: half 0 the number of elements, 1 the place
 * in the heap. */
static void patch_descriptor(int tile, int half, uint32_t value) {
    size_t size = 0;
    const size_t at = fixture_data_offset(bad(), "GALAXY") + 8 * (size_t)tile + 4 * (size_t)half;
    unsigned char *bytes = fixture_load(bad(), &size);
    for (int i = 0; i < 4; i++)
        bytes[at + (size_t)i] = (unsigned char)(value >> (24 - 8 * i));
    fixture_save(bad(), bytes, size);
    free(bytes);
}

static void descriptors(void **state) {
    (void)state;
    static const struct {
        int half;
        uint32_t value;
        const char *word;
    } cases[] = {{0, 0x7fffffff, "outside"}, {1, 0x7fffffff, "outside"}, {0, 0xffffffff, "tile 3"},
                 {1, 0xffffffff, "tile 3"},  {0, 0, "no data"},          {0, 1, "damaged"}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        packed(RICE_1, 16, false);
        patch_descriptor(2, cases[i].half, cases[i].value);
        expect_read(cases[i].word);
    }
}

/* Overwrite the first bytes of tile 3's stream, or cut the stream short. */
static void spoil(int offset, const char *with, size_t count) {
    size_t size = 0;
    const size_t at = fixture_data_offset(bad(), "GALAXY");
    unsigned char *bytes = fixture_load(bad(), &size);
    const size_t heap = at + 5 * 8;
    const size_t stream = heap + (size_t)big_endian_32(bytes + at + 2 * 8 + 4);
    memcpy(bytes + stream + offset, with, count);
    fixture_save(bad(), bytes, size);
    free(bytes);
}

static uint32_t stream_elements(void) {
    size_t size = 0;
    const size_t at = fixture_data_offset(bad(), "GALAXY");
    unsigned char *bytes = fixture_load(bad(), &size);
    const int64_t n = big_endian_32(bytes + at + 2 * 8);
    free(bytes);
    return (uint32_t)n;
}

static void streams_that_are_too_short(void **state) {
    (void)state;
    static const struct {
        int algorithm, bitpix;
    } cases[] = {{RICE_1, 8},       {RICE_1, 16},      {RICE_1, 32},  {GZIP_1, 16},
                 {GZIP_2, -32},     {GZIP_1, -64},     {PLIO_1, 16},  {PLIO_1, 32},
                 {HCOMPRESS_1, 16}, {HCOMPRESS_1, 32}, {GZIP_1, -32}, {HCOMPRESS_1, 8}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        packed(cases[i].algorithm, cases[i].bitpix, false);
        const uint32_t n = stream_elements();
        const uint32_t cuts[] = {1, n / 4, n - 2};
        for (int k = 0; k < 3; k++) {
            patch_descriptor(2, 0, cuts[k]);
            expect_read("compressed tile 3");
        }
    }
}

static void streams_that_lie(void **state) {
    (void)state;
    packed(HCOMPRESS_1, 16, false); /* its own dimensions: CFITSIO would write that many pixels */
    spoil(2, "\x00\x01\x00\x00\x00\x01\x00\x00", 8);
    expect_read("compressed tile 3");
    packed(HCOMPRESS_1, 16, false); /* bit planes beyond an integer */
    spoil(22, "\xff\xff\xff", 3);
    expect_read("compressed tile 3");
    packed(HCOMPRESS_1, 16, false); /* magic */
    spoil(0, "\x00\x00", 2);
    expect_read("compressed tile 3");
    packed(PLIO_1, 16, false); /* longer than its column says */
    spoil(6, "\x7f\xff\x7f\xff", 4);
    expect_read("compressed tile 3");
    packed(RICE_1, 16, false); /* zeros without end */
    char zeros[40] = {0};
    zeros[2] = 0x20;
    spoil(0, zeros, sizeof zeros);
    patch_descriptor(2, 0, sizeof zeros);
    expect_read("compressed tile 3");
    packed(GZIP_1, 16, false);
    spoil(12, "\xff\xff\xff\xff\xff\xff", 6);
    expect_read("compressed tile 3");
}

/* A gzip stream of another tile size would be taken for pixels of another type. */
static void gzip_of_another_size(void **state) {
    (void)state;
    packed(GZIP_1, -64, false);
    fixture_patch(bad(), "GALAXY", "ZBITPIX", "16");
    fixture_patch(bad(), "GALAXY", "ZQUANTIZ", "'NO_DITHER'");
    shear_field *field = NULL;
    shear_block *b = NULL;
    shear_error err = {0};
    assert_int_equal(shear_field_open(&field, bad(), &err), SHEAR_OK);
    assert_int_equal(shear_block_new(&b, shear_field_get_info(field), 5, NULL), SHEAR_OK);
    assert_int_equal(shear_field_read(field, 0, 1, b, &err), SHEAR_E_FORMAT);
    assert_non_null(strstr(err.message, "compressed tile 1"));
    shear_block_free(b);
    shear_field_close(field);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(header_keywords),  cmocka_unit_test(quantized_without_scale),
        cmocka_unit_test(descriptors),      cmocka_unit_test(streams_that_are_too_short),
        cmocka_unit_test(streams_that_lie), cmocka_unit_test(gzip_of_another_size),
    };
    return cmocka_run_group_tests(tests, fixture_setup, fixture_teardown);
}
