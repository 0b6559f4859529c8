/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "sheard/account.h"

#include "base/cleanup.h"
#include "report/parts.h"
#include "json/text.h"

#include <string.h>

int sheard_account_format(char **text, const sheard_report_file *file, shear_error *err) {
    return json_text_finish(text, parts_file(file, true), err);
}

static int small(const json_t *o, const char *key) {
    return (int)json_text_count_at(o, key);
}

/* Return the index of the choice that `o` has under the setting's name; 0 if it has none. */
static unsigned choice(const json_t *o, const char *setting) {
    const char *name = json_text_string_at(o, setting);
    const char *const *choices = shear_settings_find(setting)->choices;
    for (unsigned i = 0; name != NULL && choices[i] != NULL; i++) {
        if (strcmp(choices[i], name) == 0)
            return i;
    }
    return 0;
}

static enum shear_noise_band noise_band_named(const char *name) {
    for (unsigned i = 0; name != NULL && i <= SHEAR_NOISE_BAND_CORNERS; i++) {
        if (strcmp(shear_noise_band_name(i), name) == 0)
            return i;
    }
    return SHEAR_NOISE_BAND_NONE;
}

/* Return the frame of this name. Accounts of older versions have none: they are of pixels. */
static enum shear_frame frame_named(const char *name) {
    for (unsigned i = 0; name != NULL && i < SHEAR_N_FRAMES; i++) {
        if (strcmp(shear_frame_name(i), name) == 0)
            return i;
    }
    return SHEAR_FRAME_PIXEL;
}

/* Read the PSF's summary. Accounts of older versions have none: it is unknown then. */
static shear_psf_summary read_psf(const json_t *o) {
    shear_psf_summary s = {
        .looked_at = json_text_count_at(o, "looked_at"),
        .unusable = json_text_count_at(o, "unusable"),
        .worst = {.r_psf_px = json_text_number_at(o, "r_psf_px"),
                  .sampling = json_text_number_at(o, "sampling"),
                  .rim_px = json_text_number_at(o, "rim_px"),
                  .border = json_text_number_at(o, "border"),
                  .border_err = json_text_number_at(o, "border_err"),
                  .border_slope = json_text_number_at(o, "border_slope"),
                  .cut = json_text_number_at(o, "cut"),
                  .noise = json_text_number_at(o, "noise"),
                  .lowest = json_text_number_at(o, "lowest")},
    };
    for (int i = 0; i < SHEAR_N_PSF_FLAWS; i++)
        s.flawed[i] = json_text_count_at(json_object_get(o, "flaws"), shear_psf_flaw_name(i));
    return s;
}

/* Read where the light is. Accounts of older versions do not know it. */
static shear_centring read_centring(const json_t *o) {
    return (shear_centring){.looked_at = json_text_count_at(o, "looked_at"),
                            .found = json_text_count_at(o, "found"),
                            .x = json_text_number_at(o, "x"),
                            .y = json_text_number_at(o, "y"),
                            .x_err = json_text_number_at(o, "x_err"),
                            .y_err = json_text_number_at(o, "y_err")};
}

static shear_plan_info read_plan(const json_t *entry, const json_t *o) {
    const enum shear_frame frame = frame_named(json_text_string_at(o, "frame"));
    return (shear_plan_info){
        .geometry = {.nx = small(entry, "nx"), .ny = small(entry, "ny")},
        .filter_per_stamp = json_is_true(json_object_get(entry, "per_stamp")),
        .interpolation = choice(o, "interpolation"),
        .oversample = small(o, "oversample"),
        .beta_px = json_text_number_at(o, "beta_px"),
        .r_psf_px = json_text_number_at(o, "r_psf_px"),
        .filter = choice(o, "filter"),
        .core_px = json_text_number_at(o, "core_px"),
        .core_found = json_is_true(json_object_get(o, "core_found")),
        .width_px = json_text_number_at(o, "width_px"),
        .noise_band = noise_band_named(json_text_string_at(o, "noise_band")),
        .k_cut = json_text_number_at(o, "k_cut"),
        .frame = frame,
        .beta = json_text_number_at(o, frame != SHEAR_FRAME_PIXEL ? "beta_sky" : "beta_px"),
        .psf = read_psf(json_object_get(entry, "psf")),
        .centring = read_centring(json_object_get(entry, "centring")),
    };
}

int sheard_account_parse(sheard_account *account, const char *text, shear_error *err) {
    *account = (sheard_account){.texts = NULL};
    json_t *o = NULL;
    TRY(json_text_load(&o, text, "the account of a file", err));
    const json_t *resolved = json_object_get(o, "resolved");
    account->texts = o;
    account->file = (sheard_report_file){
        .path = json_text_string_at(o, "path"),
        .checksum = json_text_string_at(o, "checksum"),
        .field = json_text_string_at(o, "field"),
        .n_stamps = json_text_count_at(o, "n_stamps"),
        .n_used = json_text_count_at(o, "n_used"),
        .seconds = json_text_number_at(o, "seconds"),
    };
    if (json_is_object(resolved)) {
        account->plan = read_plan(o, resolved);
        account->file.plan = &account->plan;
    }
    return SHEAR_OK;
}

void sheard_account_deinit(sheard_account *account) {
    json_decref(account->texts);
    *account = (sheard_account){.texts = NULL};
}
