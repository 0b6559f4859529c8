/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "remote/watch_view.h"
#include "base/clock.h"

#include "remote/field_table.h"
#include "remote/job_text.h"
#include "remote/status_text.h"
#include "terminal/bar.h"
#include "terminal/human.h"
#include "terminal/style.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

enum { TEXT_STATUS, TEXT_ACTIVE, TEXT_FINISHED, TEXT_FIELDS };
enum { BAR_WIDTH = 24, FIELD_ROWS = 4 }; /* rows asked for of one field: one a digest */

static enum connection_status ask(service *s, int method, const sheard_params *p,
                                  sheard_reply *reply, char **text, sheard_rpc_error *error) {
    return connection_call(s->connection, method, p, s->reply_timeout_s, reply,
                           s->json ? text : NULL, error);
}

static enum connection_status ask_jobs(service *s, unsigned states, int64_t n, sheard_reply *reply,
                                       char **text, sheard_rpc_error *error) {
    sheard_params p;
    sheard_params_init(&p, SHEARD_METHOD_JOBS);
    p.jobs.states = states;
    p.jobs.limit = n;
    return ask(s, SHEARD_METHOD_JOBS, &p, reply, text, error);
}

static bool is_known(const watch_view *v, const char *const *names, const char *name) {
    for (size_t i = 0; i < v->n_fields; i++) {
        if (names[i] != NULL && strcmp(names[i], name) == 0) {
            return true;
        }
    }
    return false;
}

/* The fields of these jobs. There is no question for one field's line: it is the first of those
 * that begin with its name. */
static enum connection_status ask_fields(watch_view *v, const char **names, service *s,
                                         const sheard_msg_job_page *page, sheard_rpc_error *error) {
    enum connection_status status = CONNECTION_OK;
    for (size_t i = 0; status == CONNECTION_OK && i < page->n_jobs; i++) {
        const char *name = page->jobs[i].field;
        if (name == NULL || !*name || v->n_fields == WATCH_FIELDS || is_known(v, names, name)) {
            continue;
        }
        sheard_params p;
        sheard_params_init(&p, SHEARD_METHOD_FIELDS);
        p.fields.prefix = name;
        p.fields.limit = FIELD_ROWS;
        status = ask(s, SHEARD_METHOD_FIELDS, &p, &v->fields[v->n_fields],
                     &v->text[TEXT_FIELDS + v->n_fields], error);
        names[v->n_fields] = name;
        v->n_fields += status == CONNECTION_OK;
    }
    return status;
}

enum connection_status watch_view_init(watch_view *v, service *s, int64_t n_jobs,
                                       sheard_rpc_error *error) {
    const unsigned active = 1U << SHEARD_JOB_RUNNING;
    const unsigned finished = 1U << SHEARD_JOB_DONE | 1U << SHEARD_JOB_FAILED |
                              1U << SHEARD_JOB_CANCELLED | 1U << SHEARD_JOB_RETRACTED;
    const char *names[WATCH_FIELDS] = {NULL};
    *v = (watch_view){.n_fields = 0};
    enum connection_status status =
        ask(s, SHEARD_METHOD_STATUS, NULL, &v->status, &v->text[TEXT_STATUS], error);
    if (status == CONNECTION_OK) {
        status = ask_jobs(s, active, n_jobs, &v->active, &v->text[TEXT_ACTIVE], error);
    }
    if (status == CONNECTION_OK) {
        status = ask_jobs(s, finished, n_jobs, &v->finished, &v->text[TEXT_FINISHED], error);
    }
    if (status == CONNECTION_OK) {
        status = ask_fields(v, names, s, &v->active.jobs, error);
    }
    if (status == CONNECTION_OK) {
        status = ask_fields(v, names, s, &v->finished.jobs, error);
    }
    return status;
}

void watch_view_deinit(watch_view *v) {
    sheard_reply_deinit(&v->status, SHEARD_METHOD_STATUS);
    sheard_reply_deinit(&v->active, SHEARD_METHOD_JOBS);
    sheard_reply_deinit(&v->finished, SHEARD_METHOD_JOBS);
    for (size_t i = 0; i < v->n_fields; i++) {
        sheard_reply_deinit(&v->fields[i], SHEARD_METHOD_FIELDS);
    }
    for (size_t i = 0; i < sizeof v->text / sizeof *v->text; i++) {
        free(v->text[i]);
    }
}

static void title(FILE *out, const char *text, bool colours) {
    fprintf(out, "\n%s%s%s\n", colours ? STYLE_BOLD : "", text, colours ? STYLE_END : "");
}

static enum exit_code print_active(const sheard_msg_job_page *page, FILE *out, bool colours,
                                   int columns) {
    static const text_column heads[] = {{"ID", 'r'}, {"FIELD", 'l'}, {"PROGRESS", 'l'}};
    text_table *t = text_table_new(heads, sizeof heads / sizeof *heads);
    for (size_t i = 0; i < page->n_jobs; i++) {
        const sheard_msg_job *job = &page->jobs[i];
        const double part = bar_part((double)job->progress.done, (double)job->progress.total);
        char bar[BAR_WIDTH + 1];
        char figures[96];
        text_table_cell(t, NULL, "%" PRId64, job->id);
        text_table_cell(t, NULL, "%s", job->field != NULL ? job->field : "-");
        if (job_is_before_measuring(job)) {
            text_table_cell(t, STYLE_DIM, "%s",
                            job_phase_text(&job->progress, figures, sizeof figures));
            continue;
        }
        text_table_cell(
            t, NULL, "%s%s", bar_text(part, BAR_WIDTH, bar, sizeof bar),
            bar_figures(part, job->progress.rate, job->progress.eta_s, figures, sizeof figures));
    }
    const enum exit_code code = text_table_render(t, out, 2, colours, columns);
    text_table_free(t);
    return code;
}

static enum exit_code print_finished(const sheard_msg_job_page *page, FILE *out, bool colours,
                                     int columns) {
    text_table *t = job_table_new();
    for (size_t i = 0; i < page->n_jobs; i++) {
        job_table_add(t, &page->jobs[i], clock_ms(CLOCK_REALTIME));
    }
    const enum exit_code code = text_table_render(t, out, 2, colours, columns);
    text_table_free(t);
    return code;
}

static enum exit_code print_fields(const watch_view *v, FILE *out, bool colours, int columns) {
    text_table *t = field_table_new();
    for (size_t i = 0; i < v->n_fields; i++) {
        const sheard_msg_field_page *page = &v->fields[i].fields;
        for (size_t k = 0; k < page->n_fields; k++) {
            if (strcmp(page->fields[k].field, page->fields[0].field) == 0) {
                field_table_add(t, &page->fields[k], clock_ms(CLOCK_REALTIME));
            }
        }
    }
    const enum exit_code code = text_table_render(t, out, 2, colours, columns);
    text_table_free(t);
    return code;
}

/* Fields of which nothing has been counted yet have no line. */
static bool has_fields(const watch_view *v) {
    for (size_t i = 0; i < v->n_fields; i++) {
        if (v->fields[i].fields.n_fields > 0) {
            return true;
        }
    }
    return false;
}

enum exit_code watch_view_print(const watch_view *v, FILE *out, bool colours, int columns) {
    enum exit_code code = EXIT_CODE_DONE;
    status_text_brief(&v->status.status, colours, out);
    if (v->active.jobs.n_jobs > 0) {
        title(out, "running", colours);
        code = print_active(&v->active.jobs, out, colours, columns);
    }
    if (code == EXIT_CODE_DONE && v->finished.jobs.n_jobs > 0) {
        title(out, "finished", colours);
        code = print_finished(&v->finished.jobs, out, colours, columns);
    }
    if (code == EXIT_CODE_DONE && has_fields(v)) {
        title(out, "fields", colours);
        code = print_fields(v, out, colours, columns);
    }
    return code;
}

void watch_view_json(const watch_view *v, FILE *out) {
    fprintf(out, "{\"status\": %s, \"active\": %s, \"finished\": %s, \"fields\": [",
            v->text[TEXT_STATUS], v->text[TEXT_ACTIVE], v->text[TEXT_FINISHED]);
    for (size_t i = 0; i < v->n_fields; i++) {
        fprintf(out, "%s%s", i != 0 ? ", " : "", v->text[TEXT_FIELDS + i]);
    }
    fputs("]}\n", out);
    fflush(out);
}
