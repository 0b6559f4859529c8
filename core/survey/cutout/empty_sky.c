/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/cutout/empty_sky.h"

#include "base/cleanup.h"
#include "base/simd.h"
#include "survey/cutout/growth.h"
#include "survey/cutout/quiet_blocks.h"

#include <string.h>

enum { GROW = 4 }; /* pixels by which objects are grown: their faint wings are not empty sky */

/* A band of rows, as high as a mesh, and what is made of it. */
typedef struct band {
    int nx, ny; /* of the chip */
    int y, n;   /* its rows */
    double *value;
    float *sigma;
    uint8_t *defect; /* [n][nx], like value and sigma */
    int32_t *owner;  /* [n + 2 GROW][nx], from row y - GROW on */
    int padded;      /* width of a row of marks: GROWTH_MOST on both sides, and whole cells */
    uint8_t *object; /* [MESH_SIDE + 2 GROW][padded] marks of objects */
    growth grown;
    uint8_t *marks;   /* [padded] a row of grown objects ... */
    uint8_t *defects; /* [padded] ... and the number of defects in a row of cells */
    quiet_blocks quiet;
} band;

static void place_band(band *b, arena *a) {
    const size_t n = (size_t)b->nx;
    const size_t high = MESH_SIDE + 2 * GROW;
    b->padded = (b->nx + BOX_CELL - 1) / BOX_CELL * BOX_CELL + 2 * GROWTH_MOST;
    b->value = arena_doubles(a, n * MESH_SIDE);
    b->sigma = arena_take(a, n * MESH_SIDE * sizeof *b->sigma);
    b->defect = arena_take(a, n * MESH_SIDE);
    b->owner = arena_take(a, n * high * sizeof *b->owner);
    b->object = arena_take(a, (size_t)b->padded * high);
    growth_place(&b->grown, b->padded - 2 * GROWTH_MOST, a);
    b->marks = arena_take(a, (size_t)b->padded);
    b->defects = arena_take(a, (size_t)b->padded);
    quiet_blocks_place(&b->quiet, b->nx, a);
}

SHEAR_SIMD static void mark_objects(uint8_t *restrict marks, const int32_t *restrict owner,
                                    size_t n) {
#pragma omp simd
    for (size_t i = 0; i < n; i++)
        marks[i] = owner[i] != 0;
}

SHEAR_SIMD static void count_defects(uint8_t *restrict counts, const uint8_t *restrict defect,
                                     size_t n) {
#pragma omp simd
    for (size_t i = 0; i < n; i++)
        counts[i] = (uint8_t)(counts[i] + (defect[i] != 0));
}

/* Read the band, and the owners of GROW rows around it; rows beyond the chip have none. */
static int read_band(band *b, chip_pixels *pixels, shear_error *err) {
    const int first = b->y < GROW ? 0 : b->y - GROW;
    const int end = b->y + b->n + GROW < b->ny ? b->y + b->n + GROW : b->ny;
    const pixel_box own = {.y = b->y,
                           .nx = b->nx,
                           .ny = b->n,
                           .value = b->value,
                           .sigma = b->sigma,
                           .defect = b->defect};
    const pixel_box wider = {.y = first, .nx = b->nx, .ny = end - first, .owner = b->owner};
    TRY(chip_pixels_read(pixels, &own, err));
    TRY(chip_pixels_read(pixels, &wider, err));
    memset(b->object, 0, (size_t)b->padded * (MESH_SIDE + 2 * GROW));
    for (int y = first; y < end; y++) {
        uint8_t *marks = b->object + (size_t)(y - b->y + GROW) * (size_t)b->padded + GROWTH_MOST;
        mark_objects(marks, b->owner + (size_t)(y - first) * (size_t)b->nx, (size_t)b->nx);
    }
    return SHEAR_OK;
}

/* Enter a row of cells, whose first row of pixels is the band's row `top`. */
static void enter_cells(band *b, box_map *boxes, int top) {
    growth_begin(&b->grown);
    for (int y = -GROW; y < BOX_CELL + GROW; y++) {
        const int d = y < 0 ? -y : y < BOX_CELL ? 0 : y - BOX_CELL + 1;
        growth_add(&b->grown, b->object + (size_t)(top + y + GROW) * (size_t)b->padded, d, GROW);
    }
    growth_finish(&b->grown, b->marks);
    memset(b->defects, 0, (size_t)b->padded);
    for (int y = top; y < top + BOX_CELL && y < b->n; y++)
        count_defects(b->defects, b->defect + (size_t)y * (size_t)b->nx, (size_t)b->nx);
    box_map_enter(boxes, (b->y + top) / BOX_CELL, b->marks, b->defects);
}

/* Enter the band's rows, amplifier by amplifier, without what is quiet. */
static void enter_meshes(empty_sky *s, band *b) {
    const amplifier_axis *axis = &s->boxes.y;
    const int band_end = b->y + b->n;
    int end;
    for (int y = b->y; y < band_end; y = end) {
        const size_t at = (size_t)(y - b->y) * (size_t)b->nx;
        end = amplifier_axis_start(axis, amplifier_axis_at(axis, y) + 1);
        end = end < band_end ? end : band_end;
        const mesh_pixels rows = {.value = b->value + at,
                                  .sigma = b->sigma + at,
                                  .defect = b->defect + at,
                                  .y = y,
                                  .n = end - y,
                                  .map = &s->boxes};
        quiet_blocks_find(&b->quiet, &s->boxes, &rows);
        noise_mesh_enter(&s->mesh, &rows);
    }
}

static int survey(empty_sky *s, band *b, chip_pixels *pixels, shear_error *err) {
    for (b->y = 0; b->y < b->ny; b->y += MESH_SIDE) {
        b->n = b->ny - b->y < MESH_SIDE ? b->ny - b->y : MESH_SIDE;
        TRY(read_band(b, pixels, err));
        for (int top = 0; top < b->n; top += BOX_CELL)
            enter_cells(b, &s->boxes, top);
        enter_meshes(s, b);
    }
    box_map_close(&s->boxes);
    noise_mesh_close(&s->mesh);
    return SHEAR_OK;
}

static void place(empty_sky *s, arena *a) {
    box_map_place(&s->boxes, a);
    noise_mesh_place(&s->mesh, a);
}

int empty_sky_init(empty_sky *s, chip_pixels *pixels, shear_error *err) {
    band b = {.nx = s->boxes.x.pixels, .ny = s->boxes.y.pixels};
    arena kept = {0};
    arena scratch = {0};
    s->mesh.x = s->boxes.x;
    s->mesh.y = s->boxes.y;
    place(s, &kept);
    place_band(&b, &scratch);
    s->memory = arena_allocate(&kept);
    CLEANUP(release_free) void *memory = arena_allocate(&scratch);
    if (s->memory == NULL || memory == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory");
    place(s, &kept);
    place_band(&b, &scratch);
    return survey(s, &b, pixels, err);
}

void empty_sky_deinit(empty_sky *s) {
    free(s->memory);
    s->memory = NULL;
}
