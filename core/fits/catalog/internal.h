/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/catalog/internal.h: what a catalog that is being written consists of. */
#ifndef SHEAR_FITS_CATALOG_INTERNAL_H
#define SHEAR_FITS_CATALOG_INTERNAL_H

#include "base/cleanup.h"
#include "fits/io/bitset.h"
#include "fits/io/output.h"
#include "shear/catalog.h"

struct shear_catalog {
    sf_output out;
    int64_t n;
    unsigned columns; /* of the field file */
    bool id_unsigned; /* its ids are unsigned numbers of 64 bits, as bits */
    sf_bitset written;
    int64_t kept;   /* rows that its header says are on disk */
    double *values; /* [capacity]: one column of a chunk */
    int32_t *flags; /* [capacity] flags, or places */
    size_t capacity;
};

CLEANUP_DEFINE(shear_catalog, shear_catalog_abort)

/* The bookkeeping, with nothing open yet. *c is NULL on error. */
int sf_catalog_new(shear_catalog **c, const char *path, const shear_field_info *info,
                   shear_error *err);
/* Lay the table out in the empty file that c->out is. */
int sf_catalog_create_table(shear_catalog *c, const shear_field_info *info, const char *kept_for,
                            shear_error *err);
/* Its columns: how many, and whether the table at c->out.fits has just these. */
bool sf_catalog_has_columns(shear_catalog *c);

/* Keywords of an unfinished file, gone from the finished one: whose rows, and how many are safe. */
#define SF_KEPT_FOR  "KEPTFOR"
#define SF_KEPT_ROWS "KEPTROWS"

#endif
