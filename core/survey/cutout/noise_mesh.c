/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/cutout/noise_mesh.h"

#include "base/sort.h"
#include "survey/cutout/plane.h"

#include <assert.h>
#include <math.h>
#include <string.h>

enum {
    STEP = BOX_CELL, /* 256 of a mesh's pixels are looked at */
    MOST_SAMPLES = (2 * MESH_SIDE / STEP + 1) * (MESH_SIDE / STEP),
    LEAST_SAMPLES = 48,
    ORDERED = 32, /* samples that make the first guess */
    PASSES = 4
};
static const double clip = 3.0;
static const double clipped_variance = 0.973338; /* of a normal distribution cut at 3 sigma */
static const double quartiles = 1.34898;         /* their distance, in standard deviations */

typedef struct mesh_sample {
    double x, y, value;
    double inverse; /* 1 / sigma */
} mesh_sample;

static int meshes_of(int pixels) {
    return pixels < MESH_SIDE ? 1 : pixels / MESH_SIDE;
}

/* Number the meshes amplifier by amplifier. */
static void number(noise_mesh *m) {
    for (int i = 0; i < m->x.parts; i++) {
        const int width = amplifier_axis_start(&m->x, i + 1) - amplifier_axis_start(&m->x, i);
        m->first_column[i + 1] = m->first_column[i] + meshes_of(width);
    }
    for (int i = 0; i < m->y.parts; i++) {
        const int start = amplifier_axis_start(&m->y, i) / MESH_SIDE;
        const int last = (amplifier_axis_start(&m->y, i + 1) - 1) / MESH_SIDE;
        m->first_row[i + 1] = m->first_row[i] + last - start + 1;
    }
    m->columns = m->first_column[m->x.parts];
    m->rows = m->first_row[m->y.parts];
}

void noise_mesh_place(noise_mesh *m, arena *a) {
    number(m);
    const size_t n = (size_t)m->columns * (size_t)m->rows;
    m->level = arena_doubles(a, n);
    m->scale = arena_doubles(a, n);
    m->scratch = arena_doubles(a, n);
    m->samples = arena_take(a, MOST_SAMPLES * sizeof *m->samples);
}

/* The meshes of an amplifier: its columns of pixels, in n equal parts. */
typedef struct mesh_columns {
    int start, width; /* pixels */
    int first, n;     /* meshes */
} mesh_columns;

static mesh_columns columns_of(const noise_mesh *m, int amplifier) {
    const int start = amplifier_axis_start(&m->x, amplifier);
    return (mesh_columns){
        .start = start,
        .width = amplifier_axis_start(&m->x, amplifier + 1) - start,
        .first = m->first_column[amplifier],
        .n = m->first_column[amplifier + 1] - m->first_column[amplifier],
    };
}

int noise_mesh_column(const noise_mesh *m, int x) {
    const mesh_columns c = columns_of(m, amplifier_axis_at(&m->x, x));
    return c.first + (int)((int64_t)(x - c.start) * c.n / c.width);
}

int noise_mesh_row(const noise_mesh *m, int y) {
    const int within = y < m->y.pixels ? y : m->y.pixels - 1;
    const int amplifier = amplifier_axis_at(&m->y, within);
    const int start = amplifier_axis_start(&m->y, amplifier);
    return m->first_row[amplifier] + within / MESH_SIDE - start / MESH_SIDE;
}

/* Return the amplifier of a mesh, whose column or row is given. */
static int amplifier_of(const int *first, int mesh) {
    int i = 0;
    while (first[i + 1] <= mesh)
        i++;
    return i;
}

/* Return the first pixel column of a column of meshes. */
static int mesh_start(const noise_mesh *m, int column) {
    if (column == m->columns)
        return m->x.pixels;
    const mesh_columns c = columns_of(m, amplifier_of(m->first_column, column));
    return c.start + (int)(((int64_t)(column - c.first) * c.width + c.n - 1) / c.n);
}

/* Take a pixel as the next sample if it is free. Whether the chip has a map of sigma is what its
 * first free pixel says; others that differ are left out. */
static int take(noise_mesh *m, const mesh_pixels *p, int x, int y, int n) {
    const size_t at = (size_t)y * (size_t)m->x.pixels + (size_t)x;
    if (p->defect[at] != 0 || box_map_touched(p->map, x, p->y + y))
        return n;
    const bool known = isfinite(p->sigma[at]) && p->sigma[at] > 0.0F;
    if (!m->measured) {
        m->measured = true;
        m->map = known;
    }
    if (m->map && !known)
        return n;
    m->samples[n] = (mesh_sample){x, y, p->value[at], m->map ? 1.0 / (double)p->sigma[at] : 1.0};
    return n + 1;
}

static int take_samples(noise_mesh *m, int column, const mesh_pixels *p) {
    const int start = mesh_start(m, column);
    const int end = mesh_start(m, column + 1);
    int n = 0;
    for (int y = 0; y < p->n; y += STEP) {
        for (int x = start; x < end; x += STEP)
            n = take(m, p, x, y, n);
    }
    assert(n <= MOST_SAMPLES);
    return n;
}

/* Put the samples' origin into their middle, and their median value to 0. Return a first guess of
 * the standard deviation, over the pixels' own; INFINITY: more than half of them are equal. */
static double centre(mesh_sample *s, int n) {
    double value[ORDERED];
    for (int i = 0; i < ORDERED; i++)
        value[i] = s[(int64_t)i * n / ORDERED].value;
    sort_doubles(value, ORDERED);
    const double middle = value[ORDERED / 2];
    const double range = (value[ORDERED * 3 / 4] - value[ORDERED / 4]) / quartiles;
    const mesh_sample origin = s[n / 2];
    for (int i = 0; i < n; i++) {
        s[i].x -= origin.x;
        s[i].y -= origin.y;
        s[i].value -= middle;
    }
    return range > 0.0 ? range * origin.inverse : INFINITY;
}

/* Fit a plane to the samples within 3 sigma of the last one; return the new sigma. */
static double refit(const mesh_sample *s, int n, plane *p, double sigma) {
    plane_sums sums = {0};
    double count = 0.0;
    for (int i = 0; i < n; i++) {
        const double rest = (s[i].value - plane_at(p, s[i].x, s[i].y)) * s[i].inverse;
        if (fabs(rest) <= clip * sigma) {
            plane_add(&sums, s[i].x, s[i].y, s[i].value, s[i].inverse * s[i].inverse);
            count++;
        }
    }
    double chi2;
    if (count <= LEAST_SAMPLES / 2 || !plane_fit(&sums, p, &chi2))
        return NAN;
    return sqrt(chi2 / (count - 3.0) / (isinf(sigma) ? 1.0 : clipped_variance));
}

void noise_mesh_enter(noise_mesh *m, const mesh_pixels *pixels) {
    const int row = noise_mesh_row(m, pixels->y);
    for (int column = 0; column < m->columns; column++) {
        const size_t at = (size_t)row * (size_t)m->columns + (size_t)column;
        mesh_sample *s = m->samples;
        const int n = take_samples(m, column, pixels);
        double sigma = NAN;
        if (n >= LEAST_SAMPLES) {
            sigma = centre(s, n);
            plane p = {0};
            for (int i = 0; i < PASSES; i++)
                sigma = refit(s, n, &p, sigma);
        }
        double squares = 0.0;
        for (int i = 0; i < n; i++)
            squares += 1.0 / (s[i].inverse * s[i].inverse);
        m->scale[at] = isfinite(sigma) ? sigma : NAN;
        m->level[at] = m->scale[at] * sqrt(squares / n);
    }
}

/* Return the mean over the 3 x 3 meshes about one, on its amplifier; NaN if none is known. */
static double mean_about(const noise_mesh *m, const double *v, int row, int column) {
    const int *x = m->first_column + amplifier_of(m->first_column, column);
    const int *y = m->first_row + amplifier_of(m->first_row, row);
    double sum = 0.0;
    int n = 0;
    for (int j = row - 1; j <= row + 1; j++) {
        for (int i = column - 1; i <= column + 1; i++) {
            if (j < y[0] || j >= y[1] || i < x[0] || i >= x[1])
                continue;
            const double value = v[(size_t)j * (size_t)m->columns + (size_t)i];
            sum += isnan(value) ? 0.0 : value;
            n += !isnan(value);
        }
    }
    return n == 0 ? NAN : sum / n;
}

/* Replace all values, or the unknown ones only, by the mean about them. Return how many unknown
 * ones became known. */
static int spread(noise_mesh *m, double *v, bool all) {
    const size_t n = (size_t)m->columns * (size_t)m->rows;
    int known = 0;
    memcpy(m->scratch, v, n * sizeof *v);
    for (int j = 0; j < m->rows; j++) {
        for (int i = 0; i < m->columns; i++) {
            const size_t at = (size_t)j * (size_t)m->columns + (size_t)i;
            if (!all && !isnan(m->scratch[at]))
                continue;
            v[at] = mean_about(m, m->scratch, j, i);
            known += isnan(m->scratch[at]) && !isnan(v[at]);
        }
    }
    return known;
}

void noise_mesh_close(noise_mesh *m) {
    double *const maps[2] = {m->level, m->scale};
    for (int i = 0; i < 2; i++) {
        while (spread(m, maps[i], false) > 0) {
        }
        spread(m, maps[i], true);
    }
}
