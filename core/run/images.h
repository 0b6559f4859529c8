/* SPDX-License-Identifier: GPL-3.0-or-later */
/* run/images.h: images in the caller's memory, as doubles without gaps. */
#ifndef SHEAR_RUN_IMAGES_H
#define SHEAR_RUN_IMAGES_H

#include "shear/arrays.h"

#include <stdbool.h>

/* [planes][ny][nx] pixels for each number. */
typedef struct images {
    shear_images in; /* with all strides, also where the caller gave none */
    int planes, nx, ny;
} images;

/* SHEAR_E_FORMAT for a type that does not exist and where there are no pixels; `name` is for the
 * message. */
int images_init(images *m, const shear_images *in, int planes, int nx, int ny, const char *name,
                shear_error *err);

/* They are doubles without gaps and need no copy. */
bool images_are_plain(const images *m);

/* Numbers [first, first+count): in place if they are plain, else converted into `scratch`, which
 * has memory for them, and is not looked at otherwise. */
const double *images_get(const images *m, int64_t first, int count, double *scratch);
/* Convert number `i` into out[planes][ny][nx]. */
void images_copy(const images *m, int64_t i, double *out);

#endif
