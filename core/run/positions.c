/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "run/positions.h"

#include "base/cleanup.h"

enum { GALAXIES = 64, STAMPS = 512 };

bool positions_known(const shear_field_info *info) {
    const unsigned needed = SHEAR_COL_X | SHEAR_COL_Y | SHEAR_COL_DROPPED;
    return (info->columns & needed) == needed;
}

/* The distances of light from positions, pixels. */
typedef struct distances {
    int looked_at, found;
    double x[GALAXIES], y[GALAXIES];
} distances;

static void add_stamps(distances *d, const shear_block *b) {
    for (int i = 0; i < b->stamps.count && d->looked_at < GALAXIES; i++) {
        double *x = &d->x[d->found];
        double *y = &d->y[d->found];
        if (b->dropped[i] != 0)
            continue;
        d->looked_at++;
        d->found += shear_centring_find(&b->stamps, i, b->x[i], b->y[i], x, y);
    }
}

int positions_check(shear_centring *c, const shear_field_info *info, shear_source source,
                    int capacity, shear_error *err) {
    const int64_t end = info->n_stamps < STAMPS ? info->n_stamps : STAMPS;
    const shear_block *block = NULL;
    distances d = {0};
    for (int64_t first = 0; first < end && d.looked_at < GALAXIES; first += capacity) {
        const int count = end - first < capacity ? (int)(end - first) : capacity;
        TRY(source.read(source.self, 0, first, count, &block, err));
        add_stamps(&d, block);
    }
    shear_centring_summarize(c, d.looked_at, d.x, d.y, d.found);
    return SHEAR_OK;
}
