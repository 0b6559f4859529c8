/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/budget.h"
#include "engine/internal.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

double engine_now_s(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

job *job_new(const engine_job *spec, engine *e) {
    const engine_options *options = &e->options;
    job *j = calloc(1, sizeof *j);
    job_files files;
    const bool taken = job_files_take(&files, spec->input, spec->fds);
    if (j != NULL) {
        *j = (job){.engine = e,
                   .id = spec->id,
                   .priority = spec->priority,
                   .settings = spec->settings,
                   .limits = options->limits,
                   .workers = options->workers,
                   .files = files,
                   .bytes = job_files_bytes(&files),
                   .started_s = engine_now_s()};
        pthread_mutex_init(&j->saving, NULL);
        j->limits.stop = &j->stopping;
        j->catalog_path = spec->catalog != NULL ? strdup(spec->catalog) : NULL;
        j->team = calloc((size_t)options->workers, sizeof(shear_worker *));
        j->entering = calloc((size_t)options->workers, sizeof *j->entering);
        j->is_member = calloc((size_t)options->workers, sizeof *j->is_member);
    }
    if (j == NULL || !taken || j->team == NULL || j->entering == NULL || j->is_member == NULL ||
        (spec->catalog != NULL && j->catalog_path == NULL)) {
        if (j == NULL) {
            job_files_close(&files);
        }
        job_free(j);
        return NULL;
    }
    return j;
}

void job_free(job *j) {
    if (j == NULL) {
        return;
    }
    for (int i = 0; j->team != NULL && i < j->workers; i++) {
        shear_worker_free(j->team[i]);
    }
    free(j->team);
    free(j->entering);
    free(j->is_member);
    free(j->sums_before);
    shear_work_free(j->work);
    reader_stop(j->reader);
    shear_catalog_leave(j->catalog); /* for the next attempt, if there is one */
    shear_field_sums_free(j->before);
    shear_symmetry_free(j->terms_before);
    pthread_mutex_destroy(&j->saving);
    plan_cache_release(j->engine->plans, j->plan);
    budget_change(j, 0);
    job_files_close(&j->files);
    free(j->catalog_path);
    free(j);
}

static int write_rows(void *self, int64_t first, int count, const shear_row *rows,
                      const shear_block *block, shear_error *err) {
    return shear_catalog_write(self, first, count, rows, block, err);
}

static int keep_rows(void *self, int64_t rows, shear_error *err) {
    return shear_catalog_keep(self, rows, err);
}

/* The rows before the checkpoint must be there: where they are not, *first_block becomes 0 and the
 * work begins anew. */
static int open_catalog(job *j, int64_t *first_block, shear_error *err) {
    const shear_field_info *info = reader_get_info(j->reader);
    const int64_t rows = *first_block * SHEAR_BLOCK;
    if (j->catalog_path == NULL) {
        return SHEAR_OK;
    }
    if (*first_block > 0 &&
        shear_catalog_resume(&j->catalog, j->catalog_path, info, j->checksum,
                             rows < info->n_stamps ? rows : info->n_stamps, err) == SHEAR_OK) {
        return SHEAR_OK;
    }
    *first_block = 0;
    return shear_catalog_begin(&j->catalog, j->catalog_path, info, j->checksum, err);
}

static int read_block(void *self, int slot, int64_t first, int count, const shear_block **block,
                      shear_error *err) {
    job *j = self;
    job_read_begins(j, slot);
    const int code = reader_read(j->reader, slot, first, count, block, err);
    job_read_ends(j);
    return code;
}

static bool wants_terms(const job *j) {
    return shear_estimator_is_symmetric(j->settings.estimator);
}

/* The checkpoint's sums; none where the terms of their stamps are not with them: then the work
 * begins anew. */
static int read_sums_before(job *j, int64_t *first_block, shear_error *err) {
    shear_result r;
    *first_block = 0;
    if (j->first_block == 0) {
        return SHEAR_OK;
    }
    const int code = shear_field_sums_parse(&j->before, j->sums_before, err);
    if (code != SHEAR_OK) {
        return code;
    }
    shear_field_result(j->before, &r);
    const bool whole =
        j->terms_before != NULL && (int64_t)shear_symmetry_count(j->terms_before) == r.n_used;
    *first_block = whole || !wants_terms(j) ? j->first_block : 0;
    return SHEAR_OK;
}

static void forget_before(job *j) {
    shear_field_sums_free(j->before);
    shear_symmetry_free(j->terms_before);
    j->before = NULL;
    j->terms_before = NULL;
}

int job_begin(job *j, shear_error *err) {
    const shear_field_info *info = reader_get_info(j->reader);
    int64_t first_block = 0;
    int code = read_sums_before(j, &first_block, err);
    if (code == SHEAR_OK) {
        code = open_catalog(j, &first_block, err);
    }
    if (first_block == 0) {
        forget_before(j);
    }
    if (code == SHEAR_OK) {
        const shear_work_spec spec = {.info = info,
                                      .plan = j->plan,
                                      .source = {.self = j, .read = read_block},
                                      .size = j->size,
                                      .first_block = first_block,
                                      .sink = {.self = j->catalog,
                                               .write = j->catalog != NULL ? write_rows : NULL,
                                               .keep = j->catalog != NULL ? keep_rows : NULL}};
        code = shear_work_new(&j->work, &spec, err);
    }
    j->checkpoint_block = j->terms_block = first_block;
    j->checkpoint_ms = (int64_t)(1e3 * engine_now_s());
    return code;
}

bool job_step(job *j, int slot, shear_error *err) {
    if (j->team[slot] == NULL &&
        shear_worker_new(&j->team[slot], j->plan, j->size, slot, err) != SHEAR_OK) {
        shear_work_fail(j->work, err);
        return false;
    }
    return shear_work_step(j->work, j->team[slot]);
}

/* What has been measured so far. */
typedef struct so_far {
    shear_field_sums *sums; /* the checkpoint's and the work's, together */
    shear_symmetry *terms;  /* or NULL */
    int64_t next_block;
} so_far;

static void so_far_deinit(so_far *f) {
    shear_field_sums_free(f->sums);
    shear_symmetry_free(f->terms);
}

/* Terms: the work's from the `from`-th on. */
static int so_far_init(so_far *f, job *j, size_t from, shear_error *err) {
    *f = (so_far){.sums = NULL};
    int code = shear_field_sums_new(&f->sums, err);
    if (code == SHEAR_OK && wants_terms(j)) {
        code = shear_symmetry_new(&f->terms, err);
    }
    if (code == SHEAR_OK) {
        code = shear_work_join_terms(j->work, f->sums, from, f->terms, &f->next_block, err);
    }
    if (code == SHEAR_OK && j->before != NULL) {
        shear_field_sums_join(f->sums, j->before);
    }
    return code;
}

/* Into an event: sums as text, terms as bytes. */
static int so_far_write(const so_far *f, engine_event *event, shear_error *err) {
    event->next_block = f->next_block;
    if (f->terms != NULL) {
        event->terms_size = shear_symmetry_count(f->terms) * SHEAR_SYMMETRY_BYTES;
        event->terms = malloc(event->terms_size > 0 ? event->terms_size : 1);
        if (event->terms == NULL) {
            return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for the terms of a job");
        }
        shear_symmetry_bytes(f->terms, 0, event->terms);
    }
    return shear_field_sums_format(f->sums, &event->sums, err);
}

int job_checkpoint(job *j, engine_event *event, shear_error *err) {
    so_far f;
    int code = so_far_init(&f, j, j->terms_saved, err);
    if (code == SHEAR_OK) {
        code = job_files_check(&j->files, err); /* after the blocks have been read */
        if (code != SHEAR_OK) {
            shear_work_fail(j->work, err);
        }
    }
    if (code == SHEAR_OK) {
        code = shear_work_keep(j->work, f.next_block, err);
    }
    if (code == SHEAR_OK) {
        code = so_far_write(&f, event, err);
    }
    if (code == SHEAR_OK) {
        event->from_block = j->terms_block;
        j->terms_saved += f.terms != NULL ? shear_symmetry_count(f.terms) : 0;
        j->terms_block = f.next_block;
    } else {
        engine_event_deinit(event);
    }
    so_far_deinit(&f);
    return code;
}

static int complete(job *j, engine_event *event, shear_error *err) {
    so_far f = {.sums = NULL};
    int code = job_files_check(&j->files, err);
    if (code == SHEAR_OK) {
        code = so_far_init(&f, j, 0, err);
    }
    if (code == SHEAR_OK && j->terms_before != NULL) {
        code = shear_symmetry_join(f.terms, j->terms_before, 0, err);
    }
    if (code == SHEAR_OK) {
        code = shear_estimate(j->settings.estimator, f.sums, f.terms, &event->result, err);
    }
    if (code == SHEAR_OK) {
        code = so_far_write(&f, event, err);
    }
    if (code == SHEAR_OK && j->catalog != NULL) {
        char name[SHEAR_INPUT_TEXT_SIZE];
        code = shear_catalog_finish(j->catalog, j->plan, &event->result,
                                    shear_input_text(&j->files.input, name, sizeof name),
                                    j->checksum, err);
        j->catalog = NULL;
    }
    so_far_deinit(&f);
    return code;
}

void job_finish(job *j, engine_event *event) {
    *event = (engine_event){
        .kind = ENGINE_STOPPED, .job = j->id, .seconds = engine_now_s() - j->started_s};
    const shear_work_status status = shear_work_get_status(j->work);
    int code = status.code;
    if (code != SHEAR_OK) {
        shear_work_get_error(j->work, &event->error);
    } else if (status.complete) {
        event->kind = ENGINE_DONE;
        code = complete(j, event, &event->error);
    }
    if (code != SHEAR_OK) {
        event->kind = job_end_of(j, &event->error);
        engine_event_deinit(event);
    }
}
