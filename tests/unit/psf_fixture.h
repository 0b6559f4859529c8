/* SPDX-License-Identifier: GPL-3.0-or-later */
/* psf_fixture.h: files of PSF models, and what a model's samples are at a place. */
#pragma once

#include "fits_fixture.h"
#include "survey/psf/psf_models.h"

/* A column of a table: numbers (of all rows), or a text (the same in all rows). */
typedef struct psf_fixture_column {
    const char *name, *form; /* NULL: the end of the list */
    const char *dim;         /* TDIM, or NULL */
    const double *numbers;
    const char *text;
} psf_fixture_column;
/* Append a table called `name` ("": no EXTNAME). */
void psf_fixture_table(fitsfile *f, const char *name, int rows, const psf_fixture_column *columns);
/* Write keywords into the HDU that was appended last: the card "KEY = value", up to NULL. */
void psf_fixture_keys(fitsfile *f, const char *const *cards);

/* Open a file, which must work. */
psf_models *psf_fixture_open(const char *path, enum shear_psf_kind kind, int stamp);
/* Open must fail with `code`, and its message or advice contain each of the words up to NULL. */
void psf_fixture_refuse(const char *path, enum shear_psf_kind kind, int code, ...);
/* Write the samples of model `i` at a place into out[ny][nx]. */
void psf_fixture_samples(const psf_models *p, int i, const psf_place *place, double *out);

/* A number even in [0, 1), and a standard normal one. */
double psf_fixture_uniform(uint64_t *seed);
double psf_fixture_normal(uint64_t *seed);

/* Fail unless |a - b| <= tolerance. */
void psf_fixture_near(double a, double b, double tolerance);

/* Open copies of a file, each with a few wrong bytes, `rounds` times: an error, or a model that can
 * be evaluated. */
void psf_fixture_spoil(const char *path, int rounds);

/* Open the file with the n-th allocation failing, for all n. */
void psf_fixture_starve(const char *path);

/* Return the path of a file of real survey data, or NULL: there are none on this machine. */
const char *psf_fixture_real(const char *name);
/* Read the image in HDU `hdu` (1 = primary): [*ny][*nx], for the caller to free. */
double *psf_fixture_image(const char *path, int hdu, int *nx, int *ny);
