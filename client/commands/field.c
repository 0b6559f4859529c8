/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shearctl field: the current shear of one field in the service. */
#include "base/cleanup.h"
#include "base/text.h"
#include "commands/commands.h"
#include "local/report_text.h"
#include "remote/service.h"
#include "terminal/human.h"
#include "terminal/message.h"
#include "terminal/style.h"
#include "terminal/text_line.h"
#include "terminal/text_table.h"

#include <getopt.h>
#include <inttypes.h>
#include <string.h>

/* Print "12 counted, 2 to come (running: 31, 32)". */
static void print_jobs(const sheard_msg_field_row *row) {
    char running[200] = "";
    for (size_t i = 0; i < row->n_running && strlen(running) < sizeof running - 24; i++) {
        text_append(running, sizeof running, "%s%" PRId64,
                    i != 0 ? ", " : " (running: ", row->running[i]);
    }
    if (row->unfinished > 0) {
        text_line(stdout, "jobs", "%" PRId64 " counted, %" PRId64 " to come%s%s", row->jobs,
                  row->unfinished, running, running[0] != '\0' ? ")" : "");
    } else {
        text_line(stdout, "jobs", "%" PRId64 " counted", row->jobs);
    }
}

static enum exit_code print_contributions(const sheard_msg_field_row *row, bool utc) {
    static const text_column columns[] = {{"ENTRY", 'r'}, {"JOB", 'r'},     {"USED", 'r'},
                                          {"OF", 'r'},    {"COUNTED", 'l'}, {"CHECKSUM", 'l'}};
    CLEANUP(text_table_release)
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
    TRY(text_table_render(t, stdout, 2, style_on(stdout), style_columns(1, 0)));
    if (row->more && row->n_contributions > 0) {
        message_note("there are more: --after %" PRId64 " --digest %s goes on with them",
                     row->contributions[row->n_contributions - 1].id, row->digest);
    }
    return EXIT_CODE_DONE;
}

static void print_row(const char *field, const sheard_msg_field_row *row, bool utc) {
    char name[256];
    char time[HUMAN_SIZE];
    printf("field %s%s\n", message_clean(field, name, sizeof name),
           row->partial ? "  (partial: more is to come)" : "");
    print_jobs(row);
    report_text_print(row->report, row->reason, false, stdout);
    if (row->report == NULL && row->reason != NULL)
        text_line(stdout, "reason", "%s", row->reason);
    if (row->culprit.job != 0) {
        text_line(stdout, "culprit",
                  "job %" PRId64 " (%s): shearctl retract %" PRId64 " takes it back",
                  row->culprit.job, row->culprit.file != NULL ? row->culprit.file : "forgotten",
                  row->culprit.job);
    }
    text_line(stdout, "updated", "%s", human_time(row->updated_ms, utc, time));
    text_line(stdout, "digest", "%s", row->digest);
}

static enum exit_code print(const sheard_msg_field_result *result, bool contributions, bool utc) {
    enum exit_code code = EXIT_CODE_DONE;
    for (size_t i = 0; code == EXIT_CODE_DONE && i < result->n_rows; i++) {
        const sheard_msg_field_row *row = &result->rows[i];
        print_row(result->field, row, utc);
        if (contributions && row->n_contributions > 0)
            code = print_contributions(row, utc);
    }
    fflush(stdout);
    if (result->mixed) {
        message_warning("field %s was measured with different settings: its results are kept apart "
                        "and not to be averaged",
                        result->field);
    }
    return code;
}

static enum exit_code run(const command *self, int argc, char **argv) {
    CLEANUP(service_close) service s = {0};
    sheard_params p;
    sheard_reply reply = {0};
    bool jobs = false;
    sheard_params_init(&p, SHEARD_METHOD_FIELD);
    const option_entry options[] = {
        {.name = "digest", .text = &p.field.digest},
        {.name = "jobs", .flag = &jobs},
        {.name = "after", .integer = &p.field.after, .max = INT64_MAX, .given = &jobs},
        {.name = "limit",
         .integer = &p.field.limit,
         .min = 1,
         .max = SHEARD_MSG_FIELDS_PAGE,
         .given = &jobs},
        SERVICE_OPTIONS(&s),
        {0}};
    TRY(service_start(self, argc, argv, options, &s, "field", 1, 1));
    p.field.field = argv[optind];
    if (!jobs && s.json) {
        p.field.limit = 0; /* no contributions: only the text output needs them, for the ranges of
                              PSF radii and cores */
    }
    enum exit_code code = service_answer(&s, SHEARD_METHOD_FIELD, &p, &reply);
    if (code == EXIT_CODE_DONE && !s.json)
        code = print(&reply.field, jobs, s.utc);
    sheard_reply_deinit(&reply, SHEARD_METHOD_FIELD);
    return code;
}

COMMAND(field, "the shear of one field, as it is now", run, NULL);
