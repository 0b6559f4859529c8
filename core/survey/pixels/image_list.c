/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/pixels/image_list.h"

#include "base/array.h"
#include "base/cleanup.h"
#include "base/text.h"
#include "fits/header/cards.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

/* More than any image has: a band of rows must fit into the cache, and there is a table of bands.
 */
enum { MAX_SIDE = 2000000 };
/* A small file may describe more, compressed, than can be read in a day. */
static const int64_t max_pixels = INT64_C(20000000000);

/* ---- what an HDU is ---- */

static const struct {
    const char *name;
    enum shear_part part;
} words[] = {
    {"MASK", SHEAR_PART_MASK},        {"DQ", SHEAR_PART_MASK},
    {"FLAG", SHEAR_PART_MASK},        {"FLAGS", SHEAR_PART_MASK},
    {"MSK", SHEAR_PART_MASK},         {"VARIANCE", SHEAR_PART_WEIGHT},
    {"WEIGHT", SHEAR_PART_WEIGHT},    {"WHT", SHEAR_PART_WEIGHT},
    {"WGT", SHEAR_PART_WEIGHT},       {"ERR", SHEAR_PART_WEIGHT},
    {"RMS", SHEAR_PART_WEIGHT},       {"SEGMENTATION", SHEAR_PART_SEGMENTATION},
    {"SEG", SHEAR_PART_SEGMENTATION},
};

static enum shear_part part_called(const char *name) {
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
        if (strcasecmp(words[i].name, name) == 0)
            return words[i].part;
    }
    return SHEAR_PART_IMAGE;
}

static int find_part(image_hdu *image, const sf_cards *cards, shear_error *err) {
    CLEANUP(release_free) char *type = NULL;
    TRY(sf_key_string(cards, "EXTTYPE", &type, err));
    image->typed =
        type != NULL && (strcasecmp(type, "MASK") == 0 || strcasecmp(type, "VARIANCE") == 0);
    image->part = part_called(type != NULL ? type : image->hdu->name);
    return SHEAR_OK;
}

const char *image_hdu_name(const image_hdu *image) {
    /* fpack gives this name to an image that had none */
    return strcmp(image->hdu->name, "COMPRESSED_IMAGE") == 0 ? "" : image->hdu->name;
}

/* ---- the list ---- */

static int find_size(const sf_cards *cards, int64_t axes[SF_AXES], shear_error *err) {
    const sf_hdu *hdu = cards->hdu;
    int64_t naxis = hdu->naxis;
    for (int k = 0; k < SF_AXES; k++)
        axes[k] = hdu->axes[k];
    if (hdu->zimage) {
        TRY(sf_need_int(cards, "ZNAXIS", 0, 999, &naxis, err));
        for (int k = 0; k < SF_AXES; k++) {
            char key[SF_INDEXED];
            sf_card_indexed(key, "ZNAXIS", k + 1);
            axes[k] = 1;
            if (k < naxis)
                TRY(sf_need_int(cards, key, 0, INT32_MAX, &axes[k], err));
        }
    }
    if (naxis < 2 || naxis > 3 || axes[2] != 1)
        axes[0] = 0; /* no 2-D image */
    return SHEAR_OK;
}

static int check_size(const sf_cards *cards, const int64_t axes[SF_AXES], shear_error *err) {
    if (axes[0] <= MAX_SIDE && axes[1] <= MAX_SIDE && axes[0] * axes[1] <= max_pixels)
        return SHEAR_OK;
    return sf_fail(err, SHEAR_E_FORMAT, cards->at, "cut the image into smaller ones",
                   "the image has %lld x %lld pixels, but at most %d on a side and %lld in all "
                   "can be read",
                   (long long)axes[0], (long long)axes[1], MAX_SIDE, (long long)max_pixels);
}

/* Add the HDU if it holds a 2-D image. */
static int consider(image_list *list, const sf_file *file, const sf_hdu *hdu, shear_error *err) {
    image_hdu image = {.file = file, .hdu = hdu};
    CLEANUP(sf_cards_deinit) sf_cards cards = {0};
    int64_t axes[SF_AXES];
    if (hdu->kind != SF_IMAGE && !hdu->zimage)
        return SHEAR_OK;
    text_set(image.label, sizeof image.label, hdu->name);
    if (hdu->name[0] == '\0')
        snprintf(image.label, sizeof image.label, "%d (from 0)", hdu->number);
    TRY(sf_cards_init(&cards, file, hdu, image.label, err));
    TRY(find_size(&cards, axes, err));
    if (axes[0] == 0 || axes[1] == 0)
        return SHEAR_OK;
    TRY(check_size(&cards, axes, err));
    image.nx = (int)axes[0];
    image.ny = (int)axes[1];
    TRY(find_part(&image, &cards, err));
    if (!ARRAY_RESERVE(list->items, list->capacity, (size_t)list->n + 1))
        return sf_fail_memory(err, cards.at);
    list->items[list->n++] = image;
    return SHEAR_OK;
}

int image_list_init(image_list *list, const sf_file *file, shear_error *err) {
    *list = (image_list){0};
    for (int i = 0; i < file->count; i++)
        TRY(consider(list, file, &file->hdus[i], err));
    return SHEAR_OK;
}

void image_list_deinit(image_list *list) {
    free(list->items);
    *list = (image_list){0};
}

/* ---- choosing ---- */

static int keep_hdu(image_list *list, const sf_file *file, int64_t number, shear_error *err) {
    for (int i = 0; i < list->n; i++) {
        if (list->items[i].hdu->number == number) {
            list->items[0] = list->items[i];
            list->n = 1;
            return SHEAR_OK;
        }
    }
    return sf_fail(err, SHEAR_E_FORMAT, (sf_place){file->source.name, NULL},
                   "HDUs are counted from 0, the primary; or give the EXTNAME",
                   number >= file->count ? "has no HDU number %lld" : "HDU %lld is no 2-D image",
                   (long long)number);
}

static int count_part(const image_list *list, enum shear_part part) {
    int n = 0;
    for (int i = 0; i < list->n; i++)
        n += list->items[i].part == part ? 1 : 0;
    return n;
}

static void keep_part(image_list *list, enum shear_part part) {
    int n = 0;
    for (int i = 0; i < list->n; i++) {
        if (list->items[i].part == part)
            list->items[n++] = list->items[i];
    }
    list->n = n;
}

int image_list_choose(image_list *list, const sf_file *file, const shear_input_part *chosen,
                      enum shear_part part, shear_error *err) {
    if (chosen->extname != NULL) {
        const sf_hdu *hdu = NULL;
        TRY(sf_file_find(file, chosen->extname, true, &hdu, err));
        return keep_hdu(list, file, hdu->number, err);
    }
    if (chosen->hdu >= 0)
        return keep_hdu(list, file, chosen->hdu, err);
    const bool empty = list->n == 0;
    keep_part(list, count_part(list, part) > 0 ? part : SHEAR_PART_IMAGE);
    return list->n > 0 ? SHEAR_OK
                       : sf_fail(err, SHEAR_E_FORMAT, (sf_place){file->source.name, NULL},
                                 empty ? "see which file is which: images have two axes"
                                       : "choose an HDU: FILE:HDU, by number from 0 or by EXTNAME",
                                 empty ? "has no 2-D image: it cannot be the %s"
                                       : "none of its 2-D images can be the %s",
                                 shear_part_name((int)part));
}
