/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Open exposures: which catalog, sky map and PSF belong to each chip, and what that makes. */
#include "survey/exposure.h"

#include "base/cleanup.h"
#include "base/sort.h"
#include "base/text.h"
#include "common/release.h"
#include "fits/field/name.h"
#include "survey/chip_match.h"
#include "survey/internal.h"
#include "survey/no_stamps.h"
#include "survey/wcs/head_file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { DEFAULT_STAMP = 64, PLACE_SIZE = 4200 };

/* What is needed only while an exposure is opened. */
typedef struct opening {
    exposure *e;
    const shear_input *input;
    const int *fds;
    source_catalog *catalog;
    head_file head;
    source_count sources;
} opening;

static void opening_deinit(opening *o) {
    head_file_deinit(&o->head);
    source_catalog_close(o->catalog);
}

static const shear_input_part *part_of(const opening *o, enum shear_part part) {
    return &o->input->parts[part];
}

static int fd_of(const opening *o, enum shear_part part) {
    return o->fds != NULL ? o->fds[part] : -1;
}

static int need_part(const opening *o, enum shear_part part, const char *what, shear_error *err) {
    return part_of(o, part)->path != NULL
               ? SHEAR_OK
               : shear_fail(err, SHEAR_E_FORMAT, "an exposure needs an image, sources and a PSF",
                            "there is no file of the %s", what);
}

/* Open the noise image like an exposure's image. */
static int open_noise(opening *o, shear_error *err) {
    shear_input input = shear_input_of_file(NULL);
    int fds[SHEAR_N_PARTS];
    for (int i = 0; i < SHEAR_N_PARTS; i++)
        fds[i] = -1;
    input.parts[SHEAR_PART_IMAGE] = *part_of(o, SHEAR_PART_NOISE);
    fds[SHEAR_PART_IMAGE] = fd_of(o, SHEAR_PART_NOISE);
    TRY(need_part(o, SHEAR_PART_NOISE, "noise", err));
    return exposure_images_open(&o->e->noise_images, &input, o->fds != NULL ? fds : NULL, err);
}

static int open_files(opening *o, shear_error *err) {
    exposure *e = o->e;
    const int stamp = e->base.info.geometry.nx;
    TRY(need_part(o, SHEAR_PART_CATALOG, "sources", err));
    TRY(need_part(o, SHEAR_PART_PSF, "PSF", err));
    TRY(exposure_images_open(&e->images, o->input, o->fds, err));
    TRY(psf_models_open(&e->psf, part_of(o, SHEAR_PART_PSF), fd_of(o, SHEAR_PART_PSF),
                        e->options.psf_kind, stamp, err));
    TRY(source_catalog_open(&o->catalog, part_of(o, SHEAR_PART_CATALOG),
                            fd_of(o, SHEAR_PART_CATALOG), &e->options, err));
    if (part_of(o, SHEAR_PART_WCS)->path != NULL) {
        TRY(head_file_init(&o->head, part_of(o, SHEAR_PART_WCS)->path, fd_of(o, SHEAR_PART_WCS),
                           err));
    }
    return e->options.noise == SHEAR_NOISE_IMAGE ? open_noise(o, err) : SHEAR_OK;
}

/* Write which HDU has a chip's header, for messages. Return buf. */
static const char *header_place(const opening *o, int chip, char *buf, size_t size) {
    const char *name = exposure_images_name(o->e->images, chip);
    *buf = '\0';
    if (name[0] != '\0') {
        text_append(buf, size, "file '%s', HDU %s", part_of(o, SHEAR_PART_IMAGE)->path, name);
    } else {
        text_append(buf, size, "file '%s', HDU %lld", part_of(o, SHEAR_PART_IMAGE)->path,
                    (long long)exposure_images_hdu(o->e->images, chip, SHEAR_PART_IMAGE));
    }
    return buf;
}

/* Make the sky map of a chip, by the header of its image or that of the .head file. */
static int map_chip(const opening *o, int chip, sky_map **map, shear_error *err) {
    int64_t count = 0;
    char where[PLACE_SIZE];
    const char *cards = exposure_images_header(o->e->images, chip, &count);
    if (o->head.n == 0)
        return sky_map_new(map, cards, count, header_place(o, chip, where, sizeof where), err);
    if (o->head.n != 1 && o->head.n != o->e->n_chips) {
        return shear_fail(err, SHEAR_E_FORMAT, "give a block of cards, ended by END, for each chip",
                          "file '%s': has %d blocks for %d chips", part_of(o, SHEAR_PART_WCS)->path,
                          o->head.n, o->e->n_chips);
    }
    const int block = o->head.n == 1 ? 0 : chip;
    CLEANUP(release_free) char *merged = head_file_merge(&o->head, block, cards, &count);
    if (merged == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a header");
    where[0] = '\0';
    text_append(where, sizeof where, "file '%s', block %d", part_of(o, SHEAR_PART_WCS)->path,
                block + 1);
    return sky_map_new(map, merged, count, where, err);
}

static const char *table_name(const void *self, int i) {
    return source_catalog_chip(self, i);
}

static const char *model_name(const void *self, int i) {
    return psf_models_chip(self, i);
}

/* Find the table of sources and the PSF model of a chip. */
static int match_chip(const opening *o, int chip, int *table, int *model, shear_error *err) {
    const exposure *e = o->e;
    const chip_items tables = {.what = "tables of sources",
                               .file = part_of(o, SHEAR_PART_CATALOG)->path,
                               .n = source_catalog_tables(o->catalog),
                               .name = table_name,
                               .self = o->catalog};
    const chip_items models = {.what = "PSF models",
                               .file = part_of(o, SHEAR_PART_PSF)->path,
                               .n = psf_models_count(e->psf),
                               .name = model_name,
                               .self = e->psf};
    const char *name = exposure_images_name(e->images, chip);
    TRY(chip_match(&tables, chip, e->n_chips, name, table, err));
    return chip_match(&models, chip, e->n_chips, name, model, err);
}

static const char *noise_name(const void *self, int i) {
    return exposure_images_name(self, i);
}

/* Find the noise image of a chip, which must be of the chip's size. */
static int match_noise(const opening *o, int chip, shear_error *err) {
    const exposure *e = o->e;
    exposure_chip *c = &e->chips[chip];
    if (e->noise_images == NULL)
        return SHEAR_OK;
    const chip_items images = {.what = "images of noise",
                               .file = part_of(o, SHEAR_PART_NOISE)->path,
                               .n = exposure_images_chips(e->noise_images),
                               .name = noise_name,
                               .self = e->noise_images};
    const char *name = exposure_images_name(e->images, chip);
    int size[2];
    int noise[2];
    TRY(chip_match(&images, chip, e->n_chips, name, &c->noise, err));
    if (strcmp(images.file, part_of(o, SHEAR_PART_IMAGE)->path) == 0 &&
        exposure_images_hdu(e->noise_images, c->noise, SHEAR_PART_IMAGE) ==
            exposure_images_hdu(e->images, chip, SHEAR_PART_IMAGE)) {
        return shear_fail(
            err, SHEAR_E_FORMAT,
            "give an image of noise alone, or --noise near for empty sky of the image",
            "file '%s': is given both as image and as noise", images.file);
    }
    exposure_images_size(e->images, chip, &size[0], &size[1]);
    exposure_images_size(e->noise_images, c->noise, &noise[0], &noise[1]);
    if (noise[0] == size[0] && noise[1] == size[1])
        return SHEAR_OK;
    return shear_fail(err, SHEAR_E_FORMAT, "both must be of the same exposure, and trimmed alike",
                      "file '%s': the noise image of chip %d (%s) has %d x %d pixels, but the "
                      "image has %d x %d",
                      images.file, chip + 1, name[0] != '\0' ? name : "no EXTNAME", noise[0],
                      noise[1], size[0], size[1]);
}

CLEANUP_DEFINE(sky_map, sky_map_free)

/* A single catalog of several chips says by RA and Dec which source is on which. */
static int check_positions(const opening *o, const source_list *sources, const sky_map *map,
                           bool shared, shear_error *err) {
    const char *file = part_of(o, SHEAR_PART_CATALOG)->path;
    if (sources->n > 0 && sources->x == NULL && map == NULL) {
        return shear_fail(err, SHEAR_E_FORMAT,
                          "give pixel positions (--columns x=...,y=...), or the WCS (--wcs)",
                          "file '%s': has RA and Dec only, and the image has no WCS", file);
    }
    if (shared && sources->n > 0 && sources->ra == NULL) {
        return shear_fail(err, SHEAR_E_FORMAT,
                          "give a table for each chip, or RA and Dec (--columns ra=...,dec=...)",
                          "file '%s': has one table of pixel positions for %d chips", file,
                          o->e->n_chips);
    }
    return SHEAR_OK;
}

/* Of a catalog for several chips pixel positions mean nothing. */
static void forget_pixels(source_list *sources) {
    sources->x = sources->y = NULL;
}

static int find_contexts(const opening *o, int chip, contexts *c, shear_error *err) {
    const char *const *names = NULL;
    int64_t count = 0;
    const exposure *e = o->e;
    const int n = psf_models_contexts(e->psf, e->chips[chip].model, &names);
    const char *cards = exposure_images_header(e->images, chip, &count);
    char where[PLACE_SIZE];
    return contexts_init(c, names, n, cards, count, header_place(o, chip, where, sizeof where),
                         err);
}

static int open_chip(opening *o, int chip, shear_error *err) {
    exposure *e = o->e;
    exposure_chip *c = &e->chips[chip];
    contexts wanted;
    CLEANUP(sky_map_release) sky_map *map = NULL;
    CLEANUP(source_list_deinit) source_list sources = {0};
    TRY(match_chip(o, chip, &c->table, &c->model, err));
    TRY(map_chip(o, chip, &map, err));
    c->mapped = map != NULL;
    TRY(find_contexts(o, chip, &wanted, err));
    TRY(source_catalog_load(o->catalog, c->table, wanted.columns, wanted.n_columns, &sources, err));
    const bool shared = e->n_chips > 1 && source_catalog_tables(o->catalog) == 1;
    TRY(check_positions(o, &sources, map, shared, err));
    if (shared)
        forget_pixels(&sources);
    source_count_add(&o->sources, &sources, shared);
    chip_inputs in = {.sources = &sources,
                      .map = map,
                      .psf = e->psf,
                      .contexts = &wanted,
                      .model = c->model,
                      .only_inside = shared};
    exposure_images_size(e->images, chip, &in.nx, &in.ny);
    TRY(match_noise(o, chip, err));
    TRY(chip_stamps_init(&c->stamps, &in, err));
    c->first = e->base.info.n_stamps;
    e->base.info.n_stamps += c->stamps.n;
    if (map == NULL)
        e->base.info.columns &= ~(unsigned)SHEAR_COL_JACOBIAN;
    e->base.info.columns |= (c->stamps.weight != NULL ? SHEAR_COL_WEIGHT : 0u) |
                            (c->stamps.r_gal != NULL ? SHEAR_COL_R_GAL : 0u);
    return SHEAR_OK;
}

/* Return the median pixel scale of the stamps, arcsec; NaN without a sky map. */
static int find_scale(exposure *e, shear_error *err) {
    double *scales = malloc((size_t)(e->base.info.n_stamps + 1) * sizeof *scales);
    size_t n = 0;
    if (scales == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for an exposure");
    for (int c = 0; c < e->n_chips; c++) {
        for (int64_t i = 0; i < e->chips[c].stamps.n; i++) {
            const double scale = sky_distortion_of(e->chips[c].stamps.jacobian[i]).scale;
            if (isfinite(scale))
                scales[n++] = scale;
        }
    }
    sort_doubles(scales, n);
    e->base.info.pixscale = n > 0 ? scales[n / 2] : NAN;
    free(scales);
    return SHEAR_OK;
}

static int choose_frame(exposure *e, const char *image, shear_error *err) {
    shear_field_info *info = &e->base.info;
    const bool sky = (info->columns & SHEAR_COL_JACOBIAN) != 0 && isfinite(info->pixscale);
    info->frame = e->options.frame > 0 ? (enum shear_frame)(e->options.frame - 1)
                  : sky                ? SHEAR_FRAME_SKY
                                       : SHEAR_FRAME_PIXEL;
    if (info->frame != SHEAR_FRAME_PIXEL && !sky) {
        return shear_fail(err, SHEAR_E_FORMAT, "give the WCS (--wcs), or --frame pixel",
                          "file '%s': has no WCS, which the frame '%s' needs", image,
                          shear_frame_name(info->frame));
    }
    if (sky) {
        info->columns |= SHEAR_COL_RA | SHEAR_COL_DEC | SHEAR_COL_GF1 | SHEAR_COL_GF2;
    } else {
        info->columns &= ~(unsigned)SHEAR_COL_JACOBIAN;
        info->pixscale = NAN;
    }
    return SHEAR_OK;
}

/* Copy the models' descriptions; their samples remain the PSF file's. */
static int take_models(exposure *e, shear_error *err) {
    shear_field_info *info = &e->base.info;
    info->n_models = psf_models_count(e->psf);
    info->psf_terms = psf_models_get(e->psf, 0)->terms;
    info->n_psf = (int64_t)info->n_models * info->psf_terms;
    e->base.models = calloc((size_t)info->n_models, sizeof *e->base.models);
    if (e->base.models == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for PSF models");
    for (int i = 0; i < info->n_models; i++) {
        const shear_psf_model *m = psf_models_get(e->psf, i);
        shear_geometry *g = &info->geometry;
        e->base.models[i] = *m;
        g->psf_nx = m->nx > g->psf_nx ? m->nx : g->psf_nx;
        g->psf_ny = m->ny > g->psf_ny ? m->ny : g->psf_ny;
    }
    return SHEAR_OK;
}

static int open_chips(opening *o, shear_error *err) {
    exposure *e = o->e;
    const char *image = part_of(o, SHEAR_PART_IMAGE)->path;
    e->n_chips = exposure_images_chips(e->images);
    e->chips = calloc((size_t)e->n_chips, sizeof *e->chips);
    if (e->chips == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for %d chips", e->n_chips);
    for (int i = 0; i < e->n_chips; i++)
        TRY(open_chip(o, i, err));
    TRY(no_stamps_check(e, &o->sources, part_of(o, SHEAR_PART_CATALOG)->path, err));
    TRY(find_scale(e, err));
    return choose_frame(e, image, err);
}

/* Describe what does not depend on the files' content. */
static int describe(opening *o, shear_error *err) {
    exposure *e = o->e;
    shear_field_info *info = &e->base.info;
    const shear_input_part *image = part_of(o, SHEAR_PART_IMAGE);
    const char *base = strrchr(image->path, '/');
    const int stamp = e->options.stamp != 0 ? e->options.stamp : DEFAULT_STAMP;
    const int planes = e->options.noise_stamps != 0 ? e->options.noise_stamps : 1;
    if (stamp < SHEAR_MIN_SIDE || stamp > SHEAR_MAX_SIDE || planes < 1 ||
        planes > SHEAR_MAX_NOISE_PLANES) {
        return shear_fail(err, SHEAR_E_SETTING, NULL,
                          "stamps of %d px with %d noise stamps each: a side must be %d to %d px, "
                          "and there must be 1 to %d noise stamps",
                          stamp, planes, SHEAR_MIN_SIDE, SHEAR_MAX_SIDE, SHEAR_MAX_NOISE_PLANES);
    }
    *info =
        (shear_field_info){.pixscale = NAN,
                           .geometry = {.nx = stamp, .ny = stamp, .psf_oversample = 1},
                           .noise_planes = planes,
                           .psf_layout = SHEAR_PSF_MODELS,
                           .columns = SHEAR_COL_ID | SHEAR_COL_X | SHEAR_COL_Y | SHEAR_COL_PSF_ID |
                                      SHEAR_COL_PSF_TERMS | SHEAR_COL_JACOBIAN | SHEAR_COL_DROPPED,
                           .bitpix = -64,
                           .separate = true};
    for (int i = 0; i < SHEAR_N_PARTS; i++) {
        const shear_input_part *part = part_of(o, (enum shear_part)i);
        info->hdu[i] = part->path == NULL ? -1 : part->hdu >= 0 ? part->hdu : 0;
    }
    if (sf_field_name_of_file(info->name, base != NULL ? base + 1 : image->path,
                              (sf_place){image->path, NULL}, NULL) != SHEAR_OK) {
        info->name[0] = '\0';
    }
    return SHEAR_OK;
}

static void close_exposure(shear_field *field) {
    exposure *e = exposure_of(field);
    exposure_let_go(&e->held);
    for (int i = 0; e->chips != NULL && i < e->n_chips; i++)
        chip_stamps_deinit(&e->chips[i].stamps);
    free(e->chips);
    psf_models_close(e->psf);
    exposure_images_close(e->noise_images);
    exposure_images_close(e->images);
    free(e->base.models);
    free(e);
}

static const field_reader reader = {
    .read = exposure_read, .read_columns = exposure_read_columns, .close = close_exposure};

bool exposure_is(const shear_field *field) {
    return field->reader == &reader;
}

int exposure_open(shear_field **field, const shear_input *input, const int *fds, shear_error *err) {
    exposure *e = calloc(1, sizeof *e);
    *field = NULL;
    if (e == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for an exposure");
    e->base.reader = &reader;
    e->options = input->exposure;
    e->held.chip = -1;
    CLEANUP(shear_field_release) shear_field *opened = &e->base;
    CLEANUP(opening_deinit) opening o = {.e = e, .input = input, .fds = fds};
    TRY(describe(&o, err));
    TRY(open_files(&o, err));
    TRY(take_models(e, err));
    TRY(open_chips(&o, err));
    e->base.info.file_bytes = exposure_images_bytes(e->images);
    *field = CLEANUP_TAKE(opened);
    return SHEAR_OK;
}
