/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shearctl status: the state of the service. */
#include "remote/service.h"
#include "remote/status_text.h"
#include "terminal/style.h"

static const struct option options[] = {SERVICE_OPTIONS, {NULL, 0, NULL, 0}};

static int run(int argc, char **argv) {
    service s;
    sheard_reply reply = {0};
    int code = service_parse_operands(&cmd_status, argc, argv, options, NULL, NULL, &s, "", 0, 0);
    code = code != SHEAR_OK ? code : service_open(&s);
    if (code != SHEAR_OK) {
        return code;
    }
    code = service_answer(&s, SHEARD_METHOD_STATUS, NULL, &reply);
    if (code == SHEAR_OK && !s.json) {
        status_text_brief(&reply.status, style_on(stdout), stdout);
        status_text_rest(&reply.status, s.utc, stdout);
    }
    sheard_reply_deinit(&reply, SHEARD_METHOD_STATUS);
    service_close(&s);
    return code;
}

const command cmd_status = {
    .name = "status",
    .summary = "the state of the service",
    .usage = "usage: shearctl status [OPTION...]\n"
             "\n"
             "Print the state of the service: queue, workers, rates, disks, totals, and what an "
             "operator should\n"
             "look at.\n"
             "\n" SERVICE_OPTIONS_HELP "\n" EXIT_CODES_SERVICE ".\n",
    .run = run,
};
