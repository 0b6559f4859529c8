/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/fields/no_result.h: why a field has no result, and whose contribution it is.
 * g = sum w N / sum w D needs two stamps and a sum of w D above 0: one file of absurd pixels can
 * take that away from all the others. The contributions that may be to blame are looked at some at
 * a time, for there may be very many. */
#ifndef SHEARD_SERVICE_NO_RESULT_H
#define SHEARD_SERVICE_NO_RESULT_H

#include "shear/sums.h"
#include "store/store.h"

typedef struct no_result {
    char *text; /* NULL: it has one */
    char *file, *checksum;
    int64_t job, contribution; /* of the worst contribution, where one is to blame; else 0 */
    double worst_d;            /* its sum of w D */
    const char *brief;         /* what is known without them */
    int64_t n_stamps, n_used;
    double sum_d;
    int64_t seen; /* contributions up to this one have been looked at */
    bool done;
} no_result;

void no_result_begin(no_result *r, const store_field *f, const shear_result *result);
/* Some more; true: that was all, and the texts are made. What cannot be found out is left out. */
bool no_result_look(no_result *r, store *s, const store_field *f);
void no_result_deinit(no_result *r);
/* The same without looking at the contributions. Static text; NULL: it has a result. */
const char *no_result_brief(const store_field *f, const shear_result *result);

#endif
