/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/chip_stamps.h"

#include "base/arena.h"
#include "base/cleanup.h"
#include "base/sort.h"
#include "shear/stamp.h"
#include "survey/cutout/light.h"
#include "survey/half_light.h"

#include <math.h>
#include <stdlib.h>

/* Positions of all sources, in both systems as far as known: [n], NaN if unknown. */
typedef struct places {
    double *x, *y, *ra, *dec;
    void *memory;
} places;

static void places_deinit(places *p) {
    free(p->memory);
}

static void place_places(places *p, size_t n, arena *a) {
    double **const arrays[] = {&p->x, &p->y, &p->ra, &p->dec};
    for (size_t i = 0; i < sizeof arrays / sizeof arrays[0]; i++)
        *arrays[i] = arena_doubles(a, n);
}

static void fill(double *out, const double *from, int64_t n) {
    for (int64_t i = 0; i < n; i++)
        out[i] = from != NULL ? from[i] : NAN;
}

/* Take the positions that the catalog has, and convert them to the other system. */
static bool places_init(places *p, const chip_inputs *in) {
    const source_list *s = in->sources;
    arena a = {0};
    *p = (places){0};
    place_places(p, (size_t)s->n, &a);
    p->memory = arena_allocate(&a);
    if (p->memory == NULL)
        return false;
    place_places(p, (size_t)s->n, &a);
    fill(p->x, s->x, s->n);
    fill(p->y, s->y, s->n);
    fill(p->ra, NULL, s->n);
    fill(p->dec, NULL, s->n);
    if (s->x == NULL && s->ra != NULL && in->map != NULL)
        sky_map_to_pixel(in->map, s->n, s->ra, s->dec, p->x, p->y);
    if (in->map != NULL)
        sky_map_to_sky(in->map, s->n, p->x, p->y, p->ra, p->dec);
    return true;
}

static bool is_inside(const chip_inputs *in, double x, double y) {
    return x >= 0.5 && x < in->nx + 0.5 && y >= 0.5 && y < in->ny + 0.5; /* NaN is not */
}

static bool is_wanted(const chip_inputs *in, const places *p, int64_t i) {
    return in->sources->selected[i] != 0 && (!in->only_inside || is_inside(in, p->x[i], p->y[i]));
}

static int64_t count_wanted(const chip_inputs *in, const places *p) {
    int64_t n = 0;
    for (int64_t i = 0; i < in->sources->n; i++)
        n += is_wanted(in, p, i);
    return n;
}

static void place_arrays(chip_stamps *s, const source_list *l, size_t n, arena *a) {
    s->id = arena_take(a, n * sizeof *s->id);
    s->row = arena_take(a, n * sizeof *s->row);
    s->x = arena_doubles(a, n);
    s->y = arena_doubles(a, n);
    s->ra = arena_doubles(a, n);
    s->dec = arena_doubles(a, n);
    s->weight = l->weight != NULL ? arena_doubles(a, n) : NULL;
    s->r_gal = l->r_gal != NULL ? arena_doubles(a, n) : NULL;
    s->jacobian = arena_take(a, n * sizeof *s->jacobian);
    s->psf_terms = arena_doubles(a, n * (size_t)s->terms);
    s->flags = arena_take(a, n * sizeof *s->flags);
    s->shapes = arena_take(a, (size_t)l->n * sizeof *s->shapes);
}

static bool allocate(chip_stamps *s, const chip_inputs *in, int64_t wanted) {
    arena a = {0};
    s->terms = psf_models_get(in->psf, in->model)->terms;
    place_arrays(s, in->sources, (size_t)wanted, &a);
    s->memory = arena_allocate(&a);
    if (s->memory == NULL)
        return false;
    place_arrays(s, in->sources, (size_t)wanted, &a);
    return true;
}

static void add_stamp(chip_stamps *s, const chip_inputs *in, const places *p, int64_t i) {
    const source_list *l = in->sources;
    const int64_t k = s->n++;
    double context[MAX_CONTEXTS];
    const psf_place place = {
        .x = p->x[i], .y = p->y[i], .ra = p->ra[i], .dec = p->dec[i], .context = context};
    contexts_of_row(in->contexts, l, i, context);
    s->id[k] = l->id[i];
    s->row[k] = l->row[i];
    s->x[k] = p->x[i];
    s->y[k] = p->y[i];
    s->ra[k] = p->ra[i];
    s->dec[k] = p->dec[i];
    if (s->weight != NULL)
        s->weight[k] = l->weight[i];
    if (s->r_gal != NULL)
        s->r_gal[k] = l->r_gal[i];
    const bool inside = is_inside(in, p->x[i], p->y[i]);
    bool mapped = in->map == NULL;
    for (int c = 0; c < 4; c++)
        s->jacobian[k][c] = NAN;
    if (in->map != NULL && inside)
        mapped = sky_map_jacobian(in->map, p->x[i], p->y[i], s->jacobian[k]);
    if (!inside || !mapped) {
        s->flags[k] = SHEAR_FLAG_NO_POSITION;
    } else if (!psf_models_terms(in->psf, in->model, &place, s->psf_terms + k * s->terms)) {
        s->flags[k] = SHEAR_FLAG_PSF_UNUSABLE;
    }
}

static object_shape shape_of(const source_list *l, int64_t i) {
    static const double degree = M_PI / 180.0;
    if (l->a != NULL && l->a[i] > 0.0 && l->b[i] > 0.0)
        return (object_shape){.a = l->a[i], .b = l->b[i], .theta = l->theta[i] * degree};
    const double r = l->r_gal != NULL ? l->r_gal[i] : NAN;
    return (object_shape){.a = isfinite(r) ? r : 0.0, .b = NAN};
}

/* Keep the shapes of all sources, as owners of pixels: they hide their neighbours' sky, measured or
 * not. */
static void add_shapes(chip_stamps *s, const source_list *l, const places *p) {
    for (int64_t i = 0; i < l->n; i++) {
        if (!isfinite(p->x[i] + p->y[i]))
            continue;
        object_shape *shape = &s->shapes[s->n_shapes++];
        *shape = shape_of(l, i);
        shape->x = p->x[i] - 1.0;
        shape->y = p->y[i] - 1.0;
        shape->owner = (int32_t)(i + 1);
    }
}

void chip_stamps_size_shapes(chip_stamps *s, double r_psf_px) {
    for (int64_t i = 0; i < s->n_shapes; i++) {
        object_shape *shape = &s->shapes[i];
        if (isnan(shape->b))
            shape->a = shape->b = shape->a + LIGHT_PSF_RADII * r_psf_px;
    }
}

bool chip_stamps_quantile(const chip_stamps *s, double part, double *r_gal) {
    *r_gal = NAN;
    if (s->r_gal == NULL)
        return true;
    CLEANUP(release_free) double *r = malloc((size_t)(s->n + 1) * sizeof *r);
    size_t n = 0;
    for (int64_t i = 0; r != NULL && i < s->n; i++) {
        if (s->r_gal[i] > 0.0)
            r[n++] = s->r_gal[i];
    }
    if (n > 0) {
        sort_doubles(r, n);
        *r_gal = r[(size_t)(part * (double)n)];
    }
    return r != NULL;
}

double chip_stamps_light(const chip_stamps *s, int64_t i) {
    return !isnan(s->r_light) ? s->r_light : s->r_gal != NULL ? s->r_gal[i] : NAN;
}

static int out_of_memory(shear_error *err) {
    return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for the sources of a chip");
}

int chip_stamps_init(chip_stamps *s, const chip_inputs *in, shear_error *err) {
    CLEANUP(places_deinit) places p;
    *s = (chip_stamps){0};
    if (!places_init(&p, in) || !allocate(s, in, count_wanted(in, &p)))
        return out_of_memory(err);
    for (int64_t i = 0; i < in->sources->n; i++) {
        s->n_sources += is_inside(in, p.x[i], p.y[i]);
        if (is_wanted(in, &p, i))
            add_stamp(s, in, &p, i);
    }
    s->r_gal_measured = in->sources->r_gal_measured;
    s->star_radius = half_light_of_stars(in->sources);
    s->r_light = NAN;
    if (s->r_gal_measured && !chip_stamps_quantile(s, 0.5, &s->r_light))
        return out_of_memory(err);
    add_shapes(s, in->sources, &p);
    return SHEAR_OK;
}

void chip_stamps_deinit(chip_stamps *s) {
    free(s->memory);
    *s = (chip_stamps){0};
}
