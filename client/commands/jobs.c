/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shearctl jobs: a list of jobs, the newest first. */
#include "cmdline/options.h"
#include "remote/job_text.h"
#include "remote/service.h"
#include "terminal/human.h"
#include "terminal/message.h"

#include <inttypes.h>
#include <pwd.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { OPT_STATE = 256, OPT_FIELD, OPT_USER, OPT_LIMIT, OPT_CURSOR, OPT_BRIEF };
enum { DEFAULT_LIMIT = 50 };

static const struct option options[] = {
    {"state", required_argument, NULL, OPT_STATE},
    {"field", required_argument, NULL, OPT_FIELD},
    {"user", required_argument, NULL, OPT_USER},
    {"limit", required_argument, NULL, OPT_LIMIT},
    {"cursor", required_argument, NULL, OPT_CURSOR},
    {"brief", no_argument, NULL, OPT_BRIEF},
    SERVICE_OPTIONS,
    {NULL, 0, NULL, 0},
};

typedef struct jobs_options {
    service service;
    sheard_params params;
    int64_t limit; /* jobs that are still to be listed */
    bool brief;
} jobs_options;

/* "failed,cancelled" */
static int set_states(const char *text, unsigned *states) {
    for (const char *at = text; *at; at += *at == ',') {
        const size_t n = strcspn(at, ",");
        int state = 0;
        while (state < SHEARD_N_JOB_STATES &&
               !(strlen(sheard_job_state_name(state)) == n &&
                 strncmp(at, sheard_job_state_name(state), n) == 0)) {
            state++;
        }
        if (state == SHEARD_N_JOB_STATES) {
            message_fail("queued, running, waiting, done, failed, cancelled, retracted",
                         "--state %s: \"%.*s\" is no state of a job", text, (int)n, at);
            return EXIT_CODE_USAGE;
        }
        *states |= 1U << state;
        at += n;
    }
    return EXIT_CODE_DONE;
}

/* A user's name or number, or "me". */
static int set_owner(const char *text, int64_t *owner) {
    if (strcmp(text, "me") == 0) {
        *owner = getuid();
        return EXIT_CODE_DONE;
    }
    const struct passwd *user = getpwnam(text);
    if (user != NULL) {
        *owner = user->pw_uid;
        return EXIT_CODE_DONE;
    }
    if (*text < '0' || *text > '9') {
        message_fail("give a name, a number, or \"me\"", "--user %s: there is no such user", text);
        return EXIT_CODE_USAGE;
    }
    return options_int("user", text, 0, UINT32_MAX, owner);
}

static int handle(int value, void *context) {
    jobs_options *j = context;
    switch (value) {
    case OPT_STATE:
        return set_states(optarg, &j->params.jobs.states);
    case OPT_USER:
        return set_owner(optarg, &j->params.jobs.owner);
    case OPT_LIMIT:
        return options_int("limit", optarg, 1, INT64_MAX, &j->limit);
    case OPT_FIELD:
        j->params.jobs.field = optarg;
        return EXIT_CODE_DONE;
    case OPT_CURSOR:
        j->params.jobs.cursor = optarg;
        return EXIT_CODE_DONE;
    default:
        j->brief = true;
        return EXIT_CODE_DONE;
    }
}

static void show_page(const jobs_options *j, const sheard_msg_job_page *page, text_table *table) {
    const int64_t now = human_now_ms();
    for (size_t i = 0; i < page->n_jobs && !j->service.json; i++) {
        if (j->brief) {
            printf("%" PRId64 "\n", page->jobs[i].id);
        } else {
            job_table_add(table, &page->jobs[i], now);
        }
    }
}

/* All pages, up to the limit. *cursor becomes the one of the next page, or NULL: the caller's. */
static int list(jobs_options *j, text_table *table, char **cursor) {
    int code = EXIT_CODE_DONE;
    bool empty = false; /* a page: no progress would be made */
    do {
        sheard_reply reply = {0};
        j->params.jobs.limit = j->limit < SHEARD_MSG_JOBS_PAGE ? j->limit : SHEARD_MSG_JOBS_PAGE;
        code = service_answer(&j->service, SHEARD_METHOD_JOBS, &j->params, &reply);
        free(*cursor);
        *cursor = NULL;
        if (code == SHEAR_OK) {
            show_page(j, &reply.jobs, table);
            j->limit -= (int64_t)reply.jobs.n_jobs;
            empty = reply.jobs.n_jobs == 0;
            *cursor = reply.jobs.cursor != NULL ? strdup(reply.jobs.cursor) : NULL;
            j->params.jobs.cursor = *cursor;
            sheard_reply_deinit(&reply, SHEARD_METHOD_JOBS);
        }
    } while (code == SHEAR_OK && *cursor != NULL && !empty && j->limit > 0);
    return code;
}

static int run(int argc, char **argv) {
    jobs_options j = {.limit = DEFAULT_LIMIT};
    sheard_params_init(&j.params, SHEARD_METHOD_JOBS);
    int code =
        service_parse_operands(&cmd_jobs, argc, argv, options, handle, &j, &j.service, "", 0, 0);
    code = code != SHEAR_OK ? code : service_open(&j.service);
    if (code != SHEAR_OK) {
        return code;
    }
    char *cursor = NULL;
    text_table *table = job_table_new();
    code = list(&j, table, &cursor);
    if (code == SHEAR_OK && !j.service.json && !j.brief) {
        code = text_table_print(table, stdout);
    }
    fflush(stdout);
    if (code == SHEAR_OK && cursor != NULL && !j.service.json) {
        message_note("there are more jobs: --cursor %s goes on with them, --limit lists more",
                     cursor);
    }
    text_table_free(table);
    free(cursor);
    service_close(&j.service);
    return code;
}

const command cmd_jobs = {
    .name = "jobs",
    .summary = "list the service's jobs",
    .usage = "usage: shearctl jobs [OPTION...]\n"
             "\n"
             "List jobs, the newest first.\n"
             "\n"
             "  --state STATES          only these, with commas between them: queued, running, "
             "waiting,\n"
             "                          done, failed, cancelled, retracted\n"
             "  --field NAME            only jobs of this field\n"
             "  --user USER             only jobs of this user (a name, a number, or me)\n"
             "  --limit N               at most so many (default 50)\n"
             "  --cursor TEXT           go on where an earlier list ended\n"
             "  --brief                 only the numbers of the jobs\n" SERVICE_OPTIONS_HELP
             "\n" EXIT_CODES_SERVICE ".\n",
    .run = run,
};
