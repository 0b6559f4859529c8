/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shearctl field: the shear of one field, as the service has it now. */
#include "cmdline/options.h"
#include "remote/report_text.h"
#include "remote/service.h"
#include "terminal/human.h"
#include "terminal/message.h"
#include "terminal/style.h"
#include "terminal/text_table.h"

#include <inttypes.h>
#include <stdlib.h>

enum { OPT_DIGEST = 256, OPT_JOBS, OPT_AFTER, OPT_LIMIT };

static const struct option options[] = {
    {"digest", required_argument, NULL, OPT_DIGEST},
    {"jobs", no_argument, NULL, OPT_JOBS},
    {"after", required_argument, NULL, OPT_AFTER},
    {"limit", required_argument, NULL, OPT_LIMIT},
    SERVICE_OPTIONS,
    {NULL, 0, NULL, 0},
};

typedef struct field_options {
    service service;
    sheard_params params;
    bool jobs;
} field_options;

static int handle(int value, void *context) {
    field_options *f = context;
    switch (value) {
    case OPT_DIGEST:
        f->params.field.digest = optarg;
        return EXIT_CODE_DONE;
    case OPT_AFTER:
        f->jobs = true;
        return options_int("after", optarg, 0, INT64_MAX, &f->params.field.after);
    case OPT_LIMIT:
        f->jobs = true;
        return options_int("limit", optarg, 1, SHEARD_MSG_FIELDS_PAGE, &f->params.field.limit);
    default:
        f->jobs = true;
        return EXIT_CODE_DONE;
    }
}

/* "12 counted, 2 to come (running: 31, 32)" */
static void print_jobs(const sheard_msg_field_row *row) {
    char running[200] = "";
    size_t used = 0;
    for (size_t i = 0; i < row->n_running && used < sizeof running - 24; i++) {
        const int n = snprintf(running + used, sizeof running - used, "%s%" PRId64,
                               i != 0 ? ", " : " (running: ", row->running[i]);
        used += n > 0 ? (size_t)n : 0;
    }
    if (row->unfinished > 0) {
        shear_text_line(stdout, "jobs", "%" PRId64 " counted, %" PRId64 " to come%s%s", row->jobs,
                        row->unfinished, running, used != 0 ? ")" : "");
    } else {
        shear_text_line(stdout, "jobs", "%" PRId64 " counted", row->jobs);
    }
}

static int print_contributions(const sheard_msg_field_row *row, bool utc) {
    static const text_column columns[] = {{"ENTRY", 'r'}, {"JOB", 'r'},     {"USED", 'r'},
                                          {"OF", 'r'},    {"COUNTED", 'l'}, {"CHECKSUM", 'l'}};
    text_table *t = text_table_new(columns, sizeof columns / sizeof *columns);
    for (size_t i = 0; i < row->n_contributions; i++) {
        const sheard_msg_contribution *c = &row->contributions[i];
        char time[HUMAN_SIZE];
        text_table_cell(t, NULL, "%" PRId64, c->id);
        text_table_cell(t, NULL, "%" PRId64, c->job);
        text_table_cell(t, NULL, "%" PRId64, c->n_used);
        text_table_cell(t, NULL, "%" PRId64, c->n_stamps);
        text_table_cell(t, NULL, "%s", human_time(c->counted_ms, utc, time));
        text_table_cell(t, STYLE_DIM, "%s", c->checksum != NULL ? c->checksum : "-");
    }
    const int code = text_table_render(t, stdout, 2, style_on(stdout), style_columns(1, 0));
    text_table_free(t);
    if (row->more && row->n_contributions > 0) {
        message_note("there are more: --after %" PRId64 " --digest %s goes on with them",
                     row->contributions[row->n_contributions - 1].id, row->digest);
    }
    return code;
}

static int print_row(const field_options *f, const sheard_msg_field_result *result,
                     const sheard_msg_field_row *row) {
    char name[256];
    char time[HUMAN_SIZE];
    printf("field %s%s\n", message_clean(result->field, name, sizeof name),
           row->partial ? "  (partial: more is to come)" : "");
    print_jobs(row);
    shear_text_print(row->report, row->reason, stdout);
    if (row->report == NULL && row->reason != NULL) {
        shear_text_line(stdout, "reason", "%s", row->reason);
    }
    if (row->culprit.job != 0) {
        shear_text_line(
            stdout, "culprit", "job %" PRId64 " (%s): shearctl retract %" PRId64 " takes it back",
            row->culprit.job, row->culprit.file != NULL ? row->culprit.file : "forgotten",
            row->culprit.job);
    }
    shear_text_line(stdout, "updated", "%s", human_time(row->updated_ms, f->service.utc, time));
    shear_text_line(stdout, "digest", "%s", row->digest);
    return f->jobs && row->n_contributions > 0 ? print_contributions(row, f->service.utc)
                                               : EXIT_CODE_DONE;
}

static int print(const field_options *f, const sheard_msg_field_result *result) {
    int code = EXIT_CODE_DONE;
    for (size_t i = 0; code == SHEAR_OK && i < result->n_rows; i++) {
        code = print_row(f, result, &result->rows[i]);
    }
    fflush(stdout);
    if (result->mixed) {
        message_warning("field %s was measured with different settings: its results are kept apart "
                        "and not to be averaged",
                        result->field);
    }
    return code;
}

static int run(int argc, char **argv) {
    field_options f = {.jobs = false};
    sheard_reply reply = {0};
    sheard_params_init(&f.params, SHEARD_METHOD_FIELD);
    int code = service_parse_operands(&cmd_field, argc, argv, options, handle, &f, &f.service,
                                      "field", 1, 1);
    code = code != SHEAR_OK ? code : service_open(&f.service);
    if (code != SHEAR_OK) {
        return code;
    }
    f.params.field.field = argv[optind];
    if (!f.jobs && f.service.json) {
        f.params.field.limit = 0; /* else its files tell in which range PSF radii and cores are */
    }
    code = service_answer(&f.service, SHEARD_METHOD_FIELD, &f.params, &reply);
    if (code == SHEAR_OK && !f.service.json) {
        code = print(&f, &reply.field);
    }
    sheard_reply_deinit(&reply, SHEARD_METHOD_FIELD);
    service_close(&f.service);
    return code;
}

const command cmd_field = {
    .name = "field",
    .summary = "the shear of one field, as it is now",
    .usage = "usage: shearctl field [OPTION...] NAME\n"
             "\n"
             "Print the shear of a field with its errors, over all jobs that are finished. Jobs "
             "of different\n"
             "settings are kept apart, a result for each digest of settings.\n"
             "\n"
             "  --digest TEXT           only the result of these settings\n"
             "  --jobs                  list the jobs that were counted (the first 100)\n"
             "  --limit N               list so many of them (at most 1000)\n"
             "  --after ENTRY           list them from behind this entry\n" SERVICE_OPTIONS_HELP
             "\n" EXIT_CODES_SERVICE ".\n",
    .run = run,
};
