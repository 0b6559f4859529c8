/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "run/team.h"

#include "base/cleanup.h"
#include "common/release.h"

#include <omp.h>

int team_threads(int asked) {
    return asked > 0 ? asked : omp_get_max_threads();
}

/* Report progress to the caller; non-zero if the caller wants to stop. Called by one thread
 * only. */
static int report_progress(const team_job *job, shear_work *work) {
    if (job->progress == NULL)
        return 0;
    const shear_work_status status = shear_work_get_status(work);
    return job->progress(job->context, status.stamps_done, status.stamps_total);
}

/* Run one thread of the team; the first one reports progress. */
static int work_in_slot(const team_job *job, shear_work *work, int slot, shear_error *err) {
    CLEANUP(shear_worker_release) shear_worker *worker = NULL;
    TRY(shear_worker_new(&worker, job->work.plan, job->work.size, slot, err));
    while (shear_work_step(work, worker)) {
        if (slot == 0 && report_progress(job, work) != 0)
            return shear_fail(err, SHEAR_E_CANCELLED, NULL, "stopped by the caller");
    }
    return SHEAR_OK;
}

static int run_team(const team_job *job, shear_work *work, shear_error *err) {
    int code = SHEAR_OK;
#pragma omp parallel num_threads(job->threads)
    {
        shear_error error = {0};
        const int own = work_in_slot(job, work, omp_get_thread_num(), &error);
        if (own != SHEAR_OK) {
            shear_work_stop(work);
#pragma omp critical(shear_run_error)
            if (code == SHEAR_OK) {
                code = own;
                if (err != NULL)
                    *err = error;
            }
        }
    }
    if (code != SHEAR_OK)
        return code;
    if (shear_work_get_status(work).code != SHEAR_OK)
        return shear_work_get_error(work, err);
    report_progress(job, work);
    return SHEAR_OK;
}

void team_sums_deinit(team_sums *sums) {
    shear_field_sums_free(sums->sums);
    shear_symmetry_free(sums->terms);
    shear_jackknife_free(sums->jackknife);
    *sums = (team_sums){0};
}

int team_measure(const team_job *job, team_sums *out, shear_result *result, shear_error *err) {
    const enum shear_estimator estimator = shear_plan_get_settings(job->work.plan)->estimator;
    CLEANUP(shear_work_release) shear_work *work = NULL;
    shear_work_spec spec = job->work;
    int64_t blocks = 0;
    *out = (team_sums){0};
    TRY(shear_field_sums_new(&out->sums, err));
    if (spec.terms || shear_estimator_is_symmetric(estimator))
        TRY(shear_symmetry_new(&out->terms, err));
    if (job->jackknife)
        TRY(shear_jackknife_new(&out->jackknife, 2, err));
    spec.jackknife = out->jackknife;
    TRY(shear_work_new(&work, &spec, err));
    TRY(run_team(job, work, err));
    TRY(shear_work_join_terms(work, out->sums, 0, out->terms, &blocks, err));
    return shear_estimate(estimator, out->sums, out->terms, result, err);
}
