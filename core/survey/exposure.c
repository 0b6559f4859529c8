/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Open exposures: which catalog, sky map and PSF belong to each chip, and what that makes. */
#include "survey/exposure.h"

#include "base/cleanup.h"
#include "base/sort.h"
#include "common/release.h"
#include "fits/field/name.h"
#include "survey/chip_match.h"
#include "survey/chip_sky.h"
#include "survey/internal.h"
#include "survey/near_chip.h"
#include "survey/no_stamps.h"
#include "survey/noise_match.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { DEFAULT_STAMP = 64 };

/* What is needed only while an exposure is opened. */
typedef struct opening {
    exposure *e;
    const shear_input *input;
    const int *fds;
    head_file head;
    source_count sources;
} opening;

static void opening_deinit(opening *o) {
    head_file_deinit(&o->head);
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

static int open_carried(exposure *e, shear_error *err) {
    shear_field_info *info = &e->base.info;
    TRY(source_catalog_carry(e->catalog, e->options.carry, &e->carried, err));
    info->n_carried = e->carried.n;
    info->carried_bytes = e->carried.bytes;
    info->carried = e->carried.columns;
    return SHEAR_OK;
}

static int open_files(opening *o, shear_error *err) {
    exposure *e = o->e;
    const int stamp = e->base.info.geometry.nx;
    TRY(need_part(o, SHEAR_PART_CATALOG, "sources", err));
    TRY(need_part(o, SHEAR_PART_PSF, "PSF", err));
    TRY(exposure_images_open(&e->images, o->input, o->fds, err));
    TRY(psf_models_open(&e->psf, part_of(o, SHEAR_PART_PSF), fd_of(o, SHEAR_PART_PSF),
                        e->options.psf_kind, stamp, err));
    TRY(source_catalog_open(&e->catalog, part_of(o, SHEAR_PART_CATALOG),
                            fd_of(o, SHEAR_PART_CATALOG), &e->options, err));
    TRY(open_carried(e, err));
    if (part_of(o, SHEAR_PART_WCS)->path != NULL) {
        TRY(head_file_init(&o->head, part_of(o, SHEAR_PART_WCS)->path, fd_of(o, SHEAR_PART_WCS),
                           err));
    }
    return e->options.noise == SHEAR_NOISE_IMAGE ? open_noise(o, err) : SHEAR_OK;
}

/* Return the number of the HDU that was chosen for a part; -1: none, or all of that name. */
static int64_t chosen_hdu(const opening *o, enum shear_part part) {
    const shear_input_part *chosen = part_of(o, part);
    if (chosen->path == NULL)
        return -1;
    if (chosen->extname == NULL)
        return chosen->hdu;
    switch (part) {
    case SHEAR_PART_CATALOG:
        return source_catalog_hdu(o->e->catalog);
    case SHEAR_PART_PSF:
        return psf_models_hdu(o->e->psf);
    case SHEAR_PART_NOISE:
        return o->e->noise_images != NULL
                   ? exposure_images_hdu(o->e->noise_images, 0, SHEAR_PART_IMAGE)
                   : -1;
    default:
        return exposure_images_hdu(o->e->images, 0, part);
    }
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
                               .n = source_catalog_tables(o->e->catalog),
                               .name = table_name,
                               .self = o->e->catalog};
    const chip_items models = {.what = "PSF models",
                               .file = part_of(o, SHEAR_PART_PSF)->path,
                               .n = psf_models_count(e->psf),
                               .name = model_name,
                               .self = e->psf};
    const char *name = exposure_images_name(e->images, chip);
    TRY(chip_match(&tables, chip, e->n_chips, name, table, err));
    return chip_match(&models, chip, e->n_chips, name, model, err);
}

CLEANUP_DEFINE(sky_map, sky_map_free)

/* A single catalog of several chips says by RA and Dec which source is on which. */
static int check_positions(const opening *o, const source_list *sources, const sky_map *map,
                           bool shared, shear_error *err) {
    const char *file = part_of(o, SHEAR_PART_CATALOG)->path;
    if (sources->rows > 0 && map == NULL &&
        (sources->x == NULL || (shared && sources->ra != NULL))) {
        return shear_fail(err, SHEAR_E_FORMAT,
                          "give pixel positions (--columns x=...,y=...), or the WCS (--wcs)",
                          "file '%s': has RA and Dec only, and the image has no WCS", file);
    }
    if (shared && sources->rows > 0 && sources->ra == NULL) {
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
    char where[CHIP_SKY_PLACE];
    chip_sky_place(e, chip, part_of(o, SHEAR_PART_IMAGE)->path, where);
    return contexts_init(c, names, n, cards, count, where, err);
}

static bool amplifiers_fit(int amplifiers, int pixels, int least) {
    return amplifiers <= 1 || (amplifiers <= SHEAR_MAX_AMPLIFIERS && pixels / amplifiers >= least);
}

/* Check that on each of several amplifiers there is room for a stamp with its frame. */
static int check_amplifiers(const opening *o, int chip, const chip_inputs *in, shear_error *err) {
    const shear_amplifiers *a = &o->e->options.amplifiers;
    const int least = o->e->base.info.geometry.nx + 2 * CUTTER_FRAME;
    char where[CHIP_SKY_PLACE];
    if (amplifiers_fit(a->columns, in->nx, least) && amplifiers_fit(a->rows, in->ny, least))
        return SHEAR_OK;
    chip_sky_place(o->e, chip, part_of(o, SHEAR_PART_IMAGE)->path, where);
    return shear_fail(err, SHEAR_E_FORMAT,
                      "correct --amplifiers COLUMNSxROWS, or choose a smaller --stamp",
                      "%s: %d x %d amplifiers are too many for %d x %d pixels: each must hold a "
                      "stamp and its frame, %d x %d",
                      where, a->columns, a->rows, in->nx, in->ny, least, least);
}

/* Load the chip's sources; of a catalog of several chips, those near it. */
static int load_sources(const opening *o, exposure_chip *c, const chip_inputs *in,
                        shear_error *err) {
    const contexts *wanted = in->contexts;
    const bool near = in->only_inside && in->map != NULL;
    source_cap cap;
    c->sky = (near_chip){NAN, NAN};
    if (near)
        cap = near_chip_cap(in->map, in->nx, in->ny, &c->sky);
    TRY(source_catalog_load(o->e->catalog, c->table, wanted->columns, wanted->n_columns,
                            near ? &cap : NULL, in->sources, err));
    if (near)
        near_chip_measure(&c->sky, &cap);
    return SHEAR_OK;
}

static int open_chip(opening *o, int chip, shear_error *err) {
    exposure *e = o->e;
    exposure_chip *c = &e->chips[chip];
    contexts wanted;
    CLEANUP(sky_map_release) sky_map *map = NULL;
    CLEANUP(source_list_deinit) source_list sources = {0};
    TRY(match_chip(o, chip, &c->table, &c->model, err));
    TRY(chip_sky_map(&map, e, chip, part_of(o, SHEAR_PART_IMAGE)->path, &o->head,
                     part_of(o, SHEAR_PART_WCS)->path, err));
    c->mapped = map != NULL;
    TRY(find_contexts(o, chip, &wanted, err));
    const bool shared = e->n_chips > 1 && source_catalog_tables(o->e->catalog) == 1;
    chip_inputs in = {.sources = &sources,
                      .map = map,
                      .psf = e->psf,
                      .contexts = &wanted,
                      .model = c->model,
                      .only_inside = shared};
    exposure_images_size(e->images, chip, &in.nx, &in.ny);
    TRY(check_amplifiers(o, chip, &in, err));
    TRY(load_sources(o, c, &in, err));
    TRY(check_positions(o, &sources, map, shared, err));
    if (shared)
        forget_pixels(&sources);
    source_count_add(&o->sources, &sources, shared);
    TRY(noise_match(e, chip, part_of(o, SHEAR_PART_IMAGE)->path, part_of(o, SHEAR_PART_NOISE)->path,
                    &c->noise, err));
    TRY(chip_stamps_init(&c->stamps, &in, err));
    TRY(source_catalog_carried(e->catalog, c->table, &e->carried, &c->carried, err));
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
    if (sf_field_name_of_file(info->name, base != NULL ? base + 1 : image->path,
                              (sf_place){image->path, NULL}, NULL) != SHEAR_OK) {
        info->name[0] = '\0';
    }
    return SHEAR_OK;
}

static void close_exposure(shear_field *field) {
    exposure *e = exposure_of(field);
    exposure_let_go(&e->held);
    for (int i = 0; e->chips != NULL && i < e->n_chips; i++) {
        chip_stamps_deinit(&e->chips[i].stamps);
        carry_rows_deinit(&e->chips[i].carried);
    }
    free(e->chips);
    carry_list_deinit(&e->carried);
    source_catalog_close(e->catalog);
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
    for (int i = 0; i < SHEAR_N_PARTS; i++)
        e->base.info.hdu[i] = chosen_hdu(&o, (enum shear_part)i);
    TRY(take_models(e, err));
    TRY(open_chips(&o, err));
    e->base.info.file_bytes = exposure_images_bytes(e->images);
    *field = CLEANUP_TAKE(opened);
    return SHEAR_OK;
}
