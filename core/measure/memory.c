/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/memory.h"

#include "measure/internal.h"

enum { D = sizeof(double) };

static int64_t padded(int64_t n) {
    return (int64_t)fft_padded((int)n);
}

static int64_t longer(int64_t a, int64_t b) {
    return a > b ? a : b;
}

static int64_t lanes(int64_t n) {
    return 2 * n * FFT_LANES * D;
}

static int64_t transform(int64_t n) {
    return (int64_t)fft_plan_bytes((int)n);
}

/* ---- sizes of the parts ---- */

static int64_t axis_bytes(int64_t n, int64_t s) {
    return (n * s + FFT_LANES) * (int64_t)sizeof(axis_point) + n * D;
}

/* The surface of an image of nx x ny pixels that is interpolated. */
static int64_t image_bytes(int64_t nx, int64_t ny) {
    return (6 * padded(nx) * padded(ny) + 2 * padded(ny) * FFT_LANES) * D;
}

static int64_t filter_bytes(int64_t nx, int64_t ny, int64_t s) {
    return ny * s * (nx * s * D + 2 * (int64_t)sizeof(int)) + 2 * padded(nx * s) * D;
}

static int64_t filters_bytes(const shear_plan_info *info) {
    const shear_geometry *g = &info->geometry;
    return filter_bytes(g->nx, g->ny, info->oversample) +
           (info->oversample > 1 ? filter_bytes(g->nx, g->ny, 1) : 0);
}

/* The largest index of a mode that a transfer may use. */
static int64_t max_j(const shear_plan_info *info, int64_t n) {
    const int64_t s = info->oversample;
    const int64_t q = info->psf_oversample;
    return (n * (s < q ? s : q) - 1) / 2;
}

int memory_last_row(const shear_plan_info *info) {
    return (int)max_j(info, info->geometry.ny);
}

static int64_t stride(const shear_plan_info *info) {
    return padded(max_j(info, info->geometry.ny) + 1);
}

/* One number per mode. */
static int64_t table_bytes(const shear_plan_info *info) {
    return (2 * max_j(info, info->geometry.nx) + 1) * stride(info) * D;
}

static int64_t psf_factor(const shear_plan_info *info) {
    return info->psf_oversample / info->geometry.psf_oversample;
}

static int64_t transfer_scratch_bytes(const shear_plan_info *info) {
    const shear_geometry *g = &info->geometry;
    const int64_t factor = psf_factor(info);
    const int64_t period_x = (int64_t)g->nx * info->psf_oversample;
    const int64_t period_y = (int64_t)g->ny * info->psf_oversample;
    const int64_t aliased = (period_x + 2 * FFT_LANES - 1) / (2 * FFT_LANES) * (2 * FFT_LANES);
    return (factor > 1 ? image_bytes(g->psf_nx, g->psf_ny) : 0) +
           g->psf_ny * factor * FFT_LANES * D + period_y * aliased * D +
           2 * lanes(longer(period_x, period_y) + 1) + 2 * stride(info) * aliased * D +
           table_bytes(info);
}

/* ---- totals ---- */

int64_t memory_of_plan(const memory_of *m) {
    const shear_plan_info *info = m->info;
    const shear_geometry *g = &info->geometry;
    const int64_t s = info->oversample;
    const int64_t q = info->psf_oversample;
    int64_t bytes = (int64_t)sizeof(shear_plan) + axis_bytes(g->nx, s) + axis_bytes(g->ny, s) +
                    transform(info->fine_nx) + transform(info->fine_ny) +
                    axis_bytes(g->psf_nx, psf_factor(info)) +
                    axis_bytes(g->psf_ny, psf_factor(info)) + transform(g->nx * q) +
                    transform(g->ny * q) + stride(info) * D + table_bytes(info);
    if (m->has_psf)
        bytes += table_bytes(info);
    if (info->filter != SHEAR_FILTER_NONE && !info->filter_per_stamp)
        bytes += filters_bytes(info);
    if (info->noise_band != SHEAR_NOISE_BAND_NONE) {
        bytes +=
            (int64_t)high_band_bytes(g->nx, g->ny, info->noise_band == SHEAR_NOISE_BAND_CORNERS);
    }
    if (m->settings->shot_noise == SHEAR_SHOT_PLATEAU)
        bytes += g->nx * padded(g->ny / 2 + 1) * D;
    return bytes;
}

int64_t memory_of_planning(const memory_of *m) {
    return m->has_psf ? transfer_scratch_bytes(m->info) : 0;
}

int64_t memory_of_workspace(const memory_of *m, int last_jy) {
    const shear_plan_info *info = m->info;
    const shear_geometry *g = &info->geometry;
    const bool shot = m->settings->shot_noise == SHEAR_SHOT_PLATEAU;
    const bool high = info->noise_band != SHEAR_NOISE_BAND_NONE;
    const int64_t last_row = shot                                ? g->ny / 2
                             : high && (g->ny - 1) / 2 > last_jy ? (g->ny - 1) / 2
                                                                 : last_jy;
    const int64_t groups = last_row / FFT_LANES + 1;
    int64_t bytes = (int64_t)sizeof(shear_workspace) + lanes(info->fine_ny + 1) +
                    3 * lanes(longer(info->fine_nx, info->fine_ny) + 1) +
                    4 * groups * (info->fine_nx + 1) * FFT_LANES * D;
    if (info->interpolation != SHEAR_INTERP_NONE)
        bytes += 2 * image_bytes(g->nx, g->ny);
    if (info->filter_per_stamp)
        bytes += filters_bytes(info);
    if (!m->has_psf)
        bytes += transfer_scratch_bytes(info) + table_bytes(info);
    return bytes;
}
