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
    return pixels == 0 ? 0 : pixels < MESH_SIDE ? 1 : pixels / MESH_SIDE;
}

void noise_mesh_place(noise_mesh *m, int nx, int ny, int split_x, arena *a) {
    m->nx = nx;
    m->split_x = split_x;
    m->split = meshes_of(split_x);
    m->columns = m->split + meshes_of(nx - split_x);
    m->rows = (ny + MESH_SIDE - 1) / MESH_SIDE;
    const size_t n = (size_t)m->columns * (size_t)m->rows;
    m->level = arena_doubles(a, n);
    m->scale = arena_doubles(a, n);
    m->scratch = arena_doubles(a, n);
    m->samples = arena_take(a, MOST_SAMPLES * sizeof *m->samples);
}

int noise_mesh_column(const noise_mesh *m, int x) {
    const int right = m->nx - m->split_x;
    if (x < m->split_x)
        return (int)((int64_t)x * m->split / m->split_x);
    return m->split + (int)((int64_t)(x - m->split_x) * (m->columns - m->split) / right);
}

int noise_mesh_row(const noise_mesh *m, int y) {
    return y / MESH_SIDE < m->rows ? y / MESH_SIDE : m->rows - 1;
}

/* Return the first pixel column of a column of meshes; nx behind the last. */
static int mesh_start(const noise_mesh *m, int column) {
    const int right = m->columns - m->split;
    if (column < m->split)
        return (int)(((int64_t)column * m->split_x + m->split - 1) / m->split);
    const int64_t x = (int64_t)(column - m->split) * (m->nx - m->split_x);
    return m->split_x + (int)((x + right - 1) / right);
}

/* Take a pixel as the next sample if it is free. Whether the chip has a map of sigma is what its
 * first free pixel says; others that differ are left out. */
static int take(noise_mesh *m, const mesh_pixels *p, int x, int y, int n) {
    const size_t at = (size_t)y * (size_t)m->nx + (size_t)x;
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

void noise_mesh_enter(noise_mesh *m, int row, const mesh_pixels *pixels) {
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
    const int first = column < m->split ? 0 : m->split;
    const int end = column < m->split ? m->split : m->columns;
    double sum = 0.0;
    int n = 0;
    for (int j = row - 1; j <= row + 1; j++) {
        for (int i = column - 1; i <= column + 1; i++) {
            if (j < 0 || j >= m->rows || i < first || i >= end)
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
