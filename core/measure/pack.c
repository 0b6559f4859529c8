/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pack a stamp pair as z = galaxy + i noise on the fine grid, filter it, and transform both at
 * once. Strips of FFT_LANES columns are made and transformed along y while they are in the
 * first-level cache. Only the rows that are needed are kept, and transformed along x on request. */
#include "base/simd.h"
#include "measure/internal.h"

#include <string.h>

enum { BLOCK = FFT_LANES * FFT_LANES };

enum filtering { PLAIN, FILTERED, LEVELLED }; /* LEVELLED: pixels minus the origins of the sums */

/* Pack row y of a strip: add it to the photometry and multiply it by the filter's row f. */
static SHEAR_INLINE void pack_row(photometry_sums *s, const double *f, enum filtering filtering,
                                  size_t x0, size_t y, fft_lanes out) {
    const double *galaxy = s->galaxy + x0 + y * (size_t)s->nx;
    const double *noise = s->noise + x0 + y * (size_t)s->nx;
#pragma omp simd
    for (size_t l = 0; l < FFT_LANES; l++) {
        const double g = galaxy[l];
        const double n = noise[l];
        const double factor = filtering != PLAIN ? f[l] : 1.0;
        photometry_pixel(s, l, g, n);
        out.re[y * FFT_LANES + l] = factor * (filtering == LEVELLED ? g - s->galaxy_origin : g);
        out.im[y * FFT_LANES + l] = factor * (filtering == LEVELLED ? n - s->noise_origin : n);
    }
}

/* Pack rows [y0, y1) of a strip of pixels: add them to the photometry, multiply them by the filter,
 * and store both stamps' values. All in one loop: if a side is a power of two, the rows of a strip
 * share so few sets of the first-level cache that they are evicted before a second loop would read
 * them. Two rows at the same distance from the centre have the same filter values, which are read
 * once. */
static SHEAR_INLINE void pack_rows(photometry_sums *sums, const double *filter,
                                   enum filtering filtering, size_t x0, size_t y0, size_t y1,
                                   fft_lanes out) {
    photometry_sums s = *sums;
    size_t y = y0;
    for (size_t end = y1; y + 1 < end; y++, end--) {
        const double *f = filtering != PLAIN ? filter + x0 + y * (size_t)s.nx : NULL;
        pack_row(&s, f, filtering, x0, y, out);
        pack_row(&s, f, filtering, x0, end - 1, out);
    }
    if ((y1 - y0) % 2 != 0) {
        pack_row(&s, filtering != PLAIN ? filter + x0 + y * (size_t)s.nx : NULL, filtering, x0, y,
                 out);
    }
    *sums = s;
}

/* `filter` may be NULL if nothing is filtered. */
SHEAR_SIMD static void pack_columns(photometry_sums *sums, const double *filter,
                                    enum filtering filtering, size_t x0, size_t y0, size_t y1,
                                    fft_lanes out) {
    if (filtering == PLAIN) {
        pack_rows(sums, NULL, PLAIN, x0, y0, y1, out);
    } else if (filtering == FILTERED) {
        pack_rows(sums, filter, FILTERED, x0, y0, y1, out);
    } else {
        pack_rows(sums, filter, LEVELLED, x0, y0, y1, out);
    }
}

SHEAR_SIMD static void filter_lanes(const double *restrict filter, double level, double noise_level,
                                    size_t step, int y0, int y1, fft_lanes strip) {
    for (size_t y = (size_t)y0; y < (size_t)y1; y++) {
#pragma omp simd
        for (size_t l = 0; l < FFT_LANES; l++) {
            const size_t at = y * FFT_LANES + l;
            const double f = filter[y * step + l];
            strip.re[at] = f * (strip.re[at] - level);
            strip.im[at] = f * (strip.im[at] - noise_level);
        }
    }
}

/* A pair while it is packed. */
typedef struct packing {
    photometry_sums sums;
    const shear_plan *plan;
    shear_workspace *ws;
    const filter_map *filter; /* NULL: none */
    bool levelled;            /* both stamps lose a level before the filter */
    const transfer *transfer;
} packing;

/* The place of a strip, and the range of its rows that are not zero. */
typedef struct strip {
    int x0, skip; /* the first `skip` columns belong to the strip before, too */
    int y0, y1;
} strip;

/* Return strip i. The last one ends at the last column, so some columns may be packed twice. */
static strip strip_at(const packing *p, int i) {
    const filter_map *filter = p->filter;
    const int left = i * FFT_LANES;
    const int last = p->plan->info.fine_nx - FFT_LANES;
    const int x0 = left < last ? left : last;
    return (strip){.x0 = x0,
                   .skip = left - x0,
                   .y0 = filter != NULL ? filter->strip_y0[i] : 0,
                   .y1 = filter != NULL ? filter->strip_y1[i] : p->plan->info.fine_ny};
}

/* Pack a strip from pixels, with their photometry; if strips overlap, with that of the new columns
 * only. */
static void pack_strip(packing *p, const strip *st) {
    photometry_sums twice;
    if (st->skip > 0)
        twice = p->sums;
    pack_columns(st->skip > 0 ? &twice : &p->sums, p->filter != NULL ? p->filter->value : NULL,
                 p->filter == NULL ? PLAIN
                 : p->levelled     ? LEVELLED
                                   : FILTERED,
                 (size_t)st->x0, (size_t)st->y0, (size_t)st->y1, p->ws->strip);
    if (st->skip > 0)
        photometry_add(&p->sums, st->x0, st->skip, st->y0, st->y1);
}

/* Pack a strip from interpolated images. */
static void interpolate_strip(const packing *p, const strip *st) {
    const surface_grid *g = &p->plan->grid;
    shear_workspace *ws = p->ws;
    surface_strip(&ws->galaxy, g, st->x0, st->y0, st->y1, ws->strip.re);
    if (p->plan->settings.noise_correction)
        surface_strip(&ws->noise, g, st->x0, st->y0, st->y1, ws->strip.im);
    if (p->filter != NULL) {
        filter_lanes(p->filter->value + st->x0, ws->level, ws->noise_level, (size_t)g->fine_nx,
                     st->y0, st->y1, ws->strip);
    }
}

static void clear_lanes(double *lanes, int y0, int y1) {
    if (y0 < y1)
        memset(lanes + (size_t)y0 * FFT_LANES, 0, (size_t)(y1 - y0) * FFT_LANES * sizeof *lanes);
}

/* Make a strip and transform it along y. */
static fft_lanes transform_strip(packing *p, const strip *st) {
    const int ny = p->plan->info.fine_ny;
    const fft_lanes out = p->ws->strip;
    if (p->plan->grid.x.kind == AXIS_NONE) {
        pack_strip(p, st);
    } else {
        interpolate_strip(p, st);
    }
    clear_lanes(out.re, 0, st->y0);
    clear_lanes(out.re, st->y1, ny);
    clear_lanes(out.im, 0, p->plan->settings.noise_correction ? st->y0 : ny);
    clear_lanes(out.im, st->y1, ny);
    return fft_run(p->plan->along_y, out.re, out.im, FFT_LANES, p->ws->lanes[0], out);
}

/* Rows jy of a group and their mirror images -jy, transformed along y only. */
enum side { UP, DOWN };
static fft_lanes group_lanes(const shear_workspace *ws, int group, enum side side) {
    double *re = ws->modes + (size_t)(4 * group + 2 * (int)side) * ws->lane_size;
    return (fft_lanes){.re = re, .im = re + ws->lane_size};
}

/* Transpose a strip's modes from [jy][x] to [x][jy], for the groups of rows that are needed. */
static void transpose_strip(const packing *p, fft_lanes from, int x0) {
    const size_t to = (size_t)x0 * FFT_LANES;
    const int ny = p->plan->info.fine_ny;
    fft_lanes_close(from, ny);
    for (int group = 0; group <= mode_groups_last(p->plan, p->transfer); group++) {
        if (!mode_groups_want(p->plan, p->transfer, group))
            continue;
        const size_t up = (size_t)group * BLOCK;
        const size_t down = (size_t)ny * FFT_LANES - up;
        const fft_lanes rows = group_lanes(p->ws, group, UP);
        const fft_lanes mirrored = group_lanes(p->ws, group, DOWN);
        fft_transpose(from.re + up, FFT_LANES, rows.re + to);
        fft_transpose(from.im + up, FFT_LANES, rows.im + to);
        fft_transpose(from.re + down, -FFT_LANES, mirrored.re + to);
        fft_transpose(from.im + down, -FFT_LANES, mirrored.im + to);
    }
}

static void clear_columns(shear_workspace *ws, int x0, int last) {
    for (int i = 0; i < 4 * (last + 1); i++) {
        double *lanes = ws->modes + (size_t)i * ws->lane_size;
        memset(lanes + (size_t)x0 * FFT_LANES, 0, BLOCK * sizeof *lanes);
    }
}

static bool load_pair(const shear_plan *plan, shear_workspace *ws, const double *galaxy,
                      const double *noise, pack_failure *failure) {
    failure->in_noise = false;
    if (!surface_load(&ws->galaxy, &plan->grid, galaxy, &failure->x, &failure->y))
        return false;
    failure->in_noise = true;
    return !plan->settings.noise_correction ||
           surface_load(&ws->noise, &plan->grid, noise, &failure->x, &failure->y);
}

/* Set the levels that both stamps lose before the filter: see photometry_level. */
static void set_levels(packing *p, const double *galaxy, const double *noise, bool own_levels) {
    const shear_geometry *g = &p->plan->info.geometry;
    shear_workspace *ws = p->ws;
    ws->level = ws->noise_level = 0.0;
    if (p->levelled) {
        const sky_level below = photometry_level(noise, g->nx, g->ny, galaxy);
        p->sums.noise_origin = ws->noise_level = below.own;
        p->sums.galaxy_origin = ws->level =
            own_levels ? photometry_level(galaxy, g->nx, g->ny, noise).own : below.mean;
    }
}

bool pack_pair(const shear_plan *plan, shear_workspace *ws, const filter_pair *filters,
               const double *galaxy, const double *noise, bool own_levels, const transfer *t,
               photometry *ph, pack_failure *failure) {
    const shear_geometry *g = &plan->info.geometry;
    const bool as_pixels = plan->grid.x.kind == AXIS_NONE;
    packing p = {.plan = plan,
                 .ws = ws,
                 .filter = filters != NULL ? &filters->fine : NULL,
                 .levelled = filters != NULL && !shear_settings_keep_background(&plan->settings),
                 .transfer = t};
    photometry_begin(&p.sums, galaxy, noise, g->nx, g->ny, ws->strip_most);
    if (!as_pixels)
        *ph = photometry_of(galaxy, noise, g->nx, g->ny, ws->strip_most);
    set_levels(&p, galaxy, noise, own_levels);
    if (!load_pair(plan, ws, galaxy, noise, failure))
        return false;
    for (int i = 0; i * FFT_LANES < plan->info.fine_nx; i++) {
        const strip st = strip_at(&p, i);
        if (as_pixels && st.y1 - st.y0 < g->ny) {
            photometry_add(&p.sums, st.x0, st.skip, 0, st.y0);
            photometry_add(&p.sums, st.x0, st.skip, st.y1, g->ny);
        }
        if (st.y0 < st.y1) {
            transpose_strip(&p, transform_strip(&p, &st), st.x0);
        } else {
            clear_columns(ws, st.x0, mode_groups_last(plan, t));
        }
        if (as_pixels)
            photometry_end_strip(&p.sums);
    }
    if (as_pixels)
        *ph = photometry_end(&p.sums);
    return true;
}

mode_rows pack_transform_rows(const shear_plan *plan, shear_workspace *ws, int group) {
    const int nx = plan->info.fine_nx;
    const fft_lanes from = group_lanes(ws, group, UP);
    const fft_lanes mirrored = group_lanes(ws, group, DOWN);
    const fft_lanes up =
        fft_run(plan->along_x, from.re, from.im, FFT_LANES, ws->lanes[0], ws->lanes[1]);
    const fft_lanes free_one = up.re == ws->lanes[0].re ? ws->lanes[1] : ws->lanes[0];
    const fft_lanes down =
        fft_run(plan->along_x, mirrored.re, mirrored.im, FFT_LANES, ws->lanes[2], free_one);
    fft_lanes_close(up, nx);
    fft_lanes_close(down, nx);
    return (mode_rows){.up = up, .down = down, .nx = nx, .group = group};
}
