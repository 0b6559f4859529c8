/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/cutout/cutter.h"

#include "base/cleanup.h"
#include "survey/cutout/light.h"
#include "survey/cutout/marks.h"
#include "survey/cutout/noise_boxes.h"
#include "survey/cutout/plane.h"

#include <assert.h>
#include <inttypes.h>
#include <math.h>
#include <string.h>

enum {
    FRAME = CUTTER_FRAME,
    MOST_REJECTED = 256, /* noise boxes, before a galaxy is given up */
    MOST_SIDE = 200000   /* of a chip: a band of 64 rows is in memory */
};
static const int64_t most_pixels = (int64_t)1 << 34; /* a billion cells */

struct cutter {
    cutter_options options;
    chip_pixels *pixels, *noise;
    int side; /* of a box */
    empty_sky sky;
    noise_boxes boxes;
    light light;
    double *value; /* [side][side] of a box, like the next two */
    float *sigma;
    uint8_t *defect;
    int32_t *owner;  /* [side + 2 LIGHT_GROW] squared */
    uint8_t *away;   /* [side][side] not to be used for a noise stamp's plane */
    uint8_t *united; /* [stamp][stamp] masked in any stamp of the pair */
    float *white;    /* [stamp][stamp] the pixels' standard deviations */
    void *memory;    /* of the arrays; owned */
};

CLEANUP_DEFINE(cutter, cutter_free)

void cutter_free(cutter *c) {
    if (c == NULL)
        return;
    empty_sky_deinit(&c->sky);
    free(c->memory);
    free(c);
}

const noise_mesh *cutter_noise(const cutter *c) {
    return &c->sky.mesh;
}

static int check_options(const cutter_options *o, const chip_pixels *noise, shear_error *err) {
    if (o->stamp < SHEAR_MIN_SIDE || o->stamp > SHEAR_MAX_SIDE) {
        return shear_fail(err, SHEAR_E_SETTING, NULL, "stamps of %d px: expected %d to %d",
                          o->stamp, SHEAR_MIN_SIDE, SHEAR_MAX_SIDE);
    }
    if (o->noise_stamps < 1 || o->noise_stamps > SHEAR_MAX_NOISE_PLANES) {
        return shear_fail(err, SHEAR_E_SETTING, NULL,
                          "%d noise stamps per galaxy: expected 1 to %d", o->noise_stamps,
                          SHEAR_MAX_NOISE_PLANES);
    }
    if (o->noise == SHEAR_NOISE_IMAGE && (noise == NULL || o->noise_stamps > 1)) {
        return shear_fail(err, SHEAR_E_SETTING,
                          "ask for one noise stamp, or for those near the galaxies",
                          "an image of noise holds one noise stamp per galaxy, not %d",
                          noise == NULL ? 0 : o->noise_stamps);
    }
    if (o->nx > MOST_SIDE || o->ny > MOST_SIDE || (int64_t)o->nx * o->ny > most_pixels) {
        return shear_fail(err, SHEAR_E_FORMAT, "cut it into smaller images",
                          "a chip of %d x %d px is too large: expected %d px a side and %" PRId64
                          " in all, at most",
                          o->nx, o->ny, MOST_SIDE, most_pixels);
    }
    return SHEAR_OK;
}

static amplifier_axis axis_of(int pixels, int amplifiers, int box) {
    const int parts = amplifiers > 0 ? amplifiers : 1;
    assert(parts == 1 || (parts <= SHEAR_MAX_AMPLIFIERS && pixels / parts >= box));
    (void)box;
    return (amplifier_axis){pixels, parts};
}

static void place(cutter *c, arena *a) {
    const size_t n = (size_t)c->side * (size_t)c->side;
    const size_t wide = (size_t)c->side + (size_t)(2 * LIGHT_GROW);
    const size_t stamp = (size_t)c->options.stamp * (size_t)c->options.stamp;
    noise_boxes_place(&c->boxes, &c->sky, a);
    light_place(&c->light, c->side, FRAME, a);
    c->value = arena_doubles(a, n);
    c->sigma = arena_take(a, n * sizeof *c->sigma);
    c->defect = arena_take(a, n);
    c->owner = arena_take(a, wide * wide * sizeof *c->owner);
    c->away = arena_take(a, n);
    c->united = arena_take(a, stamp);
    c->white = arena_take(a, stamp * sizeof *c->white);
    c->light.defect = c->defect;
    c->light.owner = c->owner;
}

int cutter_new(cutter **c, chip_pixels *pixels, chip_pixels *noise, const cutter_options *options,
               shear_error *err) {
    *c = NULL;
    TRY(check_options(options, noise, err));
    CLEANUP(cutter_release) cutter *new = calloc(1, sizeof *new);
    if (new == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory");
    new->options = *options;
    new->pixels = pixels;
    new->noise = noise;
    new->side = options->stamp + 2 * FRAME;
    new->light.r_psf_px = options->r_psf_px > 0.0 ? options->r_psf_px : 0.0;
    new->sky.boxes = (box_map){.x = axis_of(options->nx, options->amplifiers.columns, new->side),
                               .y = axis_of(options->ny, options->amplifiers.rows, new->side),
                               .stamp = options->stamp,
                               .frame = FRAME};
    TRY(empty_sky_init(&new->sky, pixels, err));
    arena a = {0};
    place(new, &a);
    new->memory = arena_allocate(&a);
    if (new->memory == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory");
    place(new, &a);
    *c = CLEANUP_TAKE(new);
    return SHEAR_OK;
}

/* Find the stamp's place. Return the flags that forbid to look at its pixels. */
static uint32_t locate(const cutter *c, const cutter_source *source, cutter_pair *pair) {
    const cutter_options *o = &c->options;
    const double x = source->x + 0.5;
    const double y = source->y + 0.5;
    if (!(x >= 0.0 && x < o->nx && y >= 0.0 && y < o->ny))
        return SHEAR_FLAG_NO_POSITION;
    pair->x = (int)x - o->stamp / 2;
    pair->y = (int)y - o->stamp / 2;
    const bool inside = pair->x >= FRAME && pair->x + o->stamp + FRAME <= o->nx &&
                        pair->y >= FRAME && pair->y + o->stamp + FRAME <= o->ny;
    return inside ? 0 : SHEAR_FLAG_EDGE;
}

static int read_galaxy(const cutter *c, const cutter_pair *pair, shear_error *err) {
    const pixel_box box = {.x = pair->x - FRAME,
                           .y = pair->y - FRAME,
                           .nx = c->side,
                           .ny = c->side,
                           .value = c->value,
                           .sigma = c->sigma,
                           .defect = c->defect};
    const pixel_box wider = {.x = box.x - LIGHT_GROW,
                             .y = box.y - LIGHT_GROW,
                             .nx = c->side + 2 * LIGHT_GROW,
                             .ny = c->side + 2 * LIGHT_GROW,
                             .owner = c->owner};
    TRY(chip_pixels_read(c->pixels, &box, err));
    return chip_pixels_read(c->pixels, &wider, err);
}

/* Subtract the plane through the box's frame, of pixels that are not `away`, from the stamp, and
 * write it. False: the frame has too few of them. */
static bool write_stamp(const cutter *c, const uint8_t *away, double *out) {
    const int stamp = c->options.stamp;
    plane p;
    if (!plane_of_frame(&p, c->value, away, c->side, FRAME))
        return false;
    for (int y = 0; y < stamp; y++) {
        plane_subtract(&p, FRAME, y + FRAME, c->value + (ptrdiff_t)(y + FRAME) * c->side + FRAME,
                       stamp, out + (ptrdiff_t)y * stamp);
    }
    return true;
}

/* Return what hides the frame. */
static uint32_t hidden_by(const cutter *c) {
    const int n = c->side * c->side;
    int defects = 0;
    int masked = 0;
    for (int i = 0; i < n; i++) {
        defects += c->defect[i] != 0;
        masked += c->light.away[i];
    }
    return 2 * defects > masked ? SHEAR_FLAG_HOLE : SHEAR_FLAG_NEIGHBOUR;
}

/* Return the local standard deviation: with a weight map, that of the unmasked pixels on average,
 * as the mesh scales it. */
static double local_sigma(const cutter *c, double scale, double level) {
    const int n = c->side * c->side;
    double sum = 0.0;
    int count = 0;
    if (!c->sky.mesh.map)
        return level;
    for (int i = 0; i < n; i++) {
        const double sigma = (double)c->sigma[i];
        if (c->light.away[i] == 0 && isfinite(sigma)) {
            sum += sigma * sigma;
            count++;
        }
    }
    return count == 0 ? level : scale * sqrt(sum / count);
}

/* Add a box's defects to those of the pair. False, and nothing is added, if one is in the light. */
static bool unite(const cutter *c) {
    const size_t stamp = (size_t)c->options.stamp;
    const ptrdiff_t first = (ptrdiff_t)FRAME * c->side + FRAME;
    for (int y = 0; y < c->options.stamp; y++) {
        const ptrdiff_t at = first + (ptrdiff_t)y * c->side;
        if (marks_meet(c->defect + at, c->light.own + at, stamp))
            return false;
    }
    for (int y = 0; y < c->options.stamp; y++)
        marks_add(c->united + (size_t)y * stamp, c->defect + first + (ptrdiff_t)y * c->side, stamp);
    return true;
}

static double *noise_stamp(const cutter *c, const cutter_pair *pair, int k) {
    const size_t stamp = (size_t)c->options.stamp;
    return pair->noise + (size_t)k * stamp * stamp;
}

/* Read the box of a noise stamp, which begins at (x, y) with its frame. */
static int read_noise(const cutter *c, chip_pixels *from, int x, int y, shear_error *err) {
    const pixel_box box = {
        .x = x, .y = y, .nx = c->side, .ny = c->side, .value = c->value, .defect = c->defect};
    return chip_pixels_read(from, &box, err);
}

/* Return the marks of what is not empty sky in the box that begins at (x, y). */
static const uint8_t *find_away(const cutter *c, int x, int y) {
    for (int j = 0; j < c->side; j++) {
        const uint8_t *cells = box_map_row(&c->sky.boxes, (y + j) / BOX_CELL);
        uint8_t *away = c->away + (ptrdiff_t)j * c->side;
        if (j > 0 && (y + j) % BOX_CELL != 0) { /* the same cells as above */
            memcpy(away, away - c->side, (size_t)c->side);
            continue;
        }
        for (int i = 0; i < c->side; i++)
            away[i] = cells[(unsigned)(x + i) / BOX_CELL] / BOX_TOUCHED;
    }
    marks_add(c->away, c->defect, (size_t)c->side * (size_t)c->side);
    return c->away;
}

/* Cut noise stamp `k` at (x, y). *good is false if it cannot serve this galaxy. */
static int take_near(cutter *c, int x, int y, const cutter_pair *pair, int k, bool *good,
                     shear_error *err) {
    TRY(read_noise(c, c->pixels, x - FRAME, y - FRAME, err));
    const uint8_t *away = find_away(c, x - FRAME, y - FRAME);
    *good = write_stamp(c, away, noise_stamp(c, pair, k)) && unite(c);
    return SHEAR_OK;
}

static void add_place(cutter_pair *pair, int x, int y) {
    pair->noise_x[pair->n_noise] = x;
    pair->noise_y[pair->n_noise++] = y;
}

/* Cut the noise stamps out of empty sky. */
static int cut_near(cutter *c, const cutter_source *source, cutter_pair *pair, uint32_t *flags,
                    shear_error *err) {
    const draw_key key = {c->options.chip, source->id};
    int rejected = 0;
    int x = 0;
    int y = 0;
    noise_boxes_find(&c->boxes, pair->x, pair->y, key);
    while (pair->n_noise < c->options.noise_stamps) {
        if (rejected > MOST_REJECTED || !noise_boxes_draw(&c->boxes, &x, &y)) {
            *flags |= SHEAR_FLAG_NO_NOISE;
            return SHEAR_OK;
        }
        bool good;
        TRY(take_near(c, x, y, pair, pair->n_noise, &good, err));
        if (good)
            add_place(pair, x, y);
        rejected += !good;
    }
    return SHEAR_OK;
}

static int cut_image(cutter *c, cutter_pair *pair, uint32_t *flags, shear_error *err) {
    TRY(read_noise(c, c->noise, pair->x - FRAME, pair->y - FRAME, err));
    add_place(pair, pair->x, pair->y);
    if (!write_stamp(c, c->defect, pair->noise) || !unite(c))
        *flags |= SHEAR_FLAG_NO_NOISE;
    return SHEAR_OK;
}

/* Draw the noise stamps. Where the weight map has a pixel's standard deviation, its noise has it.
 */
static void draw_white(const cutter *c, const cutter_source *source, double scale,
                       const cutter_pair *pair) {
    const int stamp = c->options.stamp;
    const draw_key key = {c->options.chip, source->id};
    for (int y = 0; y < stamp; y++) {
        memcpy(c->white + (ptrdiff_t)y * stamp, c->sigma + (ptrdiff_t)(y + FRAME) * c->side + FRAME,
               (size_t)stamp * sizeof *c->white);
    }
    for (int k = 0; k < c->options.noise_stamps; k++) {
        const draw_normals d = {.purpose = DRAW_WHITE,
                                .plane = k + 1,
                                .sigma = pair->sigma,
                                .sigmas = c->sky.mesh.map ? c->white : NULL,
                                .scale = scale};
        draw_fill(noise_stamp(c, pair, k), (size_t)stamp * (size_t)stamp, key, &d);
    }
}

/* Fill what is masked in any stamp in all of them. */
static void fill(const cutter *c, const cutter_source *source, cutter_pair *pair) {
    const size_t n = (size_t)c->options.stamp * (size_t)c->options.stamp;
    const draw_key key = {c->options.chip, source->id};
    size_t filled = 0;
    for (size_t i = 0; i < n; i++)
        filled += c->united[i];
    pair->filled = (double)filled / (double)n;
    if (filled == 0)
        return;
    for (int k = 0; k <= c->options.noise_stamps; k++) {
        const draw_normals d = {
            .purpose = DRAW_FILL, .plane = k, .mask = c->united, .sigma = pair->sigma};
        draw_fill(k == 0 ? pair->galaxy : noise_stamp(c, pair, k - 1), n, key, &d);
    }
}

/* Cut the galaxy's stamp, and begin the union of masks. Return its flags. */
static uint32_t cut_galaxy(cutter *c, const cutter_source *source, cutter_pair *pair) {
    const int stamp = c->options.stamp;
    uint32_t flags = light_find(&c->light, source->x - pair->x + FRAME, source->y - pair->y + FRAME,
                                source->r_gal, source->owner);
    if (!write_stamp(c, c->light.away, pair->galaxy))
        flags |= hidden_by(c);
    for (int y = 0; y < stamp; y++) {
        memcpy(c->united + (ptrdiff_t)y * stamp,
               c->light.mask + (ptrdiff_t)(y + FRAME) * c->side + FRAME, (size_t)stamp);
    }
    return flags;
}

static int cut_noise(cutter *c, const cutter_source *source, double scale, cutter_pair *pair,
                     uint32_t *flags, shear_error *err) {
    switch (c->options.noise) {
    case SHEAR_NOISE_IMAGE:
        return cut_image(c, pair, flags, err);
    case SHEAR_NOISE_WHITE:
        draw_white(c, source, scale, pair);
        return SHEAR_OK;
    default:
        return cut_near(c, source, pair, flags, err);
    }
}

static int cut(cutter *c, const cutter_source *source, cutter_pair *pair, uint32_t *flags,
               shear_error *err) {
    *flags = locate(c, source, pair);
    if (*flags != 0)
        return SHEAR_OK;
    TRY(read_galaxy(c, pair, err));
    *flags = cut_galaxy(c, source, pair);
    const noise_mesh *m = &c->sky.mesh;
    const size_t at =
        noise_mesh_at(m, pair->x + c->options.stamp / 2, pair->y + c->options.stamp / 2);
    pair->sigma = local_sigma(c, m->scale[at], m->level[at]);
    if (*flags == 0 && !isfinite(pair->sigma))
        *flags = SHEAR_FLAG_NO_NOISE;
    if (*flags != 0)
        return SHEAR_OK;
    TRY(cut_noise(c, source, m->scale[at], pair, flags, err));
    if (*flags == 0)
        fill(c, source, pair);
    return SHEAR_OK;
}

int cutter_cut(cutter *c, const cutter_source *source, cutter_pair *pair, shear_error *err) {
    const size_t n = (size_t)c->options.stamp * (size_t)c->options.stamp;
    pair->filled = 0.0;
    pair->sigma = NAN;
    pair->x = pair->y = -1;
    pair->n_noise = 0;
    TRY(cut(c, source, pair, &pair->flags, err));
    if (pair->flags != 0) {
        memset(pair->galaxy, 0, n * sizeof *pair->galaxy);
        memset(pair->noise, 0, (size_t)c->options.noise_stamps * n * sizeof *pair->noise);
    }
    return SHEAR_OK;
}
