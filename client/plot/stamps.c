/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "plot/stamps.h"

#include "base/cleanup.h"
#include "shear/run.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The search for a usable stamp in a part of the file ends after MAX_TRIES stamps. */
enum { MAX_TRIES = 64 };

int stamp_reader_init(stamp_reader *b, shear_field *field, const shear_settings *settings,
                      shear_error *err) {
    *b = (stamp_reader){.field = field, .info = shear_field_get_info(field)};
    TRY(shear_plan_for_field(&b->plan, settings, field, err));
    b->chosen = shear_plan_get_info(b->plan);
    TRY(shear_workspace_new(&b->ws, b->plan, err));
    return shear_block_new(&b->block, b->info, 1, err);
}

void stamp_reader_deinit(stamp_reader *b) {
    shear_block_free(b->block);
    shear_workspace_free(b->ws);
    shear_plan_free(b->plan);
    *b = (stamp_reader){0};
}

static int measure(stamp_reader *b, int64_t index, shear_row *row, shear_error *err) {
    TRY(shear_field_read(b->field, index, 1, b->block, err));
    return shear_measure(b->plan, b->ws, &b->block->stamps, 0, row, err);
}

/* Find a usable stamp of [first, end): start at the middle, continue to the end, then from the
 * beginning. *found = -1 if there is none. */
static int find_usable(stamp_reader *b, int64_t first, int64_t end, int64_t *found,
                       shear_error *err) {
    const int64_t length = end - first;
    *found = -1;
    for (int64_t try = 0; try < length && try < MAX_TRIES; try++) {
        const int64_t index = first + (length / 2 + try) % length;
        shear_row row;
        TRY(measure(b, index, &row, err));
        if (row.flags == 0) {
            *found = index;
            break;
        }
    }
    return SHEAR_OK;
}

/* Return the beginning of part k of n stamps in `parts` parts, without overflow. */
static int64_t part_start(int64_t n, int parts, int k) {
    return n / parts * k + n % parts * k / parts;
}

int stamp_reader_choose(stamp_reader *b, const plot_options *options,
                        int64_t index[PLOT_MAX_STAMPS], int *n, shear_error *err) {
    const int64_t total = b->info->n_stamps;
    *n = 0;
    if (options->stamp >= total) {
        return shear_fail(err, SHEAR_E_SETTING, "stamps are counted from 0",
                          "there is no stamp %" PRId64 ": the file has %" PRId64, options->stamp,
                          total);
    }
    if (options->stamp >= 0) {
        index[(*n)++] = options->stamp;
        return SHEAR_OK;
    }
    const int parts = (int)(total < options->n_stamps ? total : options->n_stamps);
    for (int k = 0; k < parts; k++) {
        int64_t found = -1;
        TRY(find_usable(b, part_start(total, parts, k), part_start(total, parts, k + 1), &found,
                        err));
        if (found >= 0)
            index[(*n)++] = found;
    }
    if (*n == 0)
        index[(*n)++] = total / 2;
    return SHEAR_OK;
}

int stamp_reader_read(stamp_reader *b, int64_t index, sheet_stamp *stamp, shear_error *err) {
    *stamp = (sheet_stamp){.index = index, .galaxy = b->block->galaxy, .noise = b->block->noise};
    int code = measure(b, index, &stamp->row, err);
    if (code != SHEAR_OK || stamp->row.flags != 0)
        return code;
    code = shear_inspect(b->plan, b->ws, &b->block->stamps, 0, &stamp->steps, err);
    stamp->measured = code == SHEAR_OK;
    return code;
}

void sheet_stamp_deinit(sheet_stamp *stamp) {
    shear_inspection_deinit(&stamp->steps);
    *stamp = (sheet_stamp){0};
}

/* Describe the samples of a stamp's model. Those on the sky are shown as if they lay in pixels. */
static sheet_psf shape_of_model(const stamp_reader *b, const shear_psf_model *m) {
    const bool sky = m->axes == SHEAR_PSF_AXES_SKY;
    const bool power = m->axes == SHEAR_PSF_AXES_MODES;
    return (sheet_psf){.nx = m->nx,
                       .ny = m->ny,
                       .power = power,
                       .step = power ? 2.0 * acos(-1.0) / m->nx
                               : sky ? m->step / b->info->pixscale
                                     : m->step};
}

static void combine(double *out, const shear_psf_model *m, const double *terms) {
    const size_t n = (size_t)m->nx * (size_t)m->ny;
    for (int t = 0; t < m->terms; t++) {
        for (size_t i = 0; i < n; i++)
            out[i] += terms[t] * m->samples[(size_t)t * n + i];
    }
}

int stamp_reader_psf(sheet_psf *psf, const stamp_reader *b, shear_error *err) {
    const shear_geometry *g = &b->info->geometry;
    const shear_stamps *stamps = &b->block->stamps;
    const int which = stamps->psf_index != NULL ? stamps->psf_index[0] : 0;
    const shear_psf_model *models = NULL;
    const int n_models = shear_field_get_models(b->field, &models);
    const shear_psf_model *m = which >= 0 && which < n_models ? &models[which] : NULL;
    *psf = m != NULL
               ? shape_of_model(b, m)
               : (sheet_psf){.nx = g->psf_nx, .ny = g->psf_ny, .step = 1.0 / g->psf_oversample};
    const size_t pixels = (size_t)psf->nx * (size_t)psf->ny;
    psf->pixels = calloc(pixels, sizeof *psf->pixels);
    if (psf->pixels == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "no memory for a PSF image");
    if (m != NULL) {
        combine(psf->pixels, m, stamps->psf_terms);
    } else if (b->info->psf_layout == SHEAR_PSF_ONE) {
        return shear_field_read_psf(b->field, 0, psf->pixels, err);
    } else if (which >= 0 && which < stamps->n_psf) {
        memcpy(psf->pixels, stamps->psf + (size_t)which * pixels, pixels * sizeof *psf->pixels);
    }
    return SHEAR_OK;
}

void sheet_psf_deinit(sheet_psf *psf) {
    free(psf->pixels);
    *psf = (sheet_psf){0};
}
