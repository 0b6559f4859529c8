/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/inner.h"

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
                   .started_s = engine_now_s()};
        j->catalogue_path = spec->catalogue != NULL ? strdup(spec->catalogue) : NULL;
        j->team = calloc((size_t)options->workers, sizeof(shear_worker *));
        j->entering = calloc((size_t)options->workers, sizeof *j->entering);
    }
    if (j == NULL || !taken || j->team == NULL || j->entering == NULL ||
        (spec->catalogue != NULL && j->catalogue_path == NULL)) {
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
    free(j->sums_before);
    shear_work_free(j->work);
    reader_stop(j->reader);
    shear_catalog_leave(j->catalogue); /* for the next attempt, if there is one */
    shear_field_sums_free(j->before);
    plans_give_back(j->engine->plans, j->plan);
    job_files_close(&j->files);
    free(j->catalogue_path);
    free(j);
}

/* PSFs through the reader, in the form that the library asks for. */
static int read_psf(void *self, int64_t index, double *out, shear_error *err) {
    job *j = self;
    const shear_geometry *g = &reader_get_info(j->reader)->geometry;
    const double *psf = NULL;
    const int code = reader_read_psf(j->reader, index, &psf, err);
    if (code == SHEAR_OK) {
        memcpy(out, psf, (size_t)g->psf_nx * (size_t)g->psf_ny * sizeof *out);
    }
    return code;
}

static int open_file(job *j, engine_event *event, shear_error *err) {
    int code = reader_start(&j->reader, &j->files.input, j->files.fds, &j->limits, err);
    if (code == SHEAR_OK) {
        event->info = *reader_get_info(j->reader);
        code = shear_input_checksum(&j->files.input, j->files.fds, &event->info, j->checksum, err);
        memcpy(event->checksum, j->checksum, sizeof event->checksum);
    }
    if (code == SHEAR_OK) {
        j->size = shear_turn_size_for(&event->info, j->workers);
        code = reader_map(j->reader, j->workers, j->size.stamps, err);
    }
    if (code == SHEAR_OK) {
        const shear_psf_source psfs = {.self = j, .read = read_psf};
        code = plans_take(j->engine->plans, &j->settings, &event->info, psfs, &j->plan, err);
    }
    if (code == SHEAR_OK) {
        event->plan = *shear_plan_get_info(j->plan);
    }
    return code;
}

void job_prepare(job *j, engine_event *event) {
    *event = (engine_event){.kind = ENGINE_OPENED, .job = j->id};
    if (open_file(j, event, &event->error) != SHEAR_OK) {
        event->kind = ENGINE_FAILED;
        job_files_check(&j->files, &event->error); /* the better reason, where there is one */
    }
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
static int open_catalogue(job *j, int64_t *first_block, shear_error *err) {
    const shear_field_info *info = reader_get_info(j->reader);
    const int64_t rows = *first_block * SHEAR_BLOCK;
    if (j->catalogue_path == NULL) {
        return SHEAR_OK;
    }
    if (*first_block > 0 &&
        shear_catalog_resume(&j->catalogue, j->catalogue_path, info, j->checksum,
                             rows < info->n_stamps ? rows : info->n_stamps, err) == SHEAR_OK) {
        return SHEAR_OK;
    }
    *first_block = 0;
    return shear_catalog_begin(&j->catalogue, j->catalogue_path, info, j->checksum, err);
}

static int read_block(void *self, int slot, int64_t first, int count, const shear_block **block,
                      shear_error *err) {
    job *j = self;
    job_read_begins(j, slot);
    const int code = reader_read(j->reader, slot, first, count, block, err);
    job_read_ends(j);
    return code;
}

int job_begin(job *j, shear_error *err) {
    const shear_field_info *info = reader_get_info(j->reader);
    int64_t first_block = j->first_block;
    int code = open_catalogue(j, &first_block, err);
    if (code == SHEAR_OK && first_block > 0) {
        code = shear_field_sums_parse(&j->before, j->sums_before, err);
    }
    if (code == SHEAR_OK) {
        const shear_work_spec spec = {.info = info,
                                      .plan = j->plan,
                                      .source = {.self = j, .read = read_block},
                                      .size = j->size,
                                      .first_block = first_block,
                                      .sink = {.self = j->catalogue,
                                               .write = j->catalogue != NULL ? write_rows : NULL,
                                               .keep = j->catalogue != NULL ? keep_rows : NULL}};
        code = shear_work_new(&j->work, &spec, err);
    }
    j->checkpoint_block = first_block;
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

/* The checkpoint's sums and the work's, together. */
static int sums_so_far(job *j, shear_field_sums **sums, int64_t *next_block, shear_error *err) {
    const int code = shear_field_sums_new(sums, err);
    if (code == SHEAR_OK) {
        if (j->before != NULL) {
            shear_field_sums_join(*sums, j->before);
        }
        *next_block = shear_work_join_into(j->work, *sums);
    }
    return code;
}

int job_checkpoint(job *j, int64_t *next_block, char **text, shear_error *err) {
    shear_field_sums *sums = NULL;
    int code = sums_so_far(j, &sums, next_block, err);
    if (code == SHEAR_OK) {
        code = job_files_check(&j->files, err); /* after the blocks have been read */
        if (code != SHEAR_OK) {
            shear_work_fail(j->work, err);
        }
    }
    if (code == SHEAR_OK) {
        code = shear_work_keep(j->work, *next_block, err);
    }
    if (code == SHEAR_OK) {
        code = shear_field_sums_format(sums, text, err);
    }
    shear_field_sums_free(sums);
    return code;
}

static int complete(job *j, engine_event *event, shear_error *err) {
    shear_field_sums *sums = NULL;
    int code = job_files_check(&j->files, err);
    if (code == SHEAR_OK) {
        code = sums_so_far(j, &sums, &event->next_block, err);
    }
    if (code == SHEAR_OK) {
        shear_field_result(sums, &event->result);
        code = shear_field_sums_format(sums, &event->sums, err);
    }
    if (code == SHEAR_OK && j->catalogue != NULL) {
        char name[SHEAR_INPUT_TEXT_SIZE];
        code = shear_catalog_finish(j->catalogue, j->plan, &event->result,
                                    shear_input_text(&j->files.input, name, sizeof name),
                                    j->checksum, err);
        j->catalogue = NULL;
    }
    shear_field_sums_free(sums);
    return code;
}

void job_finish(job *j, engine_event *event) {
    *event = (engine_event){
        .kind = ENGINE_STOPPED, .job = j->id, .seconds = engine_now_s() - j->started_s};
    const shear_work_status status = shear_work_get_status(j->work);
    int code = status.code;
    if (code != SHEAR_OK) {
        shear_work_get_error(j->work, &event->error);
        job_files_check(&j->files, &event->error);
    } else if (status.complete) {
        event->kind = ENGINE_DONE;
        code = complete(j, event, &event->error);
    }
    if (code != SHEAR_OK) {
        event->kind = ENGINE_FAILED;
        free(event->sums);
        event->sums = NULL;
    }
}
