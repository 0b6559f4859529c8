/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/psf/mode_power.h"

#include "base/arena.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>

static void place(mode_power *m, arena *a) {
    const size_t s = (size_t)m->stamp;
    m->along_x = arena_doubles(a, 2 * s * (size_t)m->nx);
    m->along_y = arena_doubles(a, 2 * s * (size_t)m->ny);
    m->rows = arena_doubles(a, 2 * s * (size_t)m->ny);
}

static void fill(double *table, int n, double step, int stamp) {
    const double first = -2.0 * acos(-1.0) * step / stamp;
    for (int j = 0; j < stamp; j++) {
        for (int i = 0; i < n; i++) {
            *table++ = cos(first * (j - stamp / 2) * i);
            *table++ = sin(first * (j - stamp / 2) * i);
        }
    }
}

bool mode_power_init(mode_power *m, int nx, int ny, double step, int stamp) {
    *m = (mode_power){.nx = nx, .ny = ny, .stamp = stamp};
    arena a = {0};
    place(m, &a);
    m->memory = arena_allocate(&a);
    if (m->memory == NULL)
        return false;
    place(m, &a);
    fill(m->along_x, nx, step, stamp);
    fill(m->along_y, ny, step, stamp);
    return true;
}

void mode_power_deinit(mode_power *m) {
    free(m->memory);
    m->memory = NULL;
}

/* Transform the rows: rows[y][jx]. */
static void transform_rows(mode_power *m, const double *image) {
    double *out = m->rows;
    for (int y = 0; y < m->ny; y++, image += m->nx) {
        const double *e = m->along_x;
        for (int j = 0; j < m->stamp; j++, e += 2 * (ptrdiff_t)m->nx) {
            double re = 0.0;
            double im = 0.0;
            for (int x = 0; x < m->nx; x++) {
                re += image[x] * e[2 * x];
                im += image[x] * e[2 * x + 1];
            }
            *out++ = re;
            *out++ = im;
        }
    }
}

static double power_of_mode(const mode_power *m, int jx, int jy) {
    const double *e = m->along_y + 2 * (ptrdiff_t)jy * m->ny;
    const double *row = m->rows + 2 * (ptrdiff_t)jx;
    double re = 0.0;
    double im = 0.0;
    for (int y = 0; y < m->ny; y++, e += 2, row += 2 * (ptrdiff_t)m->stamp) {
        re += row[0] * e[0] - row[1] * e[1];
        im += row[0] * e[1] + row[1] * e[0];
    }
    return re * re + im * im;
}

void mode_power_of(mode_power *m, const double *image, double *power) {
    transform_rows(m, image);
    for (int jy = 0; jy < m->stamp; jy++) {
        for (int jx = 0; jx < m->stamp; jx++)
            *power++ = power_of_mode(m, jx, jy);
    }
}
