/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/pixels/internal.h: an exposure's chips, for the files of this room. */
#pragma once

#include "survey/pixels/exposure_images.h"
#include "survey/pixels/image_list.h"
#include "survey/pixels/mask_rule.h"

/* The parts that are images of the chip's shape, in this order. */
enum chip_layer { LAYER_IMAGE = 0, LAYER_WEIGHT, LAYER_MASK, LAYER_SEGMENTATION, N_LAYERS };

typedef struct image_chip {
    image_hdu layers[N_LAYERS]; /* file NULL: there is none */
    char *header;               /* [cards][80] */
    int64_t cards;
    double saturate; /* NaN: unknown */
    enum shear_weight_kind weight_kind;
    mask_rule mask;
} image_chip;

struct exposure_images {
    sf_file files[N_LAYERS];
    const char *paths[N_LAYERS]; /* the caller's, while it is opened */
    int n_files;
    image_chip *chips; /* [n_chips] */
    int n_chips;
};

/* Match the images of another layer with the chips: by EXTNAME, else by order. `images` is the list
 * of all images in the chips' file that could be chips, for their order. SHEAR_E_FORMAT. */
int exposure_images_match(exposure_images *e, enum chip_layer layer, const image_list *list,
                          const image_list *images, shear_error *err);

/* Join the header of a chip with that of the primary HDU of its file, and find SATURATE in it. */
int image_chip_read_header(image_chip *chip, shear_error *err);
