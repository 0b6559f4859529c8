/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/parts.h"

#include "sheard/no_shear.h"
#include "json/text.h"

#include <math.h>

json_t *parts_plan(const shear_plan_info *plan) {
    if (plan == NULL)
        return json_null();
    return JSON_OBJECT(
        {"interpolation", json_text_string(shear_interpolation_name(plan->interpolation))},
        {"oversample", json_integer(plan->oversample)},
        {"beta_px", json_text_number(plan->beta_px)},
        {"r_psf_px", json_text_number(plan->r_psf_px)},
        {"filter", json_text_string(shear_filter_name(plan->filter))},
        {"core_px", json_text_number(plan->core_px)},
        {"core_found", json_boolean(plan->core_found)},
        {"width_px", json_text_number(plan->width_px)},
        {"noise_band", json_text_string(shear_noise_band_name(plan->noise_band))},
        {"k_cut", json_text_number(plan->k_cut)},
        {"frame", json_text_string(shear_frame_name(plan->frame))},
        {"beta_sky", json_text_number(plan->frame != SHEAR_FRAME_PIXEL ? plan->beta : NAN)});
}

json_t *parts_psf(const shear_psf_summary *s) {
    if (s == NULL)
        return json_null();
    const shear_psf_quality *q = &s->worst;
    return JSON_OBJECT(
        {"looked_at", json_integer(s->looked_at)}, {"unusable", json_integer(s->unusable)},
        {"flaws", json_text_counts(s->flawed, SHEAR_N_PSF_FLAWS, shear_psf_flaw_name)},
        {"r_psf_px", json_text_number(q->r_psf_px)}, {"sampling", json_text_number(q->sampling)},
        {"rim_px", json_text_number(q->rim_px)}, {"border", json_text_number(q->border)},
        {"border_err", json_text_number(q->border_err)},
        {"border_slope", json_text_number(q->border_slope)}, {"cut", json_text_number(q->cut)},
        {"noise", json_text_number(q->noise)}, {"lowest", json_text_number(q->lowest)});
}

json_t *parts_centring(const shear_centring *c) {
    return JSON_OBJECT({"looked_at", json_integer(c->looked_at)}, {"found", json_integer(c->found)},
                       {"x", json_text_number(c->x)}, {"x_err", json_text_number(c->x_err)},
                       {"y", json_text_number(c->y)}, {"y_err", json_text_number(c->y_err)});
}

json_t *parts_noise_level(const shear_result *r) {
    if (r == NULL)
        return json_null();
    return JSON_OBJECT({"alpha", json_text_number(r->noise_level)},
                       {"alpha_err", json_text_number(r->noise_level_err)},
                       {"effect", json_text_number(r->noise_effect)},
                       {"shape", json_text_number(r->noise_shape)},
                       {"shape_err", json_text_number(r->noise_shape_err)},
                       {"share", json_text_number(r->noise_share)});
}

json_t *parts_influence(const shear_result *r, const char *top_file) {
    if (r == NULL)
        return json_null();
    return JSON_OBJECT(
        {"n_eff", json_text_number(r->n_eff)}, {"top_share", json_text_number(r->top_share)},
        {"top_stamp", json_text_index(r->top_stamp)}, {"top_file", json_text_string(top_file)});
}

json_t *parts_resolution(const shear_result *r) {
    if (r == NULL)
        return json_null();
    return JSON_OBJECT({"mean", json_text_number(r->resolution)},
                       {"bright", json_integer(r->n_bright)}, {"sharp", json_integer(r->n_sharp)},
                       {"bright_triples", json_integer(r->bright_triples)},
                       {"sharp_triples", json_integer(r->sharp_triples)});
}

json_t *parts_no_shear(const shear_result *r) {
    return json_text_string(r != NULL && !r->valid ? sheard_no_shear_name(r->why) : NULL);
}

json_t *parts_pair(double g1, double g2) {
    return JSON_OBJECT({"g1", json_text_number(g1)}, {"g2", json_text_number(g2)});
}

json_t *parts_file(const sheard_report_file *f, bool account) {
    json_t *o = JSON_OBJECT(
        {"path", json_text_string(f->path)}, {"checksum", json_text_string(f->checksum)},
        {"field", json_text_string(f->field)}, {"n_stamps", json_integer(f->n_stamps)},
        {"n_used", json_integer(f->n_used)}, {"resolved", parts_plan(f->plan)},
        {"seconds", json_text_number(f->seconds)});
    if (account && f->plan != NULL) {
        json_text_set(&o, "nx", json_integer(f->plan->geometry.nx));
        json_text_set(&o, "ny", json_integer(f->plan->geometry.ny));
        json_text_set(&o, "per_stamp", json_boolean(f->plan->filter_per_stamp));
        json_text_set(&o, "psf", parts_psf(&f->plan->psf));
        json_text_set(&o, "centring", parts_centring(&f->plan->centring));
    }
    return o;
}
