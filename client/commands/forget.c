/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shearctl forget: remove all contributions to a field. */
#include "base/cleanup.h"
#include "commands/commands.h"
#include "remote/service_query.h"
#include "terminal/message.h"

#include <getopt.h>
#include <inttypes.h>

/* Print what would be removed, without removing it. */
static enum exit_code explain(service *s, const sheard_msg_forget *what) {
    sheard_params p;
    sheard_reply reply = {0};
    char name[256];
    int64_t jobs = 0;
    sheard_params_init(&p, SHEARD_METHOD_FIELD);
    p.field = (sheard_msg_field){.field = what->field, .digest = what->digest};
    TRY(service_call(s, SHEARD_METHOD_FIELD, &p, &reply, NULL));
    for (size_t i = 0; i < reply.field.n_rows; i++)
        jobs += reply.field.rows[i].jobs;
    message_fail(EXIT_CODE_USAGE, "--yes does it",
                 "this would take back %" PRId64 " contributions to field %s, in %zu results", jobs,
                 message_clean(reply.field.field, name, sizeof name), reply.field.n_rows);
    sheard_reply_deinit(&reply, SHEARD_METHOD_FIELD);
    return EXIT_CODE_USAGE;
}

static void print(const sheard_reply *reply, const service *s) {
    const sheard_msg_forgotten *r = &reply->forget;
    char name[256];
    (void)s;
    printf("field %s forgotten: %" PRId64 " results of %" PRId64 " contributions, %" PRId64
           " jobs retracted\n",
           message_clean(r->field, name, sizeof name), r->rows, r->contributions, r->jobs);
}

static enum exit_code run(const command *self, int argc, char **argv) {
    CLEANUP(service_close) service s = {0};
    sheard_params p;
    bool yes = false;
    sheard_params_init(&p, SHEARD_METHOD_FORGET);
    const option_entry options[] = {{.name = "digest", .text = &p.forget.digest},
                                    {.name = "yes", .flag = &yes},
                                    SERVICE_OPTIONS(&s),
                                    {0}};
    TRY(service_start(self, argc, argv, options, &s, "field", 1, 1));
    p.forget.field = argv[optind];
    return yes ? service_ask(&s, SHEARD_METHOD_FORGET, &p, print) : explain(&s, &p.forget);
}

COMMAND(forget, "take back all that was counted in a field", run, NULL);
