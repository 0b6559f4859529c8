/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shearctl submit: files to the service, as jobs. */
#include "cmdline/options.h"
#include "remote/follow.h"
#include "remote/job_text.h"
#include "remote/submission.h"
#include "terminal/human.h"
#include "terminal/message.h"

#include <inttypes.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>

enum { OPT_FIELD = 256, OPT_PRIORITY, OPT_KEY, OPT_FORCE, OPT_WAIT, OPT_TIMEOUT, OPT_QUIET };

static const struct option own_options[] = {
    {"field", required_argument, NULL, OPT_FIELD},
    {"priority", required_argument, NULL, OPT_PRIORITY},
    {"key", required_argument, NULL, OPT_KEY},
    {"force", no_argument, NULL, OPT_FORCE},
    PART_OPTIONS,
    {"wait", no_argument, NULL, OPT_WAIT},
    {"timeout", required_argument, NULL, OPT_TIMEOUT},
    {"quiet", no_argument, NULL, OPT_QUIET},
    SERVICE_OPTIONS,
};
enum { N_OWN = sizeof own_options / sizeof own_options[0] };

typedef struct submit_state {
    submission_options what;
    bool wait, quiet;
    double timeout_s;
    service service;
    int64_t *ids; /* [n_ids] accepted */
    size_t n_ids;
    size_t refused;
    int first_code; /* of the first that was refused */
} submit_state;

static int set_setting(int value, submit_state *o) {
    shear_error err = {0};
    if (settings_options_handle(value, optarg, &o->what.settings, o->what.given, &err) != 0) {
        message_error(&err);
        return EXIT_CODE_USAGE;
    }
    return EXIT_CODE_DONE;
}

static int set_timeout(submit_state *o) {
    if (!human_parse_duration(optarg, &o->timeout_s)) {
        message_fail(NULL, "--timeout %s: expected a time, as 90, 500ms, 5min, 2h", optarg);
        return EXIT_CODE_USAGE;
    }
    return EXIT_CODE_DONE;
}

static int handle(int value, void *context) {
    submit_state *o = context;
    submission_options *what = &o->what;
    if (settings_options_is(value)) {
        return set_setting(value, o);
    }
    if (part_options_is(value)) {
        part_options_set(&what->parts, value, optarg);
        return EXIT_CODE_DONE;
    }
    switch (value) {
    case OPT_PRIORITY:
        what->has_priority = true;
        return options_int("priority", optarg, -SHEARD_MSG_PRIORITY_MAX, SHEARD_MSG_PRIORITY_MAX,
                           &what->priority);
    case OPT_TIMEOUT:
        return set_timeout(o);
    case OPT_FORCE:
        what->force = true;
        return EXIT_CODE_DONE;
    case OPT_WAIT:
        o->wait = true;
        return EXIT_CODE_DONE;
    case OPT_QUIET:
        o->quiet = true;
        return EXIT_CODE_DONE;
    default:
        *(value == OPT_FIELD ? &what->field : &what->key) = optarg;
        return EXIT_CODE_DONE;
    }
}

static int contradiction(const char *text) {
    message_fail("\"shearctl help submit\"", "submit: %s", text);
    return EXIT_CODE_USAGE;
}

static int check(submit_state *o, char **files, int n) {
    const int code = part_options_settle(&o->what.parts, &cmd_submit, files, n);
    if (code != SHEAR_OK) {
        return code;
    }
    if (o->what.key != NULL && n > 1) {
        return contradiction("a --key stands for one job: give one file with it");
    }
    if (!isnan(o->timeout_s) && !o->wait) {
        return contradiction("--timeout needs --wait");
    }
    return EXIT_CODE_DONE;
}

static void print_accepted(const sheard_msg_submitted *submitted) {
    char source[4200];
    char clean[4200];
    const sheard_msg_job *job = &submitted->job;
    printf("job %" PRId64 " %s%s: %s\n", job->id, sheard_job_state_name(job->state),
           submitted->known ? " (known by its key)" : "",
           message_clean(job_source_text(job, source, sizeof source), clean, sizeof clean));
    fflush(stdout);
}

static void refuse(submit_state *o, int code) {
    o->first_code = o->refused == 0 ? code : o->first_code;
    o->refused++;
}

/* Send one. False: nothing more can be sent. */
static bool send_one(submit_state *o, const submission *what, const char *name) {
    sheard_rpc_error error = {0};
    sheard_reply reply = {0};
    char *text = NULL;
    const int status = connection_call(o->service.connection, SHEARD_METHOD_SUBMIT, &what->params,
                                       o->service.reply_timeout_s, &reply, &text, &error);
    if (status == CONNECTION_OK) {
        o->ids[o->n_ids++] = reply.submit.job.id;
        if (!o->service.json) {
            print_accepted(&reply.submit);
        } else if (!o->wait) {
            puts(text);
            fflush(stdout);
        }
        sheard_reply_deinit(&reply, SHEARD_METHOD_SUBMIT);
        free(text);
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
        submission what;
        const int code = submission_init(&what, names[i], &o->what);
        if (code != SHEAR_OK) {
            refuse(o, code);
        } else {
            going = send_one(o, &what, names[i]);
        }
        submission_deinit(&what);
        if (!going && i + 1 < n) {
            message_fail(NULL, "%zu more files were not submitted", n - i - 1);
        }
    }
}

static void ended(void *context, const sheard_msg_job *job) {
    job_results_add(context, job);
    job_complain(job);
}

/* With --json: each job as `shearctl show` gives it. */
static int print_jobs(submit_state *o) {
    int code = EXIT_CODE_DONE;
    for (size_t i = 0; code == SHEAR_OK && i < o->n_ids; i++) {
        sheard_params p = {.id = {.id = o->ids[i]}};
        code = service_answer(&o->service, SHEARD_METHOD_JOB, &p, NULL);
    }
    return code;
}

static int wait_for_all(submit_state *o) {
    text_table *table = job_results_new();
    follow_options how = {.timeout_s = o->timeout_s, .quiet = o->quiet, .context = table};
    how.ended = o->service.json ? NULL : ended;
    int code = follow_jobs(&o->service, o->ids, o->n_ids, &how);
    if (o->service.json && code != EXIT_CODE_OTHER && code != EXIT_CODE_UNREACHABLE) {
        const int printed = print_jobs(o);
        code = printed != 0 ? printed : code;
    } else if (text_table_rows(table) > 0 && text_table_print(table, stdout) != 0) {
        code = EXIT_CODE_OTHER;
    }
    text_table_free(table);
    return code;
}

static int submit(submit_state *o, char **names, size_t n) {
    int code = service_open(&o->service);
    if (code != SHEAR_OK) {
        return code;
    }
    send_all(o, names, n);
    if (o->wait && o->n_ids > 0) {
        code = wait_for_all(o);
    }
    if (o->refused == 0) {
        return code;
    }
    return o->n_ids == 0 ? o->first_code : code == EXIT_CODE_DONE ? EXIT_CODE_PARTLY : code;
}

static int run(int argc, char **argv) {
    static char *no_name[] = {NULL};
    struct option options[N_OWN + SETTINGS_OPTIONS_MAX + 1];
    submit_state o = {.timeout_s = NAN};
    for (size_t i = 0; i < N_OWN; i++) {
        options[i] = own_options[i];
    }
    settings_options_fill(options + N_OWN, SETTINGS_OPTIONS_MAX + 1);
    shear_settings_init(&o.what.settings);
    int code = service_parse(&cmd_submit, argc, argv, options, handle, &o, &o.service);
    code = code != SHEAR_OK ? code : check(&o, argv + optind, argc - optind);
    if (code != SHEAR_OK) {
        return code;
    }
    const bool by_parts = part_options_any(&o.what.parts);
    const size_t n = by_parts ? 1 : (size_t)(argc - optind);
    o.ids = calloc(n, sizeof *o.ids);
    if (o.ids == NULL) {
        message_fail(NULL, "out of memory");
        return EXIT_CODE_OTHER;
    }
    code = submit(&o, by_parts ? no_name : argv + optind, n);
    service_close(&o.service);
    free(o.ids);
    return code;
}

const command cmd_submit = {
    .name = "submit",
    .summary = "hand files to the service, as jobs",
    .usage =
        "usage: shearctl submit [OPTION...] FILE|JOB.json|-...\n"
        "       shearctl submit [OPTION...] FILE --catalog-in FILE[:HDU]\n"
        "       shearctl submit [OPTION...] --galaxy FILE[:HDU] --noise FILE[:HDU] --psf "
        "FILE[:HDU]\n"
        "\n"
        "Have the service measure field files, or what job files say (JSON, the parameters of "
        "submit in\n"
        "docs/protocol.md; - is one on standard input). A job that was accepted is on disk: it "
        "will be done,\n"
        "whatever is killed when. Options beat what a job file says.\n"
        "\n"
        "  --field NAME            count to this field, whatever the file calls it\n"
        "  --priority N            from -100 to 100; larger is sooner (default 0)\n"
        "  --key TEXT              idempotency key: submitting again with it gives the same job\n"
        "  --force                 count even what the field already has\n" PART_OPTIONS_HELP
        "  --wait                  wait until the jobs are finished, and print their results\n"
        "  --timeout TIME          with --wait: no longer than this (as 90, 500ms, 5min, 2h)\n"
        "  --quiet                 no progress bar\n" SERVICE_OPTIONS_HELP "\n"
        "settings, where they differ from the service's own:\n" COMMAND_SETTINGS_MARK "\n"
        "\n"
        "exit status: 0 accepted (with --wait: done), 2 usage, 3 bad input, 4 some failed, 7 the "
        "service\n"
        "cannot be reached, 1 anything else; with --wait also 5 failed, 6 timed out, 8 "
        "cancelled.\n",
    .run = run,
};
