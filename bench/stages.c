/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "stages.h"

#include "timer.h"

#include "measure/internal.h"

const char *const stage_names[N_STAGES] = {
    "PSF", "interpolation", "transform along y", "packing", "along x", "moments", "border, flags"};

/* A case, and the pair that a stage works on. */
typedef struct stage_pair {
    const shear_plan *plan;
    shear_workspace *ws;
    const transfer *transfer;
    const double *galaxy, *noise, *psf;
    moments sum, noise_sum;
} stage_pair;

static const filter_pair *filter_of(const stage_pair *s) {
    return s->plan->info.filter != SHEAR_FILTER_NONE ? &s->plan->filter : NULL;
}

static int strips(const stage_pair *s) {
    return (s->plan->info.fine_nx + FFT_LANES - 1) / FFT_LANES;
}

static int strip_start(const stage_pair *s, int i) {
    const int last = s->plan->info.fine_nx - FFT_LANES;
    return i * FFT_LANES < last ? i * FFT_LANES : last;
}

static void do_psf(stage_pair *s) {
    shear_workspace *ws = s->ws;
    const transfer_plan *p = &s->plan->transfer_plan;
    psf_transform_power(&s->plan->psf_transform, &ws->psf_scratch, s->psf, ws->power, NULL);
    transfer_make(&ws->transfer, p, ws->power, NULL);
}

static void interpolate(const stage_pair *s, surface *im, const double *pixels) {
    const filter_pair *filter = filter_of(s);
    int bad;
    surface_load(im, &s->plan->grid, pixels, &bad, &bad);
    for (int i = 0; i < strips(s); i++) {
        const int y0 = filter != NULL ? filter->fine.strip_y0[i] : 0;
        const int y1 = filter != NULL ? filter->fine.strip_y1[i] : s->plan->info.fine_ny;
        surface_strip(im, &s->plan->grid, strip_start(s, i), y0, y1, s->ws->strip.re);
    }
}

static void do_interpolate(stage_pair *s) {
    interpolate(s, &s->ws->galaxy, s->galaxy);
    interpolate(s, &s->ws->noise, s->noise);
}

static void do_along_y(stage_pair *s) {
    const fft_lanes strip = s->ws->strip;
    for (int i = 0; i < strips(s); i++)
        fft_run(s->plan->along_y, strip.re, strip.im, FFT_LANES, s->ws->lanes[0], s->ws->lanes[1]);
}

static void do_pack(stage_pair *s) {
    photometry ph;
    pack_failure failure;
    pack_pair(s->plan, s->ws, filter_of(s), s->galaxy, s->noise, false, s->transfer, &ph, &failure);
}

static void do_along_x(stage_pair *s) {
    for (int group = 0; group <= mode_groups_last(s->plan, s->transfer); group++) {
        if (mode_groups_want(s->plan, s->transfer, group))
            pack_transform_rows(s->plan, s->ws, group);
    }
}

static void do_moments(stage_pair *s) {
    for (int group = 0; group * FFT_LANES <= s->transfer->jy; group++) {
        const mode_rows rows = {.up = s->ws->lanes[0],
                                .down = s->ws->lanes[2],
                                .nx = s->plan->info.fine_nx,
                                .group = group};
        moments_add(&s->sum, &s->noise_sum, &rows, &s->plan->transfer_plan.plane, s->transfer);
    }
}

static double time_stage(const bench_data *d, stage_pair *s, int repeats,
                         void (*stage)(stage_pair *)) {
    const shear_block *b = d->block;
    const size_t pixels = (size_t)b->stamps.nx * (size_t)b->stamps.ny;
    const double start = timer_processor_us();
    for (int r = 0; r < repeats; r++) {
        for (int i = 0; i < d->count; i++) {
            const size_t psf = b->stamps.psf != NULL ? (size_t)i : 0;
            s->galaxy = b->galaxy + (size_t)i * pixels;
            s->noise = b->noise + (size_t)i * pixels;
            s->psf = b->psf + psf * pixels;
            stage(s);
        }
    }
    return (timer_processor_us() - start) / ((double)repeats * d->count);
}

void stages_time(const bench_data *d, shear_workspace *ws, int repeats, double us[N_STAGES]) {
    const shear_plan *plan = d->plan;
    stage_pair s = {.plan = plan,
                    .ws = ws,
                    .transfer = plan->has_psf ? &plan->transfer : &ws->transfer,
                    .psf = d->block->psf};
    const bool interpolated = plan->grid.x.kind != AXIS_NONE;
    const double whole = bench_data_time_pairs(d, ws, repeats);
    us[STAGE_PSF] = plan->has_psf ? 0.0 : time_stage(d, &s, repeats, do_psf);
    us[STAGE_INTERPOLATE] = interpolated ? time_stage(d, &s, repeats, do_interpolate) : 0.0;
    us[STAGE_ALONG_Y] = time_stage(d, &s, repeats, do_along_y);
    us[STAGE_PACK] =
        time_stage(d, &s, repeats, do_pack) - us[STAGE_INTERPOLATE] - us[STAGE_ALONG_Y];
    us[STAGE_ALONG_X] = time_stage(d, &s, repeats, do_along_x);
    us[STAGE_MOMENTS] = time_stage(d, &s, repeats, do_moments);
    us[STAGE_REST] = whole;
    for (int i = 0; i < STAGE_REST; i++)
        us[STAGE_REST] -= us[i];
}
