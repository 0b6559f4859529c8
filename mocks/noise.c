/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "noise.h"

#include <gsl/gsl_randist.h>

/* Return the index of the pixel to which number i of the noise, in C order, belongs. */
static int noise_pixel(const noise_place *p, int i) {
    int x = i % p->nx;
    int y = i / p->nx;
    return p->rotated ? x * p->nx + (p->nx - 1 - y) : i;
}

void noise_sources(painter *p, random_sequence *r, double density, double amplitude, bool rotated) {
    double lo = -0.5 - p->reach;
    double width = p->nx + 2.0 * p->reach;
    double height = p->ny + 2.0 * p->reach;
    unsigned n = gsl_ran_poisson(&r->rng, density * width * height);
    for (unsigned k = 0; k < n; k++) {
        double x = lo + width * gsl_rng_uniform(&r->rng);
        double y = lo + height * gsl_rng_uniform(&r->rng);
        painter_point(p, amplitude, rotated ? p->nx - 1 - y : x, rotated ? x : y);
    }
}

void noise_photons(random_sequence *r, double background, double subtract, const noise_place *place,
                   double *image) {
    for (int i = 0; i < place->nx * place->ny; i++) {
        double *pixel = &image[noise_pixel(place, i)];
        random_item(r, (uint64_t)i);
        *pixel = gsl_ran_poisson(&r->rng, *pixel + background) - subtract;
    }
}

void noise_white(random_sequence *r, double sigma, const noise_place *place, double *image) {
    for (int i = 0; i < place->nx * place->ny; i++)
        image[noise_pixel(place, i)] += gsl_ran_gaussian_ziggurat(&r->rng, sigma);
}
