/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shearctl forget: everything that was counted in a field is taken back. */
#include "cmdline/options.h"
#include "remote/service.h"
#include "terminal/message.h"

#include <inttypes.h>

enum { OPT_DIGEST = 256, OPT_YES };

static const struct option options[] = {
    {"digest", required_argument, NULL, OPT_DIGEST},
    {"yes", no_argument, NULL, OPT_YES},
    SERVICE_OPTIONS,
    {NULL, 0, NULL, 0},
};

typedef struct forget_options {
    service service;
    sheard_params params;
    bool yes;
} forget_options;

static int handle(int value, void *context) {
    forget_options *f = context;
    if (value == OPT_DIGEST) {
        f->params.forget.digest = optarg;
    } else {
        f->yes = true;
    }
    return EXIT_CODE_DONE;
}

/* Not yet: what would be gone. */
static int tell(forget_options *f) {
    sheard_params p;
    sheard_reply reply = {0};
    char name[256];
    int64_t jobs = 0;
    sheard_params_init(&p, SHEARD_METHOD_FIELD);
    p.field =
        (sheard_msg_field){.field = f->params.forget.field, .digest = f->params.forget.digest};
    const bool json = f->service.json;
    f->service.json = false;
    const int code = service_answer(&f->service, SHEARD_METHOD_FIELD, &p, &reply);
    f->service.json = json;
    if (code != SHEAR_OK) {
        return code;
    }
    for (size_t i = 0; i < reply.field.n_rows; i++) {
        jobs += reply.field.rows[i].jobs;
    }
    message_fail("--yes does it",
                 "this would take back %" PRId64 " contributions to field %s, in %zu results", jobs,
                 message_clean(reply.field.field, name, sizeof name), reply.field.n_rows);
    sheard_reply_deinit(&reply, SHEARD_METHOD_FIELD);
    return EXIT_CODE_USAGE;
}

static int forget(forget_options *f) {
    sheard_reply reply = {0};
    char name[256];
    const int code = service_answer(&f->service, SHEARD_METHOD_FORGET, &f->params, &reply);
    if (code == SHEAR_OK && !f->service.json) {
        const sheard_msg_forgotten *r = &reply.forget;
        printf("field %s forgotten: %" PRId64 " results of %" PRId64 " contributions, %" PRId64
               " jobs retracted\n",
               message_clean(r->field, name, sizeof name), r->rows, r->contributions, r->jobs);
    }
    sheard_reply_deinit(&reply, SHEARD_METHOD_FORGET);
    return code;
}

static int run(int argc, char **argv) {
    forget_options f = {.yes = false};
    sheard_params_init(&f.params, SHEARD_METHOD_FORGET);
    int code = service_parse_operands(&cmd_forget, argc, argv, options, handle, &f, &f.service,
                                      "field", 1, 1);
    code = code != SHEAR_OK ? code : service_open(&f.service);
    if (code != SHEAR_OK) {
        return code;
    }
    f.params.forget.field = argv[optind];
    code = f.yes ? forget(&f) : tell(&f);
    service_close(&f.service);
    return code;
}

const command cmd_forget = {
    .name = "forget",
    .summary = "take back all that was counted in a field",
    .usage = "usage: shearctl forget [OPTION...] NAME\n"
             "\n"
             "Take everything that was counted in a field back, as retract does for each of its "
             "jobs, also those\n"
             "that the service no longer lists. Not while jobs of the field are unfinished. "
             "Administrators.\n"
             "The field is gone at once; very many jobs take a while, and go on without shearctl, "
             "too.\n"
             "\n"
             "  --digest TEXT           only the result of these settings\n"
             "  --yes                   do it; without, only say what it would take "
             "back\n" SERVICE_OPTIONS_HELP "\n" EXIT_CODES_SERVICE ".\n",
    .run = run,
};
