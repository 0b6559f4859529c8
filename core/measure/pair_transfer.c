/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Choose or make the transfer of one stamp pair: that of the plan, or one from the pair's own PSF
 * and the Jacobian at its place. */
#include "measure/internal.h"

const double *pair_transfer_image(const stamp_pair *s) {
    const shear_geometry *g = &s->plan->info.geometry;
    const shear_stamps *stamps = s->stamps;
    const int index = stamps->psf_index != NULL ? stamps->psf_index[s->i] : s->i;
    return stamps->psf == NULL || index < 0 || index >= stamps->n_psf
               ? NULL
               : stamps->psf + (size_t)index * (size_t)g->psf_nx * (size_t)g->psf_ny;
}

int pair_transfer_model(const stamp_pair *s, const double **terms) {
    const shear_plan *plan = s->plan;
    const int index = s->stamps->psf_index != NULL ? s->stamps->psf_index[s->i] : 0;
    if (index < 0 || index >= plan->n_models)
        return -1;
    *terms = s->stamps->psf_terms + (size_t)s->i * (size_t)plan->models[index].model.terms;
    return index;
}

bool pair_transfer_has_psf(const stamp_pair *s) {
    const double *terms;
    return s->plan->has_psf || (s->plan->n_models > 0 ? pair_transfer_model(s, &terms) >= 0
                                                      : pair_transfer_image(s) != NULL);
}

/* Return |W|^2 of an image on all modes, transformed once for stamps that have it one after
 * another; NULL if it is unusable. */
static const double *power_of_image(const stamp_pair *s, const double *psf) {
    shear_workspace *ws = s->ws;
    const shear_plan *plan = s->plan;
    const transfer_plan *p = &plan->transfer_plan;
    if (psf != ws->power_of) {
        const int code = plan->by_fft ? psf_transform_power(&plan->psf_transform, &ws->psf_scratch,
                                                            psf, ws->power, NULL)
                                      : psf_direct_power(&ws->direct, &p->plane, &plan->waves,
                                                         &p->target, psf, ws->power, NULL);
        ws->power_of = code == SHEAR_OK ? psf : NULL;
    }
    return ws->power_of != NULL ? ws->power : NULL;
}

/* Return |W|^2 of the pair's model; NULL if it is unusable. */
static const double *power_of_model(const stamp_pair *s, const target *aim) {
    shear_workspace *ws = s->ws;
    const double *terms;
    const int i = pair_transfer_model(s, &terms);
    const double *jacobian =
        s->stamps->jacobian != NULL ? s->stamps->jacobian + 4 * (size_t)s->i : NULL;
    return i >= 0 &&
                   plan_model_power(&s->plan->models[i], &ws->psf_sky,
                                    &s->plan->transfer_plan.plane, aim, jacobian, terms, ws->power)
               ? ws->power
               : NULL;
}

/* Return |W|^2 of the pair's PSF; NULL if it is unusable. image: the pair's own, or NULL. */
static const double *choose_power(const stamp_pair *s, const target *aim, const double *image) {
    if (s->plan->has_psf)
        return s->plan->power;
    if (s->plan->n_models > 0)
        return power_of_model(s, aim);
    return image != NULL ? power_of_image(s, image) : NULL;
}

/* Return the target in the pair's frame; NULL if its Jacobian is no map. */
static const target *choose_target(const stamp_pair *s) {
    const shear_plan *plan = s->plan;
    const transfer_plan *p = &plan->transfer_plan;
    frame_map map;
    if (plan->info.frame == SHEAR_FRAME_PIXEL)
        return &p->target;
    if (!frame_map_make(&map, s->stamps->jacobian + 4 * (size_t)s->i, plan->info.frame))
        return NULL;
    target_fill_sky(&s->ws->target, &p->plane, &map, plan->info.beta, p->s, p->farthest);
    return &s->ws->target;
}

/* Make the transfer in the workspace. Return the flag of what is wrong, or 0. */
static uint32_t make(stamp_pair *s) {
    shear_workspace *ws = s->ws;
    const bool pixel = s->plan->info.frame == SHEAR_FRAME_PIXEL;
    const double *image = s->plan->n_models == 0 ? pair_transfer_image(s) : NULL;
    if (pixel && image != NULL && image == ws->transfer_of)
        return 0;
    ws->transfer_of = NULL;
    const target *aim = choose_target(s);
    if (aim == NULL)
        return SHEAR_FLAG_NO_POSITION;
    const double *power = choose_power(s, aim, image);
    if (power == NULL ||
        transfer_make(&ws->transfer, &s->plan->transfer_plan, aim, power, NULL) != SHEAR_OK) {
        return SHEAR_FLAG_PSF_UNUSABLE;
    }
    ws->transfer_of = image;
    return 0;
}

void pair_transfer_choose(stamp_pair *s, uint32_t *flags) {
    if (s->plan->has_transfer) {
        s->transfer = &s->plan->transfer;
        return;
    }
    const uint32_t wrong = make(s);
    *flags |= wrong;
    s->transfer = wrong == 0 ? &s->ws->transfer : NULL;
}
