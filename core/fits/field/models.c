/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fits/field/models.h"

#include "base/cleanup.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

static const char hdu_name[] = "PSF_MODELS";

/* The columns, each a member of shear_psf_model and its range. */
static const struct {
    const char *name;
    size_t offset;
    bool real;
    double min, max;
} columns[] = {
    {"STEP", offsetof(shear_psf_model, step), true, 1e-6, 1e6},
    {"AXES", offsetof(shear_psf_model, axes), false, 0, SHEAR_PSF_AXES_MODES},
    {"LANCZOS", offsetof(shear_psf_model, lanczos), false, 0, 32},
    {"SMOOTHED", offsetof(shear_psf_model, smoothed_px), true, 0, SHEAR_MAX_PSF_SIDE},
    {"NX", offsetof(shear_psf_model, nx), false, SHEAR_MIN_PSF_SIDE, SHEAR_MAX_PSF_SIDE},
    {"NY", offsetof(shear_psf_model, ny), false, SHEAR_MIN_PSF_SIDE, SHEAR_MAX_PSF_SIDE},
};
enum { N_COLUMNS = sizeof columns / sizeof columns[0] };

/* ---- reading ---- */

/* Read column `c` of all models. `values` is memory for n numbers. */
static int read_column(const sf_table *table, int c, shear_psf_model *models, int n, double *values,
                       shear_error *err) {
    const sf_column *column = NULL;
    TRY(sf_table_find_number(table, columns[c].name, &column, err));
    if (column == NULL) {
        return sf_fail(err, SHEAR_E_FORMAT, table->cards->at, NULL, "it has no column %s",
                       columns[c].name);
    }
    TRY(sf_table_doubles(table, column, 0, n, values, err));
    for (int i = 0; i < n; i++) {
        const double v = values[i];
        const bool whole = columns[c].real || v == floor(v);
        if (!(v >= columns[c].min && v <= columns[c].max) || !whole) {
            return sf_fail(err, SHEAR_E_FORMAT, table->cards->at, NULL,
                           "%s of model %d is %g, but must be %s from %g to %g", columns[c].name, i,
                           v, columns[c].real ? "a number" : "an integer", columns[c].min,
                           columns[c].max);
        }
        void *member = (char *)&models[i] + columns[c].offset;
        const int integer = (int)v;
        memcpy(member, columns[c].real ? (const void *)&v : (const void *)&integer,
               columns[c].real ? sizeof v : sizeof integer);
    }
    return SHEAR_OK;
}

static int read_table(field_file *f, const sf_table *table, int n, shear_error *err) {
    CLEANUP(release_free) double *values = calloc((size_t)n, sizeof *values);
    f->base.models = calloc((size_t)n, sizeof *f->base.models);
    if (values == NULL || f->base.models == NULL)
        return sf_fail_memory(err, table->cards->at);
    for (int c = 0; c < N_COLUMNS; c++)
        TRY(read_column(table, c, f->base.models, n, values, err));
    return SHEAR_OK;
}

/* Read the planes of one model, without the margin by which the PSF's HDU may be larger. */
static int read_planes(field_file *f, shear_psf_model *m, int64_t first, double *samples,
                       shear_error *err) {
    if (m->nx > f->psf.axes[0] || m->ny > f->psf.axes[1]) {
        return sf_fail(err, SHEAR_E_FORMAT, f->psf.cards.at, NULL,
                       "its planes are %lld x %lld samples, but a model has %d x %d",
                       (long long)f->psf.axes[0], (long long)f->psf.axes[1], m->nx, m->ny);
    }
    const int64_t from[SF_AXES] = {0, 0, first};
    const int64_t size[SF_AXES] = {m->nx, m->ny, m->terms};
    m->samples = samples;
    return sf_image_read(&f->psf, from, size, samples, err);
}

static int read_samples(field_file *f, shear_error *err) {
    const shear_field_info *info = &f->base.info;
    const size_t most = (size_t)1 << 28; /* samples: 2 GiB */
    size_t all = 0;
    for (int i = 0; i < info->n_models; i++) {
        f->base.models[i].terms = info->psf_terms;
        all +=
            (size_t)f->base.models[i].nx * (size_t)f->base.models[i].ny * (size_t)info->psf_terms;
        if (all > most)
            return sf_fail(err, SHEAR_E_FORMAT, f->psf.cards.at, NULL, "its models are too large");
    }
    f->samples = malloc(all * sizeof *f->samples);
    if (f->samples == NULL)
        return sf_fail_memory(err, f->psf.cards.at);
    double *samples = f->samples;
    for (int i = 0; i < info->n_models; i++) {
        shear_psf_model *m = &f->base.models[i];
        TRY(read_planes(f, m, (int64_t)i * m->terms, samples, err));
        samples += (size_t)m->nx * (size_t)m->ny * (size_t)m->terms;
    }
    return SHEAR_OK;
}

/* Check that the number of planes is that of all terms, and note both. */
static int count_models(field_file *f, const sf_hdu *hdu, sf_place at, shear_error *err) {
    shear_field_info *info = &f->base.info;
    const sf_column *terms = f->catalog.column[__builtin_ctz(SHEAR_COL_PSF_TERMS)];
    if (terms == NULL || (info->columns & SHEAR_COL_PSF_ID) == 0) {
        return sf_fail(err, SHEAR_E_FORMAT, at, NULL,
                       "CATALOG must have the columns PSF_ID and PSF_TERMS");
    }
    if (hdu->axes[1] < 1 || hdu->axes[1] > f->psf.axes[2] ||
        hdu->axes[1] * terms->repeat != f->psf.axes[2]) {
        return sf_fail(err, SHEAR_E_FORMAT, at, NULL,
                       "%lld models of %lld terms do not make the %lld planes of HDU PSF",
                       (long long)hdu->axes[1], (long long)terms->repeat,
                       (long long)f->psf.axes[2]);
    }
    info->n_models = (int)hdu->axes[1];
    info->psf_terms = (int)terms->repeat;
    info->psf_layout = SHEAR_PSF_MODELS;
    return SHEAR_OK;
}

int field_models_read(field_file *f, shear_error *err) {
    const sf_file *file = f->parts.of[SHEAR_PART_PSF].file;
    const sf_place at = {file->source.name, hdu_name};
    const sf_hdu *hdu = NULL;
    CLEANUP(sf_cards_deinit) sf_cards cards = {0};
    CLEANUP(sf_table_deinit) sf_table table = {0};
    TRY(sf_file_find(file, hdu_name, false, &hdu, err));
    if (hdu == NULL)
        return SHEAR_OK;
    if (hdu->kind != SF_TABLE || hdu->zimage || hdu->ztable)
        return sf_fail(err, SHEAR_E_FORMAT, at, NULL, "must be a binary table (BINTABLE)");
    TRY(count_models(f, hdu, at, err));
    TRY(sf_cards_init(&cards, file, hdu, hdu_name, err));
    TRY(sf_table_init(&table, &cards, err));
    TRY(read_table(f, &table, f->base.info.n_models, err));
    return read_samples(f, err);
}

/* ---- writing ---- */

void field_models_create(fitsfile *f, const shear_psf_model *models, int n, int *status) {
    char *names[N_COLUMNS];
    char *forms[N_COLUMNS];
    for (int c = 0; c < N_COLUMNS; c++) {
        names[c] = (char *)columns[c].name; /* CFITSIO does not write to them */
        forms[c] = columns[c].real ? "D" : "J";
    }
    fits_create_tbl(f, BINARY_TBL, n, N_COLUMNS, names, forms, NULL, hdu_name, status);
    for (int i = 0; i < n; i++) {
        for (int c = 0; c < N_COLUMNS; c++) {
            void *member = (char *)&models[i] + columns[c].offset;
            fits_write_col(f, columns[c].real ? TDOUBLE : TINT, c + 1, i + 1, 1, 1, member, status);
        }
    }
}
