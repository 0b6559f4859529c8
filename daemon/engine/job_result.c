/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Make a job's checkpoints and its result. */
#include "base/cleanup.h"
#include "base/clock.h"
#include "engine/internal.h"

#include <stdlib.h>

/* The sums and terms of the blocks measured so far. */
typedef struct job_sums {
    shear_field_sums *sums; /* of the checkpoint and of the work, together */
    shear_symmetry *terms;  /* or NULL if the estimator is not symmetric */
    int64_t next_block;
} job_sums;

static void job_sums_deinit(job_sums *f) {
    shear_field_sums_free(f->sums);
    shear_symmetry_free(f->terms);
}

/* Join all sums, and the work's terms from number `from` on. */
static int job_sums_join(job_sums *f, const job *j, size_t from, shear_error *err) {
    TRY(shear_field_sums_new(&f->sums, err));
    if (shear_estimator_is_symmetric(j->settings.estimator))
        TRY(shear_symmetry_new(&f->terms, err));
    TRY(shear_work_join_terms(j->work, f->sums, from, f->terms, &f->next_block, err));
    if (j->before != NULL)
        shear_field_sums_join(f->sums, j->before);
    return SHEAR_OK;
}

/* Write the sums as text and the terms as bytes into an event. */
static int job_sums_write(const job_sums *f, engine_event *event, shear_error *err) {
    event->next_block = f->next_block;
    if (f->terms != NULL) {
        event->terms_size = shear_symmetry_count(f->terms) * SHEAR_SYMMETRY_BYTES;
        event->terms = malloc(event->terms_size > 0 ? event->terms_size : 1);
        if (event->terms == NULL)
            return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for the terms of a job");
        shear_symmetry_bytes(f->terms, 0, event->terms);
    }
    return shear_field_sums_format(f->sums, &event->sums, err);
}

/* ---- checkpoints ---- */

/* Fill a CHECKPOINT. The lock `saving` is held. */
static int make_checkpoint(job *j, engine_event *event, shear_error *err) {
    CLEANUP(job_sums_deinit) job_sums f = {0};
    TRY(job_sums_join(&f, j, j->terms_saved, err));
    int code = job_files_check(&j->files, err); /* after the blocks were read, to cover them */
    if (code != SHEAR_OK) {
        shear_work_fail(j->work, err);
        return code;
    }
    TRY(shear_work_sync(j->work, f.next_block, err));
    TRY(job_sums_write(&f, event, err));
    event->from_block = j->terms_block;
    j->terms_saved += f.terms != NULL ? shear_symmetry_count(f.terms) : 0;
    j->terms_block = f.next_block;
    return SHEAR_OK;
}

void job_save_checkpoint(job *j) {
    engine_event event = {.kind = ENGINE_CHECKPOINT, .job = j->id};
    shear_error ignored;
    LOCKED(&j->saving); /* checkpoints are queued in the order of their blocks */
    if (make_checkpoint(j, &event, &ignored) == SHEAR_OK) {
        event_queue_push(&j->engine->events, &event, NULL);
    } else {
        engine_event_deinit(&event);
    }
}

/* ---- result ---- */

enum engine_event_kind job_failure_event(const job *j, shear_error *err) {
    if (err->code == READER_E_STOPPED)
        return ENGINE_STOPPED;
    job_files_check(&j->files, err);
    return ENGINE_FAILED;
}

static int finish_catalog(job *j, const shear_result *result, shear_error *err) {
    char name[SHEAR_INPUT_TEXT_SIZE];
    const int code = shear_catalog_finish(j->catalog, j->plan, result,
                                          shear_input_text(&j->files.input, name, sizeof name),
                                          j->checksum, err);
    j->catalog = NULL;
    return code;
}

static int complete(job *j, engine_event *event, shear_error *err) {
    CLEANUP(job_sums_deinit) job_sums f = {0};
    TRY(job_files_check(&j->files, err));
    TRY(job_sums_join(&f, j, 0, err));
    if (j->terms_before != NULL)
        TRY(shear_symmetry_join(f.terms, j->terms_before, 0, err));
    TRY(shear_estimate(j->settings.estimator, f.sums, f.terms, &event->result, err));
    TRY(job_sums_write(&f, event, err));
    return j->catalog == NULL ? SHEAR_OK : finish_catalog(j, &event->result, err);
}

void job_finish(job *j, engine_event *event) {
    *event = (engine_event){
        .kind = ENGINE_STOPPED, .job = j->id, .seconds = clock_s(CLOCK_MONOTONIC) - j->started_s};
    const shear_work_status status = shear_work_get_status(j->work);
    int code = status.code;
    if (code != SHEAR_OK) {
        shear_work_get_error(j->work, &event->error);
    } else if (status.complete) {
        event->kind = ENGINE_DONE;
        code = complete(j, event, &event->error);
    }
    if (code != SHEAR_OK) {
        event->kind = job_failure_event(j, &event->error);
        engine_event_deinit(event);
    }
}
