/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Read reports back, to be shown to people. */
#include "sheard/report_summary.h"

#include "base/cleanup.h"
#include "base/text.h"
#include "json/text.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void text_of(const json_t *object, const char *key, char *buf, size_t size) {
    text_set(buf, size, json_text_string_at(object, key));
}

static void read_shear(sheard_report_summary *s, const json_t *o) {
    s->g1 = json_text_number_at(o, "g1");
    s->g1_err = json_text_number_at(o, "g1_err");
    s->g2 = json_text_number_at(o, "g2");
    s->g2_err = json_text_number_at(o, "g2_err");
    s->cov12 = json_text_number_at(o, "cov12");
    s->n_stamps = json_text_count_at(o, "n_stamps");
    s->n_used = json_text_count_at(o, "n_used");
    s->n_flagged = json_text_count_at(o, "n_flagged");
    for (int bit = 0; bit < SHEAR_N_FLAGS; bit++)
        s->flagged[bit] = json_text_count_at(json_object_get(o, "flags"), shear_flag_name(bit));
    s->jackknife = json_text_count_at(o, "jackknife");
    text_of(o, "estimator", s->estimator, sizeof s->estimator);
    text_of(o, "error_method", s->error_method, sizeof s->error_method);
    s->true_g1 = json_text_number_at(json_object_get(o, "truth"), "g1");
    s->true_g2 = json_text_number_at(json_object_get(o, "truth"), "g2");
    s->pull_g1 = json_text_number_at(json_object_get(o, "pull"), "g1");
    s->pull_g2 = json_text_number_at(json_object_get(o, "pull"), "g2");
    s->n_files = (int64_t)json_array_size(json_object_get(o, "files"));
    s->seconds = json_text_number_at(o, "seconds");
}

static void read_quality(sheard_report_summary *s, const json_t *o) {
    const json_t *level = json_object_get(o, "noise_level");
    const json_t *influence = json_object_get(o, "influence");
    text_of(o, "no_shear", s->no_shear, sizeof s->no_shear);
    s->noise_level = json_text_number_at(level, "alpha");
    s->noise_level_err = json_text_number_at(level, "alpha_err");
    s->noise_effect = json_text_number_at(level, "effect");
    s->noise_share = json_text_number_at(level, "share");
    s->n_eff = json_text_number_at(influence, "n_eff");
    s->top_share = json_text_number_at(influence, "top_share");
    text_of(influence, "top_file", s->top_file, sizeof s->top_file);
    s->top_stamp = json_is_integer(json_object_get(influence, "top_stamp"))
                       ? json_text_count_at(influence, "top_stamp")
                       : -1;
}

static void read_plan(sheard_report_summary *s, const json_t *plan) {
    text_of(plan, "interpolation", s->interpolation, sizeof s->interpolation);
    text_of(plan, "filter", s->filter, sizeof s->filter);
    s->oversample = json_text_count_at(plan, "oversample");
    s->beta_px = json_text_number_at(plan, "beta_px");
    s->r_psf_px = json_text_number_at(plan, "r_psf_px");
    s->core_px = json_text_number_at(plan, "core_px");
    s->width_px = json_text_number_at(plan, "width_px");
    s->core_found = json_is_true(json_object_get(plan, "core_found"));
    s->beta_sky = json_text_number_at(plan, "beta_sky");
    text_of(plan, "noise_band", s->noise_band, sizeof s->noise_band);
}

/* Read the frame that all files have; "mixed" if they differ. */
static void read_frame(sheard_report_summary *s, const json_t *plan, const json_t *files) {
    text_of(plan, "frame", s->frame, sizeof s->frame);
    for (size_t i = 0; i < json_array_size(files); i++) {
        const char *frame =
            json_text_string_at(json_object_get(json_array_get(files, i), "resolved"), "frame");
        if (frame != NULL && strcmp(frame, s->frame) != 0)
            text_set(s->frame, sizeof s->frame, "mixed");
    }
}

/* Read the range of a resolved setting, as PSFs and galaxies of a field's files may differ. The
 * range is NAN if the first file has no such value. */
static void read_range(const json_t *files, const char *key, double *from, double *to) {
    *to = *from;
    for (size_t i = 0; isfinite(*from) && i < json_array_size(files); i++) {
        const double x =
            json_text_number_at(json_object_get(json_array_get(files, i), "resolved"), key);
        *from = fmin(*from, x);
        *to = fmax(*to, x);
    }
}

static void read_ranges(sheard_report_summary *s, const json_t *files) {
    read_range(files, "beta_px", &s->beta_px, &s->beta_to);
    read_range(files, "r_psf_px", &s->r_psf_px, &s->r_psf_to);
    read_range(files, "core_px", &s->core_px, &s->core_to);
    read_range(files, "beta_sky", &s->beta_sky, &s->beta_sky_to);
}

static void read_settings(sheard_report_summary *s, const json_t *settings) {
    text_of(settings, "filter", s->asked_filter, sizeof s->asked_filter);
    text_of(settings, "background", s->background, sizeof s->background);
    text_of(settings, "artefacts", s->artefacts, sizeof s->artefacts);
}

static bool read_warnings(sheard_report_summary *s, const json_t *list) {
    const size_t n = json_array_size(list);
    s->warnings = n != 0 ? calloc(n, sizeof *s->warnings) : NULL;
    if (n != 0 && s->warnings == NULL)
        return false;
    for (size_t i = 0; i < n; i++) {
        const char *text = json_string_value(json_array_get(list, i));
        char *copy = text != NULL ? strdup(text) : NULL;
        if (text != NULL && copy == NULL)
            return false;
        if (copy != NULL)
            s->warnings[s->n_warnings++] = copy;
    }
    return true;
}

void sheard_report_summary_deinit(sheard_report_summary *s) {
    for (int64_t i = 0; i < s->n_warnings; i++)
        free(s->warnings[i]);
    free((void *)s->warnings);
    *s = (sheard_report_summary){0};
}

int sheard_report_summary_parse(sheard_report_summary *s, const char *text, shear_error *err) {
    json_auto_t *o = NULL;
    *s = (sheard_report_summary){0};
    TRY(json_text_load(&o, text, "a result", err));
    read_shear(s, o);
    read_quality(s, o);
    read_plan(s, json_object_get(o, "resolved"));
    read_ranges(s, json_object_get(o, "files"));
    read_frame(s, json_object_get(o, "resolved"), json_object_get(o, "files"));
    read_settings(s, json_object_get(o, "settings"));
    if (!read_warnings(s, json_object_get(o, "warnings"))) {
        sheard_report_summary_deinit(s);
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a result");
    }
    return SHEAR_OK;
}
