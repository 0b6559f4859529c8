/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/fields/field_result.h: a field's result by its settings' estimator: of what was counted,
 * and of what the jobs that run now have measured so far. Of pdf-sym only what was counted is in
 * it: stamps of running jobs would have to be solved again with every question.
 *
 * `since`: see fields/estimates.h. */
#ifndef SHEARD_SERVICE_FIELD_RESULT_H
#define SHEARD_SERVICE_FIELD_RESULT_H

#include "shear/settings.h"
#include "shear/sums.h"
#include "store/store.h"

typedef struct service service;

typedef struct field_result {
    shear_result result;
    int64_t jobs;     /* that are counted in it */
    int64_t *running; /* [n_running] jobs */
    size_t n_running;
} field_result;

/* Deinit it either way. */
int field_result_now(service *s, const store_field *f, const shear_settings *settings,
                     int64_t since, field_result *out, shear_error *err);
void field_result_deinit(field_result *r);
/* Of what was counted alone: the result, and how many jobs are in it. */
int field_result_counted(service *s, const store_field *f, int64_t since, shear_result *out,
                         int64_t *jobs, shear_error *err);

/* Add the rows of a field that have no contribution yet, but running jobs. */
int field_result_add_rows(const service *s, const char *name, store_field_page *page,
                          shear_error *err);

#endif
