/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/rpc/probe.h"

#include "base/clock.h"
#include "log/log.h"
#include "reader/sandbox.h"
#include "service/core/parts.h"
#include "service/jobs/job_outcome.h"
#include "service/rpc/methods.h"
#include "service/rpc/probe_field.h"

#include <math.h>
#include <stdio.h>
#include <unistd.h>

/* The probe's number in the engine, which no job of the store has. */
enum { PROBE_JOB = -1 };
static void answer(service *s, sheard_msg_probed what) {
    probe *p = s->probe;
    const size_t n = p->n_asking;
    what.true_g1 = PROBE_G1;
    what.true_g2 = PROBE_G2;
    what.seconds = clock_s(CLOCK_MONOTONIC) - p->begun_s;
    p->n_asking = 0;
    for (size_t i = 0; i < n; i++) {
        const sheard_reply reply = {.probe = what};
        server_reply(s->server, p->asking[i], &reply);
    }
}

static void answer_failed(service *s, const char *code, const shear_error *err) {
    log_warning("probe: %s", err->message);
    answer(s, (sheard_msg_probed){.code = code,
                                  .message = err->message,
                                  .advice = err->advice[0] != '\0' ? err->advice : NULL,
                                  .g1 = NAN,
                                  .g1_err = NAN,
                                  .g2 = NAN,
                                  .g2_err = NAN});
}

static void answer_measured(service *s, const shear_result *r) {
    char text[200];
    sheard_msg_probed what = {.ok = fabs(r->g1 - PROBE_G1) < PROBE_TOLERANCE &&
                                    fabs(r->g2 - PROBE_G2) < PROBE_TOLERANCE,
                              .g1 = r->g1,
                              .g1_err = r->g1_err,
                              .g2 = r->g2,
                              .g2_err = r->g2_err,
                              .stamps = r->n_used,
                              .landlock = (s->probe->guards & SANDBOX_LANDLOCK) != 0,
                              .namespaces = (s->probe->guards & SANDBOX_NAMESPACES) != 0};
    if (!what.ok) {
        snprintf(text, sizeof text, "the probe's shear is measured as %.6f, %.6f; it is %.6f, %.6f",
                 r->g1, r->g2, PROBE_G1, PROBE_G2);
        what.code = sheard_rpc_code_get(SHEARD_RPC_INTERNAL)->name;
        what.message = text;
        log_error("%s", text);
    }
    answer(s, what);
}

static void make_field(uv_work_t *work) {
    const service *s = work->data;
    probe *p = s->probe;
    p->err = (shear_error){0};
    p->code = probe_field_make(engine_get_scratch(s->engine), &p->fd, &p->err);
}

/* The field's file is ready: add it to the engine as a job. */
static void made(uv_work_t *work, int status) {
    service *s = work->data;
    probe *p = s->probe;
    shear_settings settings;
    (void)status; /* never cancelled */
    if (s->server == NULL || s->life.closing) {
        if (p->fd >= 0)
            close(p->fd);
        return;
    }
    if (p->code == SHEAR_OK) {
        const shear_input input = shear_input_of_file("probe.fits");
        int fds[SHEAR_N_PARTS] = {p->fd, -1, -1, -1};
        shear_settings_init(&settings);
        const engine_job job = {.id = PROBE_JOB,
                                .priority = SHEARD_MSG_PRIORITY_MAX + 1,
                                .input = &input,
                                .fds = fds,
                                .settings = settings};
        p->code = engine_add(s->engine, &job, &p->err);
    }
    if (p->code != SHEAR_OK)
        answer_failed(s, job_outcome_reason(&p->err).name, &p->err);
}

void probe_event(service *s, const engine_event *e) {
    if (e->job != PROBE_JOB) {
        return; /* a job that this process has finished with */
    }
    switch (e->kind) {
    case ENGINE_OPENED:
        s->probe->guards = e->guards;
        engine_go(s->engine, PROBE_JOB, NULL);
        break;
    case ENGINE_DONE:
        answer_measured(s, &e->result);
        break;
    case ENGINE_FAILED:
        answer_failed(s, job_outcome_reason(&e->error).name, &e->error);
        break;
    case ENGINE_STOPPED:
        answer_failed(s, sheard_rpc_code_get(SHEARD_RPC_STOPPING)->name,
                      &(shear_error){.message = "the service stops"});
        break;
    default:
        break;
    }
}

int method_probe(service *s, const server_request *r, sheard_rpc_error *error) {
    probe *p = s->probe;
    if (s->life.state == SHEARD_SERVER_STOPPING)
        return sheard_rpc_fail(error, SHEARD_RPC_STOPPING, NULL, "the service is about to exit");
    if (p->n_asking == PROBE_ASKING) {
        return sheard_rpc_fail(error, SHEARD_RPC_TOO_MANY_REQUESTS, NULL,
                               "too many requests wait for the running probe");
    }
    p->asking[p->n_asking++] = r->handle;
    if (p->n_asking > 1)
        return SHEARD_RPC_OK;
    p->begun_s = clock_s(CLOCK_MONOTONIC);
    p->work.data = s;
    p->fd = -1;
    if (uv_queue_work(&s->loop, &p->work, make_field, made) != 0) {
        answer_failed(s, sheard_rpc_code_get(SHEARD_RPC_INTERNAL)->name,
                      &(shear_error){.message = "the probe's field cannot be made now"});
    }
    return SHEARD_RPC_OK;
}
