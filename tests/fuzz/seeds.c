/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "seeds.h"

#include "fits_fixture.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { BLOCK = 2880 };

static const struct {
    const char *name;
    int compression, bitpix; /* 0: a plain file of libshear's own */
    bool lossy, front;       /* front: with other HDUs before GALAXY */
} kinds[FUZZ_SEEDS] = {
    {"cube", 0, 0, false, false},
    {"mosaic", 0, 0, false, false},
    {"double", 0, 0, false, false},
    {"gzipped", 0, 0, false, false},
    {"cube+front", 0, 0, false, true},
    {"plain16", 0, 16, false, false},
    {"rice16", RICE_1, 16, false, false},
    {"rice16+front", RICE_1, 16, false, true},
    {"gzip1", GZIP_1, 16, false, false},
    {"gzip2", GZIP_2, -32, false, false},
    {"gzip2+front", GZIP_2, -32, false, true},
    {"plio", PLIO_1, 16, false, false},
    {"hcompress", HCOMPRESS_1, 16, false, false},
    {"hcompress+front", HCOMPRESS_1, 16, false, true},
    {"lossy", RICE_1, -32, true, false},
    {"lossy+front", RICE_1, -32, true, true},
    {"lossy_gzip", GZIP_1, -64, true, false},
    {"lossy_hcompress", HCOMPRESS_1, -32, true, false},
};

const char *fuzz_seed_name(int i) {
    return kinds[i].name;
}

static void write_own(int i, const char *path) {
    shear_field_spec s = fixture_spec();
    s.columns = SHEAR_COL_WEIGHT | SHEAR_COL_FLAGS | SHEAR_COL_R_GAL;
    if (i == 1 || i == 3) {
        s.layout = SHEAR_LAYOUT_MOSAIC;
        s.n_psf = 4;
        s.columns = SHEAR_COL_PSF_ID | SHEAR_COL_ID | SHEAR_COL_X | SHEAR_COL_FLAGS;
    }
    if (i == 2) {
        s.bitpix = -64;
        s.n_psf = s.n_stamps;
        s.columns = SHEAR_COL_WEIGHT;
    }
    fixture_write(path, &s);
}

/* A catalog of many types, some of them scaled, with columns that nobody asks for. */
static void append_catalog(const char *path) {
    char *names[] = {"ID", "X", "NOTE", "FLAGS", "WEIGHT", "LIST", "RA"};
    char *forms[] = {"K", "I", "7A", "B", "E", "1PJ", "D"};
    fitsfile *f = NULL;
    int status = 0;
    fits_open_diskfile(&f, path, READWRITE, &status);
    fits_create_tbl(f, BINARY_TBL, 5, 7, names, forms, NULL, "CATALOG", &status);
    fits_write_key_lng(f, "TNULL2", -99, NULL, &status);
    fits_write_key_lng(f, "TZERO2", 1000, NULL, &status);
    fits_write_key_lng(f, "TSCAL2", 2, NULL, &status);
    fits_write_key_lng(f, "TZERO1", 1, NULL, &status);
    fits_close_file(f, &status);
    assert_int_equal(status, 0);
}

/* Other people's HDUs: compressed images, an ASCII table, a table of everything. */
static void write_front(const char *path) {
    static const int algorithms[] = {RICE_1, HCOMPRESS_1, GZIP_2};
    static double pixels[3 * 64];
    char *names[] = {"A", "B", "C"};
    char *ascii[] = {"I6", "F9.3", "A8"};
    char *binary[] = {"1PE", "20A", "3X"};
    fitsfile *f = fixture_create(path);
    int status = 0;
    for (int i = 0; i < 192; i++)
        pixels[i] = i * i % 211;
    for (int i = 0; i < 3; i++) {
        fixture_append(f,
                       &(fixture_image){.name = "OTHER",
                                        .bitpix = i == 2 ? -32 : 16,
                                        .naxis = 3,
                                        .axes = {8, 8, 3},
                                        .compression = algorithms[i],
                                        .lossy = i == 2,
                                        .tile = {8, 8, 1}},
                       pixels);
    }
    fits_create_tbl(f, ASCII_TBL, 2, 3, names, ascii, NULL, "LIST", &status);
    fits_write_key_str(f, "TNULL1", "none", NULL, &status);
    fits_create_tbl(f, BINARY_TBL, 2, 3, names, binary, NULL, "TABLE", &status);
    assert_int_equal(status, 0);
    fixture_close(f);
}

/* Both files' primary HDUs are one block. */
static fuzz_bytes put_front(fuzz_bytes good) {
    const char *path = fixture_path("front.fits");
    fuzz_bytes front = {0};
    write_front(path);
    front.data = fixture_load(path, &front.size);
    fuzz_bytes both = {malloc(front.size + good.size), front.size + good.size - BLOCK};
    memcpy(both.data, good.data, BLOCK);
    memcpy(both.data + BLOCK, front.data + BLOCK, front.size - BLOCK);
    memcpy(both.data + front.size, good.data + BLOCK, good.size - BLOCK);
    free(front.data);
    free(good.data);
    return both;
}

fuzz_bytes fuzz_seed(int i) {
    const char *path = fixture_path("seed.fits");
    if (kinds[i].bitpix == 0) {
        write_own(i, path);
    } else {
        const bool packed = kinds[i].compression != 0;
        const fixture_image image = {.bitpix = kinds[i].bitpix,
                                     .axes = {13, 9},
                                     .compression = kinds[i].compression,
                                     .lossy = kinds[i].lossy,
                                     .tile = {13, packed ? 9 : 0, packed ? 1 : 0}};
        fixture_write_like(path, &image, 5);
        append_catalog(path);
    }
    if (strcmp(kinds[i].name, "gzipped") == 0) {
        const char *plain = path;
        path = fixture_path("seed.fits.gz");
        fixture_gzip(plain, path);
    }
    fuzz_bytes b = {0};
    b.data = fixture_load(path, &b.size);
    return kinds[i].front ? put_front(b) : b;
}

bool fuzz_seed_is_good(const char *path) {
    shear_field *field = NULL;
    shear_error err = {0};
    if (shear_field_open(&field, path, &err) != SHEAR_OK)
        fprintf(stderr, "fuzz_field: %s\n", err.message);
    shear_field_close(field);
    return err.code == SHEAR_OK;
}
