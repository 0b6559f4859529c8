/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Bias from stamps that are too small for beta: shear_plan_periodic_bias().
 *
 * A transform treats its stamp as one cell of a periodic lattice. The moments are derivatives of
 * the target image's autocorrelation at 0, and therefore include those of all lattice points: at a
 * distance of one stamp side the autocorrelation should be negligible. For a Gaussian it is known
 * in closed form. */
#include "shear/plan.h"

#include <math.h>

/* Along one axis: the autocorrelation exp(-a x^2), and its second and fourth derivatives over
 * it. */
typedef struct derivatives {
    double value, second, fourth;
} derivatives;

static derivatives along(double x, double a) {
    const double x2 = a * x * x;
    return (derivatives){.value = exp(-x2),
                         .second = 2.0 * a * (2.0 * x2 - 1.0),
                         .fourth = 4.0 * a * a * (3.0 - 12.0 * x2 + 4.0 * x2 * x2)};
}

/* Return the measured g1 of a Gaussian galaxy of scale radius s under the shear g. */
static double measured(const shear_plan_info *plan, double s, double g) {
    enum { FAR = 4 };
    const double beta2 = plan->beta_px * plan->beta_px;
    const double ax = 0.25 / (s * s * (1.0 + g) * (1.0 + g) + beta2);
    const double ay = 0.25 / (s * s * (1.0 - g) * (1.0 - g) + beta2);
    double m20 = 0.0;
    double m02 = 0.0;
    double m4 = 0.0;
    for (int i = -FAR; i <= FAR; i++) {
        for (int j = -FAR; j <= FAR; j++) {
            const derivatives x = along((double)i * plan->geometry.nx, ax);
            const derivatives y = along((double)j * plan->geometry.ny, ay);
            const double c = x.value * y.value;
            m20 -= x.second * c;
            m02 -= y.second * c;
            m4 += (x.fourth + y.fourth + 2.0 * x.second * y.second) * c;
        }
    }
    return -0.5 * (m20 - m02) / (m20 + m02 - 0.5 * beta2 * m4);
}

double shear_plan_periodic_bias(const shear_plan_info *plan) {
    static const double size = 1.5; /* of the galaxy, in units of R_PSF */
    static const double g = 0.02;
    const double s = size * plan->r_psf_px;
    const double plus = measured(plan, s, g);
    const double minus = measured(plan, s, -g);
    return fmax(fabs((plus - minus) / (2.0 * g) - 1.0), fabs(0.5 * (plus + minus)));
}
