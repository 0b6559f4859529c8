/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "plot/array.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Find the first and the number of the samples within `reach` of the origin; at least one. */
static void within_reach(int n, double origin, double step, double reach, int *first, int *count) {
    double lo = 0.0;
    double hi = n - 1.0;
    if (isfinite(reach)) {
        lo = fmin(fmax(ceil(origin - reach / step), 0.0), n - 1.0);
        hi = fmin(fmax(floor(origin + reach / step), lo), n - 1.0);
    }
    *first = (int)lo;
    *count = (int)(hi - lo) + 1;
}

static shear_range edges(int first, int count, double origin, double step) {
    return (shear_range){(first - 0.5 - origin) * step, (first + count - 0.5 - origin) * step};
}

int plot_cut_init(plot_cut *cut, const double *array, const plot_lattice *lattice, double reach,
                  shear_error *err) {
    int x = 0;
    int y = 0;
    *cut = (plot_cut){0};
    within_reach(lattice->nx, lattice->x0, lattice->step_x, reach, &x, &cut->nx);
    within_reach(lattice->ny, lattice->y0, lattice->step_y, reach, &y, &cut->ny);
    cut->x = edges(x, cut->nx, lattice->x0, lattice->step_x);
    cut->y = edges(y, cut->ny, lattice->y0, lattice->step_y);
    cut->pixels = calloc((size_t)cut->nx * (size_t)cut->ny, sizeof *cut->pixels);
    if (cut->pixels == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "no memory for a picture");
    for (int row = 0; row < cut->ny; row++) {
        memcpy(cut->pixels + (size_t)row * (size_t)cut->nx,
               array + (size_t)(y + row) * (size_t)lattice->nx + x,
               (size_t)cut->nx * sizeof *array);
    }
    return SHEAR_OK;
}

void plot_cut_deinit(plot_cut *cut) {
    free(cut->pixels);
    *cut = (plot_cut){0};
}

shear_range plot_cut_range(const plot_cut *cut) {
    return shear_range_of(cut->pixels, (size_t)cut->nx * (size_t)cut->ny);
}

int plot_radial_mean(double *out, int bins, double width, const double *array,
                     const plot_lattice *lattice, shear_error *err) {
    double *number = calloc((size_t)bins, sizeof *number);
    if (number == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "no memory for a profile");
    memset(out, 0, (size_t)bins * sizeof *out);
    for (int j = 0; j < lattice->ny; j++) {
        const double y = (j - lattice->y0) * lattice->step_y;
        for (int i = 0; i < lattice->nx; i++) {
            const double x = (i - lattice->x0) * lattice->step_x;
            const double bin = floor(hypot(x, y) / width + 0.5);
            if (bin < bins) {
                out[(int)bin] += array[(size_t)j * (size_t)lattice->nx + (size_t)i];
                number[(int)bin] += 1.0;
            }
        }
    }
    for (int b = 0; b < bins; b++)
        out[b] = number[b] > 0.0 ? out[b] / number[b] : NAN;
    free(number);
    return SHEAR_OK;
}

void plot_core_centre(const double *array, int nx, int ny, double *x, double *y) {
    const double peak = shear_range_of(array, (size_t)nx * (size_t)ny).hi;
    double sum = 0.0;
    double sum_x = 0.0;
    double sum_y = 0.0;
    for (int j = 0; j < ny && peak > 0.0; j++) {
        for (int i = 0; i < nx; i++) {
            if (array[(size_t)j * (size_t)nx + (size_t)i] > exp(-0.5) * peak) {
                sum += 1.0;
                sum_x += i;
                sum_y += j;
            }
        }
    }
    *x = sum > 0.0 ? sum_x / sum : (nx - 1) / 2.0;
    *y = sum > 0.0 ? sum_y / sum : (ny - 1) / 2.0;
}
