/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/fields/field_result.h: a field's result by its settings' estimator, from the counted jobs
 * and what the running jobs have measured so far. With a symmetric estimator only counted jobs are
 * included: the stamps of running jobs would have to be solved again for every request.
 *
 * `since`: see fields/estimates.h. */
#pragma once

#include "shear/settings.h"
#include "shear/sums.h"
#include "store/store.h"

typedef struct service service;

typedef struct field_result {
    shear_result result;
    int64_t jobs;     /* number of counted jobs in it */
    int64_t *running; /* [n_running] numbers of running jobs, owned */
    size_t n_running;
} field_result;

/* Get the result, including running jobs. Deinit *out in either case. */
int field_result_now(service *s, const store_field *f, const shear_settings *settings,
                     int64_t since, field_result *out, shear_error *err);
void field_result_deinit(field_result *r);
/* Get the result of the counted jobs alone, and their number. */
int field_result_counted(service *s, const store_field *f, int64_t since, shear_result *out,
                         int64_t *jobs, shear_error *err);

/* Add rows for settings of the field that have no contribution yet, but running jobs. */
int field_result_add_rows(const service *s, const char *name, store_field_page *page,
                          shear_error *err);
