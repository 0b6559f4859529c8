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

static int lay_out_mosaic(sf_stamps *s, int64_t nx, int64_t ny, int64_t stamps, shear_error *err) {
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
    s->n = stamps > 0 ? stamps : most;
    if (stamps > most) {
        return sf_fail(err, SHEAR_E_FORMAT, s->image.cards.at, NULL,
                       "the mosaic has room for %lld stamps, not for %lld", (long long)most,
                       (long long)stamps);
    }
    return stamps > 0 ? SHEAR_OK : sf_key_int(&s->image.cards, "NSTAMP", 1, most, &s->n, err);
}

/* Read the size of a stamp from the keywords; SF_ABSENT without them. */
static int read_size(const sf_image *image, int64_t *nx, int64_t *ny, shear_error *err) {
    *nx = *ny = SF_ABSENT;
    TRY(sf_key_int(&image->cards, "STAMPNX", 1, INT32_MAX, nx, err));
    TRY(sf_key_int(&image->cards, "STAMPNY", 1, INT32_MAX, ny, err));
    const bool has_nx = *nx != SF_ABSENT;
    if (has_nx == (*ny != SF_ABSENT))
        return SHEAR_OK;
    return sf_fail(err, SHEAR_E_FORMAT, image->cards.at, "give both, or neither",
                   "it has the keyword %s without %s", has_nx ? "STAMPNX" : "STAMPNY",
                   has_nx ? "STAMPNY" : "STAMPNX");
}

/* An image this large is a grid of stamps that does not say so, rather than one stamp. */
static int check_single(const sf_image *image, shear_error *err) {
    enum { LARGE = 256 };
    if (image->naxis != 2 || (image->axes[0] <= LARGE && image->axes[1] <= LARGE))
        return SHEAR_OK;
    return sf_fail(err, SHEAR_E_FORMAT, image->cards.at,
                   "say how large a stamp is: --stamp-size (or the keywords STAMPNX and STAMPNY), "
                   "and --stamps where the last row is not full",
                   "is one image of %lld x %lld pixels, without the keywords of a mosaic of stamps",
                   (long long)image->axes[0], (long long)image->axes[1]);
}

static int lay_out(sf_stamps *s, const shear_mosaic *mosaic, shear_error *err) {
    const sf_image *image = &s->image;
    int64_t nx = mosaic->stamp_nx;
    int64_t ny = mosaic->stamp_ny;
    if (nx == 0)
        TRY(read_size(image, &nx, &ny, err));
    const bool sized = nx != SF_ABSENT;
    if (!sized)
        TRY(check_single(image, err));
    nx = sized ? nx : image->axes[0];
    ny = sized ? ny : image->axes[1];
    TRY(check_sides(s, nx, ny, err));
    s->nx = (int)nx;
    s->ny = (int)ny;
    return image->naxis == 2 && sized ? lay_out_mosaic(s, nx, ny, mosaic->stamps, err)
                                      : lay_out_cube(s, nx, ny, err);
}

int sf_stamps_init(sf_stamps *s, const sf_part *part, const shear_mosaic *mosaic,
                   shear_error *err) {
    *s = (sf_stamps){0};
    TRY(sf_part_require(part, err));
    TRY(sf_image_init(&s->image, part->file, part->hdu, part->label, err));
    return lay_out(s, mosaic, err);
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
