/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shearctl metrics. */
#include "remote/service_query.h"

static void print(const sheard_reply *reply) {
    fputs(reply->metrics.text, stdout);
}

static int run(int argc, char **argv) {
    return service_query(&cmd_metrics, SHEARD_METHOD_METRICS, print, argc, argv);
}

const command cmd_metrics = {
    .name = "metrics",
    .summary = "print the service's metrics (Prometheus text)",
    .usage = "usage: shearctl metrics [OPTION...]\n"
             "\n"
             "Print the metrics of the service in the text format of Prometheus.\n"
             "\n" SERVICE_OPTIONS_HELP "\n" EXIT_CODES_SERVICE ".\n",
    .run = run,
};
