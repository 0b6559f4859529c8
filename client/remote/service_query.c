/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "remote/service_query.h"

#include "base/cleanup.h"

#include <getopt.h>
#include <limits.h>

enum exit_code service_ask(service *s, int method, const sheard_params *params,
                           service_printer *print) {
    sheard_reply reply = {0};
    TRY(service_answer(s, method, params, &reply));
    if (!s->json)
        print(&reply, s);
    sheard_reply_deinit(&reply, method);
    return EXIT_CODE_DONE;
}

static enum exit_code ask_job(service *s, const char *name, const service_query *q) {
    sheard_params p;
    sheard_params_init(&p, q->method);
    TRY(service_job_id(name, &p.id.id));
    return service_ask(s, q->method, &p, q->print);
}

enum exit_code service_query_run(const command *self, int argc, char **argv) {
    CLEANUP(service_close) service s = {0};
    const service_query *q = self->data;
    const option_entry options[] = {SERVICE_OPTIONS(&s), {0}};
    if (q->jobs == NULL) {
        TRY(service_start(self, argc, argv, options, &s, "", 0, 0));
        return service_ask(&s, q->method, NULL, q->print);
    }
    TRY(service_start(self, argc, argv, options, &s, q->jobs, 1, INT_MAX));
    service_outcomes outcomes = {0};
    for (int i = optind; i < argc && service_outcomes_go_on(&outcomes); i++)
        service_outcomes_add(&outcomes, ask_job(&s, argv[i], q));
    return service_outcomes_code(&outcomes);
}
