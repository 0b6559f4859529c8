/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/chip_match.h: which table or model belongs to which chip. */
#pragma once

#include "shear/error.h"

/* The items of a file (tables of a catalog, models of a PSF file), of which each chip has one. */
typedef struct chip_items {
    const char *what; /* "tables of sources", for messages */
    const char *file;
    int n;
    const char *(*name)(const void *self, int i); /* EXTNAME of the chip of item `i`; "": unknown */
    const void *self;
} chip_items;

/* Find the item of chip `chip` of `chips`, called `name` ("": it has no name): by name, else by
 * order; a single item serves all chips. SHEAR_E_FORMAT: neither works. */
int chip_match(const chip_items *items, int chip, int chips, const char *name, int *item,
               shear_error *err);
