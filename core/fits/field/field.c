/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Open field files: their parts, shapes and keywords; read single PSFs. */
#include "common/release.h"

#include "base/cleanup.h"
#include "fits/field/internal.h"

#include <stdlib.h>

static int check_noise(const shear_field *f, shear_error *err) {
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

static void fill_info(shear_field *f) {
    shear_field_info *info = &f->info;
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

static int open_primary(shear_field *f, shear_error *err) {
    const sf_file *file = f->parts.of[SHEAR_PART_GALAXY].file;
    CLEANUP(sf_cards_deinit) sf_cards primary;
    TRY(sf_cards_init(&primary, file, &file->hdus[0], "primary", err));
    return sf_field_read_keys(f, &primary, err);
}

static int open_stamps(shear_field *f, shear_error *err) {
    TRY(sf_stamps_init(&f->galaxy, &f->parts.of[SHEAR_PART_GALAXY], err));
    TRY(sf_stamps_init(&f->noise, &f->parts.of[SHEAR_PART_NOISE], err));
    return check_noise(f, err);
}

static int open_field(shear_field *f, const shear_input *input, const int *fds, shear_error *err) {
    TRY(sf_parts_init(&f->parts, input, fds, err));
    TRY(open_primary(f, err));
    TRY(open_stamps(f, err));
    TRY(sf_columns_init(&f->catalog, &f->parts.of[SHEAR_PART_CATALOG], f->galaxy.n, err));
    fill_info(f);
    return sf_field_open_psf(f, err);
}

int shear_field_open_input(shear_field **field, const shear_input *input, const int *fds,
                           shear_error *err) {
    *field = NULL;
    CLEANUP(shear_field_release) shear_field *f = calloc(1, sizeof *f);
    if (f == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a field");
    TRY(open_field(f, input, fds, err));
    *field = CLEANUP_TAKE(f);
    return SHEAR_OK;
}

int shear_field_open(shear_field **field, const char *path, shear_error *err) {
    const shear_input input = shear_input_of_file(path);
    return shear_field_open_input(field, &input, NULL, err);
}

int shear_field_open_fd(shear_field **field, int fd, const char *name, shear_error *err) {
    const shear_input input = shear_input_of_file(name);
    return shear_field_open_input(field, &input, &fd, err);
}

void shear_field_close(shear_field *field) {
    if (field == NULL)
        return;
    sf_columns_deinit(&field->catalog);
    sf_image_deinit(&field->psf);
    sf_stamps_deinit(&field->noise);
    sf_stamps_deinit(&field->galaxy);
    sf_parts_deinit(&field->parts);
    free(field);
}

const shear_field_info *shear_field_get_info(const shear_field *field) {
    return &field->info;
}

int shear_field_read_psf(shear_field *field, int64_t index, double *out, shear_error *err) {
    const shear_field_info *info = &field->info;
    if (index < 0 || index >= info->n_psf) {
        return sf_fail(err, SHEAR_E_INTERNAL, field->psf.cards.at, NULL,
                       "image %lld was asked for, but there are %lld", (long long)index,
                       (long long)info->n_psf);
    }
    const int64_t first[SF_AXES] = {0, 0, index};
    const int64_t size[SF_AXES] = {info->geometry.psf_nx, info->geometry.psf_ny, 1};
    return sf_image_read(&field->psf, first, size, out, err);
}
