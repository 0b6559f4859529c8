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
    psf_waves_fill(&scratch.waves, p, m);
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

void plan_note_transfer(shear_plan *plan, const transfer *t) {
    static const double margin = 1.05;
    plan->info.k_cut = t->k_cut;
    if (margin * t->k_reach < t->k_cut)
        plan->transfer_plan.farthest = margin * t->k_reach / plan->unit;
}

/* Set what makes a stamp suspicious: somewhat less than what the typical PSF allows. */
static void set_sharpness(shear_plan *plan, const shear_psf_model *m, const double *image) {
    static const double part = 0.9;
    const double q = psf_model_sampling(m, plan->pixel_scale);
    plan->sharpness = sharpness_of(image, m->nx, m->ny, q);
    plan->suspicious.ratio = 1.0 + part * (plan->sharpness.ratio - 1.0);
}

static bool power_of(const plan_model *m, typical_scratch *s, const transfer_plan *tp,
                     const shear_plan *plan, const double *terms) {
    const double jacobian[4] = {plan->pixel_scale, 0.0, 0.0, plan->pixel_scale};
    const target_aim *aim = &tp->target.aim;
    return m->model.axes == SHEAR_PSF_AXES_SKY
               ? psf_sky_power(&m->sky, &s->sky, &tp->plane, aim, jacobian, terms, s->power)
               : psf_basis_power(&m->basis, &tp->plane, aim, terms, s->power);
}

/* Look at the typical galaxy: is beta large enough? */
static int look_at_typical(shear_plan *plan, const shear_plan_request *request, shear_error *err) {
    const transfer_plan *tp = &plan->transfer_plan;
    if (request->terms == NULL)
        return SHEAR_OK;
    const plan_model *m = &plan->models[request->model];
    typical_scratch s;
    arena a = {0};
    typical_scratch_place(&s, &tp->plane, &m->model, &a);
    CLEANUP(release_free) void *memory = arena_allocate(&a);
    if (memory == NULL)
        return out_of_memory(err);
    typical_scratch_place(&s, &tp->plane, &m->model, &a);
    if (!power_of(m, &s, tp, plan, request->terms)) {
        return shear_fail(err, SHEAR_E_PSF, NULL, "the PSF of a typical galaxy has no flux");
    }
    TRY(transfer_make(&s.transfer, tp, s.power, err));
    if (!psf_model_draw(&m->model, request->terms, s.sky.image))
        return out_of_memory(err);
    set_sharpness(plan, &m->model, s.sky.image);
    plan_note_transfer(plan, &s.transfer);
    return SHEAR_OK;
}

int plan_models_fill(shear_plan *plan, const shear_plan_request *request, shear_error *err) {
    for (int i = 0; i < plan->n_models; i++)
        TRY(fill(&plan->models[i], &plan->transfer_plan.plane, err));
    return look_at_typical(plan, request, err);
}
