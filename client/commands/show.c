/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shearctl show: everything about jobs. */
#include "remote/job_text.h"
#include "remote/service.h"

#include <limits.h>

static const struct option options[] = {SERVICE_OPTIONS, {NULL, 0, NULL, 0}};

static int show(service *s, const char *name) {
    sheard_params p;
    sheard_reply reply = {0};
    sheard_params_init(&p, SHEARD_METHOD_JOB);
    int code = service_job_id(name, &p.id.id);
    if (code != SHEAR_OK) {
        return code;
    }
    code = service_answer(s, SHEARD_METHOD_JOB, &p, &reply);
    if (code == SHEAR_OK && !s->json) {
        job_text_print(&reply.job, s->utc, stdout);
    }
    sheard_reply_deinit(&reply, SHEARD_METHOD_JOB);
    return code;
}

static int run(int argc, char **argv) {
    service s;
    int code =
        service_parse_operands(&cmd_show, argc, argv, options, NULL, NULL, &s, "job", 1, INT_MAX);
    code = code != SHEAR_OK ? code : service_open(&s);
    if (code != SHEAR_OK) {
        return code;
    }
    service_tally tally = {0};
    for (int i = optind; i < argc && service_goes_on(&tally); i++) {
        service_count(&tally, show(&s, argv[i]));
    }
    service_close(&s);
    return service_tally_code(&tally);
}

const command cmd_show = {
    .name = "show",
    .summary = "everything about a job",
    .usage = "usage: shearctl show [OPTION...] ID...\n"
             "\n"
             "Show a job: its state, source, result, settings, and what happened to it.\n"
             "\n" SERVICE_OPTIONS_HELP "\n" EXIT_CODES_SERVICE ".\n",
    .run = run,
};
