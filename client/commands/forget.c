/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shearctl forget: remove all contributions to a field. */
#include "base/cleanup.h"
#include "remote/service.h"
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
    TRY(service_call(s, SHEARD_METHOD_FIELD, &p, &reply));
    for (size_t i = 0; i < reply.field.n_rows; i++)
        jobs += reply.field.rows[i].jobs;
    message_fail(EXIT_CODE_USAGE, "--yes does it",
                 "this would take back %" PRId64 " contributions to field %s, in %zu results", jobs,
                 message_clean(reply.field.field, name, sizeof name), reply.field.n_rows);
    sheard_reply_deinit(&reply, SHEARD_METHOD_FIELD);
    return EXIT_CODE_USAGE;
}

static enum exit_code forget(service *s, const sheard_params *p) {
    sheard_reply reply = {0};
    char name[256];
    const enum exit_code code = service_answer(s, SHEARD_METHOD_FORGET, p, &reply);
    if (code == EXIT_CODE_DONE && !s->json) {
        const sheard_msg_forgotten *r = &reply.forget;
        printf("field %s forgotten: %" PRId64 " results of %" PRId64 " contributions, %" PRId64
               " jobs retracted\n",
               message_clean(r->field, name, sizeof name), r->rows, r->contributions, r->jobs);
    }
    sheard_reply_deinit(&reply, SHEARD_METHOD_FORGET);
    return code;
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
    return yes ? forget(&s, &p) : explain(&s, &p.forget);
}

const command cmd_forget = {
    .name = "forget",
    .summary = "take back all that was counted in a field",
    .run = run,
    /* clang-format off */
    .usage =
    "usage: shearctl forget [OPTION...] NAME\n"
    "\n"
    "Take back everything that was counted in a field, as retract does for each of its jobs, including\n"
    "those that the service no longer lists. Refused while jobs of the field are unfinished.\n"
    "Administrators only. The field is gone at once; with very many jobs the removal takes a while, and\n"
    "continues if shearctl ends.\n"
    "\n"
    "  --digest TEXT           only the result of these settings\n"
    "  --yes                   do it; otherwise only report what would be taken back\n"
    SERVICE_OPTIONS_HELP "\n"
    SERVICE_EXIT_CODES_HELP ".\n",
    /* clang-format on */
};
