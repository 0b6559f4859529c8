/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "remote/watch_view.h"

#include "remote/field_table.h"
#include "remote/job_text.h"
#include "remote/status_text.h"

#include "base/cleanup.h"
#include "base/clock.h"
#include "terminal/style.h"

#include <assert.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

enum { BAR_WIDTH = 24, FIELD_ROWS = 4 }; /* rows requested per field, one per digest */

/* Send the next request. */
static enum connection_status ask(watch_view *v, service *s, int method, const sheard_params *p,
                                  const char *field, sheard_rpc_error *error) {
    assert(v->n < WATCH_PARTS);
    watch_part *part = &v->parts[v->n];
    *part = (watch_part){.method = method, .field = field};
    const enum connection_status status =
        connection_call(s->connection, method, p, s->reply_timeout_s, &part->reply,
                        s->json ? &part->text : NULL, error);
    v->n += status == CONNECTION_OK;
    return status;
}

static enum connection_status ask_jobs(watch_view *v, service *s, unsigned states, int64_t n,
                                       sheard_rpc_error *error) {
    sheard_params p;
    sheard_params_init(&p, SHEARD_METHOD_JOBS);
    p.jobs.states = states;
    p.jobs.limit = n;
    return ask(v, s, SHEARD_METHOD_JOBS, &p, NULL, error);
}

static bool is_known(const watch_view *v, const char *field) {
    for (size_t i = WATCH_FIELDS; i < v->n; i++) {
        if (strcmp(v->parts[i].field, field) == 0)
            return true;
    }
    return false;
}

/* Request the fields of the jobs of a part. No request returns a single field: it is the first of
 * those that begin with its name. */
static enum connection_status ask_fields(watch_view *v, service *s, const watch_part *jobs,
                                         sheard_rpc_error *error) {
    const sheard_msg_job_page *page = &jobs->reply.jobs;
    for (size_t i = 0; i < page->n_jobs; i++) {
        const char *name = page->jobs[i].field;
        if (name == NULL || name[0] == '\0' || v->n == WATCH_PARTS || is_known(v, name))
            continue;
        sheard_params p;
        sheard_params_init(&p, SHEARD_METHOD_FIELDS);
        p.fields.prefix = name;
        p.fields.limit = FIELD_ROWS;
        TRY(ask(v, s, SHEARD_METHOD_FIELDS, &p, name, error));
    }
    return CONNECTION_OK;
}

enum connection_status watch_view_init(watch_view *v, service *s, int64_t n_jobs,
                                       sheard_rpc_error *error) {
    const unsigned active = 1U << SHEARD_JOB_RUNNING;
    const unsigned finished = 1U << SHEARD_JOB_DONE | 1U << SHEARD_JOB_FAILED |
                              1U << SHEARD_JOB_CANCELLED | 1U << SHEARD_JOB_RETRACTED;
    *v = (watch_view){.n = 0};
    TRY(ask(v, s, SHEARD_METHOD_STATUS, NULL, NULL, error));
    TRY(ask_jobs(v, s, active, n_jobs, error));
    TRY(ask_jobs(v, s, finished, n_jobs, error));
    for (size_t i = WATCH_ACTIVE; i <= WATCH_FINISHED; i++)
        TRY(ask_fields(v, s, &v->parts[i], error));
    return CONNECTION_OK;
}

void watch_view_deinit(watch_view *v) {
    for (size_t i = 0; i < v->n; i++) {
        sheard_reply_deinit(&v->parts[i].reply, v->parts[i].method);
        free(v->parts[i].text);
    }
}

static text_table *active_jobs(const sheard_msg_job_page *page) {
    static const text_column heads[] = {{"ID", 'r'}, {"FIELD", 'l'}, {"PROGRESS", 'l'}};
    text_table *t = text_table_new(heads, sizeof heads / sizeof *heads);
    for (size_t i = 0; i < page->n_jobs; i++) {
        const sheard_msg_job *job = &page->jobs[i];
        char text[128];
        text_table_cell(t, NULL, "%" PRId64, job->id);
        text_table_cell(t, NULL, "%s", job->field != NULL ? job->field : "-");
        text_table_cell(t, job_is_before_measuring(job) ? STYLE_DIM : NULL, "%s",
                        job_progress_text(job, BAR_WIDTH, text, sizeof text));
    }
    return t;
}

static text_table *finished_jobs(const sheard_msg_job_page *page) {
    text_table *t = job_table_new();
    for (size_t i = 0; i < page->n_jobs; i++)
        job_table_add(t, &page->jobs[i], clock_ms(CLOCK_REALTIME));
    return t;
}

/* Fields without a contribution have no row. */
static text_table *fields_of_jobs(const watch_view *v) {
    text_table *t = field_table_new();
    for (size_t i = WATCH_FIELDS; i < v->n; i++) {
        const sheard_msg_field_page *page = &v->parts[i].reply.fields;
        for (size_t k = 0; k < page->n_fields; k++) {
            if (strcmp(page->fields[k].field, page->fields[0].field) == 0)
                field_table_add(t, &page->fields[k], clock_ms(CLOCK_REALTIME));
        }
    }
    return t;
}

/* Print a table, which is freed, under its title; nothing if it has no rows. */
static enum exit_code print_part(const char *title, text_table *rows, FILE *out, bool colours) {
    CLEANUP(text_table_release) text_table *t = rows;
    if (text_table_is_empty(t))
        return EXIT_CODE_DONE;
    fprintf(out, "\n%s%s%s\n", colours ? STYLE_BOLD : "", title, colours ? STYLE_END : "");
    return text_table_render(t, out, 2, colours, 0);
}

enum exit_code watch_view_print(const watch_view *v, FILE *out, bool colours) {
    status_text_brief(&v->parts[WATCH_STATUS].reply.status, colours, out);
    TRY(print_part("running", active_jobs(&v->parts[WATCH_ACTIVE].reply.jobs), out, colours));
    TRY(print_part("finished", finished_jobs(&v->parts[WATCH_FINISHED].reply.jobs), out, colours));
    return print_part("fields", fields_of_jobs(v), out, colours);
}

void watch_view_json(const watch_view *v, FILE *out) {
    fprintf(out, "{\"status\": %s, \"active\": %s, \"finished\": %s, \"fields\": [",
            v->parts[WATCH_STATUS].text, v->parts[WATCH_ACTIVE].text,
            v->parts[WATCH_FINISHED].text);
    for (size_t i = WATCH_FIELDS; i < v->n; i++)
        fprintf(out, "%s%s", i > WATCH_FIELDS ? ", " : "", v->parts[i].text);
    fputs("]}\n", out);
    fflush(out);
}
