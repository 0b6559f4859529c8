/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/sources/source_list.h: the sources of an exposure's catalog, chip by chip.
 *
 * Catalogs are FITS_LDAC, FITS_1.0, any FITS table, or SExtractor's ASCII_HEAD; column names in any
 * case. All rows are kept, selected or not: an object that is not measured is a neighbour still. */
#pragma once

#include "fits/carry/carry_rows.h"
#include "shear/input.h"
#include "survey/sources/source_cap.h"

#include <stdbool.h>
#include <stdint.h>

/* A catalog file with one table per chip, or one for all. */
typedef struct source_catalog source_catalog;

/* Open the catalog at part->path, or the descriptor fd if it is not negative. Options are columns,
 * origin and select of `exposure`. SHEAR_E_IO, SHEAR_E_FORMAT (which columns are missing, and what
 * --columns could say), SHEAR_E_SETTING. *c is NULL on error. */
int source_catalog_open(source_catalog **c, const shear_input_part *part, int fd,
                        const shear_exposure *exposure, shear_error *err);
void source_catalog_close(source_catalog *c);
/* Return the number of tables of objects. */
int source_catalog_tables(const source_catalog *c);
/* Return the number of the HDU that has them; -1: several have. */
int64_t source_catalog_hdu(const source_catalog *c);
/* Return EXTNAME of the image that table `i` belongs to, from its LDAC header; "" if unknown. */
const char *source_catalog_chip(const source_catalog *c, int i);
/* Return the image's header from an LDAC catalog, [*count] cards of 80 characters, or NULL. */
const char *source_catalog_header(const source_catalog *c, int i, int64_t *count);

/* Choose the columns that are carried to results: "all", "none" or NAME,...; NULL is "all". Those
 * of several tables must agree. Errors of carry_list_init() and carry_list_match(). Call
 * carry_list_deinit after an error, too. */
int source_catalog_carry(source_catalog *c, const char *names, carry_list *l, shear_error *err);
/* Find them in table `i`, to be read while the catalog is open. */
int source_catalog_carried(source_catalog *c, int i, const carry_list *l, carry_rows *r,
                           shear_error *err);

/* Arrays of [n] sources that are loaded; undefined numbers are NaN. */
typedef struct source_list {
    int64_t n;
    int64_t rows, rows_selected; /* of the table, loaded or not */
    double *x, *y;    /* pixels, the centre of the first pixel is (1, 1); NULL: no such columns */
    double *ra, *dec; /* degrees; NULL: no such columns */
    int64_t *id;      /* NUMBER or ID, else the row's number from 1 */
    int64_t *row;     /* number in the table, from 0 */
    double *r_gal;    /* 2 FLUX_RADIUS, or R_GAL itself; NULL: neither */
    bool r_gal_measured;   /* it is 2 FLUX_RADIUS */
    double *weight;        /* WEIGHT; NULL: no such column */
    double *a, *b, *theta; /* semi-axes of the isophote, pixels, and position angle, degrees from x
                              to y; NULL: no such columns */
    double *context;       /* [n][n_contexts], as asked for */
    int n_contexts;
    uint8_t *selected; /* 0: the row expression, or FLAGS >= 4, excludes it */
    void *memory;      /* of all arrays; owned */
} source_list;

/* Load the rows of table `i` that are in the cap (NULL, or no RA and Dec: all), at most 4,000,000.
 * `contexts` are the names of further columns that a PSF model depends on.
 * SHEAR_E_FORMAT: damaged, or a context has no column. Call source_list_deinit after an error, too.
 */
int source_catalog_load(source_catalog *c, int i, const char *const *contexts, int n_contexts,
                        source_cap *cap, source_list *out, shear_error *err);
void source_list_deinit(source_list *s);
