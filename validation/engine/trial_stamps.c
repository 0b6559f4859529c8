/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/trial_stamps.h"

#include "engine/brightness.h"
#include "engine/must.h"
#include "engine/population.h"
#include "shear/field.h"

#include <assert.h>
#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

enum {
    PSF_SIDE = 64,
    PSF_FINE_SIDE = 256, /* samples, if there are several per pixel */
    PSF_NUMBERS = 64     /* PSFs of a file with PSF_ID */
};

struct trial_stamps {
    const trial *of;
    size_t pixels;
    int threads;
    light **lights; /* [threads] */
    int64_t first;
    int count, capacity;
    double *bare[2];   /* [capacity][pixels] noise-free, +g and -g, sum of squares 1; owns all */
    double *noise[2];  /* the same size: unit noise of the galaxy and of the noise stamp */
    double *stamps[2]; /* the same size: the stamps of the file */
    double *weight, *r_gal, *psf; /* [capacity], [capacity], one image */
    int32_t *psf_id;              /* [capacity] */
    int psf_side;
};

static light *new_light(const flaw *f, int side, int reach, double scale) {
    light *l = NULL;
    must(light_new(&l, &f->psf, side, reach, scale, &must_error));
    return l;
}

static int reach_of(const flaw *f) {
    return f->psf.kind == LIGHT_MOFFAT ? 2 : 8;
}

static void draw_psf(trial_stamps *s) {
    const flaw *f = s->of->flaw;
    s->psf_side = f->psf_side > 0 ? f->psf_side : f->oversample > 1 ? PSF_FINE_SIDE : PSF_SIDE;
    const size_t n = (size_t)s->psf_side * (size_t)s->psf_side;
    light *l = new_light(f, s->psf_side, f->oversample > 1 ? 2 : reach_of(f), f->oversample);
    s->psf = must_allocate(n, sizeof *s->psf, "a PSF");
    light_draw_psf(l, s->psf);
    light_free(l);
    for (size_t i = 0; i < n; i++) {
        s->psf[i] = fmax(s->psf[i], 0.0); /* rounding errors of the transform */
    }
}

trial_stamps *trial_stamps_new(const trial *t, int most) {
    const flaw *f = t->flaw;
    const size_t count = (size_t)most;
    trial_stamps *s = must_allocate(1, sizeof *s, "stamps");
    s->of = t;
    s->capacity = most;
    s->pixels = (size_t)f->side * (size_t)f->side;
    s->threads = t->threads > 0 ? t->threads : omp_get_max_threads();
    s->lights = must_allocate((size_t)s->threads, sizeof(light *), "threads");
    double **const images[] = {&s->bare[0],  &s->bare[1],   &s->noise[0],
                               &s->noise[1], &s->stamps[0], &s->stamps[1]};
    must_allocate_arrays(6, images, count * s->pixels, "stamps");
    s->weight = must_allocate(count, sizeof(double), "stamps");
    s->r_gal = must_allocate(count, sizeof(double), "stamps");
    s->psf_id = must_allocate(count, sizeof(int32_t), "stamps");
    for (int i = 0; i < s->threads; i++)
        s->lights[i] = new_light(f, f->side, reach_of(f), 1.0);
    draw_psf(s);
    return s;
}

void trial_stamps_free(trial_stamps *s) {
    for (int i = 0; i < s->threads; i++)
        light_free(s->lights[i]);
    free(s->bare[0]);
    free(s->weight);
    free(s->r_gal);
    free(s->psf_id);
    free(s->psf);
    free(s->lights);
    free(s);
}

/* ---- drawing ---- */

static double norm_of(const double *image, size_t n) {
    double square = 0.0;
    for (size_t i = 0; i < n; i++)
        square += image[i] * image[i];
    return sqrt(square);
}

/* Return the flux for which the sum of squares of the unsheared galaxy is 1; copies have the same.
 */
static double unit_flux(const trial_stamps *s, light *l, const population *p, int64_t stamp,
                        double *scratch) {
    const light_galaxy bare = population_bare(p, stamp);
    light_draw(l, &bare, 0.0, 0.0, scratch);
    return 1.0 / norm_of(scratch, s->pixels);
}

/* Draw all copies of one galaxy, at both signs of the shear. */
static void draw_galaxy(trial_stamps *s, light *l, int at, int copies) {
    const trial *t = s->of;
    population p = {.seed = t->seed, .bulges = t->flaw->bulges, .copies = t->copies};
    double *first = s->bare[0] + (size_t)at * s->pixels;
    const double flux = unit_flux(s, l, &p, s->first + at, first);
    const double r_gal = 3.0 * population_radius(&p, s->first + at);
    for (int i = 0; i < 2 * copies; i++) {
        const int k = at + i / 2;
        double *image = s->bare[i % 2] + (size_t)k * s->pixels;
        double x, y;
        p.shear[0] = i % 2 != 0 ? -t->g[0] : t->g[0];
        p.shear[1] = i % 2 != 0 ? -t->g[1] : t->g[1];
        const light_galaxy g = population_galaxy(&p, s->first + k);
        population_centre(&p, s->first + k, &x, &y);
        light_draw(l, &g, x, y, image);
        for (size_t j = 0; j < s->pixels; j++)
            image[j] *= flux;
        s->r_gal[k] = r_gal;
    }
}

void trial_stamps_draw(trial_stamps *s, int64_t first, int count) {
    const trial *t = s->of;
    assert(count <= s->capacity && count % t->copies == 0);
    s->first = first;
    s->count = count;
#pragma omp parallel for schedule(dynamic) num_threads(s->threads)
    for (int at = 0; at < count; at += t->copies) {
        draw_galaxy(s, s->lights[omp_get_thread_num()], at, t->copies);
        for (int k = at; k < at + t->copies; k++) {
            const size_t offset = (size_t)k * s->pixels;
            flaw_draw_noise(t->flaw, t->seed, first + k, s->noise[0] + offset,
                            s->noise[1] + offset);
        }
    }
}

/* ---- writing ---- */

double trial_stamps_snr(const trial_stamps *s, const trial_level *level, int k) {
    const brightness fluxes = {.range = level->range,
                               .slope = level->slope != 0.0 ? level->slope : 2.5};
    const int64_t galaxy = (s->first + k) / s->of->copies;
    return level->snr * brightness_flux(&fluxes, s->of->seed, galaxy);
}

static void compose(trial_stamps *s, const trial_level *level, int sign) {
    const trial *t = s->of;
#pragma omp parallel for schedule(static) num_threads(s->threads)
    for (int k = 0; k < s->count; k++) {
        const size_t offset = (size_t)k * s->pixels;
        const double snr = trial_stamps_snr(s, level, k);
        double *galaxy = s->stamps[0] + offset;
        for (size_t i = 0; i < s->pixels; i++)
            galaxy[i] = snr * s->bare[sign][offset + i];
        flaw_apply(t->flaw, t->seed, s->first + k, s->noise[0] + offset, s->noise[1] + offset,
                   galaxy, s->stamps[1] + offset);
        s->weight[k] = t->flaw->mistake == FLAW_WEIGHTLESS ? 0.0 : 1.0;
        s->psf_id[k] = k % PSF_NUMBERS;
    }
}

static void write_psfs(const trial_stamps *s, shear_field_writer *w, int64_t n) {
    const size_t size = (size_t)s->psf_side * (size_t)s->psf_side * sizeof(double);
    CLEANUP(release_free) double *psf = must_allocate(1, size, "a PSF");
    for (int64_t i = 0; i < n; i++) {
        memcpy(psf, s->psf, size);
        flaw_spoil_psf(s->of->flaw, s->of->seed, i, s->psf_side, psf);
        must(shear_field_write_psf(w, i, psf, &must_error));
    }
}

void trial_stamps_write(trial_stamps *s, const trial_level *level, int sign, const char *path) {
    const flaw *f = s->of->flaw;
    const bool weightless = f->mistake == FLAW_WEIGHTLESS;
    const bool many_psfs = f->psf_flaw == FLAW_PSF_FLAT_ONE;
    const int oversample = f->mistake == FLAW_OVERSAMP ? 1 : f->oversample;
    shear_field_writer *w = NULL;
    const shear_field_spec spec = {
        .name = "trial",
        .pixscale = NAN,
        .geometry = {f->side, f->side, s->psf_side, s->psf_side, oversample},
        .n_stamps = s->count,
        .n_psf = many_psfs ? PSF_NUMBERS : 1,
        .columns = (f->r_gal ? SHEAR_COL_R_GAL : 0u) | (weightless ? SHEAR_COL_WEIGHT : 0u) |
                   (many_psfs ? SHEAR_COL_PSF_ID : 0u),
        .bitpix = -32,
        .overwrite = true};
    const shear_catalog_columns rows = {.weight = weightless ? s->weight : NULL,
                                        .r_gal = f->r_gal ? s->r_gal : NULL,
                                        .psf_id = many_psfs ? s->psf_id : NULL};
    compose(s, level, sign);
    must(shear_field_create(&w, path, &spec, &must_error));
    write_psfs(s, w, spec.n_psf);
    must(shear_field_write(w, 0, s->count, s->stamps[0], s->stamps[1], &rows, &must_error));
    must(shear_field_finish(w, &must_error));
}

trial_stamps_view trial_stamps_look(const trial_stamps *s, int sign) {
    return (trial_stamps_view){
        .galaxy = s->stamps[0], .noise = s->stamps[1], .bare = s->bare[sign]};
}
