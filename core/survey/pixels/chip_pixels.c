/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/pixels/chip_pixels.h"

#include "base/arena.h"
#include "base/cleanup.h"
#include "base/pages.h"
#include "base/simd.h"
#include "fits/tiles/image.h"
#include "survey/pixels/defects.h"
#include "survey/pixels/internal.h"
#include "survey/pixels/object_painter.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A band is read at once. It is small enough for a processor's cache, and there are at least two.
 *
 * To read plain pixels again takes no longer than new memory for them, so at first there is only
 * room for what galaxies need that come in the order of their rows. Each time that a band is read
 * more often than by a survey and by a pass over the catalog, room for one more is added. */
enum {
    CACHE_BYTES = 192 << 20,
    FIRST_BYTES = 48 << 20,
    BAND_PIXELS = 1 << 18,
    MIN_BANDS = 2,
    USUAL_READS = 2,
    SURVEY_ROWS = 72 /* that a survey looks at together, at most */
};

/* Rows of the chip in memory. */
typedef struct band {
    int number;    /* -1: none */
    uint64_t used; /* when, by chip_pixels.clock */
    double *value; /* [rows][nx], like the other arrays; NULL: they are in ... */
    float *single;
    float *sigma;
    uint8_t *defect;
    int32_t *owner;
} band;

struct chip_pixels {
    const image_chip *chip;
    sf_image layers[N_LAYERS];
    bool has_weight, has_mask, has_segmentation;
    bool single; /* floats have all values of the image, and are kept instead */
    int nx, ny;
    int rows;     /* of a band; the last one may have fewer */
    int *slot_of; /* [bands]: index of a band's slot, -1: it is not in memory */
    int *reads;   /* [bands]: how often it was read, up to USUAL_READS */
    band *slots;  /* [n_slots], of which n_used are or were in use */
    int n_slots, n_first, n_used;
    void *pixels; /* of all slots */
    void *memory; /* of what else is allocated */
    uint64_t clock;
    double *scratch; /* [rows][nx]: pixels of a layer that is kept in another form */
    bool has_painter;
    object_painter painter;
};

/* ---- opening ---- */

static bool has_owners(const chip_pixels *c) {
    return c->has_segmentation || c->has_painter;
}

/* Place the arrays of a band. */
static void place(band *b, const chip_pixels *c, arena *a) {
    const size_t n = (size_t)c->rows * (size_t)c->nx;
    b->value = c->single ? NULL : arena_doubles(a, n);
    b->single = c->single ? arena_take(a, n * sizeof *b->single) : NULL;
    b->defect = arena_take(a, n);
    b->sigma = c->has_weight ? arena_take(a, n * sizeof *b->sigma) : NULL;
    b->owner = has_owners(c) ? arena_take(a, n * sizeof *b->owner) : NULL;
}

static int64_t band_bytes(const chip_pixels *c, int rows) {
    chip_pixels counted = *c;
    arena a = {0};
    band b;
    counted.rows = rows;
    place(&b, &counted, &a);
    return (int64_t)a.used;
}

/* Choose the rows of a band: whole tiles of a compressed image, unless a band of them would take
 * more than about a quarter of the cache. */
static void choose_rows(chip_pixels *c) {
    const sf_image *image = &c->layers[LAYER_IMAGE];
    const int64_t tile = image->compressed ? image->tiling.tile[1] : 1;
    int64_t rows = BAND_PIXELS / c->nx > 0 ? BAND_PIXELS / c->nx : 1;
    if (tile <= CACHE_BYTES / 64 / c->nx)
        rows = (rows + tile - 1) / tile * tile;
    c->rows = (int)(rows < c->ny ? rows : c->ny);
}

static int at_least_two(int64_t slots, int bands) {
    return slots < MIN_BANDS ? MIN_BANDS : slots < bands ? (int)slots : bands;
}

static bool any_compressed(const chip_pixels *c) {
    bool any = false;
    for (int i = 0; i < N_LAYERS; i++)
        any = any || c->layers[i].compressed;
    return any;
}

static void place_bands(chip_pixels *c, int bands, arena *a) {
    c->slot_of = arena_take(a, (size_t)bands * sizeof *c->slot_of);
    c->reads = arena_take(a, (size_t)bands * sizeof *c->reads);
    c->slots = arena_take(a, (size_t)c->n_slots * sizeof *c->slots);
    c->scratch = arena_doubles(a, (size_t)c->rows * (size_t)c->nx);
}

static int allocate_bands(chip_pixels *c, shear_error *err) {
    const int bands = (c->ny - 1) / c->rows + 1;
    const int64_t bytes = band_bytes(c, c->rows);
    c->n_slots = at_least_two(CACHE_BYTES / bytes, bands);
    c->n_first = any_compressed(c) ? c->n_slots : at_least_two(FIRST_BYTES / bytes, bands);
    arena a = {0};
    arena pixels = {.memory = pages_allocate((size_t)(c->n_slots * bytes))};
    place_bands(c, bands, &a);
    c->pixels = pixels.memory;
    c->memory = arena_allocate(&a);
    if (c->pixels == NULL || c->memory == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory");
    place_bands(c, bands, &a);
    for (int i = 0; i < bands; i++)
        c->slot_of[i] = -1;
    for (int i = 0; i < c->n_slots; i++) {
        c->slots[i].number = -1;
        place(&c->slots[i], c, &pixels);
    }
    return SHEAR_OK;
}

static int open_layers(chip_pixels *c, shear_error *err) {
    for (int i = 0; i < N_LAYERS; i++) {
        const image_hdu *image = &c->chip->layers[i];
        if (image->file != NULL)
            TRY(sf_image_init(&c->layers[i], image->file, image->hdu, image->label, err));
    }
    c->single =
        !c->layers[LAYER_IMAGE].compressed && sf_plain_fits_float(&c->layers[LAYER_IMAGE].plain);
    c->has_weight = c->chip->layers[LAYER_WEIGHT].file != NULL;
    c->has_mask = c->chip->layers[LAYER_MASK].file != NULL;
    c->has_segmentation = c->chip->layers[LAYER_SEGMENTATION].file != NULL;
    return SHEAR_OK;
}

static int init(chip_pixels *c, const object_shape *shapes, int64_t n, shear_error *err) {
    TRY(open_layers(c, err));
    c->has_painter = shapes != NULL && n > 0 && !c->has_segmentation;
    choose_rows(c);
    TRY(allocate_bands(c, err));
    if (!c->has_painter)
        return SHEAR_OK;
    return object_painter_init(&c->painter, shapes, n, c->nx, c->ny, c->rows, err);
}

int chip_pixels_open(chip_pixels **c, const exposure_images *e, int i, const object_shape *shapes,
                     int64_t n, shear_error *err) {
    *c = calloc(1, sizeof **c);
    if (*c == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory");
    (*c)->chip = &e->chips[i];
    exposure_images_size(e, i, &(*c)->nx, &(*c)->ny);
    const int code = init(*c, shapes, n, err);
    if (code != SHEAR_OK) {
        chip_pixels_close(*c);
        *c = NULL;
    }
    return code;
}

void chip_pixels_close(chip_pixels *c) {
    if (c == NULL)
        return;
    for (int i = 0; i < N_LAYERS; i++)
        sf_image_deinit(&c->layers[i]);
    object_painter_deinit(&c->painter);
    free(c->pixels);
    free(c->memory);
    free(c);
}

bool chip_pixels_segmented(const chip_pixels *c) {
    return c->has_segmentation;
}

/* ---- bands ---- */

SHEAR_SIMD static void narrow(const double *restrict from, size_t n, float *restrict to) {
#pragma omp simd
    for (size_t i = 0; i < n; i++)
        to[i] = (float)from[i];
}

SHEAR_SIMD static void widen(const float *restrict from, size_t n, double *restrict to) {
#pragma omp simd
    for (size_t i = 0; i < n; i++)
        to[i] = (double)from[i];
}

/* Fill the band whose number it has. */
static int fill(chip_pixels *c, band *b, shear_error *err) {
    const image_chip *chip = c->chip;
    const int64_t first[SF_AXES] = {0, (int64_t)b->number * c->rows, 0};
    const int count = c->ny - first[1] < c->rows ? (int)(c->ny - first[1]) : c->rows;
    const int64_t size[SF_AXES] = {c->nx, count, 1};
    const size_t n = (size_t)c->nx * (size_t)count;
    double *value = c->single ? c->scratch : b->value;
    TRY(sf_image_read(&c->layers[LAYER_IMAGE], first, size, value, err));
    defects_of_values(value, n, chip->saturate, b->defect);
    if (c->single)
        narrow(value, n, b->single);
    if (c->has_weight) {
        TRY(sf_image_read(&c->layers[LAYER_WEIGHT], first, size, c->scratch, err));
        defects_of_weights(c->scratch, n, chip->weight_kind, b->sigma, b->defect);
    }
    if (c->has_mask) {
        TRY(sf_image_read(&c->layers[LAYER_MASK], first, size, c->scratch, err));
        defects_of_mask(c->scratch, n, &chip->mask, b->defect);
    }
    if (c->has_segmentation) {
        TRY(sf_image_read(&c->layers[LAYER_SEGMENTATION], first, size, c->scratch, err));
        defects_owners(c->scratch, n, b->owner);
    } else if (c->has_painter) {
        object_painter_draw(&c->painter, b->number, count, b->owner);
    }
    return SHEAR_OK;
}

/* Return the slot that was not used for longest. */
static band *oldest(chip_pixels *c) {
    band *b = &c->slots[0];
    for (int i = 1; i < c->n_used; i++) {
        if (c->slots[i].used < b->used)
            b = &c->slots[i];
    }
    return b;
}

/* Return the slot of the last band before those that a survey looks at when it comes to this one;
 * NULL if there is none. */
static band *just_surveyed(chip_pixels *c, int number) {
    band *b = NULL;
    for (int i = 0; i < c->n_used; i++) {
        band *of = &c->slots[i];
        if (of->number < number - SURVEY_ROWS / c->rows - 1 &&
            (b == NULL || of->number > b->number))
            b = of;
    }
    return b;
}

/* Return the slot for a band: a new one, or that of the band which is least likely to be read
 * again. A catalog begins in the first rows, so that a survey, which reads each band for the first
 * time, leaves these. */
static band *choose_slot(chip_pixels *c, int number) {
    if (c->n_used < (c->reads[number] >= USUAL_READS ? c->n_slots : c->n_first))
        return &c->slots[c->n_used++];
    band *surveyed = c->reads[number] == 0 ? just_surveyed(c, number) : NULL;
    return surveyed != NULL ? surveyed : oldest(c);
}

/* Put a band into the slot, in place of the one that it holds. */
static int load(chip_pixels *c, band *b, int number, shear_error *err) {
    if (b->number >= 0)
        c->slot_of[b->number] = -1;
    b->number = number;
    c->reads[number] += c->reads[number] < USUAL_READS;
    const int code = fill(c, b, err);
    if (code == SHEAR_OK) {
        c->slot_of[number] = (int)(b - c->slots);
    } else {
        b->number = -1;
    }
    return code;
}

/* Find the band in memory, or read it. */
static int get_band(chip_pixels *c, int number, const band **out, shear_error *err) {
    const int slot = c->slot_of[number];
    band *b = slot >= 0 ? &c->slots[slot] : choose_slot(c, number);
    if (slot < 0)
        TRY(load(c, b, number, err));
    assert(b->number == number);
    b->used = ++c->clock;
    *out = b;
    return SHEAR_OK;
}

/* ---- boxes ---- */

/* Mark pixels of the box from index `at` on as outside of the chip. */
static void set_outside(const pixel_box *box, size_t at, size_t n) {
    for (size_t i = at; i < at + n; i++) {
        if (box->value != NULL)
            box->value[i] = NAN;
        if (box->sigma != NULL)
            box->sigma[i] = NAN;
        if (box->defect != NULL)
            box->defect[i] = PIXEL_OUTSIDE;
        if (box->owner != NULL)
            box->owner[i] = 0;
    }
}

/* Copy n pixels of a band, from index `from` on, to those of the box from `at` on. */
static void copy(const band *b, size_t from, const pixel_box *box, size_t at, size_t n) {
    if (box->value != NULL && b->value != NULL)
        memcpy(box->value + at, b->value + from, n * sizeof *box->value);
    if (box->value != NULL && b->value == NULL)
        widen(b->single + from, n, box->value + at);
    if (box->defect != NULL)
        memcpy(box->defect + at, b->defect + from, n);
    if (box->sigma != NULL && b->sigma != NULL)
        memcpy(box->sigma + at, b->sigma + from, n * sizeof *box->sigma);
    for (size_t i = at; i < at + n && box->sigma != NULL && b->sigma == NULL; i++)
        box->sigma[i] = NAN;
    if (box->owner != NULL && b->owner != NULL)
        memcpy(box->owner + at, b->owner + from, n * sizeof *box->owner);
    if (box->owner != NULL && b->owner == NULL)
        memset(box->owner + at, 0, n * sizeof *box->owner);
}

/* Fill row `row` of the box, whose pixels [low, high) lie in the chip. */
static int read_row(chip_pixels *c, const pixel_box *box, int row, int64_t low, int64_t high,
                    shear_error *err) {
    const int64_t y = (int64_t)box->y + row;
    const size_t at = (size_t)row * (size_t)box->nx;
    if (y < 0 || y >= c->ny || low >= high) {
        set_outside(box, at, (size_t)box->nx);
        return SHEAR_OK;
    }
    const band *b = NULL;
    TRY(get_band(c, (int)y / c->rows, &b, err));
    const size_t from = (size_t)(y % c->rows) * (size_t)c->nx + (size_t)(box->x + low);
    set_outside(box, at, (size_t)low);
    copy(b, from, box, at + (size_t)low, (size_t)(high - low));
    set_outside(box, at + (size_t)high, (size_t)(box->nx - high));
    return SHEAR_OK;
}

int chip_pixels_read(chip_pixels *c, const pixel_box *box, shear_error *err) {
    assert(box->nx >= 0 && box->ny >= 0);
    const int64_t before = -(int64_t)box->x;
    const int64_t left = (int64_t)c->nx - box->x;
    const int64_t low = before < 0 ? 0 : before;
    const int64_t high = left > box->nx ? box->nx : left;
    for (int row = 0; row < box->ny; row++)
        TRY(read_row(c, box, row, low, high, err));
    return SHEAR_OK;
}
