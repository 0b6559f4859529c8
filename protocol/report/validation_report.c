/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "sheard/validation_report.h"

#include "report/parts.h"
#include "shear/version.h"
#include "json/settings.h"
#include "json/text.h"

static json_t *fault(const sheard_fault *f) {
    json_t *first = json_array();
    for (int i = 0; i < SHEARD_FAULT_SAMPLES && i < f->count; i++)
        json_text_append(&first, json_integer(f->first[i]));
    return JSON_OBJECT({"count", json_integer(f->count)}, {"first", first});
}

static json_t *all_flags(const sheard_validation_report *v) {
    json_t *object = json_object();
    for (int bit = 0; bit < SHEAR_N_FLAGS; bit++)
        json_text_set(&object, shear_flag_name(bit), fault(&v->flags[bit]));
    return object;
}

static const char *psf_layout_name(enum shear_psf_layout layout) {
    return layout == SHEAR_PSF_ONE ? "one" : layout == SHEAR_PSF_PER_STAMP ? "per_stamp" : "by_id";
}

static json_t *field_object(const shear_field_info *f) {
    if (f == NULL)
        return json_null();
    const shear_geometry *g = &f->geometry;
    return JSON_OBJECT(
        {"name", json_text_string(f->name)}, {"n_stamps", json_integer(f->n_stamps)},
        {"nx", json_integer(g->nx)}, {"ny", json_integer(g->ny)},
        {"noise_stamps", json_integer(f->noise_planes)}, {"n_psf", json_integer(f->n_psf)},
        {"psf_nx", json_integer(g->psf_nx)}, {"psf_ny", json_integer(g->psf_ny)},
        {"psf_oversample", json_text_number(g->psf_oversample)},
        {"psf_layout", json_string(psf_layout_name(f->psf_layout))},
        {"layout", json_string(f->layout == SHEAR_LAYOUT_CUBE ? "cube" : "mosaic")},
        {"bitpix", json_integer(f->bitpix)}, {"compressed", json_boolean(f->compressed)},
        {"gzipped", json_boolean(f->gzipped)}, {"bytes", json_integer(f->file_bytes)},
        {"pixscale", json_text_number(f->pixscale)},
        {"sim_g1", f->has_truth ? json_text_number(f->sim_g1) : json_null()},
        {"sim_g2", f->has_truth ? json_text_number(f->sim_g2) : json_null()});
}

static json_t *noise_object(const sheard_validation_report *v) {
    return JSON_OBJECT({"mean", json_text_number(v->noise_mean)},
                       {"mean_err", json_text_number(v->noise_mean_err)},
                       {"rms", json_text_number(v->noise_rms)});
}

static json_t *report_object(const sheard_validation_report *v) {
    const shear_result *result = v->measured ? &v->result : NULL;
    return JSON_OBJECT(
        {"path", json_text_string(v->path)}, {"good", json_boolean(v->good)},
        {"verdict", json_text_string(v->conclusion)}, {"advice", json_text_string(v->advice)},
        {"field", field_object(v->field)}, {"settings", json_settings(v->settings)},
        {"resolved", parts_plan(v->plan)},
        {"psf", parts_psf(v->plan != NULL ? &v->plan->psf : NULL)},
        {"warnings", json_text_strings(v->warnings, v->n_warnings)},
        {"n_measurable", v->scanned ? json_integer(v->n_measurable) : json_null()},
        {"flags", v->scanned ? all_flags(v) : json_null()},
        {"negative", v->scanned ? fault(&v->negative) : json_null()},
        {"lowest_pixel", v->scanned ? json_text_number(v->lowest_pixel) : json_null()},
        {"noise", v->scanned ? noise_object(v) : json_null()},
        {v->n_chips > 0 ? "exposure" : "", v->n_chips > 0 ? parts_exposure(v) : NULL},
        {"weight_follows_flux",
         v->scanned ? json_text_number(v->weight_follows_flux) : json_null()},
        {"no_shear", parts_no_shear(result)}, {"noise_level", parts_noise_level(result)},
        {"influence", parts_influence(result, NULL)}, {"resolution", parts_resolution(result)},
        {"version", json_text_string(shear_version())});
}

int sheard_validation_report_json(char **text, const sheard_validation_report *report,
                                  shear_error *err) {
    return json_text_finish(text, report_object(report), err);
}
