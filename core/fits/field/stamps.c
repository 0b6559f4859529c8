/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fits/field/stamps.h"

#include "base/array.h"
#include "base/cleanup.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

static int check_sides(const sf_stamps *s, int64_t nx, int64_t ny, shear_error *err) {
    if (nx >= SHEAR_MIN_SIDE && nx <= SHEAR_MAX_SIDE && ny >= SHEAR_MIN_SIDE &&
        ny <= SHEAR_MAX_SIDE) {
        return SHEAR_OK;
    }
    return sf_fail(err, SHEAR_E_FORMAT, s->image.cards.at,
                   "a mosaic of stamps needs the keywords STAMPNX and STAMPNY",
                   "its stamps are %lld x %lld pixels, but a side must have %d to %d",
                   (long long)nx, (long long)ny, SHEAR_MIN_SIDE, SHEAR_MAX_SIDE);
}

/* Lay out a cube, or a single 2-D stamp. */
static int lay_out_cube(sf_stamps *s, int64_t nx, int64_t ny, shear_error *err) {
    const int64_t *axes = s->image.axes;
    if (nx != axes[0] || ny != axes[1]) {
        return sf_fail(err, SHEAR_E_FORMAT, s->image.cards.at, "leave STAMPNX and STAMPNY out",
                       "STAMPNX x STAMPNY is %lld x %lld, but the cube's planes are %lld x %lld",
                       (long long)nx, (long long)ny, (long long)axes[0], (long long)axes[1]);
    }
    s->layout = SHEAR_LAYOUT_CUBE;
    s->columns = 1;
    s->n = axes[2];
    return SHEAR_OK;
}

static int lay_out_mosaic(sf_stamps *s, int64_t nx, int64_t ny, shear_error *err) {
    const int64_t *axes = s->image.axes;
    if (axes[0] % nx != 0 || axes[1] % ny != 0) {
        return sf_fail(err, SHEAR_E_FORMAT, s->image.cards.at, NULL,
                       "the mosaic is %lld x %lld pixels, which is not a multiple of STAMPNX x "
                       "STAMPNY (%lld x %lld)",
                       (long long)axes[0], (long long)axes[1], (long long)nx, (long long)ny);
    }
    s->layout = SHEAR_LAYOUT_MOSAIC;
    s->columns = axes[0] / nx;
    const int64_t most = s->columns * (axes[1] / ny);
    s->n = most;
    return sf_key_int(&s->image.cards, "NSTAMP", 1, most, &s->n, err);
}

static int lay_out(sf_stamps *s, shear_error *err) {
    const sf_image *image = &s->image;
    int64_t nx = SF_ABSENT;
    int64_t ny = SF_ABSENT;
    TRY(sf_key_int(&image->cards, "STAMPNX", 1, INT32_MAX, &nx, err));
    TRY(sf_key_int(&image->cards, "STAMPNY", 1, INT32_MAX, &ny, err));
    const bool has_nx = nx != SF_ABSENT;
    if (has_nx != (ny != SF_ABSENT)) {
        return sf_fail(err, SHEAR_E_FORMAT, image->cards.at, "give both, or neither",
                       "it has the keyword %s without %s", has_nx ? "STAMPNX" : "STAMPNY",
                       has_nx ? "STAMPNY" : "STAMPNX");
    }
    nx = has_nx ? nx : image->axes[0];
    ny = has_nx ? ny : image->axes[1];
    TRY(check_sides(s, nx, ny, err));
    s->nx = (int)nx;
    s->ny = (int)ny;
    return image->naxis == 2 && has_nx ? lay_out_mosaic(s, nx, ny, err)
                                       : lay_out_cube(s, nx, ny, err);
}

int sf_stamps_init(sf_stamps *s, const sf_part *part, shear_error *err) {
    *s = (sf_stamps){0};
    TRY(sf_part_require(part, err));
    TRY(sf_image_init(&s->image, part->file, part->hdu, part->label, err));
    return lay_out(s, err);
}

void sf_stamps_deinit(sf_stamps *s) {
    sf_image_deinit(&s->image);
    free(s->scratch);
    s->scratch = NULL;
}

/* Read stamps [first, first + count), all in one row of the mosaic: one box, which is then
 * split. */
static int read_run(sf_stamps *s, int64_t first, int64_t count, double *out, shear_error *err) {
    const int64_t row = s->nx * count;
    const int64_t low[SF_AXES] = {first % s->columns * s->nx, first / s->columns * s->ny, 0};
    const int64_t size[SF_AXES] = {row, s->ny, 1};
    if (!ARRAY_RESERVE_EXACT(s->scratch, s->capacity, (size_t)(row * s->ny)))
        return sf_fail_memory(err, s->image.cards.at);
    TRY(sf_image_read(&s->image, low, size, s->scratch, err));
    for (int64_t i = 0; i < count; i++) {
        for (int64_t y = 0; y < s->ny; y++) {
            memcpy(out + (i * s->ny + y) * s->nx, s->scratch + y * row + i * s->nx,
                   (size_t)s->nx * sizeof *out);
        }
    }
    return SHEAR_OK;
}

int sf_stamps_read(sf_stamps *s, int64_t first, int64_t count, double *out, shear_error *err) {
    assert(first >= 0 && count >= 0 && first <= s->n - count);
    if (s->layout == SHEAR_LAYOUT_CUBE)
        return sf_image_planes(&s->image, first, count, out, err);
    for (int64_t done = 0; done < count;) {
        const int64_t in_row = s->columns - (first + done) % s->columns;
        const int64_t run = in_row < count - done ? in_row : count - done;
        TRY(read_run(s, first + done, run, out + done * s->nx * s->ny, err));
        done += run;
    }
    return SHEAR_OK;
}
