/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/fields/field_result.h"

#include "base/cleanup.h"
#include "service/core/parts.h"
#include "service/fields/estimates.h"
#include "service/jobs/active_jobs.h"

CLEANUP_DEFINE(shear_field_sums, shear_field_sums_free)

static int result_of(service *s, const store_field *f, const shear_settings *settings,
                     const shear_field_sums *sums, int64_t since, shear_result *out, int64_t *jobs,
                     shear_error *err) {
    *jobs = f->jobs;
    if (shear_estimator_is_symmetric(settings->estimator))
        return estimates_get(s, f, sums, since, out, jobs, err);
    shear_field_result(sums, out);
    return SHEAR_OK;
}

/* List the running jobs of the field and, if `partial`, add their sums: exactly, so that the result
 * does not depend on the order. */
static void add_running(service *s, const store_field *f, shear_field_sums *sums, bool partial,
                        field_result *out) {
    for (const active_job *j = s->jobs->first; j != NULL && out->n_running < SHEARD_MSG_LIST_MAX;
         j = j->next) {
        if (!active_job_is_of(j, f->name, f->settings_digest))
            continue;
        out->running[out->n_running++] = j->id;
        if (partial)
            engine_partial(s->engine, j->id, sums);
    }
}

int field_result_now(service *s, const store_field *f, const shear_settings *settings,
                     int64_t since, field_result *out, shear_error *err) {
    CLEANUP(shear_field_sums_release) shear_field_sums *sums = NULL;
    *out = (field_result){.running = calloc(SHEARD_MSG_LIST_MAX, sizeof *out->running)};
    if (out->running == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory");
    TRY(f->sums != NULL && f->sums[0] != '\0' ? shear_field_sums_parse(&sums, f->sums, err)
                                              : shear_field_sums_new(&sums, err));
    add_running(s, f, sums, !shear_estimator_is_symmetric(settings->estimator), out);
    return result_of(s, f, settings, sums, since, &out->result, &out->jobs, err);
}

void field_result_deinit(field_result *r) {
    free(r->running);
    *r = (field_result){.jobs = 0};
}

int field_result_counted(service *s, const store_field *f, int64_t since, shear_result *out,
                         int64_t *jobs, shear_error *err) {
    CLEANUP(shear_field_sums_release) shear_field_sums *sums = NULL;
    shear_settings settings;
    TRY(sheard_settings_read(&settings, f->settings, err));
    TRY(shear_field_sums_parse(&sums, f->sums, err));
    return result_of(s, f, &settings, sums, since, out, jobs, err);
}

/* ---- rows of running jobs ---- */

static int add_row(store_field_page *page, const char *name, const active_job *j,
                   shear_error *err) {
    char settings[SHEARD_MSG_SETTINGS_SIZE];
    TRY(sheard_settings_write(&j->settings, settings, sizeof settings, err));
    store_field *larger = realloc(page->fields, (page->n + 1) * sizeof *larger);
    if (larger == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for the rows of a field");
    page->fields = larger;
    store_field *f = &larger[page->n++];
    *f = (store_field){.name = strdup(name),
                       .settings_digest = strdup(j->digest),
                       .settings = strdup(settings),
                       .sums = strdup("")};
    return f->name != NULL && f->settings_digest != NULL && f->settings != NULL && f->sums != NULL
               ? SHEAR_OK
               : shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for the rows of a field");
}

int field_result_add_rows(const service *s, const char *name, store_field_page *page,
                          shear_error *err) {
    const size_t counted = page->n;
    for (const active_job *j = s->jobs->first; j != NULL; j = j->next) {
        if (!active_job_is_of(j, name, NULL))
            continue;
        if (store_field_page_find(page, j->digest) == NULL)
            TRY(add_row(page, name, j, err));
        store_field *f = store_field_page_find(page, j->digest);
        if (f >= page->fields + counted)
            f->unfinished++;
    }
    return SHEAR_OK;
}
