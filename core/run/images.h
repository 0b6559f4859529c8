/* SPDX-License-Identifier: GPL-3.0-or-later */
/* run/images.h: read images in the caller's memory as doubles without gaps. */
#pragma once

#include "shear/arrays.h"

#include <stdbool.h>

/* Equal images, numbered from 0. Each number has [planes][ny][nx] pixels. */
typedef struct images {
    shear_images in; /* with all strides set, also if the caller gave none */
    int planes, nx, ny;
} images;

/* Set up *m. SHEAR_E_FORMAT if there are no pixels or their type is unknown; `name` is for the
 * message. */
int images_init(images *m, const shear_images *in, int planes, int nx, int ny, const char *name,
                shear_error *err);

/* Return whether they are doubles without gaps, which need no copy. */
bool images_are_plain(const images *m);

/* Return numbers [first, first+count): in place if they are plain, else converted into `scratch`,
 * which must be large enough. `scratch` is not used for plain images. */
const double *images_get(const images *m, int64_t first, int count, double *scratch);
/* Convert number `i` into out[planes][ny][nx]. */
void images_copy(const images *m, int64_t i, double *out);
