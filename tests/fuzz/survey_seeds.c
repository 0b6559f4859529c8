/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Whole exposures in one file: an image with its mask and variance, a catalog, and a PSF of each
 * kind. */
#include "seeds.h"

#include "psf_fixture.h"

#include <math.h>
#include <stdio.h>

enum { NX = 128, NY = 88, N = NX * NY, SOURCES = 6, SIDE = 9, PLANE = SIDE * SIDE, KINDS = 5 };

static const char *const kinds[KINDS] = {"psfex", "piff", "cube", "stars", "image"};

const char *fuzz_seed_name(int i) {
    return kinds[i % KINDS];
}

/* The sources are on the left; on the right there is empty sky for noise. */
static double place_x(int i) {
    return 22.0 + 27.0 * (i % 2) + 0.3 * i;
}

static double place_y(int i) {
    const int row = i / 2;
    return 21.0 + 22.0 * row;
}

/* ---- images ---- */

static double light(int x, int y) {
    double sum = 0.0;
    for (int i = 0; i < SOURCES; i++) {
        const double d2 = pow(x + 1 - place_x(i), 2.0) + pow(y + 1 - place_y(i), 2.0);
        sum += 2000.0 * exp(-d2 / 8.0);
    }
    return sum;
}

static void write_wcs(fitsfile *f, int i) {
    static const char *const types[][2] = {
        {"RA---TAN", "DEC--TAN"}, {"RA---TPV", "DEC--TPV"}, {"RA---TAN-SIP", "DEC--TAN-SIP"}};
    const char *const cards[] = {"CRVAL1  =                150.0",
                                 "CRVAL2  =                  2.0",
                                 "CRPIX1  =                 48.0",
                                 "CRPIX2  =                 44.0",
                                 "CD1_1   =              -7.2E-5",
                                 "CD1_2   =               1.0E-6",
                                 "CD2_1   =               1.0E-6",
                                 "CD2_2   =               7.2E-5",
                                 "AIRMASS =                  1.2",
                                 "SATURATE=              30000.0",
                                 NULL};
    const char *const tpv[] = {"PV1_1   =                  1.0", "PV1_7   =                 12.0",
                               "PV2_1   =                  1.0", "PV2_7   =                 12.0",
                               NULL};
    const char *const sip[] = {"A_ORDER =                    2", "A_2_0   =               1.0E-5",
                               "B_ORDER =                    2", "B_1_1   =               2.0E-5",
                               NULL};
    int status = 0;
    fits_write_key_str(f, "CTYPE1", types[i % 3][0], NULL, &status);
    fits_write_key_str(f, "CTYPE2", types[i % 3][1], NULL, &status);
    assert_int_equal(status, 0);
    psf_fixture_keys(f, cards);
    psf_fixture_keys(f, i % 3 == 1 ? tpv : i % 3 == 2 ? sip : tpv + 4);
}

static void append_image(fitsfile *f, const char *name, const char *type, int bitpix, int i,
                         const double *pixels) {
    const fixture_image image = {.name = name,
                                 .bitpix = bitpix,
                                 .naxis = 2,
                                 .axes = {NX, NY, 1},
                                 .compression = i % 3 == 0   ? 0
                                                : i % 3 == 1 ? RICE_1
                                                             : GZIP_1,
                                 .lossy = true};
    int status = 0;
    fixture_append(f, &image, pixels);
    fits_write_key_str(f, "EXTTYPE", type, NULL, &status);
    assert_int_equal(status, 0);
}

static void append_images(fitsfile *f, int i) {
    double pixels[N];
    const int bitpix = i % 2 == 0 ? -32 : 16;
    uint32_t noise = 1;
    for (int k = 0; k < N; k++) {
        noise = noise * 1664525u + 1013904223u;
        pixels[k] = 100.0 + (double)(noise >> 26) + light(k % NX, k / NX);
    }
    append_image(f, "SCI", "IMAGE", bitpix, i, pixels);
    write_wcs(f, i / 2);
    for (int k = 0; k < N; k++)
        pixels[k] = k % 997 == 0 ? 1.0 : 0.0;
    append_image(f, "MSK", "MASK", 16, i, pixels);
    for (int k = 0; k < N; k++)
        pixels[k] = 340.0;
    append_image(f, "VAR", "VARIANCE", -32, i, pixels);
}

/* ---- the catalog ---- */

static void append_sources(fitsfile *f) {
    double x[SOURCES];
    double y[SOURCES];
    double ra[SOURCES];
    double dec[SOURCES];
    double number[SOURCES];
    static const double zero[SOURCES];
    double size[SOURCES];
    for (int i = 0; i < SOURCES; i++) {
        x[i] = place_x(i);
        y[i] = place_y(i);
        ra[i] = 150.0 - 7.2e-5 * (x[i] - 48.0);
        dec[i] = 2.0 + 7.2e-5 * (y[i] - 44.0);
        number[i] = i + 1;
        size[i] = 2.0;
    }
    const psf_fixture_column columns[] = {
        {"NUMBER", "1J", NULL, number, NULL},    {"X_IMAGE", "1E", NULL, x, NULL},
        {"Y_IMAGE", "1E", NULL, y, NULL},        {"ALPHA_J2000", "1D", NULL, ra, NULL},
        {"DELTA_J2000", "1D", NULL, dec, NULL},  {"A_IMAGE", "1E", NULL, size, NULL},
        {"B_IMAGE", "1E", NULL, size, NULL},     {"THETA_IMAGE", "1E", NULL, zero, NULL},
        {"FLUX_RADIUS", "1E", NULL, size, NULL}, {"MAG_AUTO", "1E", NULL, number, NULL},
        {"FLAGS", "1I", NULL, zero, NULL},       {0}};
    psf_fixture_table(f, "OBJECTS", SOURCES, columns);
}

/* ---- PSFs ---- */

/* Write planes of a star that becomes wider, or nothing but for the first plane. */
static void fill_planes(double *out, int planes, bool first_only) {
    for (int p = 0; p < planes; p++) {
        for (int k = 0; k < PLANE; k++) {
            const double d2 = pow(k % SIDE - 4, 2.0) + pow(k / SIDE - 4, 2.0);
            out[p * PLANE + k] = p > 0 && first_only ? 1e-4 * d2 : exp(-d2 / (4.0 + 0.1 * p));
        }
    }
}

static void append_psfex(fitsfile *f, bool deep) {
    enum { TERMS = 6 };
    static const char *const plain[] = {"POLNAXIS=                    2",
                                        "POLNAME1= 'X_IMAGE '",
                                        "POLNAME2= 'Y_IMAGE '",
                                        "POLGRP1 =                    1",
                                        "POLGRP2 =                    1",
                                        "POLDEG1 =                    2",
                                        NULL};
    static const char *const contexts[] = {"POLNAXIS=                    2",
                                           "POLNAME1= 'MAG_AUTO'",
                                           "POLNAME2= ':AIRMASS'",
                                           "POLGRP1 =                    1",
                                           "POLGRP2 =                    1",
                                           "POLDEG1 =                    2",
                                           NULL};
    static const char *const both[] = {"POLNGRP =                    1",
                                       "POLZERO1=                 48.0",
                                       "POLZERO2=                 44.0",
                                       "POLSCAL1=                 90.0",
                                       "POLSCAL2=                 90.0",
                                       "PSF_FWHM=                  3.0",
                                       "PSF_SAMP=                  0.9",
                                       "PSFNAXIS=                    3",
                                       "PSFAXIS1=                    9",
                                       "PSFAXIS2=                    9",
                                       "PSFAXIS3=                    6",
                                       "ACCEPTED=                   50",
                                       "LOADED  =                   60",
                                       "CHI2    =                  1.1",
                                       NULL};
    double planes[TERMS * PLANE];
    fill_planes(planes, TERMS, true);
    const psf_fixture_column columns[] = {{"PSF_MASK", "486E", "(9,9,6)", planes, NULL}, {0}};
    psf_fixture_table(f, "PSF_DATA", 1, columns);
    psf_fixture_keys(f, deep ? contexts : plain);
    psf_fixture_keys(f, both);
}

static void append_piff(fitsfile *f) {
    enum { TERMS = 3 };
    static const double nine = SIDE;
    static const double step = 0.26;
    static const double order[] = {1.0, 1.0};
    static const double pointing[] = {10.0, 2.0}; /* hours, degrees */
    static const double range[] = {-12.0, 12.0, 3.0, 4.0};
    double planes[PLANE];
    double q[PLANE * TERMS] = {0.0};
    fill_planes(planes, 1, true);
    for (int k = 0; k < PLANE; k++)
        q[k * TERMS] = planes[k];
    const psf_fixture_column psf[] = {{"type", "9A", NULL, NULL, "SimplePSF"}, {0}};
    const psf_fixture_column model[] = {{"type", "9A", NULL, NULL, "PixelGrid"},
                                        {"size", "K", NULL, &nine, NULL},
                                        {"scale", "D", NULL, &step, NULL},
                                        {"interp", "10A", NULL, NULL, "Lanczos(7)"},
                                        {0}};
    const psf_fixture_column interp[] = {
        {"type", "15A", NULL, NULL, "BasisPolynomial"}, {"order", "2K", NULL, order, NULL}, {0}};
    const psf_fixture_column solution[] = {{"q", "243D", "(3,81)", q, NULL}, {0}};
    const psf_fixture_column wcs[] = {
        {"ra", "D", NULL, pointing, NULL}, {"dec", "D", NULL, pointing + 1, NULL}, {0}};
    const psf_fixture_column stars[] = {
        {"u", "D", NULL, range, NULL}, {"v", "D", NULL, range, NULL}, {0}};
    psf_fixture_table(f, "psf", 1, psf);
    psf_fixture_table(f, "psf_model", 1, model);
    psf_fixture_table(f, "psf_interp", 1, interp);
    psf_fixture_table(f, "psf_interp_solution", 1, solution);
    psf_fixture_table(f, "psf_wcs", 1, wcs);
    psf_fixture_table(f, "psf_stars", 4, stars);
}

static void append_cube(fitsfile *f, int planes) {
    static const double x[] = {20.0, 50.0, 80.0};
    static const double y[] = {20.0, 60.0, 40.0};
    double pixels[3 * PLANE];
    const fixture_image image = {
        .name = "PSF", .bitpix = -32, .naxis = planes > 1 ? 3 : 2, .axes = {SIDE, SIDE, planes}};
    const psf_fixture_column places[] = {{"X", "D", NULL, x, NULL}, {"Y", "D", NULL, y, NULL}, {0}};
    fill_planes(pixels, planes, false);
    fixture_append(f, &image, pixels);
    if (planes > 1)
        psf_fixture_table(f, "PLACES", planes, places);
}

static void append_stars(fitsfile *f) {
    enum { STARS = 14 };
    double pixels[STARS * PLANE];
    double x[STARS];
    double y[STARS];
    for (int i = 0; i < STARS; i++) {
        fill_planes(pixels + (size_t)i * PLANE, 1, true);
        x[i] = 6.0 * i + 5.0;
        y[i] = 80.0 - 5.0 * (i * i % 14);
    }
    for (int k = 0; k < STARS * PLANE; k++)
        pixels[k] = 1000.0 * pixels[k] + k * 7919 % 13;
    const psf_fixture_column columns[] = {{"VIGNET", "81E", "(9,9)", pixels, NULL},
                                          {"X_IMAGE", "1E", NULL, x, NULL},
                                          {"Y_IMAGE", "1E", NULL, y, NULL},
                                          {0}};
    psf_fixture_table(f, "STARS", STARS, columns);
}

static void append_psf(fitsfile *f, int i) {
    switch (i % KINDS) {
    case 0:
        append_psfex(f, i / KINDS % 2 != 0);
        break;
    case 1:
        append_piff(f);
        break;
    case 2:
        append_cube(f, 3);
        break;
    case 3:
        append_stars(f);
        break;
    default:
        append_cube(f, 1);
    }
}

/* ---- files ---- */

fuzz_bytes fuzz_seed(int i) {
    const char *path = fixture_path("seed.fits");
    fitsfile *f = fixture_create(path);
    append_images(f, i);
    append_psf(f, i);
    append_sources(f);
    fixture_close(f);
    fuzz_bytes b = {0};
    b.data = fixture_load(path, &b.size);
    return b;
}

bool fuzz_seed_is_good(const char *path) {
    shear_input input = shear_input_of_file(NULL);
    shear_field *field = NULL;
    shear_error err = {0};
    input.parts[SHEAR_PART_IMAGE] = (shear_input_part){path, "SCI", -1};
    input.parts[SHEAR_PART_CATALOG] = (shear_input_part){path, NULL, -1};
    input.parts[SHEAR_PART_PSF] = (shear_input_part){path, NULL, -1};
    input.exposure.origin = 1;
    input.exposure.stamp = 16;
    const bool good = shear_field_open_input(&field, &input, NULL, &err) == SHEAR_OK &&
                      shear_field_get_info(field)->n_stamps == SOURCES;
    if (!good)
        fprintf(stderr, "fuzz_survey: %s (%s)\n", err.message, err.advice);
    shear_field_close(field);
    return good;
}
