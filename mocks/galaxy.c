/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "galaxy.h"

#include "random.h"

#include <gsl/gsl_math.h>
#include <math.h>

int galaxy_max_points(const shear_mock_spec *s) {
    return s->galaxy == SHEAR_MOCK_IRREGULAR ? s->steps : s->points;
}

/* Return the surface brightness at r, in units of R_G: eq. (10) of Zhang (2010). */
static double surface_brightness(const shear_mock_spec *s, double r) {
    double disk = r / s->disk_scale;
    double bulge = disk * s->bulge_ratio;
    return exp(-disk) + s->bulge_fraction * exp(-sqrt(sqrt(bulge)));
}

/* Draw a point of the unit disk from the face-on profile, exactly, by rejection from a uniform
 * disk. */
static void draw_disk_point(const shear_mock_spec *s, const gsl_rng *rng, double *x, double *y) {
    double peak = 1.0 + s->bulge_fraction;
    for (;;) {
        *x = 2.0 * gsl_rng_uniform(rng) - 1.0;
        *y = 2.0 * gsl_rng_uniform(rng) - 1.0;
        double height = peak * gsl_rng_uniform(rng);
        double r2 = *x * *x + *y * *y;
        if (r2 <= 1.0 && height < surface_brightness(s, sqrt(r2)))
            return;
    }
}

static int regular_points(const shear_mock_spec *s, const gsl_rng *rng, double *x, double *y) {
    double span = s->inclination_max_deg - s->inclination_min_deg;
    double inclination = (s->inclination_min_deg + span * gsl_rng_uniform(rng)) * (M_PI / 180.0);
    double position_angle = 2.0 * M_PI * gsl_rng_uniform(rng);
    double foreshortening = cos(inclination);
    double c = s->r_gal_px * cos(position_angle);
    double si = s->r_gal_px * sin(position_angle);
    for (int k = 0; k < s->points; k++) {
        double u, v;
        draw_disk_point(s, rng, &u, &v);
        v *= foreshortening;
        x[k] = c * u - si * v;
        y[k] = si * u + c * v;
    }
    return s->points;
}

static int irregular_points(const shear_mock_spec *s, const gsl_rng *rng, double *x, double *y) {
    double r2_max = s->r_gal_px * s->r_gal_px;
    double px = 0.0;
    double py = 0.0;
    int n = 0;
    for (int k = 0; k < s->steps; k++) {
        double direction = 2.0 * M_PI * gsl_rng_uniform(rng);
        px += s->step_px * cos(direction);
        py += s->step_px * sin(direction);
        if (px * px + py * py > r2_max) {
            px = 0.0;
            py = 0.0;
            continue;
        }
        x[n] = px;
        y[n] = py;
        n++;
    }
    return n;
}

int galaxy_points(const shear_mock_spec *s, int64_t index, double *x, double *y) {
    random_sequence r;
    random_begin(&r, s->seed, RANDOM_GALAXY, (uint64_t)index, 0);
    if (s->galaxy == SHEAR_MOCK_IRREGULAR)
        return irregular_points(s, &r.rng, x, y);
    return regular_points(s, &r.rng, x, y);
}

void galaxy_rotate(int eighths, int n, double *x, double *y) {
    for (int k = 0; k < n && eighths % 2 == 1; k++) {
        double u = M_SQRT1_2 * (x[k] - y[k]);
        y[k] = M_SQRT1_2 * (x[k] + y[k]);
        x[k] = u;
    }
    for (int quarter = 0; quarter < eighths / 2; quarter++) {
        for (int k = 0; k < n; k++) {
            double u = -y[k];
            y[k] = x[k];
            x[k] = u;
        }
    }
}

void galaxy_lens(double g1, double g2, int n, double *x, double *y) {
    for (int k = 0; k < n; k++) {
        double u = (1.0 + g1) * x[k] + g2 * y[k];
        y[k] = g2 * x[k] + (1.0 - g1) * y[k];
        x[k] = u;
    }
}
