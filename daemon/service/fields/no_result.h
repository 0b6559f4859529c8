/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/fields/no_result.h: why a field has no result, and which contribution is the cause. g =
 * sum w N / sum w D needs two stamps and a positive sum of w D: one file of absurd pixels can make
 * it negative for all others. Contributions are examined a few at a time, since there may be very
 * many. */
#pragma once

#include "shear/sums.h"
#include "store/store.h"

typedef struct no_result {
    char *text; /* NULL: the field has a result, or out of memory */
    char *file, *checksum;
    int64_t job, contribution; /* of the worst contribution; 0: none is the cause */
    double worst_d;            /* its sum of w D */
    const char *brief;         /* reason known without the contributions; static */
    int64_t n_stamps, n_used;
    double sum_d;
    int64_t seen; /* id of the last contribution examined */
    bool done;
} no_result;

void no_result_begin(no_result *r, const store_field *f, const shear_result *result);
/* Examine some more contributions. Return true if that was all; the texts are then complete, except
 * for what cannot be read. */
bool no_result_look(no_result *r, store *s, const store_field *f);
void no_result_deinit(no_result *r);
/* Return the reason without examining contributions, static text, or NULL: the field has a
 * result. */
const char *no_result_brief(const store_field *f, const shear_result *result);
