/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "exposure/light.h"

#include <gsl/gsl_math.h>
#include <math.h>

/* Half-light radius of an exponential disk over its scale. */
static const double half_light = 1.6783469900166605;

static const double exponents[] = {2.5, 3.5, 4.5}; /* of enum shear_mock_moffat */

/* A 2 x 2 matrix. */
typedef struct matrix {
    double xx, xy, yx, yy;
} matrix;

static matrix times(matrix a, matrix b) {
    return (matrix){a.xx * b.xx + a.xy * b.yx, a.xx * b.xy + a.xy * b.yy, a.yx * b.xx + a.yy * b.yx,
                    a.yx * b.xy + a.yy * b.yy};
}

/* Return the shear (1 + g1, g2; g2, 1 - g1) that conserves the area, times `scale`. */
static matrix shear(double g1, double g2, double scale) {
    const double s = scale / sqrt(1.0 - g1 * g1 - g2 * g2);
    return (matrix){s * (1.0 + g1), s * g2, s * g2, s * (1.0 - g1)};
}

static matrix inverse_jacobian(const double j[4]) {
    const double det = j[0] * j[3] - j[1] * j[2];
    return (matrix){j[3] / det, -j[1] / det, -j[2] / det, j[0] / det};
}

/* Return M M'. */
static quadratic square(matrix m) {
    return (quadratic){m.xx * m.xx + m.xy * m.xy, m.xx * m.yx + m.xy * m.yy,
                       m.yx * m.yx + m.yy * m.yy};
}

static double evaluate(const quadratic *q, double kx, double ky) {
    return q->xx * kx * kx + 2.0 * q->xy * kx * ky + q->yy * ky * ky;
}

psf_place light_psf(const shear_mock_exposure *e, const focal_plane *f, double dx, double dy) {
    const double u = dx / f->half_x;
    const double v = dy / f->half_y;
    const double change = e->psf_variation;
    return (psf_place){.fwhm = e->fwhm_px * (1.0 + change * (0.35 * u - 0.25 * v +
                                                             0.2 * (u * u + v * v - 2.0 / 3.0))),
                       .e1 = e->psf_e1 + 0.5 * change * (0.5 * u + 0.3 * (u * u - v * v)),
                       .e2 = e->psf_e2 + 0.5 * change * (0.4 * v + 0.6 * u * v)};
}

light light_of(const shear_mock_exposure *e, const scene_object *o, const psf_place *psf) {
    const double beta = exponents[e->moffat];
    const double alpha = 0.5 * psf->fwhm / sqrt(pow(2.0, 1.0 / beta) - 1.0);
    light l = {.flux = o->flux, .psf = square(shear(psf->e1, psf->e2, alpha)), .moffat = e->moffat};
    if (!o->is_star) {
        const matrix shape = shear(o->e1, o->e2, o->r_half / half_light);
        const matrix on_sky = times(shear(e->g1, e->g2, 1.0), shape);
        l.galaxy = square(times(inverse_jacobian(o->sky.j), on_sky));
    }
    return l;
}

/* The transform of (1 + r^2)^-b is proportional to x^(b-1) K_(b-1)(x). */
static double moffat_transform(enum shear_mock_moffat moffat, double x) {
    switch (moffat) {
    case SHEAR_MOCK_MOFFAT_25:
        return (1.0 + x) * exp(-x);
    case SHEAR_MOCK_MOFFAT_35:
        return (1.0 + x * (1.0 + x / 3.0)) * exp(-x);
    default:
        return (1.0 + x * (1.0 + x * (0.4 + x / 15.0))) * exp(-x);
    }
}

static double sinc(double x) {
    return fabs(x) < 1e-8 ? 1.0 : sin(x) / x;
}

double light_pixel(double k) {
    return sinc(0.5 * k);
}

double light_transform(const light *l, double kx, double ky) {
    const double q = 1.0 + evaluate(&l->galaxy, kx, ky);
    return moffat_transform(l->moffat, sqrt(evaluate(&l->psf, kx, ky))) / (q * sqrt(q));
}

/* Return the longest semi-axis of the form's ellipse. */
static double longest(const quadratic *q) {
    const double mean = 0.5 * (q->xx + q->yy);
    return sqrt(mean + hypot(0.5 * (q->xx - q->yy), q->xy));
}

/* A convolution of two profiles reaches at most as far as both together; the Moffat's wing is
 * (b - 1) / (pi alpha^2) (r / alpha)^(-2 b). */
double light_reach(const light *l, double threshold) {
    const double beta = exponents[l->moffat];
    const double alpha = longest(&l->psf);
    const double peak = l->flux * (beta - 1.0) / (M_PI * alpha * alpha);
    const double scale = longest(&l->galaxy);
    return alpha * pow(fmax(1.0, peak / threshold), 0.5 / beta) +
           scale * log(fmax(1.0, peak / threshold));
}
