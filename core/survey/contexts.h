/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/contexts.h: the numbers of a galaxy that a PSF model depends on beside its position:
 * columns of the catalog, and keywords of the image's header (":AIRMASS"). */
#pragma once

#include "survey/sources/source_list.h"

enum { MAX_CONTEXTS = 8 };

typedef struct contexts {
    int n;
    double value[MAX_CONTEXTS];        /* of keywords */
    int column[MAX_CONTEXTS];          /* number among the columns; -1: a keyword */
    const char *columns[MAX_CONTEXTS]; /* [n_columns] names, borrowed */
    int n_columns;
} contexts;

/* Sort the names, and read those of keywords from the header [count][80]; `where` names its file
 * and HDU in messages. SHEAR_E_FORMAT: a keyword is not there. */
int contexts_init(contexts *c, const char *const *names, int n, const char *cards, int64_t count,
                  const char *where, shear_error *err);
/* Fill out[c->n] for a row of the catalog, whose contexts are c->columns. */
void contexts_of_row(const contexts *c, const source_list *sources, int64_t row, double *out);
