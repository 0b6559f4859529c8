/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fits/catalog/keywords.h"

#include "base/cleanup.h"
#include "base/text.h"
#include "fits/field/name.h"
#include "fits/io/output.h"
#include "fits/schema/result_columns.h"
#include "measure/result.h"
#include "shear/version.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

static void put_string(fitsfile *f, const char *key, const char *text, const char *comment,
                       int *status) {
    char clean[1024]; /* FITS allows printable ASCII only */
    text_set(clean, sizeof clean, text);
    sf_make_printable(clean);
    fits_write_key_longstr(f, key, clean, comment, status);
}

void sf_catalog_write_field(fitsfile *f, const shear_field_info *info, int *status) {
    if (info->name[0] != '\0')
        put_string(f, "FIELD", info->name, "name of the field", status);
    if (info->has_truth) {
        sf_output_double(f, "SIM_G1", info->sim_g1, "true shear of the mock", status);
        sf_output_double(f, "SIM_G2", info->sim_g2, "true shear of the mock", status);
    }
}

/* Write numbers and logicals as such; choices, "auto" and "none" as strings. */
static void put_setting(fitsfile *f, const shear_settings *s, const shear_setting_def *def,
                        int *status) {
    char text[64];
    char comment[FLEN_COMMENT];
    const void *member = (const char *)s + def->offset;
    shear_settings_format(s, def, text, sizeof text);
    snprintf(comment, sizeof comment, "%s%s%s%s", def->unit[0] != '\0' ? "[" : "", def->unit,
             def->unit[0] != '\0' ? "] " : "", def->help);
    if (def->type == SHEAR_T_BOOL) {
        fits_write_key_log(f, def->keyword, *(const bool *)member ? 1 : 0, comment, status);
    } else if (def->type == SHEAR_T_INT && strcmp(text, "auto") != 0) {
        fits_write_key_lng(f, def->keyword, *(const int *)member, comment, status);
    } else if (def->type == SHEAR_T_DOUBLE && isfinite(*(const double *)member)) {
        sf_output_double(f, def->keyword, *(const double *)member, comment, status);
    } else {
        put_string(f, def->keyword, text, comment, status);
    }
}

static void put_settings(fitsfile *f, const shear_settings *s, int *status) {
    size_t n = 0;
    const shear_setting_def *table = shear_settings_table(&n);
    for (size_t i = 0; i < n; i++)
        put_setting(f, s, &table[i], status);
}

static void put_resolved(fitsfile *f, const shear_plan_info *p, int *status) {
    sf_output_double(f, "R_PSF", p->r_psf_px, "[px] scale radius of the PSF", status);
    sf_output_double(f, "BETA", p->beta_px, "[px] scale radius of the target PSF", status);
    if (p->frame != SHEAR_FRAME_PIXEL)
        sf_output_double(f, "BETA_SKY", p->beta, "[arcsec] the same on the sky", status);
    put_string(f, "RINTERP", shear_interpolation_name(p->interpolation), "interpolation used",
               status);
    fits_write_key_lng(f, "ROVERS", p->oversample, "fine grid used, points per pixel", status);
    put_string(f, "RFILTER", shear_filter_name(p->filter), "filter used", status);
    sf_output_double(f, "RCORE", p->core_px, "[px] core of the filter; absent: none or per stamp",
                     status);
    sf_output_double(f, "RWIDTH", p->width_px, "[px] width of the filter's edge", status);
    put_string(f, "RNOISEBD", shear_noise_band_name(p->noise_band),
               "where the noise level was read off", status);
    sf_output_double(f, "KCUT", p->k_cut, "[rad/px] modes from here on are left out", status);
}

/* Numbers of the result; the first N_SHEARS need a valid one. */
enum { N_SHEARS = 5, N_NUMBERS = 9 };
static const struct {
    const char *key;
    size_t offset; /* of the double in shear_result */
    const char *comment;
} numbers[N_NUMBERS] = {
    {"G1", offsetof(shear_result, g1), "shear of the field"},
    {"G2", offsetof(shear_result, g2), "shear of the field"},
    {"G1_ERR", offsetof(shear_result, g1_err), "1-sigma error of G1"},
    {"G2_ERR", offsetof(shear_result, g2_err), "1-sigma error of G2"},
    {"COV12", offsetof(shear_result, cov12), "covariance of G1 and G2"},
    {"NOISELVL", offsetof(shear_result, noise_level),
     "noise under galaxies over that of noise stamps"},
    {"NOISELER", offsetof(shear_result, noise_level_err), "1-sigma error of NOISELVL"},
    {"N_EFF", offsetof(shear_result, n_eff), "effective number of stamps"},
    {"TOPSHARE", offsetof(shear_result, top_share), "part of the stamp that counts most"},
};

/* The axes of the shears: without them a sign of g2 means nothing. */
static void put_frame(fitsfile *f, enum shear_frame frame, int *status) {
    static const char *const axes[] = {[SHEAR_FRAME_PIXEL] = "x along rows, y along columns",
                                       [SHEAR_FRAME_SKY] = "x to the West, y to the North",
                                       [SHEAR_FRAME_SKY_EAST] = "x to the East, y to the North"};
    put_string(f, "FRAME", shear_frame_name(frame), axes[frame], status);
}

static void put_result(fitsfile *f, const shear_result *r, int *status) {
    for (int i = r->valid ? 0 : N_SHEARS; i < N_NUMBERS; i++) {
        const double *value = (const void *)((const char *)r + numbers[i].offset);
        sf_output_double(f, numbers[i].key, *value, numbers[i].comment, status);
    }
    if (r->top_stamp >= 0)
        fits_write_key_lng(f, "TOPSTAMP", r->top_stamp, "its number, from 0", status);
    put_string(f, "ERRMETH", shear_error_method(r), "where the errors are from", status);
    fits_write_key_lng(f, "NJACK", r->jackknife, "groups of the jackknife", status);
    fits_write_key_lng(f, "NSTAMPS", r->n_stamps, "stamps, all of them rows here", status);
    fits_write_key_lng(f, "NUSED", r->n_used, "stamps in the sums", status);
    fits_write_key_lng(f, "NFLAGGED", r->n_flagged, "stamps left out", status);
    for (int i = 0; i < SHEAR_N_FLAGS; i++)
        fits_write_key_lng(f, sf_flag_keywords[i], r->flagged[i], shear_flag_name(i), status);
}

static void put_flag_legend(fitsfile *f, int *status) {
    fits_write_comment(f,
                       "Bits of column FLAGS; a row with any of them is not in the sums:", status);
    for (int i = 0; i < SHEAR_N_FLAGS; i++) {
        char line[200];
        snprintf(line, sizeof line, "%u %s: %s", 1u << i, shear_flag_name(i), shear_flag_help(i));
        fits_write_comment(f, line, status);
    }
}

void sf_catalog_write_result(fitsfile *f, const shear_plan *plan, const shear_result *result,
                             const char *input_name, const char *checksum, int *status) {
    put_string(f, "VERSION", shear_version(), "of libshear", status);
    put_string(f, "INPUT", input_name, "the field file", status);
    put_string(f, "INCHKSUM", checksum, "its XXH3 checksum, 128 bits", status);
    put_settings(f, shear_plan_get_settings(plan), status);
    put_frame(f, shear_plan_get_info(plan)->frame, status);
    put_resolved(f, shear_plan_get_info(plan), status);
    put_result(f, result, status);
    put_flag_legend(f, status);
}

/* Read a number that is NaN if it is absent, and a count that is 0 then. */
static int get_double(const sf_cards *cards, const char *key, double *out, shear_error *err) {
    *out = NAN;
    return sf_key_double(cards, key, out, err);
}

static int get_count(const sf_cards *cards, const char *key, int64_t *out, shear_error *err) {
    const int64_t most = INT64_C(1) << 53; /* the largest integer that a double holds exactly */
    *out = 0;
    return sf_key_int(cards, key, 0, most, out, err);
}

static int get_name(const sf_cards *cards, char out[SHEAR_FIELD_NAME_SIZE], shear_error *err) {
    CLEANUP(release_free) char *text = NULL;
    TRY(sf_key_string(cards, "FIELD", &text, err));
    return text == NULL
               ? SHEAR_OK
               : sf_field_name_copy(out, text, SHEAR_E_FORMAT, cards->at, "keyword FIELD", err);
}

/* Read the estimator; an unknown or missing name counts as the mean. */
static int get_estimator(const sf_cards *cards, enum shear_estimator *out, shear_error *err) {
    CLEANUP(release_free) char *text = NULL;
    TRY(sf_key_string(cards, "ESTIMAT", &text, err));
    shear_settings settings;
    shear_settings_init(&settings);
    settings.estimator = SHEAR_ESTIMATOR_MEAN;
    if (text != NULL)
        (void)shear_settings_set(&settings, "estimator", text, NULL);
    *out = settings.estimator;
    return SHEAR_OK;
}

static int get_result(const sf_cards *cards, shear_result *out, shear_error *err) {
    int64_t groups = 0;
    *out = result_unknown();
    out->sum_weight = out->sum_d = NAN;
    for (int i = 0; i < N_NUMBERS; i++) {
        double *value = (void *)((char *)out + numbers[i].offset);
        TRY(get_double(cards, numbers[i].key, value, err));
    }
    out->valid = isfinite(out->g1) && isfinite(out->g2);
    TRY(sf_key_int(cards, "NJACK", 0, INT32_MAX, &groups, err));
    out->jackknife = (int)groups;
    TRY(get_estimator(cards, &out->estimator, err));
    TRY(get_count(cards, "NSTAMPS", &out->n_stamps, err));
    TRY(get_count(cards, "NUSED", &out->n_used, err));
    TRY(get_count(cards, "NFLAGGED", &out->n_flagged, err));
    for (int i = 0; i < SHEAR_N_FLAGS; i++)
        TRY(get_count(cards, sf_flag_keywords[i], &out->flagged[i], err));
    return SHEAR_OK;
}

int sf_catalog_read_header(const sf_cards *cards, shear_catalog_table *t, shear_error *err) {
    TRY(get_name(cards, t->field, err));
    TRY(get_double(cards, "SIM_G1", &t->sim_g1, err));
    TRY(get_double(cards, "SIM_G2", &t->sim_g2, err));
    t->has_truth = isfinite(t->sim_g1) && isfinite(t->sim_g2);
    TRY(get_double(cards, "BETA", &t->beta_px, err));
    TRY(get_double(cards, "R_PSF", &t->r_psf_px, err));
    return get_result(cards, &t->result, err);
}
