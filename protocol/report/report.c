/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "sheard/report.h"

#include "report/parts.h"
#include "shear/version.h"
#include "json/settings.h"
#include "json/text.h"

#include <string.h>

static json_t *file_list(const sheard_report *r) {
    json_t *array = json_array();
    for (size_t i = 0; i < r->n_files; i++)
        json_text_append(&array, parts_file(&r->files[i], false));
    return array;
}

static json_t *truth(const sheard_report *report) {
    return report->has_truth ? parts_pair(report->true_g1, report->true_g2) : json_null();
}

static json_t *pull(const sheard_report *report) {
    const shear_result *r = report->result;
    return report->has_truth ? parts_pair((r->g1 - report->true_g1) / r->g1_err,
                                          (r->g2 - report->true_g2) / r->g2_err)
                             : json_null();
}

/* Make the errors of the delta method; null if the result's errors are these already. */
static json_t *delta_err(const shear_result *r) {
    return !r->valid || strcmp(shear_error_method(r), "delta") == 0
               ? json_null()
               : parts_pair(r->delta_g1_err, r->delta_g2_err);
}

static json_t *estimates(const sheard_report_estimators *e) {
    if (e == NULL || e->n == 0)
        return json_null();
    json_t *o = json_object();
    for (int i = 0; i < e->n; i++) {
        const shear_result *r = &e->of[i];
        json_text_set(
            &o, shear_estimator_name(r->estimator),
            JSON_OBJECT({"g1", json_text_number(r->g1)}, {"g1_err", json_text_number(r->g1_err)},
                        {"g2", json_text_number(r->g2)}, {"g2_err", json_text_number(r->g2_err)},
                        {"cov12", json_text_number(r->cov12)},
                        {"error_method", json_string(shear_error_method(r))}));
    }
    return o;
}

static json_t *report_object(const sheard_report *report) {
    const shear_result *r = report->result;
    return JSON_OBJECT(
        {"field", json_text_string(report->field)}, {"g1", json_text_number(r->g1)},
        {"g1_err", json_text_number(r->g1_err)}, {"g2", json_text_number(r->g2)},
        {"g2_err", json_text_number(r->g2_err)}, {"cov12", json_text_number(r->cov12)},
        {"n_stamps", json_integer(r->n_stamps)}, {"n_used", json_integer(r->n_used)},
        {"n_flagged", json_integer(r->n_flagged)},
        {"flags", json_text_counts(r->flagged, SHEAR_N_FLAGS, shear_flag_name)},
        {"settings", json_settings(report->settings)}, {"resolved", parts_plan(report->plan)},
        {"files", file_list(report)},
        {"estimator", json_string(shear_estimator_name(r->estimator))},
        {"error_method", json_string(shear_error_method(r))},
        {"jackknife", r->jackknife != 0 ? json_integer(r->jackknife) : json_null()},
        {"truth", truth(report)}, {"pull", pull(report)}, {"delta_err", delta_err(r)},
        {"no_shear", parts_no_shear(r)}, {"noise_level", parts_noise_level(r)},
        {"influence", parts_influence(r, report->top_file)}, {"resolution", parts_resolution(r)},
        {report->estimators != NULL ? "estimators" : "", estimates(report->estimators)},
        {"filter_removed", json_text_number(r->filter_removed)},
        {"warnings", json_text_strings(report->warnings, report->n_warnings)},
        {"version", json_text_string(shear_version())},
        {"seconds", json_text_number(report->seconds)});
}

int sheard_report_json(char **text, const sheard_report *report, shear_error *err) {
    return json_text_finish(text, report_object(report), err);
}
