/* SPDX-License-Identifier: GPL-3.0-or-later */
/* match.c: which image of another file belongs to which chip. */
#include "survey/pixels/internal.h"

#include "base/cleanup.h"

#include <strings.h>

/* Return the index of the only image called `name`; -1 if there is none or are several. */
static int find_name(const image_list *list, const char *name) {
    int found = -1;
    for (int i = 0; i < list->n && name[0] != '\0'; i++) {
        if (strcasecmp(image_hdu_name(&list->items[i]), name) != 0)
            continue;
        if (found >= 0)
            return -1;
        found = i;
    }
    return found;
}

/* Assign the images by name. Return how many chips have one; 0 if two chips have one name. */
static int match_names(exposure_images *e, enum chip_layer layer, const image_list *list) {
    int matched = 0;
    for (int i = 0; i < e->n_chips; i++) {
        const char *name = image_hdu_name(&e->chips[i].layers[LAYER_IMAGE]);
        const int found = find_name(list, name);
        for (int k = 0; k < i && found >= 0; k++) {
            if (strcasecmp(image_hdu_name(&e->chips[k].layers[LAYER_IMAGE]), name) == 0)
                return 0;
        }
        if (found >= 0)
            e->chips[i].layers[layer] = list->items[found];
        matched += found >= 0 ? 1 : 0;
    }
    return matched;
}

/* Return the place of a chip among the images of its file, and their number. */
static int place_of(const image_chip *chip, const image_list *images, int *n) {
    int place = -1;
    *n = 0;
    for (int i = 0; i < images->n; i++) {
        if (images->items[i].hdu == chip->layers[LAYER_IMAGE].hdu)
            place = *n;
        *n += images->items[i].part == SHEAR_PART_IMAGE ? 1 : 0;
    }
    return place;
}

static int match_order(exposure_images *e, enum chip_layer layer, const image_list *list,
                       const image_list *images, shear_error *err) {
    int n = 0;
    for (int i = 0; i < e->n_chips; i++) {
        const int place = place_of(&e->chips[i], images, &n);
        if (list->n != n && list->n != e->n_chips)
            break;
        e->chips[i].layers[layer] = list->items[list->n == e->n_chips ? i : place];
    }
    if (list->n == n || list->n == e->n_chips)
        return SHEAR_OK;
    return sf_fail(err, SHEAR_E_FORMAT, (sf_place){list->items[0].file->source.name, NULL},
                   "there must be one for each chip, of the same EXTNAME or in the same order; or "
                   "choose the HDU of each: FILE:HDU",
                   "has %d 2-D images, but the exposure has %d chips", list->n, e->n_chips);
}

static int unmatched(const exposure_images *e, enum chip_layer layer, const image_list *list,
                     shear_error *err) {
    int i = 0;
    while (e->chips[i].layers[layer].file != NULL)
        i++;
    const char *name = image_hdu_name(&e->chips[i].layers[LAYER_IMAGE]);
    return sf_fail(err, SHEAR_E_FORMAT, (sf_place){list->items[0].file->source.name, NULL},
                   "HDUs of an exposure are matched by EXTNAME: all chips need one, or none",
                   "has images for some chips, but not for %s (HDU %d of the exposure)",
                   name[0] != '\0' ? name : "the one without an EXTNAME",
                   e->chips[i].layers[LAYER_IMAGE].hdu->number);
}

int exposure_images_match(exposure_images *e, enum chip_layer layer, const image_list *list,
                          const image_list *images, shear_error *err) {
    const int matched = match_names(e, layer, list);
    if (matched == e->n_chips)
        return SHEAR_OK;
    return matched == 0 ? match_order(e, layer, list, images, err) : unmatched(e, layer, list, err);
}
