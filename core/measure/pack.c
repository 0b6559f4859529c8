/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From a stamp pair to the modes of its transform: galaxy + i noise on the fine grid, filtered, one
 * complex transform for both, rows first. What no column of the result needs is not made. */
#include "base/simd.h"
#include "measure/plan_impl.h"

#include <string.h>

SHEAR_SIMD static void pack_row(double complex *out, const double *galaxy, const double *noise,
                                const double *filter, int n) {
    double *pairs = (double *)out;
    if (filter != NULL) {
#pragma omp simd
        for (int i = 0; i < n; i++) {
            pairs[2 * i] = filter[i] * galaxy[i];
            pairs[2 * i + 1] = filter[i] * noise[i];
        }
    } else {
#pragma omp simd
        for (int i = 0; i < n; i++) {
            pairs[2 * i] = galaxy[i];
            pairs[2 * i + 1] = noise[i];
        }
    }
}

/* Row `fine_y` of an image, columns [x0, x1): made in `scratch`, or the pixels as they are. */
static const double *fine_row(const image *im, const image_grid *g, int fine_y, int x0, int x1,
                              double *scratch) {
    if (g->x.kind == AXIS_NONE) {
        return im->pixels + (size_t)fine_y * (size_t)g->x.n + x0;
    }
    image_row(im, g, fine_y, x0, x1, scratch);
    return scratch;
}

/* One fine row of the pair: interpolated where the filter lets it through, zero elsewhere. */
static void make_row(const shear_plan *plan, shear_workspace *ws, const filter_map *filter, int y,
                     double complex *row) {
    const int width = plan->info.fine_nx;
    const bool outside = y >= plan->info.fine_ny;
    const int x0 = outside ? 0 : filter != NULL ? filter->x0[y] : 0;
    const int x1 = outside ? 0 : filter != NULL ? filter->x1[y] : width;
    memset(row, 0, (size_t)x0 * sizeof *row);
    memset(row + x1, 0, (size_t)(width - x1) * sizeof *row);
    if (x0 == x1) {
        return;
    }
    const double *galaxy = fine_row(&ws->galaxy, &plan->grid, y, x0, x1, ws->galaxy_row);
    const double *noise = ws->no_noise;
    if (plan->settings.noise_correction) {
        noise = fine_row(&ws->noise, &plan->grid, y, x0, x1, ws->noise_row);
    }
    const double *values = filter != NULL ? filter->value + (size_t)y * (size_t)width + x0 : NULL;
    pack_row(row + x0, galaxy, noise, values, x1 - x0);
}

/* Rows that the pair before this one filled and this one does not are zero again. */
static void clear_rows(const shear_plan *plan, shear_workspace *ws, int first, int end) {
    const size_t row = plan->stride * sizeof *ws->pair;
    for (int y = ws->first_row; y < ws->end_row; y++) {
        if (y < first || y >= end) {
            memset(ws->pair + (size_t)y * plan->stride, 0, row);
        }
    }
    ws->first_row = first;
    ws->end_row = end;
}

static void transform_rows(const shear_plan *plan, shear_workspace *ws, const filter_map *filter) {
    const int first = filter != NULL ? filter->y0 / FFT_LINES * FFT_LINES : 0;
    const int end = (int)fft_padded(filter != NULL ? filter->y1 : plan->info.fine_ny);
    clear_rows(plan, ws, first, end);
    for (int y = first; y < end; y += FFT_LINES) {
        double complex *out = ws->pair + (size_t)y * plan->stride;
        for (int l = 0; l < FFT_LINES; l++) {
            make_row(plan, ws, filter, y + l, ws->lines + (size_t)l * (size_t)plan->info.fine_nx);
        }
        fft_complex(plan->rows, ws->lines, out);
        for (int l = 0; l < FFT_LINES; l++) { /* column nx is column 0 once more, for the mirror */
            double complex *row = out + (size_t)l * plan->stride;
            row[plan->info.fine_nx] = row[0];
        }
    }
}

bool pack_pair(const shear_plan *plan, shear_workspace *ws, const filter_map *filter,
               const double *galaxy, const double *noise, pack_failure *failure) {
    failure->in_noise = false;
    if (!image_load(&ws->galaxy, &plan->grid, galaxy, &failure->x, &failure->y)) {
        return false;
    }
    failure->in_noise = true;
    if (plan->settings.noise_correction &&
        !image_load(&ws->noise, &plan->grid, noise, &failure->x, &failure->y)) {
        return false;
    }
    transform_rows(plan, ws, filter);
    return true;
}

mode_columns transform_columns(const shear_plan *plan, shear_workspace *ws, int group) {
    const int first = group * FFT_LINES;
    fft_complex(plan->columns, ws->pair + first, ws->left);
    fft_complex(plan->mirrored, ws->pair + plan->info.fine_nx - first, ws->right);
    return (mode_columns){.left = ws->left, .right = ws->right, .group = group};
}
