/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/pixels/image_list.h: the HDUs of a file that hold one 2-D image each, plain or compressed.
 */
#pragma once

#include "fits/header/file.h"
#include "shear/input.h"

#include <stdbool.h>

typedef struct image_hdu {
    const sf_file *file;
    const sf_hdu *hdu;
    char label[SF_NAME]; /* for messages: EXTNAME, or its number */
    enum shear_part
        part;   /* what EXTTYPE, or else EXTNAME, says that it is; else SHEAR_PART_IMAGE */
    bool typed; /* EXTTYPE is MASK or VARIANCE, as LSST writes it */
    int nx, ny;
} image_hdu;

typedef struct image_list {
    image_hdu *items; /* [capacity], n in use; in the order of the file */
    int n;
    size_t capacity;
} image_list;

/* List the images of `file`, which must outlive the list. SHEAR_E_FORMAT, SHEAR_E_IO,
 * SHEAR_E_NOMEM. Call image_list_deinit after an error, too. */
int image_list_init(image_list *list, const sf_file *file, shear_error *err);
void image_list_deinit(image_list *list);

/* Keep only the HDU that is chosen; if none is, those that are this part; if there are none, those
 * that are not said to be anything. SHEAR_E_FORMAT: none is left. */
int image_list_choose(image_list *list, const sf_file *file, const shear_input_part *chosen,
                      enum shear_part part, shear_error *err);

/* Return the image's EXTNAME; "" if it has none of its own. */
const char *image_hdu_name(const image_hdu *image);
