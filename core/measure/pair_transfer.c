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
                                                         &p->target.aim, psf, ws->power, NULL);
        ws->power_of = code == SHEAR_OK ? psf : NULL;
    }
    return ws->power_of != NULL ? ws->power : NULL;
}

/* Choose |W|^2 of the pair's model. `scaled` is memory for its coefficients. */
static bool choose_model(const stamp_pair *s, double *scaled, galaxy_power *power) {
    shear_workspace *ws = s->ws;
    const double *terms;
    const int i = pair_transfer_model(s, &terms);
    if (i < 0)
        return false;
    const plan_model *m = &s->plan->models[i];
    if (m->model.axes != SHEAR_PSF_AXES_SKY) {
        *power = (galaxy_power){.basis = &m->basis, .terms = scaled};
        return psf_basis_scale(&m->basis, terms, scaled);
    }
    *power = (galaxy_power){.table = ws->power};
    return psf_sky_power(&m->sky, &ws->psf_sky, &s->plan->transfer_plan.plane, &ws->aim,
                         s->stamps->jacobian + 4 * (size_t)s->i, terms, ws->power);
}

/* Choose |W|^2 of the pair's PSF. Return false if it is unusable. */
static bool choose_power(const stamp_pair *s, double *scaled, galaxy_power *power) {
    if (s->plan->n_models > 0)
        return choose_model(s, scaled, power);
    const double *image = s->plan->has_psf ? NULL : pair_transfer_image(s);
    *power = (galaxy_power){.table = s->plan->has_psf ? s->plan->power
                                     : image != NULL  ? power_of_image(s, image)
                                                      : NULL};
    return power->table != NULL;
}

/* Make the transfer of a pair whose PSF is a model, or whose frame is on the sky. Return the flag
 * of what is wrong, or 0. */
static uint32_t make_galaxys(const stamp_pair *s) {
    const shear_plan *plan = s->plan;
    const transfer_plan *p = &plan->transfer_plan;
    double scaled[SHEAR_MAX_PSF_TERMS];
    frame_map map = frame_map_pixel;
    galaxy_power power;
    if (plan->info.frame != SHEAR_FRAME_PIXEL &&
        !frame_map_make(&map, s->stamps->jacobian + 4 * (size_t)s->i, plan->info.frame)) {
        return SHEAR_FLAG_NO_POSITION;
    }
    s->ws->aim = target_aim_at(&p->plane, &map, plan->info.beta, p->farthest);
    return choose_power(s, scaled, &power) &&
                   galaxy_transfer_make(&s->ws->transfer, p, &s->ws->aim, &power)
               ? 0
               : SHEAR_FLAG_PSF_UNUSABLE;
}

/* Make the transfer of a pair with a PSF image, in the pixel frame. */
static uint32_t make_images(const stamp_pair *s) {
    shear_workspace *ws = s->ws;
    const double *image = pair_transfer_image(s);
    if (image != NULL && image == ws->transfer_of)
        return 0;
    const double *power = image != NULL ? power_of_image(s, image) : NULL;
    const bool made = power != NULL && transfer_make(&ws->transfer, &s->plan->transfer_plan, power,
                                                     NULL) == SHEAR_OK;
    ws->transfer_of = made ? image : NULL;
    return made ? 0 : SHEAR_FLAG_PSF_UNUSABLE;
}

void pair_transfer_choose(stamp_pair *s, uint32_t *flags) {
    const shear_plan *plan = s->plan;
    if (plan->has_transfer) {
        s->transfer = &plan->transfer;
        return;
    }
    const bool image = plan->n_models == 0 && plan->info.frame == SHEAR_FRAME_PIXEL;
    const uint32_t wrong = image ? make_images(s) : make_galaxys(s);
    *flags |= wrong;
    s->transfer = wrong == 0 ? &s->ws->transfer : NULL;
}
