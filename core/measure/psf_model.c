/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/psf_model.h"

#include "base/cleanup.h"
#include "base/simd.h"
#include "measure/power_tail.h"
#include "shear/plan.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

SHEAR_SIMD static void add(const double *plane, double factor, size_t n, double *sum) {
#pragma omp simd
    for (size_t i = 0; i < n; i++)
        sum[i] += factor * plane[i];
}

void psf_model_sum(const double *samples, int terms, size_t size, const double *c, double *image) {
    memset(image, 0, size * sizeof *image);
    for (int t = 0; t < terms; t++)
        add(samples + (size_t)t * size, c[t], size, image);
}

/* A transform along one axis, from modes about the middle to places about it. */
typedef struct axis_transform {
    int n;
    double *cosine, *sine; /* [n] of 2 pi i/n */
    double *line;          /* [n][re, im] */
} axis_transform;

static void begin_axis(axis_transform *a, int n) {
    a->n = n;
    for (int i = 0; i < n; i++) {
        a->cosine[i] = cos(2.0 * M_PI * i / n);
        a->sine[i] = sin(2.0 * M_PI * i / n);
    }
}

/* Transform a line in place; its elements are `stride` apart. */
static void transform(const axis_transform *a, double *re, double *im, size_t stride) {
    const int n = a->n;
    const int middle = n / 2;
    for (int x = 0; x < n; x++) {
        double sum_re = 0.0;
        double sum_im = 0.0;
        for (int j = 0; j < n; j++) {
            const int turn = ((x - middle) * (j - middle) % n + n) % n;
            const size_t at = (size_t)j * stride;
            sum_re += re[at] * a->cosine[turn] - im[at] * a->sine[turn];
            sum_im += re[at] * a->sine[turn] + im[at] * a->cosine[turn];
        }
        a->line[2 * x] = sum_re;
        a->line[2 * x + 1] = sum_im;
    }
    for (int x = 0; x < n; x++) {
        re[(size_t)x * stride] = a->line[2 * x];
        im[(size_t)x * stride] = a->line[2 * x + 1];
    }
}

/* Turn |W|^2 into the image of W >= 0. With `noise`, that of |W|^2 remains. */
static bool image_of_power(const shear_psf_model *m, bool noise, double *image) {
    const size_t nx = (size_t)m->nx;
    const size_t ny = (size_t)m->ny;
    const size_t longest = nx > ny ? nx : ny;
    CLEANUP(release_free) double *im = calloc(nx * ny + 4 * longest, sizeof *im);
    if (im == NULL)
        return false;
    axis_transform a = {.cosine = im + nx * ny};
    a.sine = a.cosine + longest;
    a.line = a.sine + longest;
    if (!noise)
        power_tail_fill(image, m->nx, m->ny);
    for (size_t i = 0; i < nx * ny; i++)
        image[i] = sqrt(fmax(0.0, image[i]));
    begin_axis(&a, m->nx);
    for (size_t y = 0; y < ny; y++)
        transform(&a, image + y * nx, im + y * nx, 1);
    begin_axis(&a, m->ny);
    for (size_t x = 0; x < nx; x++)
        transform(&a, image + x, im + x, nx);
    return true;
}

static bool draw(const shear_psf_model *m, const double *c, bool noise, double *image) {
    psf_model_sum(m->samples, m->terms, (size_t)m->nx * (size_t)m->ny, c, image);
    return m->axes != SHEAR_PSF_AXES_MODES || image_of_power(m, noise, image);
}

bool psf_model_draw(const shear_psf_model *m, const double *c, double *image) {
    return draw(m, c, false, image);
}

double psf_model_sampling(const shear_psf_model *m, double scale) {
    return m->axes == SHEAR_PSF_AXES_MODES ? 1.0
           : m->axes == SHEAR_PSF_AXES_SKY ? scale / m->step
                                           : 1.0 / m->step;
}

/* Draw the PSF into new memory; *image is NULL on error. */
static int draw_new(double **image, const shear_psf_model *m, const double *c, bool noise,
                    shear_error *err) {
    *image = calloc((size_t)m->nx * (size_t)m->ny, sizeof **image);
    if (*image != NULL && draw(m, c, noise, *image))
        return SHEAR_OK;
    free(*image);
    *image = NULL;
    return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a PSF of %d x %d samples", m->nx,
                      m->ny);
}

static int examine(shear_psf_quality *q, const shear_psf_model *m, const double *c, double scale,
                   bool noise, shear_error *err) {
    CLEANUP(release_free) double *image = NULL;
    TRY(draw_new(&image, m, c, noise, err));
    return shear_psf_examine(q, image, m->nx, m->ny, psf_model_sampling(m, scale), err);
}

int shear_psf_model_examine(shear_psf_quality *q, const shear_psf_model *m, const double *terms,
                            double scale, shear_error *err) {
    shear_psf_quality noisy;
    TRY(examine(q, m, terms, scale, false, err));
    if (m->axes != SHEAR_PSF_AXES_MODES)
        return SHEAR_OK;
    TRY(examine(&noisy, m, terms, scale, true, err));
    q->noise = noisy.noise;
    return SHEAR_OK;
}

int shear_psf_model_radius(const shear_psf_model *m, const double *terms, double scale,
                           double *r_psf_px, shear_error *err) {
    CLEANUP(release_free) double *image = NULL;
    TRY(draw_new(&image, m, terms, false, err));
    return shear_psf_radius(image, m->nx, m->ny, psf_model_sampling(m, scale), r_psf_px, err);
}
