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

/* Send a request for each job, until the service is gone. Returns EXIT_CODE_PARTLY if only some
 * succeed, otherwise the code of the first failure. */
static enum exit_code ask_jobs(service *s, char **names, int n, const service_query *q) {
    enum exit_code first = EXIT_CODE_DONE;
    int n_failed = 0;
    for (int i = 0; i < n; i++) {
        const enum exit_code code = ask_job(s, names[i], q);
        if (code == EXIT_CODE_UNREACHABLE)
            return code;
        first = n_failed == 0 ? code : first;
        n_failed += code != EXIT_CODE_DONE;
    }
    return n_failed > 0 && n_failed < n ? EXIT_CODE_PARTLY : first;
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
    return ask_jobs(&s, argv + optind, argc - optind, q);
}
