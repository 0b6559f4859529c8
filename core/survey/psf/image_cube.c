/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/psf/image_cube.h"

#include "base/cleanup.h"
#include "base/text.h"
#include "fits/tiles/image.h"
#include "survey/psf/mode_fit.h"
#include "survey/psf/mode_power.h"
#include "survey/psf/places.h"

#include <stdlib.h>
#include <strings.h>

enum { MOST_NEAREST = 64, DEGREE = 3, MOST_IMAGES = 1 << 20 };

typedef struct psf_cube {
    char label[SF_NAME];
    sf_image image;
    int nx, ny, n;
    double step; /* pixels */
} psf_cube;

/* ---- the images ---- */

static bool is_image(const sf_hdu *hdu) {
    return (hdu->kind == SF_IMAGE && hdu->naxis >= 2) || (hdu->kind == SF_TABLE && hdu->zimage);
}

/* Find the chosen HDU, the one called PSF, or the only image; NULL: there is no image.
 * SHEAR_E_FORMAT: there are several. */
static int find_image(const psf_models *p, const sf_hdu **image, shear_error *err) {
    int n = 0;
    *image = NULL;
    for (int i = 0; i < p->file.count; i++) {
        const sf_hdu *hdu = &p->file.hdus[i];
        if ((p->chosen != NULL && p->chosen != hdu) || !is_image(hdu))
            continue;
        *image = hdu;
        if (strcasecmp(hdu->name, "PSF") == 0)
            return SHEAR_OK;
        n++;
    }
    return n <= 1 ? SHEAR_OK
                  : sf_fail(err, SHEAR_E_FORMAT, (sf_place){p->file.source.name, NULL},
                            "choose the HDU, FILE:HDU, or put all images of the PSF into one cube",
                            "has %d images, none of which is called PSF", n);
}

static int open_cube(psf_cube *c, const psf_models *p, const sf_hdu *hdu, shear_error *err) {
    double oversample = 1.0;
    psf_label(hdu, c->label);
    TRY(sf_image_init(&c->image, &p->file, hdu, c->label, err));
    const int64_t *axes = c->image.axes;
    const sf_place at = c->image.cards.at;
    if (axes[0] < 3 || axes[1] < 3 || axes[0] > PSF_SIDE || axes[1] > PSF_SIDE ||
        axes[2] > MOST_IMAGES) {
        return sf_fail(err, SHEAR_E_FORMAT, at, "give images of a PSF, not of the sky",
                       "images of a PSF have 3 x 3 to %d x %d pixels, not %lld x %lld", PSF_SIDE,
                       PSF_SIDE, (long long)axes[0], (long long)axes[1]);
    }
    TRY(sf_key_double(&c->image.cards, "OVERSAMP", &oversample, err));
    if (!(oversample >= 0.01 && oversample <= 100.0)) {
        return sf_fail(err, SHEAR_E_FORMAT, at, "it is the number of samples per pixel",
                       "keyword OVERSAMP is %g, but must be from 0.01 to 100", oversample);
    }
    c->nx = (int)axes[0];
    c->ny = (int)axes[1];
    c->n = (int)axes[2];
    c->step = 1.0 / oversample;
    return SHEAR_OK;
}

static void close_cube(psf_cube *c) {
    sf_image_deinit(&c->image);
}

/* Read image i, which must be a PSF. */
static int read_image(psf_cube *c, int i, double *out, shear_error *err) {
    TRY(sf_image_planes(&c->image, i, 1, out, err));
    const int code = shear_psf_usable(out, c->nx, c->ny, err);
    return code == SHEAR_OK ? code
                            : shear_prefix(err, code, "file '%s', HDU %s, image %d",
                                           c->image.cards.at.file, c->label, i);
}

/* ---- their places ---- */

/* Open the first table with positions. */
static int open_places(psf_record *r, const psf_models *p, shear_error *err) {
    for (int i = 0; i < p->file.count; i++) {
        const sf_column *columns[2] = {NULL, NULL};
        bool sky = false;
        if (!psf_record_is_table(&p->file.hdus[i]))
            continue;
        TRY(psf_record_init(r, &p->file, &p->file.hdus[i], err));
        TRY(psf_places_find(r, columns, &sky, err));
        if (columns[0] != NULL)
            return SHEAR_OK;
        psf_record_deinit(r);
    }
    return sf_fail(err, SHEAR_E_FORMAT, (sf_place){p->file.source.name, NULL},
                   "append a table with X and Y (pixels from 1), or RA and DEC, of each image",
                   "several images of a PSF need their positions");
}

static int read_places(psf_places *places, const psf_models *p, int n, shear_error *err) {
    CLEANUP(psf_record_deinit) psf_record r = {0};
    TRY(open_places(&r, p, err));
    return psf_places_init(places, &r, n, err);
}

/* ---- models ---- */

/* Keep all images as planes. */
static int keep_images(psf_chip *chip, psf_cube *c, shear_error *err) {
    const size_t plane = (size_t)c->nx * (size_t)c->ny;
    chip->samples = calloc(plane * (size_t)c->n, sizeof *chip->samples);
    if (chip->samples == NULL)
        return sf_fail_memory(err, c->image.cards.at);
    for (int i = 0; i < c->n; i++)
        TRY(read_image(c, i, chip->samples + (size_t)i * plane, err));
    chip->model = (shear_psf_model){
        .nx = c->nx, .ny = c->ny, .terms = c->n, .axes = SHEAR_PSF_AXES_PIXEL, .step = c->step};
    return SHEAR_OK;
}

static int use_nearest(psf_chip *chip, psf_places *places, psf_cube *c, shear_error *err) {
    TRY(keep_images(chip, c, err));
    psf_places_set_variables(places, chip);
    chip->planes = c->n;
    chip->places = CLEANUP_TAKE(places->at);
    text_append(chip->text, sizeof chip->text,
                "%d images of %d x %d samples of %.2f px, the nearest", c->n, c->nx, c->ny,
                c->step);
    return SHEAR_OK;
}

static int compute_power(mode_spectra *s, psf_cube *c, shear_error *err) {
    CLEANUP(release_free) double *image = calloc((size_t)c->nx * (size_t)c->ny, sizeof *image);
    CLEANUP(mode_power_deinit) mode_power m = {0};
    const int zero = s->stamp / 2 * (s->stamp + 1);
    if (image == NULL || !mode_power_init(&m, c->nx, c->ny, c->step, s->stamp))
        return sf_fail_memory(err, c->image.cards.at);
    for (int i = 0; i < c->n; i++) {
        double *power = mode_spectra_of(s, i);
        TRY(read_image(c, i, image, err));
        mode_power_of(&m, image, power);
        const double flux2 = power[zero];
        for (int j = 0; j < s->stamp * s->stamp; j++)
            power[j] /= flux2;
        s->weight[i] = 1.0;
    }
    return SHEAR_OK;
}

static int use_polynomial(psf_chip *chip, psf_places *places, psf_cube *c, int stamp,
                          shear_error *err) {
    CLEANUP(mode_spectra_deinit) mode_spectra s = {0};
    TRY(mode_spectra_init(&s, c->n, stamp, c->image.cards.at, err));
    TRY(compute_power(&s, c, err));
    psf_places_set_variables(places, chip);
    TRY(mode_fit(chip, places, &s, DEGREE, c->image.cards.at, err));
    text_append(chip->text, sizeof chip->text, "power of %d images of %d x %d samples of %.2f px",
                c->n, c->nx, c->ny, c->step);
    psf_chip_describe(chip);
    return SHEAR_OK;
}

static int read_model(psf_models *p, psf_chip *chip, psf_cube *c, shear_error *err) {
    CLEANUP(psf_places_deinit) psf_places places = {0};
    if (c->n == 1) {
        text_append(chip->text, sizeof chip->text,
                    "an image of %d x %d samples of %.2f px, constant", c->nx, c->ny, c->step);
        return keep_images(chip, c, err);
    }
    TRY(read_places(&places, p, c->n, err));
    return c->n <= MOST_NEAREST ? use_nearest(chip, &places, c, err)
                                : use_polynomial(chip, &places, c, p->stamp, err);
}

int image_cube_read(psf_models *p, shear_error *err) {
    CLEANUP(close_cube) psf_cube c = {0};
    const sf_hdu *hdu = NULL;
    psf_chip *chip = NULL;
    TRY(find_image(p, &hdu, err));
    if (hdu == NULL)
        return SHEAR_OK;
    TRY(open_cube(&c, p, hdu, err));
    TRY(psf_chip_new(p, &chip, err));
    return read_model(p, chip, &c, err);
}
