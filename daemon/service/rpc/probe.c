/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/rpc/probe.h"

#include "base/clock.h"
#include "log/log.h"
#include "reader/sandbox.h"
#include "service/core/parts.h"
#include "service/jobs/job_outcome.h"
#include "service/rpc/methods.h"
#include "service/rpc/probe_field.h"
#include "service/rpc/refuse.h"

#include <math.h>
#include <stdlib.h>
#include <unistd.h>

/* The engine's name for it: no job of the store has it. */
enum { PROBE_JOB = -1 };
enum { ASKING_MAX = 16 };

typedef struct asking {
    server_handle to[ASKING_MAX];
    size_t n; /* > 0: a probe is under way */
} asking;

struct probe {
    asking asking;
    uv_work_t work;
    int fd, code; /* of the field's file */
    shear_error err;
    double begun_s;
    unsigned guards; /* enum sandbox_guard */
};

static void answer(service *s, const sheard_msg_probed *what) {
    probe *p = s->probe;
    const asking all = p->asking;
    p->asking.n = 0;
    for (size_t i = 0; i < all.n; i++) {
        const sheard_reply reply = {.probe = *what};
        server_reply(s->server, all.to[i], &reply);
    }
}

static void answer_failed(service *s, const char *code, const shear_error *err) {
    const sheard_msg_probed what = {.code = code,
                                    .message = err->message,
                                    .advice = err->advice[0] != '\0' ? err->advice : NULL,
                                    .g1 = NAN,
                                    .g1_err = NAN,
                                    .g2 = NAN,
                                    .g2_err = NAN,
                                    .true_g1 = PROBE_G1,
                                    .true_g2 = PROBE_G2,
                                    .seconds = clock_s(CLOCK_MONOTONIC) - s->probe->begun_s};
    log_warning("probe: %s", err->message);
    answer(s, &what);
}

static void answer_measured(service *s, const shear_result *r) {
    char text[200];
    sheard_msg_probed what = {.ok = fabs(r->g1 - PROBE_G1) < PROBE_TOLERANCE &&
                                    fabs(r->g2 - PROBE_G2) < PROBE_TOLERANCE,
                              .g1 = r->g1,
                              .g1_err = r->g1_err,
                              .g2 = r->g2,
                              .g2_err = r->g2_err,
                              .true_g1 = PROBE_G1,
                              .true_g2 = PROBE_G2,
                              .stamps = r->n_used,
                              .seconds = clock_s(CLOCK_MONOTONIC) - s->probe->begun_s,
                              .landlock = (s->probe->guards & SANDBOX_LANDLOCK) != 0,
                              .namespaces = (s->probe->guards & SANDBOX_NAMESPACES) != 0};
    if (!what.ok) {
        snprintf(text, sizeof text, "the probe's shear is measured as %.6f, %.6f; it is %.6f, %.6f",
                 r->g1, r->g2, PROBE_G1, PROBE_G2);
        what.code = sheard_rpc_code_get(SHEARD_RPC_INTERNAL)->name;
        what.message = text;
        log_error("%s", text);
    }
    answer(s, &what);
}

static void make_field(uv_work_t *work) {
    const service *s = work->data;
    probe *p = s->probe;
    p->err = (shear_error){0};
    p->code = probe_field_make(engine_get_scratch(s->engine), &p->fd, &p->err);
}

/* The field is there: a job for the engine, as any, but none of the store's. */
static void made(uv_work_t *work, int status) {
    service *s = work->data;
    probe *p = s->probe;
    shear_settings settings;
    (void)status; /* never cancelled */
    if (s->server == NULL || s->life.closing) {
        if (p->fd >= 0) {
            close(p->fd);
        }
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
    if (p->code != SHEAR_OK) {
        answer_failed(s, job_outcome_reason(&p->err).name, &p->err);
    }
}

void probe_event(service *s, const engine_event *e) {
    if (e->job != PROBE_JOB) {
        return; /* of a job that this process has done with */
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

void method_probe(service *s, const server_request *r) {
    if (s->life.state == SHEARD_SERVER_STOPPING) {
        refuse_with(s, r->handle, SHEARD_RPC_STOPPING, "the service is about to exit");
        return;
    }
    if (s->probe == NULL) {
        s->probe = calloc(1, sizeof *s->probe);
    }
    probe *p = s->probe;
    if (p == NULL) {
        refuse_with(s, r->handle, SHEARD_RPC_OUT_OF_MEMORY, "out of memory for a probe");
        return;
    }
    if (p->asking.n == ASKING_MAX) {
        refuse_with(s, r->handle, SHEARD_RPC_TOO_MANY_REQUESTS,
                    "as many wait for the probe under way as may");
        return;
    }
    p->asking.to[p->asking.n++] = r->handle;
    if (p->asking.n > 1) {
        return;
    }
    p->begun_s = clock_s(CLOCK_MONOTONIC);
    p->work.data = s;
    p->fd = -1;
    if (uv_queue_work(&s->loop, &p->work, make_field, made) != 0) {
        answer_failed(s, sheard_rpc_code_get(SHEARD_RPC_INTERNAL)->name,
                      &(shear_error){.message = "the probe's field cannot be made now"});
    }
}

void probe_free(probe *p) {
    free(p);
}
