/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/rpc/probe.h"

#include "base/cleanup.h"
#include "base/clock.h"
#include "log/log.h"
#include "reader/sandbox.h"
#include "service/core/parts.h"
#include "service/jobs/job_outcome.h"
#include "service/rpc/methods.h"
#include "shear/field.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* ---- a tiny field of known shear, drawn by formula ---- */

#define PROBE_G1 0.02
#define PROBE_G2 (-0.01)
enum { SIDE = 32, PROBE_STAMPS = 16 };
/* noise: relative to the galaxy's peak */
static const double galaxy_sigma_px = 2.5, psf_sigma_px = 1.5, noise = 1e-3;

/* Return a number in [-1, 1), from the same sequence in every process. */
static double draw(uint64_t *seed) {
    *seed = *seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (double)(*seed >> 11) * 0x1p-52 - 1.0;
}

/* Draw a round Gaussian under the shear, convolved with the PSF, which gives a Gaussian again. Its
 * centre is off the stamp's by a fraction of a pixel. */
static void draw_galaxy(uint64_t *seed, double out[SIDE * SIDE]) {
    const double s2 = galaxy_sigma_px * galaxy_sigma_px;
    const double p2 = psf_sigma_px * psf_sigma_px;
    const double norm = 1.0 - PROBE_G1 * PROBE_G1 - PROBE_G2 * PROBE_G2;
    const double a = (1.0 + PROBE_G1) / norm;
    const double b = PROBE_G2 / norm;
    const double d = (1.0 - PROBE_G1) / norm;
    const double xx = s2 * (a * a + b * b) + p2;
    const double yy = s2 * (b * b + d * d) + p2;
    const double xy = s2 * b * (a + d);
    const double det = xx * yy - xy * xy;
    const double x0 = 0.5 * (SIDE + draw(seed));
    const double y0 = 0.5 * (SIDE + draw(seed));
    for (int j = 0; j < SIDE; j++) {
        for (int i = 0; i < SIDE; i++) {
            const double x = i - x0;
            const double y = j - y0;
            const double r2 = (yy * x * x - 2.0 * xy * x * y + xx * y * y) / det;
            out[j * SIDE + i] = exp(-0.5 * r2) + noise * draw(seed);
        }
    }
}

static void draw_psf(double out[SIDE * SIDE]) {
    const double p2 = psf_sigma_px * psf_sigma_px;
    for (int j = 0; j < SIDE; j++) {
        for (int i = 0; i < SIDE; i++) {
            const double x = i - 0.5 * SIDE;
            const double y = j - 0.5 * SIDE;
            out[j * SIDE + i] = exp(-0.5 * (x * x + y * y) / p2);
        }
    }
}

static int write_all(shear_field_writer *w, shear_error *err) {
    double galaxy[SIDE * SIDE];
    double blank[SIDE * SIDE];
    uint64_t seed = 1;
    for (int i = 0; i < PROBE_STAMPS; i++) {
        draw_galaxy(&seed, galaxy);
        for (int k = 0; k < SIDE * SIDE; k++)
            blank[k] = noise * draw(&seed);
        TRY(shear_field_write(w, i, 1, galaxy, blank, NULL, err));
    }
    draw_psf(galaxy);
    return shear_field_write_psf(w, 0, galaxy, err);
}

static int open_path(const char *path, int *fd, shear_error *err) {
    *fd = open(path, O_RDONLY | O_CLOEXEC);
    return *fd >= 0 ? SHEAR_OK
                    : shear_fail(err, SHEAR_E_IO, NULL, "%.300s: cannot be opened: %s", path,
                                 strerror(errno));
}

/* Write the field into `directory`, open it for reading, and remove its name. *fd is -1 on error.
 * Waits for the disk. */
static int write_field(const char *directory, int *fd, shear_error *err) {
    char path[4300];
    shear_field_writer *w = NULL;
    const shear_field_spec spec = {.name = "probe",
                                   .pixscale = NAN,
                                   .has_truth = true,
                                   .sim_g1 = PROBE_G1,
                                   .sim_g2 = PROBE_G2,
                                   .geometry = {SIDE, SIDE, SIDE, SIDE, 1},
                                   .n_stamps = PROBE_STAMPS,
                                   .n_psf = 1,
                                   .layout = SHEAR_LAYOUT_CUBE,
                                   .bitpix = -64,
                                   .overwrite = true};
    *fd = -1;
    snprintf(path, sizeof path, "%s/probe.fits", directory);
    int code = shear_field_create(&w, path, &spec, err);
    code = code == SHEAR_OK ? write_all(w, err) : code;
    if (code != SHEAR_OK) {
        shear_field_abort(w);
        return code;
    }
    code = shear_field_finish(w, err);
    code = code == SHEAR_OK ? open_path(path, fd, err) : code;
    unlink(path);
    return code;
}

/* ---- the probe ---- */

/* Bound of |measured - true| per component: terms beyond second order in the shear, pixels and
 * noise contribute less. */
static const double tolerance = 2e-4;

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
    sheard_msg_probed what = {.ok = fabs(r->g1 - PROBE_G1) < tolerance &&
                                    fabs(r->g2 - PROBE_G2) < tolerance,
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
    p->code = write_field(engine_get_scratch(s->engine), &p->fd, &p->err);
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
