/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fits/tiles/view.h"

#include "base/cleanup.h"
#include "fits/header/card.h"
#include "fits/tiles/view_driver.h"

#include <stdio.h>

void sf_view_init(sf_view *v, const sf_file *file, const sf_hdu *hdu) {
    *v = (sf_view){.file = file, .data_offset = hdu->data_offset, .data_bytes = hdu->data_bytes};
}

static void add(sf_view *v, const char *text) {
    char padded[SF_CARD + 1];
    snprintf(padded, sizeof padded, "%-80.80s", text);
    buffer_add(&v->header, padded, SF_CARD);
}

static void add_value(sf_view *v, const char *key, const char *value) {
    char card[SF_CARD + 1];
    snprintf(card, sizeof card, "%-8.8s= %20.70s", key, value);
    add(v, card);
}

void sf_view_logical(sf_view *v, const char *key, bool value) {
    add_value(v, key, value ? "T" : "F");
}

void sf_view_int(sf_view *v, const char *key, int64_t value) {
    char text[24];
    snprintf(text, sizeof text, "%lld", (long long)value);
    add_value(v, key, text);
}

void sf_view_double(sf_view *v, const char *key, double value) {
    char text[32];
    snprintf(text, sizeof text, "%.17G", value);
    add_value(v, key, text);
}

void sf_view_string(sf_view *v, const char *key, const char *value) {
    char text[FLEN_VALUE];
    snprintf(text, sizeof text, "'%-8.60s'", value);
    add_value(v, key, text);
}

void sf_view_scale(sf_view *v, double scale, double zero) {
    if (scale != 1.0 || zero != 0.0) {
        sf_view_double(v, "BSCALE", scale);
        sf_view_double(v, "BZERO", zero);
    }
}

void sf_view_end(sf_view *v) {
    add(v, "END");
    while (!v->header.failed && v->header.n % SF_BLOCK_BYTES != 0)
        add(v, "");
}

int sf_view_open(sf_view *v, int number, sf_place at, fitsfile **fits, shear_error *err) {
    *fits = NULL;
    if (v->header.failed)
        return sf_fail_memory(err, at);
    int status = 0;
    TRY(sf_view_driver_open(v, fits, &status, err));
    fits_movabs_hdu(*fits, number + 1, NULL, &status);
    return sf_check_status(err, at, status, "cannot be opened");
}

void sf_view_close(fitsfile *fits) {
    if (fits != NULL) {
        int status = 0;
        fits_close_file(fits, &status);
        if (status != 0)
            fits_clear_errmsg();
    }
}

void sf_view_deinit(sf_view *v) {
    sf_view_driver_release(v);
    buffer_deinit(&v->header);
}
