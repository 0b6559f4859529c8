/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Transform the PSF models of a plan, and look at the PSF of a typical galaxy. */
#include "measure/internal.h"

#include "base/cleanup.h"
#include "measure/psf_model.h"

#include <math.h>
#include <stdlib.h>

/* Scratch of one model's transform. */
typedef struct model_scratch {
    psf_waves waves;
    double *rows;
} model_scratch;

static void model_scratch_place(model_scratch *s, const mode_plane *p, const shear_psf_model *m,
                                arena *a) {
    psf_waves_place(&s->waves, p, m->nx, m->ny, a);
    s->rows = arena_doubles(a, 2 * FFT_LANES * (size_t)m->nx);
}

/* Scratch of the typical galaxy. */
typedef struct typical_scratch {
    psf_sky_scratch sky; /* and the image */
    double *power;
    transfer transfer;
} typical_scratch;

static void typical_scratch_place(typical_scratch *s, const mode_plane *p, const shear_psf_model *m,
                                  arena *a) {
    psf_sky_scratch_place(&s->sky, m->nx, m->ny, a);
    s->power = arena_doubles(a, p->size);
    transfer_place(&s->transfer, p, a);
}

void plan_models_scratch(const shear_plan *plan, const shear_plan_request *request, arena *a) {
    for (int i = 0; i < request->n_models; i++) {
        model_scratch of_model;
        typical_scratch typical;
        arena one = {0};
        model_scratch_place(&of_model, &plan->transfer_plan.plane, &request->models[i], &one);
        typical_scratch_place(&typical, &plan->transfer_plan.plane, &request->models[i], &one);
        a->used = one.used > a->used ? one.used : a->used;
    }
}

static int out_of_memory(shear_error *err) {
    return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a PSF model");
}

static int fill_basis(plan_model *of, const mode_plane *p, shear_error *err) {
    const shear_psf_model *m = &of->model;
    model_scratch scratch;
    arena a = {0};
    model_scratch_place(&scratch, p, m, &a);
    CLEANUP(release_free) void *memory = arena_allocate(&a);
    if (memory == NULL)
        return out_of_memory(err);
    model_scratch_place(&scratch, p, m, &a);
    psf_waves_fill(&scratch.waves, p, m->step, m->lanczos);
    psf_basis_fill(&of->basis, p, &scratch.waves, m->samples, scratch.rows);
    return SHEAR_OK;
}

static int fill(plan_model *m, const mode_plane *p, shear_error *err) {
    if (m->model.axes == SHEAR_PSF_AXES_PIXEL)
        return fill_basis(m, p, err);
    if (m->model.axes == SHEAR_PSF_AXES_SKY) {
        psf_sky_fill(&m->sky, &m->model);
    } else {
        psf_basis_fill_power(&m->basis, p, m->model.samples);
    }
    return SHEAR_OK;
}

/* Set what makes a stamp suspicious, somewhat less than what the typical PSF allows, and how far
 * modes count, somewhat farther than with the typical PSF. */
static void set_limits(shear_plan *plan, const shear_psf_model *m, const typical_scratch *s) {
    static const double margin = 1.15;
    static const double of_ratio = 0.8;
    const double q = psf_model_sampling(m, plan->pixel_scale);
    transfer_plan *tp = &plan->transfer_plan;
    plan->info.k_cut = s->transfer.k_cut;
    plan->sharpness = sharpness_of(s->sky.image, m->nx, m->ny, q);
    plan->suspicious.ratio = 1.0 + of_ratio * (plan->sharpness.ratio - 1.0);
    tp->farthest = fmin(tp->farthest, margin * s->transfer.k_reach / plan->unit);
    target_limit(&tp->target, &tp->plane, tp->farthest * plan->unit);
}

bool plan_model_power(const plan_model *m, psf_sky_scratch *scratch, const mode_plane *p,
                      const target *aim, const double *jacobian, const double *terms,
                      double *power) {
    return m->model.axes == SHEAR_PSF_AXES_SKY
               ? psf_sky_power(&m->sky, scratch, p, aim, jacobian, terms, power)
               : psf_basis_power(&m->basis, p, aim, terms, power);
}

/* Look at the typical galaxy: is beta large enough? */
static int look_at_typical(shear_plan *plan, const shear_plan_request *request, shear_error *err) {
    const transfer_plan *tp = &plan->transfer_plan;
    if (request->terms == NULL)
        return SHEAR_OK;
    const plan_model *m = &plan->models[request->model];
    const double jacobian[4] = {plan->pixel_scale, 0.0, 0.0, plan->pixel_scale};
    typical_scratch s;
    arena a = {0};
    typical_scratch_place(&s, &tp->plane, &m->model, &a);
    CLEANUP(release_free) void *memory = arena_allocate(&a);
    if (memory == NULL)
        return out_of_memory(err);
    typical_scratch_place(&s, &tp->plane, &m->model, &a);
    if (!plan_model_power(m, &s.sky, &tp->plane, &tp->target, jacobian, request->terms, s.power)) {
        return shear_fail(err, SHEAR_E_PSF, NULL, "the PSF of a typical galaxy has no flux");
    }
    TRY(transfer_make(&s.transfer, tp, &tp->target, s.power, err));
    if (!psf_model_draw(&m->model, request->terms, s.sky.image))
        return out_of_memory(err);
    set_limits(plan, &m->model, &s);
    return SHEAR_OK;
}

int plan_models_fill(shear_plan *plan, const shear_plan_request *request, shear_error *err) {
    for (int i = 0; i < plan->n_models; i++)
        TRY(fill(&plan->models[i], &plan->transfer_plan.plane, err));
    return look_at_typical(plan, request, err);
}
