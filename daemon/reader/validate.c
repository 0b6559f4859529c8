/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "reader/validate.h"

#include "base/text.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static bool in_range(int64_t value, int64_t low, int64_t high) {
    return value >= low && value <= high;
}

static bool hdus_are_valid(const shear_field_info *info) {
    bool valid = true;
    for (int i = 0; i < SHEAR_N_PARTS; i++)
        valid = valid && in_range(info->hdu[i], -1, INT32_MAX);
    return valid;
}

static bool text_is_valid(const char *name) {
    while (*name >= ' ' && *name <= '~')
        name++;
    return *name == '\0';
}

/* Check what is said of the frame. */
static bool frame_is_valid(const shear_field_info *info) {
    return info->frame == SHEAR_FRAME_PIXEL ||
           (in_range(info->frame, SHEAR_FRAME_PIXEL, SHEAR_FRAME_SKY_EAST) &&
            (info->columns & SHEAR_COL_JACOBIAN) != 0 && info->pixscale > 0.0 &&
            isfinite(info->pixscale));
}

/* Check what is said of PSF models. */
static bool models_are_valid(const shear_field_info *info) {
    const unsigned needed = SHEAR_COL_PSF_ID | SHEAR_COL_PSF_TERMS;
    if (info->psf_layout != SHEAR_PSF_MODELS)
        return info->n_models == 0 && info->psf_terms == 0;
    return in_range(info->psf_terms, 1, SHEAR_MAX_PSF_TERMS) &&
           in_range(info->n_models, 1, INT32_MAX) &&
           info->n_psf == (int64_t)info->n_models * info->psf_terms &&
           (info->columns & needed) == needed;
}

/* Models of modes are drawn on the stamps' grid. */
static bool axes_are_valid(const shear_psf_model *m, const shear_field_info *info) {
    const shear_geometry *g = &info->geometry;
    return in_range(m->axes, SHEAR_PSF_AXES_PIXEL, SHEAR_PSF_AXES_MODES) &&
           (m->axes != SHEAR_PSF_AXES_MODES || (m->nx == g->nx && m->ny == g->ny)) &&
           (m->axes != SHEAR_PSF_AXES_SKY || (info->columns & SHEAR_COL_JACOBIAN) != 0);
}

bool validate_model(const shear_psf_model *m, const shear_field_info *info) {
    return in_range(m->nx, 1, info->geometry.psf_nx) && in_range(m->ny, 1, info->geometry.psf_ny) &&
           m->terms == info->psf_terms && axes_are_valid(m, info) && m->step > 1e-9 &&
           m->step < 1e9 && in_range(m->lanczos, 0, 32) && m->smoothed_px >= 0.0 &&
           m->smoothed_px <= SHEAR_MAX_PSF_SIDE &&
           (m->smoothed_px == 0.0 || m->axes == SHEAR_PSF_AXES_PIXEL);
}

/* Terminate the text, and return whether it is printable. */
static bool end_text(char *text, size_t size) {
    text[size - 1] = '\0';
    return text_is_valid(text);
}

/* Terminate the text, and return whether it is empty or a finite number. */
static bool end_number(char *text, size_t size) {
    double value;
    text[size - 1] = '\0';
    return text[0] == '\0' ||
           (strspn(text, "+-.0123456789E") == strlen(text) && text_to_double(text, &value));
}

/* Return whether the form is a count and a letter that make this width. */
static bool form_is_valid(const char *form, int64_t bytes) {
    static const char types[] = "LBIJKAEDCMX";
    static const int bits[] = {8, 8, 16, 32, 64, 8, 32, 64, 64, 128, 1};
    char *type = NULL;
    const long long repeat = strtoll(form, &type, 10);
    const char *known = type != form && *type != '\0' ? strchr(types, *type) : NULL;
    return known != NULL && type[1] == '\0' && in_range(repeat, 1, INT64_C(1) << 20) &&
           (repeat * bits[known - types] + 7) / 8 == bytes;
}

bool validate_carried(shear_carried *c) {
    return end_text(c->name, sizeof c->name) && c->name[0] != '\0' &&
           end_text(c->form, sizeof c->form) && end_text(c->unit, sizeof c->unit) &&
           end_number(c->null, sizeof c->null) && end_number(c->scale, sizeof c->scale) &&
           end_number(c->zero, sizeof c->zero) && in_range(c->bytes, 1, SHEAR_MAX_CARRIED_BYTES) &&
           form_is_valid(c->form, c->bytes);
}

/* What is said of pointers is not believed. */
static bool carried_is_valid(shear_field_info *info) {
    info->carried = NULL;
    return in_range(info->n_carried, 0, SHEAR_MAX_CARRIED) &&
           in_range(info->carried_bytes, info->n_carried, SHEAR_MAX_CARRIED_BYTES) &&
           (info->n_carried > 0 || info->carried_bytes == 0);
}

bool validate_info(shear_field_info *info) {
    const shear_geometry *g = &info->geometry;
    info->name[sizeof info->name - 1] = '\0';
    return text_is_valid(info->name) && in_range(g->nx, SHEAR_MIN_SIDE, SHEAR_MAX_SIDE) &&
           in_range(g->ny, SHEAR_MIN_SIDE, SHEAR_MAX_SIDE) && in_range(g->psf_nx, 1, 4096) &&
           in_range(g->psf_ny, 1, 4096) && g->psf_oversample >= SHEAR_MIN_PSF_OVERSAMPLE &&
           g->psf_oversample <= SHEAR_MAX_PSF_OVERSAMPLE &&
           in_range(info->n_stamps, 1, INT64_C(1) << 40) &&
           in_range(info->n_psf, 1, INT64_C(1) << 40) &&
           in_range(info->layout, SHEAR_LAYOUT_CUBE, SHEAR_LAYOUT_MOSAIC) &&
           in_range(info->psf_layout, SHEAR_PSF_ONE, SHEAR_PSF_MODELS) &&
           in_range(info->noise_planes, 1, SHEAR_MAX_NOISE_PLANES) && models_are_valid(info) &&
           frame_is_valid(info) && hdus_are_valid(info) && carried_is_valid(info);
}

bool validate_checksum(const char text[SHEAR_CHECKSUM_SIZE]) {
    return strnlen(text, SHEAR_CHECKSUM_SIZE) == SHEAR_CHECKSUM_SIZE - 1 &&
           strspn(text, "0123456789abcdef") == SHEAR_CHECKSUM_SIZE - 1;
}
