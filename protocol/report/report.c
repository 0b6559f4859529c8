/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "sheard/report.h"

#include "report/quality.h"
#include "report/report_file.h"
#include "shear/version.h"
#include "json/text.h"

/* {"galaxy_not_finite": 0, ...}: every flag, also those that no stamp carries. */
static json_t *flag_counts(const shear_result *r) {
    json_t *object = json_object();
    bool failed = object == NULL;
    for (int bit = 0; bit < SHEAR_N_FLAGS; bit++) {
        json_text_set(object, shear_flag_name(bit), json_integer(r->flagged[bit]), &failed);
    }
    return json_text_whole(object, failed);
}

static json_t *pair(double g1, double g2) {
    json_t *object = json_object();
    bool failed = object == NULL;
    json_text_set(object, "g1", json_text_number(g1), &failed);
    json_text_set(object, "g2", json_text_number(g2), &failed);
    return json_text_whole(object, failed);
}

json_t *report_file_json(const sheard_report_file *f) {
    json_t *object = json_object();
    bool failed = object == NULL;
    json_text_set(object, "path", json_text_string(f->path), &failed);
    json_text_set(object, "checksum", json_text_string(f->checksum), &failed);
    json_text_set(object, "field", json_text_string(f->field), &failed);
    json_text_set(object, "n_stamps", json_integer(f->n_stamps), &failed);
    json_text_set(object, "n_used", json_integer(f->n_used), &failed);
    json_text_set(object, "resolved", json_text_plan(f->plan), &failed);
    json_text_set(object, "seconds", json_text_number(f->seconds), &failed);
    return json_text_whole(object, failed);
}

static json_t *file_list(const sheard_report *r) {
    json_t *array = json_array();
    for (size_t i = 0; i < r->n_files; i++) {
        if (json_array_append_new(array, report_file_json(&r->files[i])) != 0) {
            json_decref(array);
            return NULL;
        }
    }
    return array;
}

static void set_shear(json_t *o, const shear_result *r, bool *failed) {
    json_text_set(o, "g1", json_text_number(r->g1), failed);
    json_text_set(o, "g1_err", json_text_number(r->g1_err), failed);
    json_text_set(o, "g2", json_text_number(r->g2), failed);
    json_text_set(o, "g2_err", json_text_number(r->g2_err), failed);
    json_text_set(o, "cov12", json_text_number(r->cov12), failed);
    json_text_set(o, "n_stamps", json_integer(r->n_stamps), failed);
    json_text_set(o, "n_used", json_integer(r->n_used), failed);
    json_text_set(o, "n_flagged", json_integer(r->n_flagged), failed);
    json_text_set(o, "flags", flag_counts(r), failed);
}

static void set_errors_and_truth(json_t *o, const sheard_report *report, bool *failed) {
    const shear_result *r = report->result;
    json_text_set(o, "estimator", json_string(shear_estimator_name(r->estimator)), failed);
    json_text_set(o, "error_method", json_string(shear_error_method(r)), failed);
    json_text_set(o, "jackknife", r->jackknife != 0 ? json_integer(r->jackknife) : json_null(),
                  failed);
    json_text_set(o, "truth",
                  report->has_truth ? pair(report->true_g1, report->true_g2) : json_null(), failed);
    json_text_set(o, "pull",
                  report->has_truth ? pair((r->g1 - report->true_g1) / r->g1_err,
                                           (r->g2 - report->true_g2) / r->g2_err)
                                    : json_null(),
                  failed);
}

static json_t *estimate(const shear_result *r) {
    json_t *o = json_object();
    bool failed = o == NULL;
    json_text_set(o, "g1", json_text_number(r->g1), &failed);
    json_text_set(o, "g1_err", json_text_number(r->g1_err), &failed);
    json_text_set(o, "g2", json_text_number(r->g2), &failed);
    json_text_set(o, "g2_err", json_text_number(r->g2_err), &failed);
    json_text_set(o, "cov12", json_text_number(r->cov12), &failed);
    json_text_set(o, "error_method", json_string(shear_error_method(r)), &failed);
    return json_text_whole(o, failed);
}

static json_t *estimates(const sheard_report_estimators *e) {
    if (e->n == 0) {
        return json_null();
    }
    json_t *o = json_object();
    bool failed = o == NULL;
    for (int i = 0; i < e->n; i++) {
        json_text_set(o, shear_estimator_name(e->of[i].estimator), estimate(&e->of[i]), &failed);
    }
    return json_text_whole(o, failed);
}

static void set_quality(json_t *o, const sheard_report *report, bool *failed) {
    const shear_result *r = report->result;
    json_text_set(o, "delta_err", report_delta_err(r), failed);
    json_text_set(o, "no_shear", report_no_shear(r), failed);
    json_text_set(o, "noise_level", report_noise_level(r), failed);
    json_text_set(o, "influence", report_influence(r, report->top_file), failed);
}

int sheard_report_json(char **text, const sheard_report *report, shear_error *err) {
    json_t *o = json_object();
    bool failed = o == NULL;
    json_text_set(o, "field", json_text_string(report->field), &failed);
    set_shear(o, report->result, &failed);
    json_text_set(o, "settings", json_text_settings(report->settings), &failed);
    json_text_set(o, "resolved", json_text_plan(report->plan), &failed);
    json_text_set(o, "files", file_list(report), &failed);
    set_errors_and_truth(o, report, &failed);
    set_quality(o, report, &failed);
    if (report->estimators != NULL) {
        json_text_set(o, "estimators", estimates(report->estimators), &failed);
    }
    json_text_set(o, "filter_removed", json_text_number(report->result->filter_removed), &failed);
    json_text_set(o, "warnings", json_text_strings(report->warnings, report->n_warnings), &failed);
    json_text_set(o, "version", json_text_string(shear_version()), &failed);
    json_text_set(o, "seconds", json_text_number(report->seconds), &failed);
    return json_text_finish(text, o, failed, err);
}
