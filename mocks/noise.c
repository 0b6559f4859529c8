/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "noise.h"

#include <gsl/gsl_randist.h>

void noise_sources(struct painter *p, struct random *r, double density, double amplitude) {
    double lo = -0.5 - p->reach;
    double width = p->nx + 2.0 * p->reach;
    double height = p->ny + 2.0 * p->reach;
    unsigned n = gsl_ran_poisson(&r->rng, density * width * height);
    for (unsigned k = 0; k < n; k++) {
        double x = lo + width * gsl_rng_uniform(&r->rng);
        double y = lo + height * gsl_rng_uniform(&r->rng);
        painter_point(p, amplitude, x, y);
    }
}

void noise_photons(struct random *r, double background, double subtract, int n, double *image) {
    for (int i = 0; i < n; i++) {
        random_item(r, (uint64_t)i);
        image[i] = gsl_ran_poisson(&r->rng, image[i] + background) - subtract;
    }
}

void noise_white(struct random *r, double sigma, int n, double *image) {
    for (int i = 0; i < n; i++) {
        image[i] += gsl_ran_gaussian_ziggurat(&r->rng, sigma);
    }
}
