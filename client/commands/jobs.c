/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shearctl jobs: list jobs, newest first. */
#include "base/cleanup.h"
#include "base/clock.h"
#include "commands/commands.h"
#include "remote/job_text.h"
#include "remote/page_list.h"
#include "terminal/message.h"

#include <inttypes.h>
#include <pwd.h>
#include <string.h>
#include <unistd.h>

enum { DEFAULT_LIMIT = 50 };

/* Parse states: "failed,cancelled". */
static enum exit_code set_states(const option_entry *e, const char *value) {
    unsigned *states = e->context;
    for (const char *at = value; *at != '\0'; at += *at == ',') {
        const size_t n = strcspn(at, ",");
        int state = 0;
        while (state < SHEARD_N_JOB_STATES &&
               !(strlen(sheard_job_state_name(state)) == n &&
                 strncmp(at, sheard_job_state_name(state), n) == 0)) {
            state++;
        }
        if (state == SHEARD_N_JOB_STATES) {
            return message_fail(EXIT_CODE_USAGE,
                                "queued, running, waiting, done, failed, cancelled, retracted",
                                "--state %s: \"%.*s\" is not a state of a job", value, (int)n, at);
        }
        *states |= 1U << state;
        at += n;
    }
    return EXIT_CODE_DONE;
}

/* Parse a user's name or number, or "me". */
static enum exit_code set_owner(const option_entry *e, const char *value) {
    int64_t *owner = e->context;
    const bool me = strcmp(value, "me") == 0;
    const struct passwd *user = me ? NULL : getpwnam(value);
    if (me || user != NULL) {
        *owner = me ? getuid() : user->pw_uid;
        return EXIT_CODE_DONE;
    }
    if (*value < '0' || *value > '9') {
        return message_fail(EXIT_CODE_USAGE, "give a name, a number, or \"me\"",
                            "--user %s: there is no such user", value);
    }
    return options_integer(e->name, value, 0, UINT32_MAX, owner);
}

static size_t show(const page_list *l, const sheard_reply *reply, const char **next) {
    const sheard_msg_job_page *page = &reply->jobs;
    const int64_t now = clock_ms(CLOCK_REALTIME);
    for (size_t i = 0; i < page->n_jobs && !l->service.json; i++) {
        if (l->brief) {
            printf("%" PRId64 "\n", page->jobs[i].id);
        } else {
            job_table_add(l->table, &page->jobs[i], now);
        }
    }
    *next = page->cursor;
    return page->n_jobs;
}

static enum exit_code run(const command *self, int argc, char **argv) {
    CLEANUP(page_list_deinit)
    page_list l = {.what = "jobs",
                   .hint = ", --limit lists more",
                   .method = SHEARD_METHOD_JOBS,
                   .page_max = SHEARD_MSG_JOBS_PAGE,
                   .limit = DEFAULT_LIMIT,
                   .show = show};
    sheard_msg_jobs *p = &l.params.jobs;
    sheard_params_init(&l.params, l.method);
    l.page_limit = &p->limit;
    l.cursor = &p->cursor;
    const option_entry options[] = {
        {.name = "state", .set = set_states, .context = &p->states},
        {.name = "field", .text = &p->field},
        {.name = "user", .set = set_owner, .context = &p->owner},
        {.name = "limit", .integer = &l.limit, .min = 1, .max = INT64_MAX},
        {.name = "cursor", .text = &p->cursor},
        {.name = "brief", .flag = &l.brief},
        SERVICE_OPTIONS(&l.service),
        {0}};
    TRY(service_start(self, argc, argv, options, &l.service, "", 0, 0));
    l.table = job_table_new();
    return page_list_print(&l);
}

COMMAND(jobs, "list the service's jobs", run, NULL);
