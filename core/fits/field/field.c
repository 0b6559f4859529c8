/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Open field files: their parts, shapes and keywords; read single PSFs. */
#include "base/cleanup.h"
#include "common/release.h"
#include "fits/field/models.h"
#include "fits/field/name.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- keywords of the primary header, in the file that holds the galaxies ---- */

/* Return the name without blanks around it: trailing blanks mean nothing in FITS. */
static char *trim(char *text) {
    text += strspn(text, " ");
    for (size_t n = strlen(text); n > 0 && text[n - 1] == ' '; n--)
        text[n - 1] = '\0';
    return text;
}

static int read_name(field_file *f, const sf_cards *primary, shear_error *err) {
    const sf_file *galaxy = f->parts.of[SHEAR_PART_GALAXY].file;
    CLEANUP(release_free) char *text = NULL;
    TRY(sf_key_string(primary, "FIELD", &text, err));
    const char *given = text == NULL ? "" : trim(text);
    if (given[0] != '\0') {
        return sf_field_name_copy(f->base.info.name, given, SHEAR_E_FORMAT, primary->at,
                                  "keyword FIELD", err);
    }
    /* A file name need not be a valid field name; shear_field_need_name() reports that, if the name
     * is needed. */
    if (sf_field_name_of_file(f->base.info.name, galaxy->source.base, primary->at, NULL) !=
        SHEAR_OK)
        f->base.info.name[0] = '\0';
    return SHEAR_OK;
}

static int read_pixscale(field_file *f, const sf_cards *primary, shear_error *err) {
    double *pixscale = &f->base.info.pixscale;
    *pixscale = NAN;
    TRY(sf_key_double(primary, "PIXSCALE", pixscale, err));
    return !(*pixscale <= 0.0)
               ? SHEAR_OK
               : sf_fail(err, SHEAR_E_FORMAT, primary->at, "give arcseconds per pixel",
                         "keyword PIXSCALE is %g, but must be positive", *pixscale);
}

static int read_shear(const sf_cards *primary, const char *key, double *g, shear_error *err) {
    *g = NAN;
    TRY(sf_key_double(primary, key, g, err));
    return !(fabs(*g) >= 1.0)
               ? SHEAR_OK
               : sf_fail(err, SHEAR_E_FORMAT, primary->at, NULL,
                         "keyword %s is %g, but a shear lies between -1 and 1", key, *g);
}

/* Read FRAME: the axes of the shear that is measured. */
static int read_frame(field_file *f, const sf_cards *primary, shear_error *err) {
    CLEANUP(release_free) char *text = NULL;
    TRY(sf_key_string(primary, "FRAME", &text, err));
    if (text == NULL)
        return SHEAR_OK;
    const char *word = trim(text);
    for (int i = SHEAR_FRAME_PIXEL; i <= SHEAR_FRAME_SKY_EAST; i++) {
        if (strcmp(word, shear_frame_name((enum shear_frame)i)) == 0) {
            f->base.info.frame = (enum shear_frame)i;
            return SHEAR_OK;
        }
    }
    return sf_fail(err, SHEAR_E_FORMAT, primary->at, NULL,
                   "keyword FRAME is '%s', but must be pixel, sky or sky-east", word);
}

static int read_primary(field_file *f, shear_error *err) {
    const sf_file *file = f->parts.of[SHEAR_PART_GALAXY].file;
    CLEANUP(sf_cards_deinit) sf_cards primary;
    TRY(sf_cards_init(&primary, file, &file->hdus[0], "primary", err));
    TRY(read_name(f, &primary, err));
    TRY(read_pixscale(f, &primary, err));
    TRY(read_frame(f, &primary, err));
    TRY(read_shear(&primary, "SIM_G1", &f->base.info.sim_g1, err));
    TRY(read_shear(&primary, "SIM_G2", &f->base.info.sim_g2, err));
    f->base.info.has_truth = !isnan(f->base.info.sim_g1) && !isnan(f->base.info.sim_g2);
    return SHEAR_OK;
}

/* Check that a frame on the sky has all it needs. */
static int check_frame(const field_file *f, shear_error *err) {
    const shear_field_info *info = &f->base.info;
    if (info->frame == SHEAR_FRAME_PIXEL ||
        ((info->columns & SHEAR_COL_JACOBIAN) != 0 && !isnan(info->pixscale))) {
        return SHEAR_OK;
    }
    const sf_place at = {f->parts.of[SHEAR_PART_GALAXY].file->source.name, "primary"};
    return sf_fail(err, SHEAR_E_FORMAT, at, "leave FRAME out for a shear along the pixels",
                   "keyword FRAME is %s: that needs the keyword PIXSCALE and the column JACOBIAN "
                   "in CATALOG",
                   shear_frame_name(info->frame));
}

/* ---- the PSFs: their shape and number, and which stamp each belongs to ---- */

static int check_psf_sides(const field_file *f, shear_error *err) {
    const int64_t *axes = f->psf.axes;
    for (int k = 0; k < 2; k++) {
        if (axes[k] < SHEAR_MIN_PSF_SIDE || axes[k] > SHEAR_MAX_PSF_SIDE) {
            return sf_fail(err, SHEAR_E_FORMAT, f->psf.cards.at, NULL,
                           "its images are %lld x %lld samples, but a side must have %d to %d",
                           (long long)axes[0], (long long)axes[1], SHEAR_MIN_PSF_SIDE,
                           SHEAR_MAX_PSF_SIDE);
        }
    }
    return SHEAR_OK;
}

static int find_oversampling(const sf_cards *cards, double *oversample, shear_error *err) {
    TRY(sf_key_double(cards, "OVERSAMP", oversample, err));
    if (isnan(*oversample) ||
        (*oversample >= SHEAR_MIN_PSF_OVERSAMPLE && *oversample <= SHEAR_MAX_PSF_OVERSAMPLE)) {
        return SHEAR_OK;
    }
    return sf_fail(err, SHEAR_E_FORMAT, cards->at,
                   "give the number of PSF samples per galaxy pixel",
                   "keyword OVERSAMP is %g: it must be %g to %d", *oversample,
                   SHEAR_MIN_PSF_OVERSAMPLE, SHEAR_MAX_PSF_OVERSAMPLE);
}

/* Read OVERSAMP: from the PSFs' HDU, else the primary header, else 1. */
static int read_oversampling(field_file *f, shear_error *err) {
    const sf_file *file = f->parts.of[SHEAR_PART_PSF].file;
    CLEANUP(sf_cards_deinit) sf_cards primary = {0};
    double oversample = NAN;
    TRY(find_oversampling(&f->psf.cards, &oversample, err));
    if (isnan(oversample)) {
        TRY(sf_cards_init(&primary, file, &file->hdus[0], "primary", err));
        TRY(find_oversampling(&primary, &oversample, err));
    }
    f->base.info.geometry.psf_oversample = isnan(oversample) ? 1.0 : oversample;
    return SHEAR_OK;
}

static int assign_psfs(field_file *f, shear_error *err) {
    shear_field_info *info = &f->base.info;
    info->n_psf = f->psf.axes[2];
    info->geometry.psf_nx = (int)f->psf.axes[0];
    info->geometry.psf_ny = (int)f->psf.axes[1];
    if (info->n_models > 0)
        return SHEAR_OK;
    if (info->n_psf == 1) {
        info->psf_layout = SHEAR_PSF_ONE;
    } else if ((info->columns & SHEAR_COL_PSF_ID) != 0) {
        info->psf_layout = SHEAR_PSF_BY_ID;
    } else if (info->n_psf == info->n_stamps) {
        info->psf_layout = SHEAR_PSF_PER_STAMP;
    } else {
        return sf_fail(
            err, SHEAR_E_FORMAT, f->psf.cards.at,
            "give one image, or one per stamp, or a column PSF_ID in CATALOG",
            "it has %lld images for %lld stamps, and there is no column PSF_ID that says "
            "which is whose",
            (long long)info->n_psf, (long long)info->n_stamps);
    }
    return SHEAR_OK;
}

static int open_psf(field_file *f, shear_error *err) {
    const sf_part *part = &f->parts.of[SHEAR_PART_PSF];
    TRY(sf_part_require(part, err));
    TRY(sf_image_init(&f->psf, part->file, part->hdu, part->label, err));
    TRY(check_psf_sides(f, err));
    TRY(field_models_read(f, err));
    TRY(assign_psfs(f, err));
    return read_oversampling(f, err);
}

/* ---- the field ---- */

static int check_noise(const field_file *f, shear_error *err) {
    const sf_stamps *g = &f->galaxy;
    const sf_stamps *n = &f->noise;
    if (n->nx == g->nx && n->ny == g->ny && n->n >= g->n && n->n % g->n == 0 &&
        n->n / g->n <= SHEAR_MAX_NOISE_PLANES) {
        return SHEAR_OK;
    }
    return sf_fail(err, SHEAR_E_FORMAT, n->image.cards.at,
                   "every galaxy stamp needs its noise stamp, or as many as the others, of the "
                   "same shape",
                   "it has %lld stamps of %d x %d pixels, but %s has %lld of %d x %d",
                   (long long)n->n, n->nx, n->ny, g->image.cards.at.hdu, (long long)g->n, g->nx,
                   g->ny);
}

/* Carry what else is in the catalog. */
static int open_carried(field_file *f, shear_error *err) {
    shear_field_info *info = &f->base.info;
    if (f->catalog.table.cards == NULL)
        return SHEAR_OK;
    TRY(carry_list_init(&f->carried, &f->catalog.table, "all", true, err));
    TRY(carry_rows_init(&f->carried_rows, &f->carried, &f->catalog.table, f->catalog.cards.at,
                        err));
    info->n_carried = f->carried.n;
    info->carried_bytes = f->carried.bytes;
    info->carried = f->carried.columns;
    return SHEAR_OK;
}

static void fill_info(field_file *f) {
    shear_field_info *info = &f->base.info;
    info->geometry.nx = f->galaxy.nx;
    info->geometry.ny = f->galaxy.ny;
    info->n_stamps = f->galaxy.n;
    info->noise_planes = (int)(f->noise.n / f->galaxy.n);
    info->layout = f->galaxy.layout;
    info->columns = f->catalog.have;
    const sf_column *id = f->catalog.column[__builtin_ctz(SHEAR_COL_ID)];
    info->id_unsigned = id != NULL && id->by.is_unsigned;
    info->bitpix = f->galaxy.image.bitpix;
    info->compressed = f->galaxy.image.compressed;
    info->separate = !sf_parts_are_whole(&f->parts);
    for (int i = 0; i < SHEAR_N_PARTS; i++) {
        const sf_hdu *hdu = f->parts.of[i].hdu;
        info->hdu[i] = hdu != NULL ? hdu->number : -1;
    }
    for (int i = 0; i < f->parts.n_files; i++) {
        info->gzipped |= f->parts.files[i].source.gzipped;
        info->file_bytes += f->parts.files[i].source.file_bytes;
    }
}

static int open_field(field_file *f, const shear_input *input, const int *fds, shear_error *err) {
    TRY(sf_parts_init(&f->parts, input, fds, err));
    TRY(read_primary(f, err));
    TRY(sf_stamps_init(&f->galaxy, &f->parts.of[SHEAR_PART_GALAXY], &input->mosaic, err));
    TRY(sf_stamps_init(&f->noise, &f->parts.of[SHEAR_PART_NOISE], &input->mosaic, err));
    TRY(check_noise(f, err));
    TRY(sf_columns_init(&f->catalog, &f->parts.of[SHEAR_PART_CATALOG], f->galaxy.n, err));
    fill_info(f);
    TRY(open_carried(f, err));
    TRY(check_frame(f, err));
    return open_psf(f, err);
}

static void close_file(shear_field *field) {
    field_file *f = field_file_of(field);
    carry_rows_deinit(&f->carried_rows);
    carry_list_deinit(&f->carried);
    sf_columns_deinit(&f->catalog);
    sf_image_deinit(&f->psf);
    sf_stamps_deinit(&f->noise);
    sf_stamps_deinit(&f->galaxy);
    sf_parts_deinit(&f->parts);
    free(f->base.models);
    free(f->samples);
    free(f);
}

static int read_image(shear_field *field, int64_t index, double *out, shear_error *err) {
    return sf_image_planes(&field_file_of(field)->psf, index, 1, out, err);
}

static const field_reader reader = {.read = field_file_read,
                                    .read_columns = field_file_read_columns,
                                    .read_psf = read_image,
                                    .close = close_file};

int field_file_open(shear_field **field, const shear_input *input, const int *fds,
                    shear_error *err) {
    field_file *f = calloc(1, sizeof *f);
    *field = NULL;
    if (f == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a field");
    CLEANUP(shear_field_release) shear_field *opened = &f->base;
    f->base.reader = &reader;
    TRY(open_field(f, input, fds, err));
    *field = CLEANUP_TAKE(opened);
    return SHEAR_OK;
}

/* ---- a field of any kind ---- */

void shear_field_close(shear_field *field) {
    if (field != NULL)
        field->reader->close(field);
}

const shear_field_info *shear_field_get_info(const shear_field *field) {
    return &field->info;
}

int shear_field_get_models(const shear_field *field, const shear_psf_model **models) {
    *models = field->models;
    return field->info.n_models;
}

/* Copy plane `index` of the models into the lower left corner of an image. */
static void copy_plane(const shear_field *field, int64_t index, double *out) {
    const shear_geometry *g = &field->info.geometry;
    const shear_psf_model *m = &field->models[index / field->info.psf_terms];
    const int64_t term = index % field->info.psf_terms;
    const double *from = m->samples + term * m->nx * m->ny;
    memset(out, 0, (size_t)g->psf_nx * (size_t)g->psf_ny * sizeof *out);
    for (int y = 0; y < m->ny; y++, out += g->psf_nx, from += m->nx)
        memcpy(out, from, (size_t)m->nx * sizeof *from);
}

int shear_field_read_psf(shear_field *field, int64_t index, double *out, shear_error *err) {
    if (index < 0 || index >= field->info.n_psf) {
        return shear_fail(err, SHEAR_E_INTERNAL, NULL,
                          "PSF image %lld was asked for, but there are %lld", (long long)index,
                          (long long)field->info.n_psf);
    }
    if (field->info.n_models == 0)
        return field->reader->read_psf(field, index, out, err);
    copy_plane(field, index, out);
    return SHEAR_OK;
}

static int check_block(const shear_field *field, int64_t first, int count, shear_block *block,
                       shear_error *err) {
    const int64_t n = field->info.n_stamps;
    if (count < 1 || count > block->capacity || first < 0 || first > n - count) {
        return shear_fail(
            err, SHEAR_E_INTERNAL, NULL,
            "%d stamps from %lld on were asked for into a block of %d, but there are %lld", count,
            (long long)first, block->capacity, (long long)n);
    }
    block->stamps.first = first;
    block->stamps.count = count;
    return SHEAR_OK;
}

int shear_field_read(shear_field *field, int64_t first, int count, shear_block *block,
                     shear_error *err) {
    TRY(check_block(field, first, count, block, err));
    return field->reader->read(field, first, count, block, err);
}

int shear_field_read_columns(shear_field *field, int64_t first, int count, shear_block *block,
                             shear_error *err) {
    TRY(check_block(field, first, count, block, err));
    return field->reader->read_columns(field, first, count, block, err);
}

int shear_field_need_name(const shear_field_info *info, const char *path, shear_error *err) {
    if (info->name[0] != '\0')
        return SHEAR_OK;
    char shown[161];
    char unused[sizeof info->name];
    sf_printable_name(shown, sizeof shown, path);
    const sf_place at = {shown, "primary"};
    TRY(sf_field_name_of_file(unused, path, at, err));
    return sf_fail(err, SHEAR_E_FORMAT, at, "give the keyword FIELD in the primary header",
                   "the field has no name");
}
