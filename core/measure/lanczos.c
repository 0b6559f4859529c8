/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/lanczos.h"

#include <math.h>

static double sinc(double t) {
    const double x = M_PI * t;
    return fabs(x) < 1e-8 ? 1.0 : sin(x) / x;
}

/* Integrate the even kernel times cos(w t) by Gauss's rule of eight points on intervals of half a
 * sample. */
static double integral(int n, double w) {
    static const double at[4] = {0.1834346424956498, 0.5255324099163290, 0.7966664774136267,
                                 0.9602898564975363};
    static const double weight[4] = {0.3626837833783620, 0.3137066458778873, 0.2223810344533745,
                                     0.1012285362903763};
    double sum = 0.0;
    for (int i = 0; i < 2 * n; i++) {
        for (int j = 0; j < 8; j++) {
            const double t = 0.5 * i + 0.25 * (1.0 + (j < 4 ? at[j] : -at[j - 4]));
            sum += weight[j % 4] * sinc(t) * sinc(t / n) * cos(w * t);
        }
    }
    return sum;
}

double lanczos_transform(int n, double w) {
    return integral(n, w) / integral(n, 0.0);
}
