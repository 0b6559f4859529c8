/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Read the PSF models of a field from its reader, plane by plane through the shared memory. */
#include "base/cleanup.h"
#include "reader/exchange.h"
#include "reader/validate.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

static int read_description(reader *r, int64_t i, shear_psf_model *m, shear_error *err) {
    static const char what[] = "describe a PSF model";
    const reader_request request = {.op = READER_MODEL, .first = i};
    reader_reply reply;
    TRY(exchange_ask(r, &request, what, &reply, err));
    *m = reply.model;
    m->samples = NULL; /* no pointer of the child's is used */
    return validate_model(m, &r->info) ? SHEAR_OK
                                       : exchange_give_up(r, READER_E_PROTOCOL, what, err);
}

/* Read the planes of model `i`, which are the lower left corners of PSF images. */
static int read_planes(reader *r, int64_t i, shear_psf_model *m, double *samples,
                       shear_error *err) {
    const size_t row = (size_t)r->info.geometry.psf_nx;
    const double *plane = NULL;
    m->samples = samples;
    for (int64_t t = 0; t < m->terms; t++) {
        TRY(reader_read_psf(r, i * m->terms + t, &plane, err));
        for (size_t y = 0; y < (size_t)m->ny; y++, samples += m->nx)
            memcpy(samples, plane + y * row, (size_t)m->nx * sizeof *samples);
    }
    return SHEAR_OK;
}

static int allocate(reader *r, shear_error *err) {
    const shear_field_info *info = &r->info;
    const int64_t plane = (int64_t)info->geometry.psf_nx * info->geometry.psf_ny * 8;
    if (info->n_psf > r->shared_bytes / plane) {
        return shear_fail(err, READER_E_MEMORY, "raise [reader] shared_memory",
                          "%" PRId64 " planes of PSF models take %" PRId64
                          " bytes each, and [reader] shared_memory allows %" PRId64 " in all",
                          info->n_psf, plane, r->shared_bytes);
    }
    r->models = calloc((size_t)info->n_models, sizeof *r->models);
    r->samples = malloc((size_t)(info->n_psf * plane));
    return r->models != NULL && r->samples != NULL
               ? SHEAR_OK
               : shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for PSF models");
}

int reader_read_models(reader *r, const shear_psf_model **models, shear_error *err) {
    *models = r->models;
    if (r->models != NULL || r->info.n_models == 0)
        return SHEAR_OK;
    TRY(allocate(r, err));
    double *samples = r->samples;
    for (int64_t i = 0; i < r->info.n_models; i++) {
        shear_psf_model *m = &r->models[i];
        TRY(read_description(r, i, m, err));
        TRY(read_planes(r, i, m, samples, err));
        samples += (int64_t)m->terms * m->nx * m->ny;
    }
    *models = r->models;
    return SHEAR_OK;
}
