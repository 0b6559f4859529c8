/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/catalog/internal.h: the members of a catalog that is being written. */
#pragma once

#include "base/cleanup.h"
#include "fits/io/bitset.h"
#include "fits/io/output.h"
#include "fits/schema/layout.h"
#include "shear/catalog.h"

struct shear_catalog {
    sf_output out;
    int64_t n;
    unsigned columns;  /* of the field file */
    int carried_bytes; /* of a row of carried columns */
    bool id_unsigned;  /* its ids are unsigned numbers of 64 bits, stored as bits */
    sf_bitset written;
    int64_t kept;   /* number of rows that its header declares to be on disk */
    double *values; /* [capacity]: one column of a chunk, of any type */
    size_t capacity;
};

CLEANUP_DEFINE(shear_catalog, shear_catalog_abort)

/* Make a catalog with nothing open yet. *c is NULL on error. */
int sf_catalog_new(shear_catalog **c, const char *path, const shear_field_info *info,
                   shear_error *err);
/* Create the file at `path`, with its table. `kept_for`: the input's checksum for a file that
 * outlives its process (which replaces any other), or NULL. *c is NULL on error. */
int sf_catalog_begin(shear_catalog **c, const char *path, const shear_field_info *info,
                     const char *kept_for, bool overwrite, shear_error *err);
/* Make the columns of a catalog for such a field, {0} before; those carried are borrowed. */
void sf_catalog_layout(sf_layout *l, const shear_field_info *info);
/* Fail unless the CFITSIO status is 0: "cannot be written". */
int sf_catalog_check(const shear_catalog *c, int status, shear_error *err);

/* Keywords of an unfinished file, removed from the finished one: the input's checksum, and the
 * number of rows that are on disk. */
#define SF_KEPT_FOR  "KEPTFOR"
#define SF_KEPT_ROWS "KEPTROWS"
