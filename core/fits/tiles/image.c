/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fits/tiles/image.h"

#include "base/cleanup.h"

#include <math.h>
#include <string.h>

static int check_header(const sf_hdu *hdu, sf_place at, shear_error *err) {
    if (hdu->zimage && hdu->kind == SF_TABLE) {
        return SHEAR_OK; /* checked by sf_tiling_init */
    }
    if (hdu->kind != SF_IMAGE)
        return sf_fail(err, SHEAR_E_FORMAT, at, NULL, "must be an image, but is a table");
    if (hdu->naxis != 2 && hdu->naxis != 3) {
        return sf_fail(err, SHEAR_E_FORMAT, at, NULL, "must have 2 or 3 axes, but NAXIS is %lld",
                       (long long)hdu->naxis);
    }
    if (hdu->pcount != 0 || hdu->gcount != 1)
        return sf_fail(err, SHEAR_E_FORMAT, at, NULL, "an image must have PCOUNT 0 and GCOUNT 1");
    for (int k = 0; k < hdu->naxis; k++) {
        if (hdu->axes[k] == 0)
            return sf_fail(err, SHEAR_E_FORMAT, at, NULL, "NAXIS%d is 0: it has no pixels", k + 1);
    }
    return SHEAR_OK;
}

static int set_tiled(sf_image *image, shear_error *err) {
    image->compressed = true;
    TRY(sf_table_init(&image->table, &image->cards, err));
    TRY(sf_tiling_init(&image->tiling, &image->table, err));
    image->naxis = (int)image->tiling.naxis;
    image->bitpix = (int)image->tiling.bitpix;
    memcpy(image->axes, image->tiling.axes, sizeof image->axes);
    return sf_tiles_init(&image->tiles, &image->table, &image->tiling, err);
}

static int set_blank(sf_plain *p, const sf_cards *cards, shear_error *err) {
    const char *card = NULL;
    TRY(sf_cards_find(cards, "BLANK", &card, err));
    p->has_blank = card != NULL;
    return sf_key_int(cards, "BLANK", INT64_MIN, INT64_MAX, &p->blank, err);
}

static int set_plain(sf_image *image, double scale, double zero, shear_error *err) {
    const sf_hdu *hdu = image->cards.hdu;
    sf_plain *p = &image->plain;
    *p = (sf_plain){.file = image->cards.file,
                    .data_offset = hdu->data_offset,
                    .bitpix = image->bitpix,
                    .scale = scale,
                    .zero = zero,
                    .at = image->cards.at};
    memcpy(p->axes, image->axes, sizeof p->axes);
    return image->bitpix < 0 ? SHEAR_OK : set_blank(p, &image->cards, err);
}

static int show_tiled(sf_image *image, double scale, double zero, shear_error *err) {
    sf_view_init(&image->view, image->cards.file, image->cards.hdu);
    sf_tiling_show(&image->tiling, &image->table, scale, zero, &image->view);
    return sf_view_open(&image->view, 1, image->cards.at, &image->fits, err);
}

int sf_image_init(sf_image *image, const sf_file *file, const sf_hdu *hdu, const char *label,
                  shear_error *err) {
    *image = (sf_image){.cards.at = {file->source.name, label}};
    TRY(check_header(hdu, image->cards.at, err));
    TRY(sf_cards_init(&image->cards, file, hdu, label, err));
    image->naxis = (int)hdu->naxis;
    image->bitpix = (int)hdu->bitpix;
    memcpy(image->axes, hdu->axes, sizeof image->axes);
    if (hdu->zimage)
        TRY(set_tiled(image, err));
    double scale = 1.0;
    double zero = 0.0;
    TRY(sf_key_double(&image->cards, "BSCALE", &scale, err));
    TRY(sf_key_double(&image->cards, "BZERO", &zero, err));
    if (scale == 0.0)
        return sf_fail(err, SHEAR_E_FORMAT, image->cards.at, NULL, "keyword BSCALE is 0");
    return image->compressed ? show_tiled(image, scale, zero, err)
                             : set_plain(image, scale, zero, err);
}

void sf_image_deinit(sf_image *image) {
    sf_tiles_deinit(&image->tiles);
    sf_table_deinit(&image->table);
    sf_view_close(image->fits);
    image->fits = NULL;
    sf_view_deinit(&image->view);
    sf_cards_deinit(&image->cards);
}

int sf_image_read(sf_image *image, const int64_t first[SF_AXES], const int64_t size[SF_AXES],
                  double *out, shear_error *err) {
    if (!image->compressed)
        return sf_plain_read(&image->plain, first, size, out, err);
    TRY(sf_tiles_check(&image->tiles, first, size, err));
    double null = NAN;
    long low[SF_AXES];
    long high[SF_AXES];
    long step[SF_AXES] = {1, 1, 1};
    for (int k = 0; k < SF_AXES; k++) {
        low[k] = (long)(first[k] + 1);
        high[k] = (long)(first[k] + size[k]);
    }
    int status = 0;
    int any_null = 0; /* not NULL: CFITSIO 4.2 writes to it in any case if a pixel is undefined */
    fits_read_subset(image->fits, TDOUBLE, low, high, step, &null, out, &any_null, &status);
    return sf_check_status(err, image->cards.at, status, "its pixels cannot be read");
}

int sf_image_planes(sf_image *image, int64_t first, int64_t count, double *out, shear_error *err) {
    const int64_t low[SF_AXES] = {0, 0, first};
    const int64_t size[SF_AXES] = {image->axes[0], image->axes[1], count};
    return sf_image_read(image, low, size, out, err);
}
