/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shearctl wait: until jobs are finished. */
#include "remote/follow.h"
#include "remote/job_text.h"
#include "terminal/human.h"
#include "terminal/message.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>

enum { OPT_TIMEOUT = 256, OPT_QUIET };

static const struct option options[] = {
    {"timeout", required_argument, NULL, OPT_TIMEOUT},
    {"quiet", no_argument, NULL, OPT_QUIET},
    SERVICE_OPTIONS,
    {NULL, 0, NULL, 0},
};

static int handle(int value, void *context) {
    follow_options *o = context;
    if (value == OPT_QUIET) {
        o->quiet = true;
    } else if (!human_parse_duration(optarg, &o->timeout_s)) {
        message_fail(NULL, "--timeout %s: expected a time, as 90, 500ms, 5min, 2h", optarg);
        return EXIT_CODE_USAGE;
    }
    return EXIT_CODE_DONE;
}

/* A row on standard output, and what went wrong on standard error. */
static void ended(void *context, const sheard_msg_job *job) {
    job_results_add(context, job);
    job_complain(job);
}

static int wait_for(service *s, const int64_t *ids, size_t n, follow_options *o) {
    text_table *table = job_results_new();
    o->print = true;
    o->context = table;
    o->ended = s->json ? NULL : ended;
    int code = service_open(s);
    if (code == SHEAR_OK) {
        code = follow_jobs(s, ids, n, o);
    }
    if (text_table_rows(table) > 0 && text_table_print(table, stdout) != 0) {
        code = EXIT_CODE_OTHER;
    }
    text_table_free(table);
    service_close(s);
    return code;
}

static int run(int argc, char **argv) {
    service s;
    follow_options o = {.timeout_s = NAN};
    int code =
        service_parse_operands(&cmd_wait, argc, argv, options, handle, &o, &s, "jobs", 1, INT_MAX);
    if (code != SHEAR_OK) {
        return code;
    }
    const size_t n = (size_t)(argc - optind);
    int64_t *ids = calloc(n, sizeof *ids);
    if (ids == NULL) {
        message_fail(NULL, "out of memory");
        return EXIT_CODE_OTHER;
    }
    for (size_t i = 0; code == SHEAR_OK && i < n; i++) {
        code = service_job_id(argv[optind + (int)i], &ids[i]);
    }
    if (code == SHEAR_OK) {
        code = wait_for(&s, ids, n, &o);
    }
    free(ids);
    return code;
}

const command cmd_wait = {
    .name = "wait",
    .summary = "wait until jobs are finished",
    .usage = "usage: shearctl wait [OPTION...] ID...\n"
             "\n"
             "Wait until the jobs are finished, and print how they ended. On a terminal a bar "
             "shows what is done,\n"
             "the rate and the time left. An interrupt ends the waiting, not the jobs.\n"
             "\n"
             "  --timeout TIME          wait no longer than this (as 90, 500ms, 5min, 2h)\n"
             "  --quiet                 no progress bar\n" SERVICE_OPTIONS_HELP "\n"
             "exit status: 0 all done, 4 some done, 5 failed, 6 timed out, 8 cancelled, 2 usage, "
             "3 no such\n"
             "job, 7 the service cannot be reached, 1 anything else.\n",
    .run = run,
};
