/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fits/image.h"

#include "fits/keys.h"

#include <math.h>

static int check_header(const sf_hdu *hdu, sf_place at, shear_error *err) {
    if (hdu->zimage && hdu->kind == SF_TABLE) {
        return sf_tiles_check_header(hdu, at, err);
    }
    if (hdu->kind != SF_IMAGE) {
        return sf_fail(err, SHEAR_E_FORMAT, at, NULL, "must be an image, but is a table");
    }
    if (hdu->naxis != 2 && hdu->naxis != 3) {
        return sf_fail(err, SHEAR_E_FORMAT, at, NULL, "must have 2 or 3 axes, but NAXIS is %lld",
                       (long long)hdu->naxis);
    }
    if (hdu->pcount != 0 || hdu->gcount != 1) {
        return sf_fail(err, SHEAR_E_FORMAT, at, NULL, "an image must have PCOUNT 0 and GCOUNT 1");
    }
    for (int k = 0; k < hdu->naxis; k++) {
        if (hdu->axes[k] == 0) {
            return sf_fail(err, SHEAR_E_FORMAT, at, NULL, "NAXIS%d is 0: it has no pixels", k + 1);
        }
    }
    return SHEAR_OK;
}

/* What CFITSIO understands must be what was checked. */
static int cross_check(sf_image *image, const sf_hdu *hdu, shear_error *err) {
    int status = 0;
    int bitpix = 0;
    int naxis = 0;
    LONGLONG axes[SF_AXES] = {1, 1, 1};
    fits_get_img_paramll(image->fits, SF_AXES, &bitpix, &naxis, axes, &status);
    if (status != 0) {
        return sf_fail_status(err, image->at, status, "is no image that CFITSIO can read");
    }
    const int64_t *expected = hdu->zimage ? hdu->zaxes : hdu->axes;
    image->naxis = (int)(hdu->zimage ? hdu->znaxis : hdu->naxis);
    image->bitpix = (int)(hdu->zimage ? hdu->zbitpix : hdu->bitpix);
    bool same = naxis == image->naxis && bitpix == image->bitpix;
    for (int k = 0; k < SF_AXES; k++) {
        image->axes[k] = k < image->naxis ? expected[k] : 1;
        same = same && (k >= image->naxis || axes[k] == image->axes[k]);
    }
    return same ? SHEAR_OK
                : sf_fail(err, SHEAR_E_FORMAT, image->at, NULL,
                          "its header contradicts itself (NAXIS, NAXISn, BITPIX)");
}

static int check_scaling(sf_image *image, shear_error *err) {
    double scale = 1.0;
    double zero = 0.0;
    bool found = false;
    int rc = sf_key_double(image->fits, image->at, "BSCALE", &scale, &found, err);
    if (rc == SHEAR_OK) {
        rc = sf_key_double(image->fits, image->at, "BZERO", &zero, &found, err);
    }
    if (rc == SHEAR_OK && scale == 0.0) {
        rc = sf_fail(err, SHEAR_E_FORMAT, image->at, NULL, "keyword BSCALE is 0");
    }
    return rc;
}

int sf_image_init(sf_image *image, const sf_file *file, const sf_hdu *hdu, const char *label,
                  shear_error *err) {
    *image = (sf_image){.at = {file->source.name, label}};
    int rc = check_header(hdu, image->at, err);
    if (rc == SHEAR_OK) {
        rc = sf_open_hdu(file, hdu->number, label, &image->fits, err);
    }
    if (rc == SHEAR_OK) {
        rc = cross_check(image, hdu, err);
    }
    if (rc == SHEAR_OK) {
        rc = check_scaling(image, err);
    }
    image->compressed = hdu->zimage;
    if (rc == SHEAR_OK && image->compressed) {
        rc = sf_tiles_init(&image->tiles, file, hdu, image->fits, image->at, err);
    }
    return rc;
}

void sf_image_deinit(sf_image *image) {
    sf_tiles_deinit(&image->tiles);
    sf_close_hdu(image->fits);
    image->fits = NULL;
}

/* Plain pixels that follow each other in the file are read in one piece. */
static bool contiguous(const sf_image *image, const int64_t size[SF_AXES]) {
    return !image->compressed && size[0] == image->axes[0] &&
           (size[1] == image->axes[1] || size[2] == 1);
}

int sf_image_read(sf_image *image, const int64_t first[SF_AXES], const int64_t size[SF_AXES],
                  double *out, shear_error *err) {
    if (image->compressed) {
        const int rc = sf_tiles_check(&image->tiles, first, size, err);
        if (rc != SHEAR_OK) {
            return rc;
        }
    }
    /* Floating pixels of a plain image need no null value: CFITSIO then copies them bit by bit. */
    double null = image->bitpix < 0 && !image->compressed ? 0.0 : NAN;
    long low[SF_AXES];
    long high[SF_AXES];
    long step[SF_AXES] = {1, 1, 1};
    for (int k = 0; k < SF_AXES; k++) {
        low[k] = (long)(first[k] + 1);
        high[k] = (long)(first[k] + size[k]);
    }
    int status = 0;
    int any_null = 0; /* not NULL: CFITSIO 4.2 writes to it unasked where a pixel is undefined */
    if (contiguous(image, size)) {
        fits_read_pix(image->fits, TDOUBLE, low, size[0] * size[1] * size[2], &null, out, &any_null,
                      &status);
    } else {
        fits_read_subset(image->fits, TDOUBLE, low, high, step, &null, out, &any_null, &status);
    }
    return status == 0 ? SHEAR_OK
                       : sf_fail_status(err, image->at, status, "its pixels cannot be read");
}
