/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "gaussian.h"

#include "test.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>

void gaussian_draw(const gaussian *g, int nx, int ny, int per_pixel, double *out) {
    const double det = g->xx * g->yy - g->xy * g->xy;
    for (int j = 0; j < ny; j++) {
        for (int i = 0; i < nx; i++) {
            const double x = (double)i / per_pixel - g->x0;
            const double y = (double)j / per_pixel - g->y0;
            const double q = (g->yy * x * x - 2.0 * g->xy * x * y + g->xx * y * y) / det;
            out[(size_t)j * (size_t)nx + (size_t)i] = g->amplitude * exp(-0.5 * q);
        }
    }
}

/* P(k) = A^2 4 pi^2 |C| exp(-k^T Q k), Q = C - C_psf + beta^2: k is Gaussian with covariance S =
 * Q^-1 / 2. */
shear_row gaussian_row(const gaussian *g, const gaussian *psf, double beta) {
    const double qxx = g->xx - psf->xx + beta * beta;
    const double qyy = g->yy - psf->yy + beta * beta;
    const double qxy = g->xy - psf->xy;
    const double q = qxx * qyy - qxy * qxy;
    const double total =
        g->amplitude * g->amplitude * (g->xx * g->yy - g->xy * g->xy) * M_PI / sqrt(q);
    const double sxx = 0.5 * qyy / q;
    const double syy = 0.5 * qxx / q;
    const double sxy = -0.5 * qxy / q;
    const double mixed = sxx * syy + 2.0 * sxy * sxy;
    shear_row r = {.m20 = total * sxx,
                   .m02 = total * syy,
                   .m11 = total * sxy,
                   .m4 = total * (3.0 * sxx * sxx + 2.0 * mixed + 3.0 * syy * syy),
                   .u = total * (3.0 * sxx * sxx - 6.0 * mixed + 3.0 * syy * syy),
                   .v = total * 3.0 * sxy * (sxx - syy)};
    r.n1 = -0.5 * (r.m20 - r.m02);
    r.n2 = -r.m11;
    r.d = r.m20 + r.m02 - 0.5 * beta * beta * r.m4;
    return r;
}

void assert_near(double a, double b, double tolerance, double scale, const char *what) {
    if (!(fabs(a - b) <= tolerance * fabs(scale))) {
        print_error("%s: %.17g and %.17g differ by %.3g, allowed %.3g\n", what, a, b, fabs(a - b),
                    tolerance * fabs(scale));
        fail();
    }
}

void assert_rows_near(const shear_row *a, const shear_row *b, double tolerance) {
    const double second = fabs(b->m20) + fabs(b->m02);
    const double fourth = fabs(b->m4);
    assert_near(a->m20, b->m20, tolerance, second, "m20");
    assert_near(a->m02, b->m02, tolerance, second, "m02");
    assert_near(a->m11, b->m11, tolerance, second, "m11");
    assert_near(a->m4, b->m4, tolerance, fourth, "m4");
    assert_near(a->u, b->u, tolerance, fourth, "u");
    assert_near(a->v, b->v, tolerance, fourth, "v");
    assert_near(a->n1, b->n1, tolerance, second, "n1");
    assert_near(a->n2, b->n2, tolerance, second, "n2");
    assert_near(a->d, b->d, tolerance, second, "d");
}

void assert_same_rows(const shear_row *a, const shear_row *b, int n) {
    const size_t used = offsetof(shear_row, flags) + sizeof a->flags; /* what follows is padding */
    for (int i = 0; i < n; i++) {
        shear_row at_same_place = b[i];
        at_same_place.stamp = a[i].stamp;
        assert_memory_equal(&a[i], &at_same_place, used);
    }
}
