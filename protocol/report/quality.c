/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/quality.h"

#include "sheard/no_shear.h"
#include "json/text.h"

#include <string.h>

json_t *report_noise_level(const shear_result *r) {
    if (r == NULL) {
        return json_null();
    }
    json_t *o = json_object();
    bool failed = o == NULL;
    json_text_set(o, "alpha", json_text_number(r->noise_level), &failed);
    json_text_set(o, "alpha_err", json_text_number(r->noise_level_err), &failed);
    json_text_set(o, "effect", json_text_number(r->noise_effect), &failed);
    json_text_set(o, "shape", json_text_number(r->noise_shape), &failed);
    json_text_set(o, "shape_err", json_text_number(r->noise_shape_err), &failed);
    json_text_set(o, "share", json_text_number(r->noise_share), &failed);
    return json_text_whole(o, failed);
}

json_t *report_influence(const shear_result *r, const char *top_file) {
    if (r == NULL) {
        return json_null();
    }
    json_t *o = json_object();
    bool failed = o == NULL;
    json_text_set(o, "n_eff", json_text_number(r->n_eff), &failed);
    json_text_set(o, "top_share", json_text_number(r->top_share), &failed);
    json_text_set(o, "top_stamp", r->top_stamp >= 0 ? json_integer(r->top_stamp) : json_null(),
                  &failed);
    json_text_set(o, "top_file", json_text_string(top_file), &failed);
    return json_text_whole(o, failed);
}

json_t *report_no_shear(const shear_result *r) {
    return json_text_string(r != NULL && !r->valid ? sheard_no_shear_name(r->why) : NULL);
}

json_t *report_delta_err(const shear_result *r) {
    if (!r->valid || strcmp(shear_error_method(r), "delta") == 0) {
        return json_null();
    }
    json_t *o = json_object();
    bool failed = o == NULL;
    json_text_set(o, "g1", json_text_number(r->delta_g1_err), &failed);
    json_text_set(o, "g2", json_text_number(r->delta_g2_err), &failed);
    return json_text_whole(o, failed);
}
