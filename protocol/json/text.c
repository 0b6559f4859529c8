/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "json/text.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Bytes of the well-formed UTF-8 sequence at s (Unicode's table 3-7), or 0. `left` bytes may be
 * read. */
static size_t sequence_length(const unsigned char *s, size_t left) {
    size_t length = s[0] < 0x80   ? 1
                    : s[0] < 0xC2 ? 0
                    : s[0] < 0xE0 ? 2
                    : s[0] < 0xF0 ? 3
                    : s[0] < 0xF5 ? 4
                                  : 0;
    if (length == 0 || length > left) {
        return 0;
    }
    for (size_t i = 1; i < length; i++) {
        if ((s[i] & 0xC0) != 0x80) {
            return 0;
        }
    }
    /* Overlong forms, surrogates and what lies beyond U+10FFFF show in the second byte. */
    bool bad = (s[0] == 0xE0 && s[1] < 0xA0) || (s[0] == 0xED && s[1] > 0x9F) ||
               (s[0] == 0xF0 && s[1] < 0x90) || (s[0] == 0xF4 && s[1] > 0x8F);
    return bad ? 0 : length;
}

json_t *json_text_string(const char *text) {
    if (text == NULL) {
        return json_null();
    }
    size_t length = strlen(text);
    char *clean = malloc(3 * length + 1); /* U+FFFD has three bytes */
    if (clean == NULL) {
        return NULL;
    }
    size_t used = 0;
    for (size_t i = 0; i < length;) {
        size_t step = sequence_length((const unsigned char *)text + i, length - i);
        const char *from = step != 0 ? text + i : "\xEF\xBF\xBD";
        size_t n = step != 0 ? step : 3;
        memcpy(clean + used, from, n);
        used += n;
        i += step != 0 ? step : 1;
    }
    json_t *string = json_stringn(clean, used);
    free(clean);
    return string;
}

json_t *json_text_strings(const char *const *texts, size_t n) {
    json_t *array = json_array();
    for (size_t i = 0; i < n; i++) {
        if (json_array_append_new(array, json_text_string(texts[i])) != 0) {
            json_decref(array);
            return NULL;
        }
    }
    return array;
}

json_t *json_text_number(double x) {
    return isfinite(x) ? json_real(x) : json_null();
}

static json_t *setting_value(const shear_settings *s, const shear_setting_def *def) {
    const void *member = (const char *)s + def->offset;
    switch (def->type) {
    case SHEAR_T_CHOICE:
        return json_text_string(def->choices[*(const int *)member]);
    case SHEAR_T_INT: {
        int value = *(const int *)member;
        return def->has_auto && value == 0 ? json_string(shear_setting_auto(def))
                                           : json_integer(value);
    }
    case SHEAR_T_DOUBLE: {
        double value = *(const double *)member;
        return def->has_auto && isnan(value) ? json_string(shear_setting_auto(def))
                                             : json_text_number(value);
    }
    case SHEAR_T_BOOL:
        return json_boolean(*(const bool *)member);
    default:
        return json_null();
    }
}

json_t *json_text_settings(const shear_settings *s) {
    size_t n = 0;
    const shear_setting_def *table = shear_settings_table(&n);
    json_t *object = json_object();
    bool failed = object == NULL;
    for (size_t i = 0; i < n; i++) {
        json_text_set(object, table[i].name, setting_value(s, &table[i]), &failed);
    }
    return json_text_whole(object, failed);
}

json_t *json_text_plan(const shear_plan_info *plan) {
    if (plan == NULL) {
        return json_null();
    }
    json_t *o = json_object();
    bool failed = o == NULL;
    json_text_set(o, "interpolation",
                  json_text_string(shear_interpolation_name(plan->interpolation)), &failed);
    json_text_set(o, "oversample", json_integer(plan->oversample), &failed);
    json_text_set(o, "beta_px", json_text_number(plan->beta_px), &failed);
    json_text_set(o, "r_psf_px", json_text_number(plan->r_psf_px), &failed);
    json_text_set(o, "filter", json_text_string(shear_filter_name(plan->filter)), &failed);
    json_text_set(o, "core_px", json_text_number(plan->core_px), &failed);
    json_text_set(o, "core_found", json_boolean(plan->core_found), &failed);
    json_text_set(o, "width_px", json_text_number(plan->width_px), &failed);
    json_text_set(o, "noise_band", json_text_string(shear_noise_band_name(plan->noise_band)),
                  &failed);
    json_text_set(o, "k_cut", json_text_number(plan->k_cut), &failed);
    return json_text_whole(o, failed);
}

static json_t *flaw_counts(const shear_psf_summary *s) {
    json_t *o = json_object();
    bool failed = o == NULL;
    for (int i = 0; i < SHEAR_N_PSF_FLAWS; i++) {
        json_text_set(o, shear_psf_flaw_name(i), json_integer(s->flawed[i]), &failed);
    }
    return json_text_whole(o, failed);
}

json_t *json_text_psf(const shear_psf_summary *s) {
    if (s == NULL) {
        return json_null();
    }
    const shear_psf_quality *q = &s->worst;
    json_t *o = json_object();
    bool failed = o == NULL;
    json_text_set(o, "looked_at", json_integer(s->looked_at), &failed);
    json_text_set(o, "unusable", json_integer(s->unusable), &failed);
    json_text_set(o, "flaws", flaw_counts(s), &failed);
    json_text_set(o, "r_psf_px", json_text_number(q->r_psf_px), &failed);
    json_text_set(o, "sampling", json_text_number(q->sampling), &failed);
    json_text_set(o, "rim_px", json_text_number(q->rim_px), &failed);
    json_text_set(o, "border", json_text_number(q->border), &failed);
    json_text_set(o, "border_err", json_text_number(q->border_err), &failed);
    json_text_set(o, "border_slope", json_text_number(q->border_slope), &failed);
    json_text_set(o, "cut", json_text_number(q->cut), &failed);
    json_text_set(o, "noise", json_text_number(q->noise), &failed);
    json_text_set(o, "lowest", json_text_number(q->lowest), &failed);
    return json_text_whole(o, failed);
}

void json_text_set(json_t *object, const char *key, json_t *value, bool *failed) {
    if (json_object_set_new(object, key, value) != 0) {
        *failed = true;
    }
}

json_t *json_text_whole(json_t *object, bool failed) {
    if (failed) {
        json_decref(object);
        return NULL;
    }
    return object;
}

/* json_dumps of jansson 2.14 loses text, without a word, where its buffer cannot grow: so the size
 * is asked for first, and the buffer is ours. NULL: no memory. */
static char *dump(const json_t *object) {
    enum { FLAGS = JSON_COMPACT | JSON_ENSURE_ASCII | JSON_REAL_PRECISION(17) };
    size_t size = json_dumpb(object, NULL, 0, FLAGS);
    char *text = size > 0 ? malloc(size + 1) : NULL;
    if (text != NULL && json_dumpb(object, text, size, FLAGS) != size) {
        free(text);
        return NULL;
    }
    if (text != NULL) {
        text[size] = '\0';
    }
    return text;
}

int json_text_finish(char **text, json_t *object, bool failed, shear_error *err) {
    *text = failed ? NULL : dump(object);
    json_decref(object);
    if (*text == NULL) {
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory while writing JSON");
    }
    return SHEAR_OK;
}
