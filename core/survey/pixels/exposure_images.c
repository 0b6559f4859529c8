/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/pixels/exposure_images.h"

#include "base/cleanup.h"
#include "fits/header/meds.h"
#include "survey/pixels/internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const enum shear_part parts[N_LAYERS] = {SHEAR_PART_IMAGE, SHEAR_PART_WEIGHT,
                                                SHEAR_PART_MASK, SHEAR_PART_SEGMENTATION};

/* ---- files ---- */

/* Open a layer's file, unless it is open already for another one. */
static int open_file(exposure_images *e, const char *path, int fd, const sf_file **file,
                     shear_error *err) {
    for (int i = 0; i < e->n_files; i++) {
        if (strcmp(e->paths[i], path) == 0) {
            *file = &e->files[i];
            return SHEAR_OK;
        }
    }
    sf_file *f = &e->files[e->n_files];
    e->paths[e->n_files++] = path; /* so that it is closed, also after an error */
    *file = f;
    TRY(sf_file_open(f, path, fd, err));
    return sf_meds_refuse(f, err);
}

/* List the images of a layer's file, and those of it that the layer may be. */
static int open_layer(exposure_images *e, enum chip_layer layer, const shear_input *input,
                      const int *fds, image_list *all, image_list *chosen, shear_error *err) {
    const sf_file *file = NULL;
    const enum shear_part part = parts[layer];
    TRY(open_file(e, input->parts[part].path, fds != NULL ? fds[part] : -1, &file, err));
    TRY(image_list_init(all, file, err));
    TRY(image_list_init(chosen, file, err));
    return image_list_choose(chosen, file, &input->parts[part], part, err);
}

/* ---- chips ---- */

/* With what chips inherit; real exposures have less than 10 MiB. */
enum { MAX_HEADER_BYTES = 256 << 20 };

static int read_headers(exposure_images *e, shear_error *err) {
    const sf_file *file = e->chips[0].layers[LAYER_IMAGE].file;
    int64_t bytes = 0;
    for (int i = 0; i < e->n_chips; i++) {
        bytes += e->chips[i].layers[LAYER_IMAGE].hdu->header_bytes + file->hdus[0].header_bytes;
        if (bytes > MAX_HEADER_BYTES) {
            return sf_fail(err, SHEAR_E_FORMAT, (sf_place){file->source.name, NULL},
                           "choose an HDU: FILE:HDU, by number from 0 or by EXTNAME",
                           "the headers of its images have more than %d MiB, with that of the "
                           "primary HDU for each",
                           MAX_HEADER_BYTES >> 20);
        }
        TRY(image_chip_read_header(&e->chips[i], err));
    }
    return SHEAR_OK;
}

static int make_chips(exposure_images *e, const image_list *images, shear_error *err) {
    e->chips = calloc((size_t)images->n, sizeof *e->chips);
    if (e->chips == NULL)
        return sf_fail_memory(err, (sf_place){e->files[0].source.name, NULL});
    e->n_chips = images->n;
    for (int i = 0; i < e->n_chips; i++)
        e->chips[i].layers[LAYER_IMAGE] = images->items[i];
    return read_headers(e, err);
}

/* Find the chip's weight map or mask in the chip's own file: one of the HDUs between it and the
 * next image. */
static void find_own_layer(image_chip *chip, enum chip_layer layer, const image_list *all) {
    bool behind = false;
    for (int i = 0; i < all->n; i++) {
        const image_hdu *image = &all->items[i];
        if (behind && image->part == SHEAR_PART_IMAGE)
            return;
        if (behind && image->typed && image->part == parts[layer]) {
            chip->layers[layer] = *image;
            return;
        }
        behind = behind || image->hdu == chip->layers[LAYER_IMAGE].hdu;
    }
}

static int check_layer(const image_chip *chip, enum chip_layer layer, shear_error *err) {
    const image_hdu *image = &chip->layers[LAYER_IMAGE];
    const image_hdu *other = &chip->layers[layer];
    const sf_place at = {other->file != NULL ? other->file->source.name : "", other->label};
    const char *name = shear_part_name((int)parts[layer]);
    if (other->file == NULL)
        return SHEAR_OK;
    if (other->hdu == image->hdu) {
        return sf_fail(err, SHEAR_E_FORMAT, at,
                       "choose the HDU of each: FILE:HDU, by number from 0 or by EXTNAME",
                       "image and %s are the same HDU", name);
    }
    if (other->nx == image->nx && other->ny == image->ny)
        return SHEAR_OK;
    return sf_fail(err, SHEAR_E_FORMAT, at, "both must be of the same exposure, and trimmed alike",
                   "the %s has %d x %d pixels, but the image (%s) has %d x %d", name, other->nx,
                   other->ny, image->label, image->nx, image->ny);
}

static int init_mask_rule(image_chip *chip, const char *text, shear_error *err) {
    const image_hdu *mask = &chip->layers[LAYER_MASK];
    CLEANUP(sf_cards_deinit) sf_cards cards = {0};
    if (mask->file == NULL && text != NULL) {
        return sf_fail(err, SHEAR_E_SETTING,
                       (sf_place){chip->layers[LAYER_IMAGE].file->source.name, NULL},
                       "give the mask as well",
                       "bad mask values ('%.40s') are given, but there is no mask", text);
    }
    if (mask->file == NULL)
        return SHEAR_OK;
    TRY(sf_cards_init(&cards, mask->file, mask->hdu, mask->label, err));
    return mask_rule_init(&chip->mask, text, &cards, err);
}

/* Check the chip's layers, and find what their pixels mean. */
static int finish_chip(image_chip *chip, const shear_exposure *options, shear_error *err) {
    const image_hdu *weight = &chip->layers[LAYER_WEIGHT];
    for (int layer = LAYER_WEIGHT; layer < N_LAYERS; layer++)
        TRY(check_layer(chip, (enum chip_layer)layer, err));
    chip->weight_kind = weight->typed ? SHEAR_WEIGHT_IS_VARIANCE : options->weight_kind;
    return init_mask_rule(chip, options->mask_bad, err);
}

/* ---- opening ---- */

static int open_other(exposure_images *e, enum chip_layer layer, const shear_input *input,
                      const int *fds, const image_list *images, shear_error *err) {
    CLEANUP(image_list_deinit) image_list all = {0};
    CLEANUP(image_list_deinit) image_list chosen = {0};
    if (input->parts[parts[layer]].path == NULL) {
        for (int i = 0; i < e->n_chips && layer != LAYER_SEGMENTATION; i++)
            find_own_layer(&e->chips[i], layer, images);
        return SHEAR_OK;
    }
    TRY(open_layer(e, layer, input, fds, &all, &chosen, err));
    return exposure_images_match(e, layer, &chosen, images, err);
}

static int open_all(exposure_images *e, const shear_input *input, const int *fds,
                    shear_error *err) {
    CLEANUP(image_list_deinit) image_list all = {0};
    CLEANUP(image_list_deinit) image_list images = {0};
    TRY(open_layer(e, LAYER_IMAGE, input, fds, &all, &images, err));
    TRY(make_chips(e, &images, err));
    for (int layer = LAYER_WEIGHT; layer < N_LAYERS; layer++)
        TRY(open_other(e, (enum chip_layer)layer, input, fds, &all, err));
    for (int i = 0; i < e->n_chips; i++)
        TRY(finish_chip(&e->chips[i], &input->exposure, err));
    return SHEAR_OK;
}

int exposure_images_open(exposure_images **e, const shear_input *input, const int *fds,
                         shear_error *err) {
    *e = calloc(1, sizeof **e);
    if (*e == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory");
    const int code = open_all(*e, input, fds, err);
    if (code != SHEAR_OK) {
        exposure_images_close(*e);
        *e = NULL;
    }
    return code;
}

void exposure_images_close(exposure_images *e) {
    if (e == NULL)
        return;
    for (int i = 0; i < e->n_chips; i++)
        free(e->chips[i].header);
    free(e->chips);
    for (int i = 0; i < e->n_files; i++)
        sf_file_close(&e->files[i]);
    free(e);
}

/* ---- what there is ---- */

int exposure_images_chips(const exposure_images *e) {
    return e->n_chips;
}

const char *exposure_images_name(const exposure_images *e, int i) {
    return image_hdu_name(&e->chips[i].layers[LAYER_IMAGE]);
}

const char *exposure_images_header(const exposure_images *e, int i, int64_t *count) {
    *count = e->chips[i].cards;
    return e->chips[i].header;
}

void exposure_images_size(const exposure_images *e, int i, int *nx, int *ny) {
    *nx = e->chips[i].layers[LAYER_IMAGE].nx;
    *ny = e->chips[i].layers[LAYER_IMAGE].ny;
}

int64_t exposure_images_hdu(const exposure_images *e, int i, enum shear_part part) {
    for (int layer = 0; layer < N_LAYERS; layer++) {
        if (parts[layer] == part && e->chips[i].layers[layer].file != NULL)
            return e->chips[i].layers[layer].hdu->number;
    }
    return -1;
}

int64_t exposure_images_bytes(const exposure_images *e) {
    int64_t bytes = 0;
    for (int i = 0; i < e->n_files; i++)
        bytes += e->files[i].source.file_bytes;
    return bytes;
}
