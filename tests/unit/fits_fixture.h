/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits_fixture.h: good field files, and the tools that spoil them. */
#pragma once

#include "shear/field.h"
#include "test.h"

#include <fitsio.h>
#include <stdbool.h>

/* Group set-up and tear-down: a temporary directory, removed with all that is in it. */
int fixture_setup(void **state);
int fixture_teardown(void **state);
/* "<that directory>/name"; the last 8 answers stay valid. */
const char *fixture_path(const char *name);
/* How many entries the directory holds. */
int fixture_count_files(void);

/* What pixel (x, y) of image i is: exact as a float, different everywhere. */
enum fixture_kind { FIXTURE_GALAXY, FIXTURE_NOISE, FIXTURE_PSF };
double fixture_pixel(int kind, int64_t i, int y, int x);

/* What row i of a catalog column is. */
double fixture_column(unsigned bit, int64_t i);
/* PSF_ID of row i where there are n_psf images. */
int32_t fixture_psf_id(int64_t i, int64_t n_psf);

/* 10 stamps of 12 x 10 in a cube of floats, one PSF of 9 x 7, OVERSAMP 2, no catalog. */
shear_field_spec fixture_spec(void);
/* Write the file that the spec describes, through libshear's writer, in scrambled chunks. */
void fixture_write(const char *path, const shear_field_spec *spec);
/* The same with the default spec. */
void fixture_write_good(const char *path);

/* An image to be written by CFITSIO itself. */
typedef struct fixture_image {
    const char *name;
    int bitpix;
    int naxis;
    long axes[3];
    double bscale, bzero; /* bscale 0 = leave both out */
    bool has_blank;
    long blank;
    int compression; /* RICE_1 and so on; 0 = none */
    long tile[3];    /* 0 = CFITSIO's choice */
    bool lossy;      /* quantize floating pixels */
} fixture_image;
/* Create a file with an empty primary HDU. */
fitsfile *fixture_create(const char *path);
/* Append the image; `pixels` are physical values. */
void fixture_append(fitsfile *f, const fixture_image *image, const double *pixels);
void fixture_close(fitsfile *f);
/* A field of `n` stamps whose three images are like *image (name and axes apart; the PSF is 9 x 7).
 */
void fixture_write_like(const char *path, const fixture_image *image, int n);

/* Bytes of a file; the caller frees them. */
unsigned char *fixture_load(const char *path, size_t *size);
void fixture_save(const char *path, const void *bytes, size_t size);
void fixture_gzip(const char *from, const char *to);
/* Put a card "KEY     = value" into the header of `hdu` ("" = primary), in place of the one with
 * that key or before END. */
void fixture_patch(const char *path, const char *hdu, const char *key, const char *value);
/* The string of a keyword in the header of `hdu`; false where it has none. */
bool fixture_string(const char *path, const char *hdu, const char *key, char value[FLEN_VALUE]);
/* Where the data of `hdu` begin in the file. */
size_t fixture_data_offset(const char *path, const char *hdu);

/* Open must fail with `code`; the message must contain the file's name and each of the words up to
 * NULL. */
void fixture_expect_open(const char *path, int code, ...);
