/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "sheard/report.h"

#include "report/quality.h"
#include "shear/version.h"
#include "json/text.h"

static json_t *fault(const sheard_fault *f) {
    json_t *object = json_object();
    json_t *first = json_array();
    bool failed = object == NULL || first == NULL;
    json_text_set(object, "count", json_integer(f->count), &failed);
    for (int i = 0; i < SHEARD_FAULT_SAMPLES && i < f->count; i++) {
        failed = json_array_append_new(first, json_integer(f->first[i])) != 0 || failed;
    }
    json_text_set(object, "first", first, &failed); /* takes the reference, also when it fails */
    return json_text_whole(object, failed);
}

static json_t *all_flags(const sheard_validation_report *v) {
    json_t *object = json_object();
    bool failed = object == NULL;
    for (int bit = 0; bit < SHEAR_N_FLAGS; bit++) {
        json_text_set(object, shear_flag_name(bit), fault(&v->flags[bit]), &failed);
    }
    return json_text_whole(object, failed);
}

static const char *psf_layout_name(int layout) {
    return layout == SHEAR_PSF_ONE ? "one" : layout == SHEAR_PSF_PER_STAMP ? "per_stamp" : "by_id";
}

static void set_shape(json_t *o, const shear_field_info *f, bool *failed) {
    const shear_geometry *g = &f->geometry;
    json_text_set(o, "nx", json_integer(g->nx), failed);
    json_text_set(o, "ny", json_integer(g->ny), failed);
    json_text_set(o, "noise_stamps", json_integer(f->noise_planes), failed);
    json_text_set(o, "n_psf", json_integer(f->n_psf), failed);
    json_text_set(o, "psf_nx", json_integer(g->psf_nx), failed);
    json_text_set(o, "psf_ny", json_integer(g->psf_ny), failed);
    json_text_set(o, "psf_oversample", json_integer(g->psf_oversample), failed);
    json_text_set(o, "psf_layout", json_string(psf_layout_name(f->psf_layout)), failed);
}

static json_t *field_object(const shear_field_info *f) {
    if (f == NULL) {
        return json_null();
    }
    json_t *o = json_object();
    bool failed = o == NULL;
    json_text_set(o, "name", json_text_string(f->name), &failed);
    json_text_set(o, "n_stamps", json_integer(f->n_stamps), &failed);
    set_shape(o, f, &failed);
    json_text_set(o, "layout", json_string(f->layout == SHEAR_LAYOUT_CUBE ? "cube" : "mosaic"),
                  &failed);
    json_text_set(o, "bitpix", json_integer(f->bitpix), &failed);
    json_text_set(o, "compressed", json_boolean(f->compressed), &failed);
    json_text_set(o, "gzipped", json_boolean(f->gzipped), &failed);
    json_text_set(o, "bytes", json_integer(f->file_bytes), &failed);
    json_text_set(o, "pixscale", json_text_number(f->pixscale), &failed);
    json_text_set(o, "sim_g1", f->has_truth ? json_text_number(f->sim_g1) : json_null(), &failed);
    json_text_set(o, "sim_g2", f->has_truth ? json_text_number(f->sim_g2) : json_null(), &failed);
    return json_text_whole(o, failed);
}

static json_t *noise_object(const sheard_validation_report *v) {
    json_t *o = json_object();
    bool failed = o == NULL;
    json_text_set(o, "mean", json_text_number(v->noise_mean), &failed);
    json_text_set(o, "mean_err", json_text_number(v->noise_mean_err), &failed);
    json_text_set(o, "rms", json_text_number(v->noise_rms), &failed);
    return json_text_whole(o, failed);
}

int sheard_validation_report_json(char **text, const sheard_validation_report *v,
                                  shear_error *err) {
    const shear_result *result = v->measured ? &v->result : NULL;
    json_t *o = json_object();
    bool failed = o == NULL;
    json_text_set(o, "path", json_text_string(v->path), &failed);
    json_text_set(o, "good", json_boolean(v->good), &failed);
    json_text_set(o, "verdict", json_text_string(v->conclusion), &failed);
    json_text_set(o, "advice", json_text_string(v->advice), &failed);
    json_text_set(o, "field", field_object(v->field), &failed);
    json_text_set(o, "settings", json_text_settings(v->settings), &failed);
    json_text_set(o, "resolved", json_text_plan(v->plan), &failed);
    json_text_set(o, "psf", json_text_psf(v->plan != NULL ? &v->plan->psf : NULL), &failed);
    json_text_set(o, "warnings", json_text_strings(v->warnings, v->n_warnings), &failed);
    json_text_set(o, "n_measurable", v->scanned ? json_integer(v->n_measurable) : json_null(),
                  &failed);
    json_text_set(o, "flags", v->scanned ? all_flags(v) : json_null(), &failed);
    json_text_set(o, "negative", v->scanned ? fault(&v->negative) : json_null(), &failed);
    json_text_set(o, "lowest_pixel", v->scanned ? json_text_number(v->lowest_pixel) : json_null(),
                  &failed);
    json_text_set(o, "noise", v->scanned ? noise_object(v) : json_null(), &failed);
    json_text_set(o, "weight_follows_flux",
                  v->scanned ? json_text_number(v->weight_follows_flux) : json_null(), &failed);
    json_text_set(o, "no_shear", report_no_shear(result), &failed);
    json_text_set(o, "noise_level", report_noise_level(result), &failed);
    json_text_set(o, "influence", report_influence(result, NULL), &failed);
    json_text_set(o, "version", json_text_string(shear_version()), &failed);
    return json_text_finish(text, o, failed, err);
}
