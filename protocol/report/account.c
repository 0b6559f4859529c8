/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "sheard/account.h"

#include "report/report_file.h"
#include "json/text.h"

#include <math.h>
#include <string.h>

int sheard_account_format(char **text, const sheard_report_file *file, shear_error *err) {
    json_t *o = report_file_json(file);
    bool failed = o == NULL;
    if (o != NULL && file->plan != NULL) {
        json_text_set(o, "nx", json_integer(file->plan->geometry.nx), &failed);
        json_text_set(o, "ny", json_integer(file->plan->geometry.ny), &failed);
        json_text_set(o, "per_stamp", json_boolean(file->plan->filter_per_stamp), &failed);
        json_text_set(o, "psf", json_text_psf(&file->plan->psf), &failed);
    }
    return json_text_finish(text, o, failed, err);
}

static double number(const json_t *o, const char *key) {
    const json_t *value = json_object_get(o, key);
    return json_is_number(value) ? json_number_value(value) : (double)NAN;
}

static int small(const json_t *o, const char *key) {
    return (int)json_integer_value(json_object_get(o, key));
}

static const char *text_at(const json_t *o, const char *key) {
    return json_string_value(json_object_get(o, key));
}

/* The number of a setting's choice by its name; 0 where there is none of this name. */
static int choice(const json_t *o, const char *key, const char *(*name_of)(int), int n) {
    const char *name = text_at(o, key);
    for (int i = 0; name != NULL && i < n; i++) {
        if (strcmp(name_of(i), name) == 0) {
            return i;
        }
    }
    return 0;
}

/* Accounts of older versions have none: nothing is known then. */
static shear_psf_summary read_psf(const json_t *o) {
    shear_psf_summary s = {
        .looked_at = json_integer_value(json_object_get(o, "looked_at")),
        .unusable = json_integer_value(json_object_get(o, "unusable")),
        .worst = {.r_psf_px = number(o, "r_psf_px"),
                  .sampling = number(o, "sampling"),
                  .rim_px = number(o, "rim_px"),
                  .border = number(o, "border"),
                  .border_err = number(o, "border_err"),
                  .border_slope = number(o, "border_slope"),
                  .cut = number(o, "cut"),
                  .noise = number(o, "noise"),
                  .lowest = number(o, "lowest")},
    };
    for (int i = 0; i < SHEAR_N_PSF_FLAWS; i++) {
        const json_t *count = json_object_get(json_object_get(o, "flaws"), shear_psf_flaw_name(i));
        s.flawed[i] = json_integer_value(count);
    }
    return s;
}

static void read_plan(shear_plan_info *plan, const json_t *entry, const json_t *o) {
    enum { CHOICES = 32 };
    *plan = (shear_plan_info){
        .geometry = {.nx = small(entry, "nx"), .ny = small(entry, "ny")},
        .filter_per_stamp = json_is_true(json_object_get(entry, "per_stamp")),
        .interpolation = choice(o, "interpolation", shear_interpolation_name, CHOICES),
        .oversample = small(o, "oversample"),
        .beta_px = number(o, "beta_px"),
        .r_psf_px = number(o, "r_psf_px"),
        .filter = choice(o, "filter", shear_filter_name, CHOICES),
        .core_px = number(o, "core_px"),
        .core_found = json_is_true(json_object_get(o, "core_found")),
        .width_px = number(o, "width_px"),
        .noise_band = choice(o, "noise_band", shear_noise_band_name, CHOICES),
        .k_cut = number(o, "k_cut"),
        .psf = read_psf(json_object_get(entry, "psf")),
    };
}

int sheard_account_parse(sheard_account *account, const char *text, shear_error *err) {
    json_error_t why;
    *account = (sheard_account){.texts = NULL};
    json_t *o = json_loads(text, 0, &why);
    if (!json_is_object(o)) {
        json_decref(o);
        return shear_fail(err, SHEAR_E_FORMAT, NULL, "the account of a file is no JSON object");
    }
    const json_t *resolved = json_object_get(o, "resolved");
    account->texts = o;
    account->file = (sheard_report_file){
        .path = text_at(o, "path"),
        .checksum = text_at(o, "checksum"),
        .field = text_at(o, "field"),
        .n_stamps = json_integer_value(json_object_get(o, "n_stamps")),
        .n_used = json_integer_value(json_object_get(o, "n_used")),
        .seconds = number(o, "seconds"),
    };
    if (json_is_object(resolved)) {
        read_plan(&account->plan, o, resolved);
        account->file.plan = &account->plan;
    }
    return SHEAR_OK;
}

void sheard_account_deinit(sheard_account *account) {
    json_decref(account->texts);
    *account = (sheard_account){.texts = NULL};
}
