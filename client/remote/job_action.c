/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "remote/job_action.h"

#include <inttypes.h>
#include <limits.h>

static const struct option options[] = {SERVICE_OPTIONS, {NULL, 0, NULL, 0}};

static int act(service *s, int method, const char *name) {
    sheard_params p;
    sheard_reply reply = {0};
    sheard_params_init(&p, method);
    int code = service_job_id(name, &p.id.id);
    if (code != SHEAR_OK) {
        return code;
    }
    code = service_answer(s, method, &p, &reply);
    if (code == SHEAR_OK && !s->json) {
        const sheard_msg_job *job = method == SHEARD_METHOD_CANCEL  ? &reply.cancel
                                    : method == SHEARD_METHOD_RETRY ? &reply.retry
                                                                    : &reply.retract;
        printf("job %" PRId64 " %s%s\n", job->id, sheard_job_state_name(job->state),
               job->cancel_asked && !sheard_job_state_is_final(job->state) ? ", being cancelled"
                                                                           : "");
    }
    sheard_reply_deinit(&reply, method);
    return code;
}

int job_action_run(const command *self, int method, int argc, char **argv) {
    service s;
    int code =
        service_parse_operands(self, argc, argv, options, NULL, NULL, &s, "jobs", 1, INT_MAX);
    code = code != SHEAR_OK ? code : service_open(&s);
    if (code != SHEAR_OK) {
        return code;
    }
    service_tally tally = {0};
    for (int i = optind; i < argc && service_goes_on(&tally); i++) {
        service_count(&tally, act(&s, method, argv[i]));
    }
    service_close(&s);
    return service_tally_code(&tally);
}
