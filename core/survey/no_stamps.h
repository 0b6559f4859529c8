/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/no_stamps.h: why an exposure has no galaxy that can be measured. */
#pragma once

#include "survey/internal.h"

/* What was read of the catalog. */
typedef struct source_count {
    int64_t rows, selected;
    bool by_sky; /* places are RA and Dec */
} source_count;

/* Add the sources of a chip's table; `shared`: it is every chip's. */
void source_count_add(source_count *c, const source_list *sources, bool shared);

/* SHEAR_E_FORMAT: no row, none that is selected, none that is on its image, none with a PSF. */
int no_stamps_check(const exposure *e, const source_count *c, const char *catalog,
                    shear_error *err);
