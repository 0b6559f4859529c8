/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Write field files. All HDUs are created at once with their final sizes, so that stamps may be
 * written in any order. */
#include "base/cleanup.h"
#include "fits/carry/carry_rows.h"
#include "fits/field/models.h"
#include "fits/field/name.h"
#include "fits/io/bitset.h"
#include "fits/io/output.h"
#include "fits/schema/field_columns.h"
#include "fits/schema/layout.h"

#include <math.h>
#include <stdlib.h>

enum { HDU_PRIMARY = 1, HDU_GALAXY, HDU_NOISE, HDU_PSF, HDU_CATALOG };

struct shear_field_writer {
    sf_output out;
    shear_field_spec spec;  /* without its pointers */
    int terms;              /* of a PSF model */
    int carried_bytes;      /* of a row of carried columns */
    int64_t columns;        /* stamps per row of the mosaic */
    sf_bitset stamps, psfs; /* written so far */
};

/* ---- the specification ---- */

static int model_terms(const shear_field_spec *s) {
    return s->n_models > 0 ? s->models[0].terms : 0;
}

static int bad_spec(sf_place at, const char *what, shear_error *err) {
    return sf_fail(err, SHEAR_E_SETTING, at, NULL, "cannot be made: %s", what);
}

static bool inside(int64_t value, int64_t min, int64_t max) {
    return value >= min && value <= max;
}

static int check_sizes(const shear_field_spec *s, sf_place at, shear_error *err) {
    const shear_geometry *g = &s->geometry;
    const bool has_ids = (s->columns & SHEAR_COL_PSF_ID) != 0;
    const struct {
        bool kept;
        const char *what;
    } rules[] = {
        {inside(g->nx, SHEAR_MIN_SIDE, SHEAR_MAX_SIDE) &&
             inside(g->ny, SHEAR_MIN_SIDE, SHEAR_MAX_SIDE),
         "a stamp's side must have 8 to 1024 pixels"},
        {inside(g->psf_nx, SHEAR_MIN_PSF_SIDE, SHEAR_MAX_PSF_SIDE) &&
             inside(g->psf_ny, SHEAR_MIN_PSF_SIDE, SHEAR_MAX_PSF_SIDE),
         "a PSF's side must have 3 to 4096 samples"},
        {g->psf_oversample >= SHEAR_MIN_PSF_OVERSAMPLE &&
             g->psf_oversample <= SHEAR_MAX_PSF_OVERSAMPLE,
         "the PSF's oversampling must be 0.1 to 64"},
        {inside(s->n_stamps, 1, INT32_MAX), "the number of stamps must be 1 to 2147483647"},
        {inside(s->noise_planes, 0, SHEAR_MAX_NOISE_PLANES),
         "there must be 1 to 64 noise stamps per galaxy"},
        {s->n_psf == 1 || s->n_psf == s->n_stamps || s->n_models > 0 ||
             (has_ids && inside(s->n_psf, 1, INT32_MAX)),
         "there must be one PSF, or one per stamp, or a column PSF_ID"},
        {s->n_models == 0 || s->n_psf == (int64_t)s->n_models * model_terms(s),
         "there must be a PSF image for every term of every model"},
        {(s->n_models > 0) == ((s->columns & SHEAR_COL_PSF_TERMS) != 0),
         "PSF models and the column PSF_TERMS belong together"},
        {s->layout == SHEAR_LAYOUT_CUBE || s->layout == SHEAR_LAYOUT_MOSAIC,
         "the layout is neither cube nor mosaic"},
        {inside(s->mosaic_columns, 0, s->n_stamps),
         "a mosaic's row must have 1 to n_stamps stamps"},
        {s->bitpix == -32 || s->bitpix == -64, "BITPIX must be -32 or -64"},
    };
    for (size_t i = 0; i < sizeof rules / sizeof rules[0]; i++) {
        if (!rules[i].kept)
            return bad_spec(at, rules[i].what, err);
    }
    return SHEAR_OK;
}

/* Check that the reader would accept the file. SHEAR_E_SETTING; `file` is for messages. */
static int check_spec(const shear_field_spec *s, const char *file, shear_error *err) {
    const sf_place at = {file, NULL};
    if (s->name != NULL) {
        char copy[SHEAR_FIELD_NAME_SIZE];
        TRY(sf_field_name_copy(copy, s->name, SHEAR_E_SETTING, at, "as given", err));
    }
    if (!isnan(s->pixscale) && !(s->pixscale > 0.0 && isfinite(s->pixscale)))
        return bad_spec(at, "the pixel scale must be positive", err);
    if (s->has_truth && !(fabs(s->sim_g1) < 1.0 && fabs(s->sim_g2) < 1.0))
        return bad_spec(at, "the true shear must lie between -1 and 1", err);
    return check_sizes(s, at, err);
}

/* ---- the file ---- */

static int result(const shear_field_writer *w, const char *hdu, int status, shear_error *err) {
    return sf_check_status(err, (sf_place){w->out.name, hdu}, status, "cannot be written");
}

static int write_primary(shear_field_writer *w, const shear_field_spec *spec, shear_error *err) {
    fitsfile *f = w->out.fits;
    int status = 0;
    fits_create_img(f, BYTE_IMG, 0, NULL, &status);
    if (spec->name != NULL)
        fits_write_key_longstr(f, "FIELD", spec->name, "name of the field", &status);
    sf_output_double(f, "PIXSCALE", spec->pixscale, "[arcsec] per pixel", &status);
    if (spec->frame != SHEAR_FRAME_PIXEL)
        fits_write_key_str(f, "FRAME", shear_frame_name(spec->frame), "axes of the shear", &status);
    if (spec->has_truth) {
        sf_output_double(f, "SIM_G1", spec->sim_g1, "true shear of the mock", &status);
        sf_output_double(f, "SIM_G2", spec->sim_g2, "true shear of the mock", &status);
    }
    for (const char *const *line = spec->history; line != NULL && *line != NULL; line++)
        fits_write_history(f, *line, &status);
    return result(w, "primary", status, err);
}

static int64_t noise_planes(const shear_field_spec *s) {
    return s->noise_planes > 1 ? s->noise_planes : 1;
}

static void create_mosaic(fitsfile *f, const shear_field_spec *s, int64_t n, int64_t columns,
                          int *status) {
    const int64_t rows = (n - 1) / columns + 1;
    long axes[2] = {(long)(columns * s->geometry.nx), (long)(rows * s->geometry.ny)};
    fits_create_img(f, s->bitpix, 2, axes, status);
    fits_write_key_lng(f, "STAMPNX", s->geometry.nx, "pixels of a stamp along x", status);
    fits_write_key_lng(f, "STAMPNY", s->geometry.ny, "pixels of a stamp along y", status);
    if (rows * columns != n)
        fits_write_key_lng(f, "NSTAMP", n, "stamps; the last row is not full", status);
}

static int create_stamps(shear_field_writer *w, const char *name, const char *comment, int64_t n,
                         shear_error *err) {
    const shear_field_spec *s = &w->spec;
    long cube[3] = {s->geometry.nx, s->geometry.ny, (long)n};
    int status = 0;
    if (s->layout == SHEAR_LAYOUT_CUBE) {
        fits_create_img(w->out.fits, s->bitpix, 3, cube, &status);
    } else {
        create_mosaic(w->out.fits, s, n, w->columns, &status);
    }
    fits_write_key_str(w->out.fits, "EXTNAME", name, comment, &status);
    return result(w, name, status, err);
}

/* Write OVERSAMP: an integer if it is whole, which any reader takes. */
static void write_oversampling(fitsfile *f, double oversample, int *status) {
    static const char comment[] = "PSF samples per galaxy pixel";
    if (oversample == floor(oversample)) {
        fits_write_key_lng(f, "OVERSAMP", (LONGLONG)oversample, comment, status);
    } else {
        fits_write_key_dbl(f, "OVERSAMP", oversample, -15, comment, status);
    }
}

static int create_psf(shear_field_writer *w, shear_error *err) {
    const shear_field_spec *s = &w->spec;
    int status = 0;
    long axes[3] = {s->geometry.psf_nx, s->geometry.psf_ny, (long)s->n_psf};
    fits_create_img(w->out.fits, s->bitpix, s->n_psf == 1 ? 2 : 3, axes, &status);
    fits_write_key_str(w->out.fits, "EXTNAME", "PSF", "point spread function", &status);
    write_oversampling(w->out.fits, s->geometry.psf_oversample, &status);
    return result(w, "PSF", status, err);
}

static int create_catalog(shear_field_writer *w, const shear_field_spec *spec, shear_error *err) {
    sf_layout l = {0};
    int status = 0;
    sf_layout_add_columns(&l, spec->columns, w->terms);
    const int first = l.n + 1;
    sf_layout_add_carried(&l, spec->carried, spec->n_carried);
    if (l.n == 0)
        return SHEAR_OK;
    fits_create_tbl(w->out.fits, BINARY_TBL, w->spec.n_stamps, l.n, l.names, l.forms, l.units,
                    "CATALOG", &status);
    carry_write_keys(w->out.fits, spec->carried, spec->n_carried, first, &status);
    return result(w, "CATALOG", status, err);
}

static int create_models(shear_field_writer *w, const shear_field_spec *spec, shear_error *err) {
    int status = 0;
    if (spec->n_models > 0)
        field_models_create(w->out.fits, spec->models, spec->n_models, &status);
    return result(w, "PSF_MODELS", status, err);
}

CLEANUP_DEFINE(shear_field_writer, shear_field_abort)

int shear_field_create(shear_field_writer **writer, const char *path, const shear_field_spec *spec,
                       shear_error *err) {
    *writer = NULL;
    TRY(check_spec(spec, path, err));
    CLEANUP(shear_field_writer_release) shear_field_writer *w = calloc(1, sizeof *w);
    if (w == NULL)
        return sf_fail_memory(err, (sf_place){path, NULL});
    w->out.directory = -1;
    w->spec = *spec;
    w->spec.name = NULL;
    w->terms = model_terms(spec);
    w->spec.models = NULL;
    w->spec.history = NULL;
    w->spec.carried = NULL;
    for (int i = 0; i < spec->n_carried; i++)
        w->carried_bytes += spec->carried[i].bytes;
    w->columns = spec->mosaic_columns > 0 ? spec->mosaic_columns
                                          : (int64_t)ceil(sqrt((double)spec->n_stamps));
    if (!sf_bitset_init(&w->stamps, spec->n_stamps) || !sf_bitset_init(&w->psfs, spec->n_psf))
        return sf_fail_memory(err, (sf_place){path, NULL});
    TRY(sf_output_create(&w->out, path, spec->overwrite, err));
    TRY(write_primary(w, spec, err));
    TRY(create_stamps(w, "GALAXY", "galaxy stamps", spec->n_stamps, err));
    TRY(create_stamps(w, "NOISE", "noise stamps", noise_planes(spec) * spec->n_stamps, err));
    TRY(create_psf(w, err));
    TRY(create_catalog(w, spec, err));
    TRY(create_models(w, spec, err));
    *writer = CLEANUP_TAKE(w);
    return SHEAR_OK;
}

static int write_stamps(shear_field_writer *w, int hdu, int64_t first, int64_t count,
                        const double *pixels, shear_error *err) {
    const int64_t nx = w->spec.geometry.nx;
    const int64_t ny = w->spec.geometry.ny;
    const bool cube = w->spec.layout == SHEAR_LAYOUT_CUBE;
    int status = 0;
    fits_movabs_hdu(w->out.fits, hdu, NULL, &status);
    if (cube) {
        fits_write_img(w->out.fits, TDOUBLE, first * nx * ny + 1, count * nx * ny, (double *)pixels,
                       &status);
    }
    for (int64_t i = first; !cube && i < first + count; i++, pixels += nx * ny) {
        long low[2] = {(long)(i % w->columns * nx + 1), (long)(i / w->columns * ny + 1)};
        long high[2] = {(long)(low[0] + nx - 1), (long)(low[1] + ny - 1)};
        fits_write_subset(w->out.fits, TDOUBLE, low, high, (double *)pixels, &status);
    }
    return result(w, hdu == HDU_GALAXY ? "GALAXY" : "NOISE", status, err);
}

static int write_catalog(shear_field_writer *w, int64_t first, int count,
                         const shear_catalog_columns *c, shear_error *err) {
    int status = 0;
    fits_movabs_hdu(w->out.fits, HDU_CATALOG, NULL, &status);
    int column = 0;
    for (const sf_column_def *def = sf_column_defs; def < sf_column_defs + SF_COLUMNS; def++) {
        const int type = def->form[0] == 'K' ? TLONGLONG : def->form[0] == 'J' ? TINT : TDOUBLE;
        void *values = sf_column_array(c, def->in_rows);
        if ((w->spec.columns & def->bit) == 0)
            continue;
        if (values == NULL) {
            return sf_fail(err, SHEAR_E_INTERNAL, (sf_place){w->out.name, "CATALOG"}, NULL,
                           "no values were given for column %s", def->name);
        }
        const int64_t numbers = (int64_t)count * sf_column_repeat(def, w->terms);
        fits_write_col(w->out.fits, type, ++column, first + 1, 1, numbers, values, &status);
    }
    if (w->carried_bytes > 0)
        carry_write_rows(w->out.fits, first, count, c->carried, w->carried_bytes, &status);
    return result(w, "CATALOG", status, err);
}

int shear_field_write(shear_field_writer *w, int64_t first, int count, const double *galaxy,
                      const double *noise, const shear_catalog_columns *columns, shear_error *err) {
    static const shear_catalog_columns none = {0};
    if (count < 1 || first < 0 || first > w->spec.n_stamps - count) {
        return sf_fail(err, SHEAR_E_INTERNAL, (sf_place){w->out.name, NULL}, NULL,
                       "%d stamps from %lld on were written, but there are %lld", count,
                       (long long)first, (long long)w->spec.n_stamps);
    }
    const int64_t planes = noise_planes(&w->spec);
    TRY(write_stamps(w, HDU_GALAXY, first, count, galaxy, err));
    TRY(write_stamps(w, HDU_NOISE, planes * first, planes * count, noise, err));
    if (w->spec.columns != 0 || w->spec.n_carried > 0)
        TRY(write_catalog(w, first, count, columns != NULL ? columns : &none, err));
    sf_bitset_add(&w->stamps, first, count);
    return SHEAR_OK;
}

int shear_field_write_psf(shear_field_writer *w, int64_t index, const double *psf,
                          shear_error *err) {
    const int64_t samples = (int64_t)w->spec.geometry.psf_nx * w->spec.geometry.psf_ny;
    if (index < 0 || index >= w->spec.n_psf) {
        return sf_fail(err, SHEAR_E_INTERNAL, (sf_place){w->out.name, "PSF"}, NULL,
                       "image %lld was written, but there are %lld", (long long)index,
                       (long long)w->spec.n_psf);
    }
    int status = 0;
    fits_movabs_hdu(w->out.fits, HDU_PSF, NULL, &status);
    fits_write_img(w->out.fits, TDOUBLE, index * samples + 1, samples, (double *)psf, &status);
    if (status == 0)
        sf_bitset_add(&w->psfs, index, 1);
    return result(w, "PSF", status, err);
}

static int check_complete(const shear_field_writer *w, shear_error *err) {
    const int64_t stamp = sf_bitset_first_gap(&w->stamps);
    const int64_t psf = sf_bitset_first_gap(&w->psfs);
    if (stamp < 0 && psf < 0)
        return SHEAR_OK;
    return sf_fail(err, SHEAR_E_INTERNAL, (sf_place){w->out.name, NULL}, NULL,
                   "%s %lld was never written", stamp >= 0 ? "stamp" : "PSF image",
                   (long long)(stamp >= 0 ? stamp : psf));
}

int shear_field_finish(shear_field_writer *w, shear_error *err) {
    CLEANUP(shear_field_writer_release) shear_field_writer *own = w;
    TRY(check_complete(own, err));
    return sf_output_commit(&own->out, err);
}

void shear_field_abort(shear_field_writer *w) {
    if (w == NULL)
        return;
    sf_output_discard(&w->out);
    sf_bitset_deinit(&w->stamps);
    sf_bitset_deinit(&w->psfs);
    free(w);
}
