/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "exposure/scene.h"

#include "random.h"

#include <gsl/gsl_math.h>
#include <gsl/gsl_randist.h>
#include <math.h>
#include <stdlib.h>

/* Galaxies in a grid leave their cell's centre by at most this part of the spacing. */
static const double jitter = 0.1;
/* Galaxies of a cell are sheared about its centre: those of the whole field would move by many
 * pixels, and have other noise. */
static const double cell_px = 400.0;
static const double max_ellipticity = 0.7;

static uint64_t index_of(int chip, int64_t number) {
    return (uint64_t)chip << 40 | (uint64_t)number;
}

/* Return a flux with N(> F) proportional to F^-slope between min and max. */
static double draw_flux(const gsl_rng *rng, double min, double max, double slope) {
    const double u = gsl_rng_uniform(rng);
    if (slope < 1e-6)
        return min * pow(max / min, u);
    return min * pow(1.0 - u * (1.0 - pow(max / min, -slope)), -1.0 / slope);
}

static void draw_star(const shear_mock_exposure *e, int chip, int64_t number, scene_object *o) {
    random_sequence r;
    random_begin(&r, e->seed, RANDOM_EXPOSURE_STAR, index_of(chip, number), 0);
    o->is_star = true;
    o->flux = draw_flux(&r.rng, e->star_flux_min, e->star_flux_max, e->star_flux_slope);
}

/* Rotated copies follow each other, and differ in the angle only. */
static void draw_galaxy(const shear_mock_exposure *e, int chip, int64_t number, scene_object *o) {
    const int copies = e->fours ? 4 : 1;
    const double angle = (double)(number % copies) * M_PI_2; /* spin 2: twice 45 degrees */
    random_sequence r;
    random_begin(&r, e->seed, RANDOM_EXPOSURE_GALAXY, index_of(chip, number / copies), 0);
    o->flux = draw_flux(&r.rng, e->flux_min, e->flux_max, e->flux_slope);
    o->r_half = e->r_half_min + (e->r_half_max - e->r_half_min) * gsl_rng_uniform(&r.rng);
    double e1, e2;
    do {
        e1 = gsl_ran_gaussian_ziggurat(&r.rng, e->ellipticity);
        e2 = gsl_ran_gaussian_ziggurat(&r.rng, e->ellipticity);
    } while (hypot(e1, e2) > max_ellipticity);
    o->e1 = cos(angle) * e1 - sin(angle) * e2;
    o->e2 = sin(angle) * e1 + cos(angle) * e2;
}

/* The places of a chip: a grid of cells, or `columns` 0 and as many places as objects. */
typedef struct places {
    int64_t columns, rows;
    int64_t galaxies, stars; /* of random places */
} places;

static places places_of(const shear_mock_exposure *e) {
    if (e->spacing_px > 0.0) {
        return (places){.columns = (int64_t)(e->nx / e->spacing_px),
                        .rows = (int64_t)(e->ny / e->spacing_px)};
    }
    const double side = e->pixel_scale_arcsec / 60.0;
    const double area = side * side * e->nx * e->ny;
    return (places){.galaxies = llround(e->galaxies * area), .stars = llround(e->stars * area)};
}

static int64_t count(const places *p) {
    return p->columns * p->rows + p->galaxies + p->stars;
}

/* Set the place of object i, and return whether it is a star. */
static bool put(const shear_mock_exposure *e, const places *p, int chip, int64_t i,
                scene_object *o) {
    random_sequence r;
    random_begin(&r, e->seed, RANDOM_EXPOSURE_PLACE, index_of(chip, i), 0);
    const double u = gsl_rng_uniform(&r.rng);
    const double v = gsl_rng_uniform(&r.rng);
    if (p->columns == 0) {
        o->x = 0.5 + u * e->nx;
        o->y = 0.5 + v * e->ny;
        return i >= p->galaxies;
    }
    const double column = (double)(i % p->columns) - 0.5 * (double)(p->columns - 1);
    const double row = (double)(i / p->columns) - 0.5 * (double)(p->rows - 1);
    o->x = 0.5 * (e->nx + 1) + e->spacing_px * (column + jitter * (2.0 * u - 1.0));
    o->y = 0.5 * (e->ny + 1) + e->spacing_px * (row + jitter * (2.0 * v - 1.0));
    return gsl_rng_uniform(&r.rng) * (e->galaxies + e->stars) < e->stars;
}

/* Shear an object's place about the centre of its cell, on the sky. */
static void shear_place(const shear_mock_exposure *e, const focal_plane *f, const chip_place *chip,
                        scene_object *o) {
    const double cx = 0.5 + cell_px * (floor((o->x - 0.5) / cell_px) + 0.5);
    const double cy = 0.5 + cell_px * (floor((o->y - 0.5) / cell_px) + 0.5);
    const sky_place centre = focal_plane_sky(f, cx - chip->crpix_x, cy - chip->crpix_y);
    const double *j = centre.j;
    const double u = j[0] * (o->x - cx) + j[1] * (o->y - cy);
    const double v = j[2] * (o->x - cx) + j[3] * (o->y - cy);
    const double scale = 1.0 / sqrt(1.0 - e->g1 * e->g1 - e->g2 * e->g2);
    const double su = scale * ((1.0 + e->g1) * u + e->g2 * v);
    const double sv = scale * (e->g2 * u + (1.0 - e->g1) * v);
    const double det = j[0] * j[3] - j[1] * j[2];
    o->x = cx + (j[3] * su - j[1] * sv) / det;
    o->y = cy + (j[0] * sv - j[2] * su) / det;
}

bool scene_init(scene *s, const shear_mock_exposure *e, const focal_plane *f, int i) {
    const places p = places_of(e);
    const chip_place chip = focal_plane_chip(e, i);
    const int64_t n = count(&p);
    int64_t galaxies = 0;
    *s = (scene){.objects = calloc(n > 0 ? (size_t)n : 1, sizeof *s->objects), .n = n};
    if (s->objects == NULL)
        return false;
    for (int64_t k = 0; k < n; k++) {
        scene_object *o = &s->objects[k];
        if (put(e, &p, i, k, o)) {
            draw_star(e, i, k, o);
        } else {
            draw_galaxy(e, i, galaxies++, o);
        }
        if (e->shear_places && !o->is_star)
            shear_place(e, f, &chip, o);
        o->dx = o->x - chip.crpix_x;
        o->dy = o->y - chip.crpix_y;
        o->sky = focal_plane_sky(f, o->dx, o->dy);
    }
    return true;
}

void scene_deinit(scene *s) {
    free(s->objects);
}
