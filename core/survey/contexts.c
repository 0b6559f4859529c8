/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/contexts.h"

#include "base/cleanup.h"
#include "fits/header/card.h"

#include <math.h>
#include <string.h>

static int read_keyword(const char *key, const char *cards, int64_t count, const char *where,
                        double *value, shear_error *err) {
    for (int64_t i = 0; i < count; i++) {
        char found[SF_KEY + 1];
        sf_card_key(cards + i * SF_CARD, found);
        if (strcmp(found, key) == 0 && sf_card_double(cards + i * SF_CARD, value))
            return SHEAR_OK;
    }
    return shear_fail(err, SHEAR_E_FORMAT, "make the PSF model without it, or add the keyword",
                      "%s: has no number %s in its header, on which the PSF model depends", where,
                      key);
}

int contexts_init(contexts *c, const char *const *names, int n, const char *cards, int64_t count,
                  const char *where, shear_error *err) {
    *c = (contexts){.n = n};
    if (n > MAX_CONTEXTS) {
        return shear_fail(err, SHEAR_E_FORMAT, NULL,
                          "the PSF model depends on %d numbers, but there may be %d", n,
                          MAX_CONTEXTS);
    }
    for (int i = 0; i < n; i++) {
        const bool keyword = names[i][0] == ':';
        c->column[i] = keyword ? -1 : c->n_columns;
        if (keyword) {
            TRY(read_keyword(names[i] + 1, cards, count, where, &c->value[i], err));
        } else {
            c->columns[c->n_columns++] = names[i];
        }
    }
    return SHEAR_OK;
}

void contexts_of_row(const contexts *c, const source_list *sources, int64_t row, double *out) {
    for (int i = 0; i < c->n; i++) {
        out[i] = c->column[i] < 0 ? c->value[i]
                                  : sources->context[row * sources->n_contexts + c->column[i]];
    }
}
