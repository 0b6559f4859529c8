/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shearctl submit: submit files to the service as jobs. */
#include "base/cleanup.h"
#include "commands/commands.h"
#include "remote/follow.h"
#include "remote/job_text.h"
#include "remote/submission.h"
#include "terminal/message.h"

#include <getopt.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>

typedef struct submit_state {
    submission_options what;
    follow_options how; /* with --wait */
    bool wait;
    service service;
    int64_t *ids; /* [n_ids] accepted jobs */
    size_t n_ids;
    size_t refused;
    enum exit_code first_code; /* of the first refused file */
} submit_state;

static enum exit_code check(const command *self, submit_state *o, char **files, int n) {
    TRY(part_options_settle(&o->what.parts, self, files, n));
    if (o->what.key != NULL && n > 1)
        return options_fail(self, "a --key stands for one job: give one file with it");
    if (!isnan(o->how.timeout_s) && !o->wait)
        return options_fail(self, "--timeout needs --wait");
    return EXIT_CODE_DONE;
}

static void print_accepted(const sheard_msg_submitted *submitted) {
    char source[4200];
    char clean[4200];
    const sheard_msg_job *job = &submitted->job;
    printf("job %" PRId64 " %s%s: %s\n", job->id, sheard_job_state_name(job->state),
           submitted->known ? " (known by its key)" : "",
           message_clean(job_source_text(job, source, sizeof source), clean, sizeof clean));
}

static void refuse(submit_state *o, enum exit_code code) {
    o->first_code = o->refused == 0 ? code : o->first_code;
    o->refused++;
}

static void accept(submit_state *o, const sheard_msg_submitted *submitted, const char *text) {
    o->ids[o->n_ids++] = submitted->job.id;
    if (!o->service.json) {
        print_accepted(submitted);
    } else if (!o->wait) {
        puts(text);
    }
    fflush(stdout);
}

/* Send one request. Returns false if no further request can be sent. */
static bool send_one(submit_state *o, const submission *what, const char *name) {
    sheard_rpc_error error = {0};
    sheard_reply reply = {0};
    CLEANUP(release_free) char *text = NULL;
    const enum connection_status status =
        connection_call(o->service.connection, SHEARD_METHOD_SUBMIT, &what->params,
                        o->service.reply_timeout_s, &reply, &text, &error);
    if (status == CONNECTION_OK) {
        accept(o, &reply.submit, text);
        sheard_reply_deinit(&reply, SHEARD_METHOD_SUBMIT);
        return true;
    }
    char said[sizeof error.message];
    snprintf(said, sizeof said, "%s", error.message);
    snprintf(error.message, sizeof error.message, "%.200s%s%.270s", name != NULL ? name : "",
             name != NULL ? ": " : "", said);
    refuse(o, service_say(status, &error));
    return status == CONNECTION_REFUSED && !error.retry;
}

static void send_all(submit_state *o, char **names, size_t n) {
    bool going = true;
    for (size_t i = 0; going && i < n; i++) {
        CLEANUP(submission_deinit) submission what = {0};
        const enum exit_code code = submission_init(&what, names[i], &o->what);
        if (code != EXIT_CODE_DONE) {
            refuse(o, code);
        } else {
            going = send_one(o, &what, names[i]);
        }
        if (!going && i + 1 < n)
            message_fail(EXIT_CODE_PARTLY, NULL, "%zu more files were not submitted", n - i - 1);
    }
}

/* Print each job as `shearctl show` does, for --json. */
static enum exit_code print_jobs(submit_state *o) {
    for (size_t i = 0; i < o->n_ids; i++) {
        const sheard_params p = {.id = {.id = o->ids[i]}};
        TRY(service_answer(&o->service, SHEARD_METHOD_JOB, &p, NULL));
    }
    return EXIT_CODE_DONE;
}

static enum exit_code wait_for_all(submit_state *o) {
    const enum exit_code code = follow_jobs(&o->service, o->ids, o->n_ids, &o->how);
    if (!o->service.json || code == EXIT_CODE_OTHER || code == EXIT_CODE_UNREACHABLE)
        return code;
    TRY(print_jobs(o));
    return code;
}

static enum exit_code submit(submit_state *o, char **names, size_t n) {
    TRY(service_open(&o->service));
    send_all(o, names, n);
    const enum exit_code code = o->wait && o->n_ids > 0 ? wait_for_all(o) : EXIT_CODE_DONE;
    if (o->refused == 0)
        return code;
    return o->n_ids == 0 ? o->first_code : code == EXIT_CODE_DONE ? EXIT_CODE_PARTLY : code;
}

/* Fill in *o from the command line. */
static enum exit_code parse(const command *self, int argc, char **argv, submit_state *o) {
    submission_options *what = &o->what;
    const option_entry options[] = {{.name = "field", .text = &what->field},
                                    {.name = "priority",
                                     .integer = &what->priority,
                                     .min = -SHEARD_MSG_PRIORITY_MAX,
                                     .max = SHEARD_MSG_PRIORITY_MAX,
                                     .given = &what->has_priority},
                                    {.name = "key", .text = &what->key},
                                    {.name = "force", .flag = &what->force},
                                    PART_OPTIONS(&what->parts),
                                    EXPOSURE_OPTIONS(&what->parts),
                                    {.name = "wait", .flag = &o->wait},
                                    {.name = "timeout", .seconds = &o->how.timeout_s},
                                    {.name = "quiet", .flag = &o->how.quiet},
                                    SERVICE_OPTIONS(&o->service),
                                    {0}};
    service_init(&o->service);
    TRY(options_parse(self, argc, argv, options, &what->settings));
    return check(self, o, argv + optind, argc - optind);
}

static enum exit_code run(const command *self, int argc, char **argv) {
    static char *no_name[] = {NULL};
    submit_state o = {.what = {.parts = PART_OPTIONS_INIT}, .how = {.timeout_s = NAN}};
    TRY(parse(self, argc, argv, &o));
    const bool by_parts = part_options_any(&o.what.parts);
    const size_t n = by_parts ? 1 : (size_t)(argc - optind);
    CLEANUP(release_free) int64_t *ids = calloc(n, sizeof *ids);
    if (ids == NULL)
        return message_no_memory();
    o.ids = ids;
    const enum exit_code code = submit(&o, by_parts ? no_name : argv + optind, n);
    service_close(&o.service);
    return code;
}

COMMAND(submit, "hand files to the service, as jobs", run, NULL);
