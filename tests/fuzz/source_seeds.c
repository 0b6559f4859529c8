/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Catalogs of sources in all formats. */
#include "seeds.h"

#include "source_fixture.h"

#include <stdio.h>
#include <string.h>

enum { ROWS = 12, FORMATS = 6 };

static const char *const formats[FORMATS] = {"ldac", "fields", "objects", "tables", "text", "gzip"};

static const char *const head[] = {"SIMPLE  =                    T", "EXTNAME = 'N15     '", "END",
                                   NULL};

static double chip_of(long i) {
    return (double)(i % 3 + 1);
}

static double angle(long i) {
    return 0.001 * (double)i;
}

static const source_fixture_column more[] = {
    {"EXT_NUMBER", "1B", NULL, chip_of}, {"coord_ra", "1D", "rad", angle},
    {"coord_dec", "1D", "rad", angle},   {"FLUX_RADIUS", "1E", NULL, chip_of},
    {"A_IMAGE", "1E", NULL, chip_of},    {"B_IMAGE", "1E", NULL, chip_of},
    {"THETA_IMAGE", "1E", "deg", angle}, {"ISOAREA_IMAGE", "1K", NULL, chip_of},
    {"VIGNET", "9E", NULL, angle},       {"CLEAN", "1L", NULL, chip_of}};
enum { USUAL = 5, MORE = sizeof more / sizeof *more };

const char *fuzz_seed_name(int i) {
    return formats[i % FORMATS];
}

/* The usual columns, and of every second table all others. */
static void append(fitsfile *f, const char *name, int i) {
    source_fixture_column columns[USUAL + MORE];
    memcpy(columns, source_fixture_usual, sizeof source_fixture_usual);
    memcpy(columns + USUAL, more, sizeof more);
    source_fixture_table(f, name, columns, i / FORMATS % 2 == 0 ? USUAL : USUAL + MORE, ROWS);
}

static void write_fits(const char *path, int i) {
    static const char *const names[] = {"LDAC_OBJECTS", "OBJECTS", "OBJECTS", "CCD1"};
    static const char *const heads[] = {"LDAC_IMHEAD", "FIELDS", NULL, NULL};
    const int format = i % FORMATS % 4;
    fitsfile *f = fixture_create(path);
    for (int chip = 0; chip < 1 + i / FORMATS % 3; chip++) {
        if (heads[format] != NULL)
            source_fixture_header(f, heads[format], head);
        append(f, names[format], i);
    }
    fixture_close(f);
}

static void write_text(const char *path) {
    char text[2000] =
        "# 1 NUMBER Running number\n# 2 X_IMAGE along x [pixel]\n# 3 Y_IMAGE [pixel]\n"
        "# 4 FLUX_APER Vector [count]\n# 7 FLAGS\n# 8 MAG_AUTO [mag]\n";
    for (int i = 0; i < ROWS; i++) {
        const size_t n = strlen(text);
        snprintf(text + n, sizeof text - n, "%5d %9.3f %9.3f 1 2.5 -3e2 %d %7.3f\n", i + 1,
                 10.5 + i, 20.25 * i, i % 6, 18.0 + i);
    }
    source_fixture_text(path, text);
}

fuzz_bytes fuzz_seed(int i) {
    const char *path = fixture_path("seed.cat");
    const char *packed = fixture_path("seed.cat.gz");
    const int format = i % FORMATS;
    if (format == 4 || (format == 5 && i / FORMATS % 2 == 0)) {
        write_text(path);
    } else {
        write_fits(path, i);
    }
    if (format == 5)
        fixture_gzip(path, packed);
    fuzz_bytes b = {0};
    b.data = fixture_load(format == 5 ? packed : path, &b.size);
    return b;
}

bool fuzz_seed_is_good(const char *path) {
    source_catalog *c = source_fixture_open(path, NULL);
    source_list s = source_fixture_load(c, 0);
    const bool good = s.n > 0 && s.x != NULL;
    source_list_deinit(&s);
    source_catalog_close(c);
    return good;
}
