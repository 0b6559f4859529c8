/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Prepare a job: open its files in its reader, hash them, reserve memory, and make the plan. */
#include "base/cleanup.h"
#include "engine/budget.h"
#include "engine/internal.h"

#include <inttypes.h>
#include <string.h>

/* Copies of a stamp's terms in memory when a job ends: the work's, the job's sums, and the bytes
 * for the store. */
enum { TERMS_COPIES = 3 };

/* Read a PSF from the reader, as the read function of shear_psf_source. */
static int read_psf(void *self, int64_t index, double *out, shear_error *err) {
    job *j = self;
    const shear_geometry *g = &reader_get_info(j->reader)->geometry;
    const double *psf = NULL;
    TRY(reader_read_psf(j->reader, index, &psf, err));
    memcpy(out, psf, (size_t)g->psf_nx * (size_t)g->psf_ny * sizeof *out);
    return SHEAR_OK;
}

/* Read the coefficients of a stamp, as the function of shear_psf_source. */
static int read_terms(void *self, int64_t stamp, int *model, double *terms, shear_error *err) {
    job *j = self;
    const shear_block *b = NULL;
    TRY(reader_read_columns(j->reader, stamp, &b, err));
    const bool dropped = b->dropped != NULL && (b->dropped[0] & SHEAR_FLAGS_WITHOUT_PSF) != 0;
    *model = dropped ? -1 : b->psf_index[0];
    memcpy(terms, b->psf_terms, (size_t)reader_get_info(j->reader)->psf_terms * sizeof *terms);
    return SHEAR_OK;
}

/* ---- memory ---- */

/* Return the bytes that the job takes beside its plan, with `team` workers. */
static int64_t beside_plan(const job *j, int team) {
    int64_t bytes = reader_shared_bytes(j->reader) + team * shear_worker_bytes(j->plan, j->size);
    if (shear_estimator_is_symmetric(j->settings.estimator))
        bytes += TERMS_COPIES * reader_get_info(j->reader)->n_stamps * SHEAR_SYMMETRY_BYTES;
    return bytes;
}

/* Return the number of workers that the whole budget has memory for; 0: not even one. */
static int team_for(const job *j) {
    const int64_t left = budget_total(j) - shear_plan_bytes(j->plan);
    int team = j->workers;
    while (team > 0 && beside_plan(j, team) > left)
        team--;
    return team;
}

static int refuse(const job *j, int64_t needed, shear_error *err) {
    const shear_geometry *g = &reader_get_info(j->reader)->geometry;
    return shear_fail(err, ENGINE_E_MEMORY,
                      "cut smaller stamps, oversample less, or have [limits] memory raised",
                      "stamps of %d x %d px with these settings need %" PRId64
                      " bytes of memory, and [limits] memory allows %" PRId64 " for all jobs",
                      g->nx, g->ny, needed, budget_total(j));
}

static int reserve(job *j, int64_t bytes, shear_error *err) {
    switch (budget_wait(j, bytes)) {
    case BUDGET_RESERVED:
        return SHEAR_OK;
    case BUDGET_NEVER:
        return refuse(j, bytes, err);
    default:
        return shear_fail(err, READER_E_STOPPED, NULL, "stopped while it waited for memory");
    }
}

/* Reserve memory for planning and make the plan; only then is it known how much the job takes
 * beside it. If that is not free now, release the plan, and wait for both together. */
static int plan_within_budget(job *j, const shear_plan_request *request, shear_error *err) {
    shear_memory memory;
    TRY(shear_plan_memory(&memory, request, err));
    const int64_t planning = memory.plan + memory.planning;
    for (int64_t bytes = planning;;) {
        TRY(reserve(j, bytes, err));
        TRY(plan_cache_acquire(j->engine->plans, request, &j->plan, err));
        j->team_size = team_for(j);
        if (j->team_size == 0)
            return refuse(j, memory.plan + beside_plan(j, 1), err);
        const int64_t rest = beside_plan(j, j->team_size);
        if (budget_settle(j, rest))
            return SHEAR_OK;
        bytes = memory.plan + rest > planning ? memory.plan + rest : planning;
    }
}

/* Read what the plan is made from, and make it. The PSF and the sample are read before memory is
 * reserved for them; they are no larger than the shared memory. */
static int make_plan(job *j, const shear_field_info *info, shear_error *err) {
    shear_psf_source psfs = {.self = j, .read = read_psf, .read_terms = read_terms};
    CLEANUP(shear_plan_request_deinit) shear_plan_request request = {0};
    TRY(reader_read_models(j->reader, &psfs.models, err));
    TRY(shear_plan_request_read(&request, &j->settings, info, psfs, err));
    const shear_source source = {.self = j->reader, .read = reader_read};
    const int capacity = j->size.stamps < SHEAR_BLOCK ? j->size.stamps : SHEAR_BLOCK;
    TRY(shear_plan_request_sample(&request, info, source, capacity, err));
    return plan_within_budget(j, &request, err);
}

/* ---- all steps ---- */

static int prepare(job *j, engine_event *event, shear_error *err) {
    TRY(reader_start(&j->reader, &j->files.input, j->files.fds, &j->limits, err));
    event->info = *reader_get_info(j->reader);
    event->guards = reader_get_guards(j->reader);
    atomic_store(&j->stage, ENGINE_HASHING);
    TRY(reader_checksum(j->reader, j->checksum, &j->hashed, err));
    memcpy(event->checksum, j->checksum, sizeof event->checksum);
    atomic_store(&j->stage, ENGINE_PREPARING);
    j->size = shear_unit_size_for(&event->info, j->workers);
    TRY(reader_map(j->reader, j->workers, j->size.stamps, err));
    TRY(make_plan(j, &event->info, err));
    event->plan = *shear_plan_get_info(j->plan);
    return SHEAR_OK;
}

void job_prepare(job *j, engine_event *event) {
    *event = (engine_event){.kind = ENGINE_OPENED, .job = j->id};
    atomic_store(&j->stage, ENGINE_OPENING);
    if (prepare(j, event, &event->error) != SHEAR_OK)
        event->kind = job_failure_event(j, &event->error);
}
