/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/cutout/draw.h"

#include <Random123/philox.h>
#include <assert.h>
#include <math.h>

enum { WORDS = 4 };

static philox4x32_ctr_t words(draw_key key, enum draw_purpose purpose, uint32_t plane,
                              uint32_t block) {
    const uint64_t id = (uint64_t)key.id;
    const philox4x32_ctr_t counter = {{(uint32_t)id, (uint32_t)(id >> 32), plane, block}};
    const philox4x32_key_t k = {{(uint32_t)key.chip, (uint32_t)purpose}};
    return philox4x32(counter, k);
}

uint32_t draw_index(draw_key key, uint32_t i, uint32_t n) {
    assert(n > 0);
    const philox4x32_ctr_t w = words(key, DRAW_BOX, 0, i);
    const uint64_t high = (uint64_t)w.v[0] * n;
    const uint64_t low = (uint64_t)w.v[1] * n;
    return (uint32_t)((high + (low >> 32)) >> 32);
}

/* Make normal numbers of the words of a block (Box and Muller 1958). */
static void normals(philox4x32_ctr_t w, double out[WORDS]) {
    static const double two_pi = 6.283185307179586;
    for (int i = 0; i < WORDS; i += 2) {
        const double r = sqrt(-2.0 * log(((double)w.v[i] + 0.5) * 0x1p-32));
        const double angle = two_pi * 0x1p-32 * (double)w.v[i + 1];
        out[i] = r * cos(angle);
        out[i + 1] = r * sin(angle);
    }
}

static double sigma_at(const draw_normals *d, size_t i) {
    return d->sigmas != NULL && isfinite(d->sigmas[i]) ? d->scale * (double)d->sigmas[i] : d->sigma;
}

void draw_fill(double *to, size_t n, draw_key key, const draw_normals *what) {
    double z[WORDS] = {0.0};
    size_t block = SIZE_MAX;
    for (size_t i = 0; i < n; i++) {
        if (what->mask != NULL && what->mask[i] == 0)
            continue;
        if (i / WORDS != block) {
            block = i / WORDS;
            normals(words(key, what->purpose, (uint32_t)what->plane, (uint32_t)block), z);
        }
        to[i] = sigma_at(what, i) * z[i % WORDS];
    }
}
