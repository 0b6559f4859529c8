/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "remote/service_query.h"

#include "base/cleanup.h"

#include <getopt.h>
#include <inttypes.h>
#include <limits.h>

static enum exit_code ask(service *s, int method, const sheard_params *params,
                          service_printer *print) {
    sheard_reply reply = {0};
    const enum exit_code code = service_answer(s, method, params, &reply);
    if (code == EXIT_CODE_DONE && !s->json)
        print(&reply, s);
    sheard_reply_deinit(&reply, method);
    return code;
}

static enum exit_code ask_job(service *s, const char *name, int method, service_printer *print) {
    sheard_params p;
    sheard_params_init(&p, method);
    TRY(service_job_id(name, &p.id.id));
    return ask(s, method, &p, print);
}

enum exit_code service_query(const command *self, int argc, char **argv, int method,
                             service_printer *print) {
    CLEANUP(service_close) service s = {0};
    const option_entry options[] = {SERVICE_OPTIONS(&s), {0}};
    TRY(service_start(self, argc, argv, options, &s, "", 0, 0));
    return ask(&s, method, NULL, print);
}

enum exit_code service_query_jobs(const command *self, int argc, char **argv, const char *what,
                                  int method, service_printer *print) {
    CLEANUP(service_close) service s = {0};
    const option_entry options[] = {SERVICE_OPTIONS(&s), {0}};
    TRY(service_start(self, argc, argv, options, &s, what, 1, INT_MAX));
    service_outcomes outcomes = {0};
    for (int i = optind; i < argc && service_outcomes_go_on(&outcomes); i++)
        service_outcomes_add(&outcomes, ask_job(&s, argv[i], method, print));
    return service_outcomes_code(&outcomes);
}

void service_query_print_job(const sheard_msg_job *job) {
    printf("job %" PRId64 " %s%s\n", job->id, sheard_job_state_name(job->state),
           job->cancel_asked && !sheard_job_state_is_final(job->state) ? ", being cancelled" : "");
}
