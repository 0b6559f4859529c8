/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shearctl metrics: print the service's metrics in Prometheus' format. */
#include "remote/service_query.h"

static void print(const sheard_reply *reply, const service *s) {
    (void)s;
    fputs(reply->metrics.text, stdout);
}

static enum exit_code run(const command *self, int argc, char **argv) {
    return service_query(self, argc, argv, SHEARD_METHOD_METRICS, print);
}

const command cmd_metrics = {
    .name = "metrics",
    .summary = "print the service's metrics (Prometheus text)",
    .run = run,
    /* clang-format off */
    .usage =
    "usage: shearctl metrics [OPTION...]\n"
    "\n"
    "Print the metrics of the service in the text format of Prometheus.\n"
    "\n"
    SERVICE_OPTIONS_HELP "\n"
    SERVICE_EXIT_CODES_HELP ".\n",
    /* clang-format on */
};
