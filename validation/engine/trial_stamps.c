/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/trial_stamps.h"
#include "engine/brightness.h"
#include "engine/must.h"
#include "engine/population.h"

#include "shear/field.h"

#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

enum {
    PSF_SIDE = 64,
    PSF_FINE_SIDE = 256, /* samples, where there are several in a pixel */
    PSF_NUMBERS = 64     /* PSFs of a file that tells them apart */
};

struct studio {
    const struct trial *trial;
    size_t pixels;
    int threads;
    struct light **lights; /* [threads] */
    int64_t first;
    int count;
    double *bare[2];              /* [most][pixels] noise-free, at +g and -g, of unit square sum */
    double *noise[2];             /* the same: unit noise of the galaxy and of the noise stamp */
    double *stamps[2];            /* the same: what is written */
    double *weight, *r_gal, *psf; /* [most], [most], one image */
    int32_t *psf_id;              /* [most] */
    int psf_side;
};

static int reach_of(const struct flaw *f) {
    return f->psf.kind == LIGHT_MOFFAT ? 2 : 8;
}

static int draw_psf(struct studio *s, shear_error *err) {
    const struct flaw *f = s->trial->flaw;
    struct light *light = NULL;
    s->psf_side = f->psf_side > 0 ? f->psf_side : f->oversample > 1 ? PSF_FINE_SIDE : PSF_SIDE;
    int code = SHEAR_OK;
    s->psf =
        memory_new((size_t)s->psf_side * (size_t)s->psf_side, sizeof *s->psf, "a PSF", &code, err);
    code = code != SHEAR_OK ? code
                            : light_new(&light, &f->psf, s->psf_side,
                                        f->oversample > 1 ? 2 : reach_of(f), f->oversample, err);
    if (code == SHEAR_OK) {
        light_draw_psf(light, s->psf);
        light_free(light);
    }
    for (int i = 0; code == SHEAR_OK && i < s->psf_side * s->psf_side; i++) {
        s->psf[i] = fmax(s->psf[i], 0.0); /* the transform's rounding */
    }
    return code;
}

static int allocate(struct studio *s, int most, shear_error *err) {
    int code = SHEAR_OK;
    const size_t n = (size_t)most * s->pixels;
    for (int i = 0; i < 2; i++) {
        s->bare[i] = memory_new(n, sizeof(double), "stamps", &code, err);
        s->noise[i] = memory_new(n, sizeof(double), "stamps", &code, err);
        s->stamps[i] = memory_new(n, sizeof(double), "stamps", &code, err);
    }
    s->weight = memory_new((size_t)most, sizeof(double), "stamps", &code, err);
    s->r_gal = memory_new((size_t)most, sizeof(double), "stamps", &code, err);
    s->psf_id = memory_new((size_t)most, sizeof(int32_t), "stamps", &code, err);
    s->lights = memory_new((size_t)s->threads, sizeof(struct light *), "threads", &code, err);
    return code;
}

int studio_new(struct studio **studio, const struct trial *t, int most, shear_error *err) {
    int code = SHEAR_OK;
    struct studio *s = memory_new(1, sizeof *s, "a trial", &code, err);
    *studio = s;
    if (code != SHEAR_OK) {
        return code;
    }
    s->trial = t;
    s->pixels = (size_t)t->flaw->side * (size_t)t->flaw->side;
    s->threads = t->threads > 0 ? t->threads : omp_get_max_threads();
    code = allocate(s, most, err);
    for (int i = 0; code == SHEAR_OK && i < s->threads; i++) {
        code = light_new(&s->lights[i], &t->flaw->psf, t->flaw->side, reach_of(t->flaw), 1.0, err);
    }
    return code != SHEAR_OK ? code : draw_psf(s, err);
}

void studio_free(struct studio *s) {
    if (s == NULL) {
        return;
    }
    for (int i = 0; s->lights != NULL && i < s->threads; i++) {
        light_free(s->lights[i]);
    }
    for (int i = 0; i < 2; i++) {
        free(s->bare[i]);
        free(s->noise[i]);
        free(s->stamps[i]);
    }
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
    for (size_t i = 0; i < n; i++) {
        square += image[i] * image[i];
    }
    return sqrt(square);
}

/* The flux that makes the square sum of the unsheared galaxy 1; copies have the same. */
static double unit_flux(struct studio *s, struct light *light, const population *p, int64_t stamp,
                        double *scratch) {
    const light_galaxy bare = population_bare(p, stamp);
    light_draw(light, &bare, 0.0, 0.0, scratch);
    return 1.0 / norm_of(scratch, s->pixels);
}

/* All copies of one galaxy, at both signs. */
static void draw_galaxy(struct studio *s, struct light *light, int at, int copies) {
    const struct trial *t = s->trial;
    population p = {.seed = t->seed, .bulges = t->flaw->bulges, .copies = t->copies};
    double *first = s->bare[0] + (size_t)at * s->pixels;
    const double flux = unit_flux(s, light, &p, s->first + at, first);
    for (int i = 0; i < 2 * copies; i++) {
        const int k = at + i / 2;
        double *image = s->bare[i % 2] + (size_t)k * s->pixels;
        double x, y;
        p.shear[0] = i % 2 ? -t->g[0] : t->g[0];
        p.shear[1] = i % 2 ? -t->g[1] : t->g[1];
        const light_galaxy g = population_galaxy(&p, s->first + k);
        population_centre(&p, s->first + k, &x, &y);
        light_draw(light, &g, x, y, image);
        for (size_t j = 0; j < s->pixels; j++) {
            image[j] *= flux;
        }
    }
    s->r_gal[at] = 3.0 * population_radius(&p, s->first + at);
    for (int k = at + 1; k < at + copies; k++) {
        s->r_gal[k] = s->r_gal[at];
    }
}

int studio_draw(struct studio *s, int64_t first, int count, shear_error *err) {
    const struct trial *t = s->trial;
    (void)err;
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
    return SHEAR_OK;
}

/* ---- writing ---- */

double studio_snr(const struct studio *s, const trial_level *level, int k) {
    const struct trial *t = s->trial;
    const brightness fluxes = {.range = level->range,
                               .slope = level->slope != 0.0 ? level->slope : 2.5};
    return level->snr * brightness_flux(&fluxes, t->seed, (s->first + k) / t->copies);
}

static void compose(struct studio *s, const trial_level *level, int sign) {
    const struct trial *t = s->trial;
#pragma omp parallel for schedule(static) num_threads(s->threads)
    for (int k = 0; k < s->count; k++) {
        const size_t offset = (size_t)k * s->pixels;
        const double snr = studio_snr(s, level, k);
        double *galaxy = s->stamps[0] + offset;
        for (size_t i = 0; i < s->pixels; i++) {
            galaxy[i] = snr * s->bare[sign][offset + i];
        }
        flaw_apply(t->flaw, t->seed, s->first + k, s->noise[0] + offset, s->noise[1] + offset,
                   galaxy, s->stamps[1] + offset);
        s->weight[k] = t->flaw->mistake == FLAW_WEIGHTLESS ? 0.0 : 1.0;
        s->psf_id[k] = k % PSF_NUMBERS;
    }
}

static int write_psfs(const struct studio *s, shear_field_writer *w, int n, shear_error *err) {
    const size_t size = (size_t)s->psf_side * (size_t)s->psf_side;
    int code = SHEAR_OK;
    double *psf = memory_new(size, sizeof *psf, "a PSF", &code, err);
    for (int i = 0; code == SHEAR_OK && i < n; i++) {
        memcpy(psf, s->psf, size * sizeof *psf);
        flaw_spoil_psf(s->trial->flaw, s->trial->seed, i, s->psf_side, psf);
        code = shear_field_write_psf(w, i, psf, err);
    }
    free(psf);
    return code;
}

static unsigned columns_of(const struct flaw *f) {
    unsigned columns = f->r_gal ? SHEAR_COL_R_GAL : 0;
    columns |= f->mistake == FLAW_WEIGHTLESS ? SHEAR_COL_WEIGHT : 0;
    return columns | (f->psf_flaw == FLAW_PSF_FLAT_ONE ? SHEAR_COL_PSF_ID : 0);
}

static int write_all(const struct studio *s, shear_field_writer *w, unsigned columns, int n_psf,
                     shear_error *err) {
    const shear_catalog_columns rows = {.weight = columns & SHEAR_COL_WEIGHT ? s->weight : NULL,
                                        .r_gal = columns & SHEAR_COL_R_GAL ? s->r_gal : NULL,
                                        .psf_id = columns & SHEAR_COL_PSF_ID ? s->psf_id : NULL};
    int code = write_psfs(s, w, n_psf, err);
    return code != SHEAR_OK
               ? code
               : shear_field_write(w, 0, s->count, s->stamps[0], s->stamps[1], &rows, err);
}

int studio_write(struct studio *s, const trial_level *level, int sign, const char *path,
                 shear_error *err) {
    const struct flaw *f = s->trial->flaw;
    const int n_psf = f->psf_flaw == FLAW_PSF_FLAT_ONE ? PSF_NUMBERS : 1;
    const int oversample = f->mistake == FLAW_OVERSAMP ? 1 : f->oversample;
    shear_field_writer *w = NULL;
    const shear_field_spec spec = {
        .name = "trial",
        .pixscale = NAN,
        .geometry = {f->side, f->side, s->psf_side, s->psf_side, oversample},
        .n_stamps = s->count,
        .n_psf = n_psf,
        .columns = columns_of(f),
        .bitpix = -32,
        .overwrite = true};
    compose(s, level, sign);
    int code = shear_field_create(&w, path, &spec, err);
    if (code != SHEAR_OK) {
        return code;
    }
    code = write_all(s, w, spec.columns, n_psf, err);
    if (code != SHEAR_OK) {
        shear_field_abort(w);
        return code;
    }
    return shear_field_finish(w, err);
}

studio_view studio_look(const struct studio *s, int sign) {
    return (studio_view){.galaxy = s->stamps[0], .noise = s->stamps[1], .bare = s->bare[sign]};
}
