/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Write field files. All HDUs are created at once with their final sizes, so that stamps may be
 * written in any order. */
#include "base/cleanup.h"
#include "fits/field/columns.h"
#include "fits/field/spec.h"
#include "fits/header/key_write.h"
#include "fits/io/bitset.h"
#include "fits/io/output.h"

#include <math.h>
#include <stdlib.h>

enum { HDU_PRIMARY = 1, HDU_GALAXY, HDU_NOISE, HDU_PSF, HDU_CATALOG };

struct shear_field_writer {
    sf_output out;
    shear_field_spec spec;  /* without its pointers */
    int64_t columns;        /* stamps per row of the mosaic */
    sf_bitset stamps, psfs; /* written so far */
};

static int result(const shear_field_writer *w, const char *hdu, int status, shear_error *err) {
    return sf_check_status(err, (sf_place){w->out.name, hdu}, status, "cannot be written");
}

static int write_primary(shear_field_writer *w, const shear_field_spec *spec, shear_error *err) {
    fitsfile *f = w->out.fits;
    int status = 0;
    fits_create_img(f, BYTE_IMG, 0, NULL, &status);
    if (spec->name != NULL)
        fits_write_key_longstr(f, "FIELD", spec->name, "name of the field", &status);
    sf_key_write_double(f, "PIXSCALE", spec->pixscale, "[arcsec] per pixel", &status);
    if (spec->has_truth) {
        sf_key_write_double(f, "SIM_G1", spec->sim_g1, "true shear of the mock", &status);
        sf_key_write_double(f, "SIM_G2", spec->sim_g2, "true shear of the mock", &status);
    }
    for (const char *const *line = spec->history; line != NULL && *line != NULL; line++)
        fits_write_history(f, *line, &status);
    return result(w, "primary", status, err);
}

static int64_t noise_planes(const shear_field_spec *s) {
    return s->noise_planes > 1 ? s->noise_planes : 1;
}

static void create_cube(fitsfile *f, const shear_field_spec *s, int64_t n, int *status) {
    long axes[3] = {s->geometry.nx, s->geometry.ny, (long)n};
    fits_create_img(f, s->bitpix, 3, axes, status);
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
    int status = 0;
    if (w->spec.layout == SHEAR_LAYOUT_CUBE) {
        create_cube(w->out.fits, &w->spec, n, &status);
    } else {
        create_mosaic(w->out.fits, &w->spec, n, w->columns, &status);
    }
    fits_write_key_str(w->out.fits, "EXTNAME", name, comment, &status);
    return result(w, name, status, err);
}

static int create_psf(shear_field_writer *w, shear_error *err) {
    const shear_field_spec *s = &w->spec;
    int status = 0;
    long axes[3] = {s->geometry.psf_nx, s->geometry.psf_ny, (long)s->n_psf};
    fits_create_img(w->out.fits, s->bitpix, s->n_psf == 1 ? 2 : 3, axes, &status);
    fits_write_key_str(w->out.fits, "EXTNAME", "PSF", "point spread function", &status);
    fits_write_key_lng(w->out.fits, "OVERSAMP", s->geometry.psf_oversample,
                       "PSF samples per galaxy pixel", &status);
    return result(w, "PSF", status, err);
}

static int create_catalog(shear_field_writer *w, shear_error *err) {
    sf_layout l = {0};
    int status = 0;
    sf_layout_add_columns(&l, w->spec.columns);
    if (l.n == 0)
        return SHEAR_OK;
    fits_create_tbl(w->out.fits, BINARY_TBL, w->spec.n_stamps, l.n, l.names, l.forms, l.units,
                    "CATALOG", &status);
    return result(w, "CATALOG", status, err);
}

static int create_hdus(shear_field_writer *w, const shear_field_spec *spec, shear_error *err) {
    TRY(write_primary(w, spec, err));
    TRY(create_stamps(w, "GALAXY", "galaxy stamps", spec->n_stamps, err));
    TRY(create_stamps(w, "NOISE", "noise stamps", noise_planes(spec) * spec->n_stamps, err));
    TRY(create_psf(w, err));
    return create_catalog(w, err);
}

static int begin(shear_field_writer *w, const char *path, const shear_field_spec *spec,
                 shear_error *err) {
    w->spec = *spec;
    w->spec.name = NULL;
    w->spec.history = NULL;
    w->columns = spec->mosaic_columns > 0 ? spec->mosaic_columns
                                          : (int64_t)ceil(sqrt((double)spec->n_stamps));
    if (!sf_bitset_init(&w->stamps, spec->n_stamps) || !sf_bitset_init(&w->psfs, spec->n_psf))
        return sf_fail_memory(err, (sf_place){path, NULL});
    TRY(sf_output_create(&w->out, path, spec->overwrite, err));
    return create_hdus(w, spec, err);
}

CLEANUP_DEFINE(shear_field_writer, shear_field_abort)

int shear_field_create(shear_field_writer **writer, const char *path, const shear_field_spec *spec,
                       shear_error *err) {
    *writer = NULL;
    TRY(sf_field_spec_check(spec, path, err));
    CLEANUP(shear_field_writer_release) shear_field_writer *w = calloc(1, sizeof *w);
    if (w == NULL)
        return sf_fail_memory(err, (sf_place){path, NULL});
    w->out.directory = -1;
    TRY(begin(w, path, spec, err));
    *writer = CLEANUP_TAKE(w);
    return SHEAR_OK;
}

static void write_cube(shear_field_writer *w, int64_t first, int64_t count, const double *pixels,
                       int *status) {
    const int64_t stamp = (int64_t)w->spec.geometry.nx * w->spec.geometry.ny;
    fits_write_img(w->out.fits, TDOUBLE, first * stamp + 1, count * stamp, (double *)pixels,
                   status);
}

static void write_mosaic(shear_field_writer *w, int64_t first, int64_t count, const double *pixels,
                         int *status) {
    const int64_t nx = w->spec.geometry.nx;
    const int64_t ny = w->spec.geometry.ny;
    for (int64_t i = first; i < first + count; i++, pixels += nx * ny) {
        long low[2] = {(long)(i % w->columns * nx + 1), (long)(i / w->columns * ny + 1)};
        long high[2] = {(long)(low[0] + nx - 1), (long)(low[1] + ny - 1)};
        fits_write_subset(w->out.fits, TDOUBLE, low, high, (double *)pixels, status);
    }
}

static int write_stamps(shear_field_writer *w, int hdu, int64_t first, int64_t count,
                        const double *pixels, shear_error *err) {
    int status = 0;
    fits_movabs_hdu(w->out.fits, hdu, NULL, &status);
    if (w->spec.layout == SHEAR_LAYOUT_CUBE) {
        write_cube(w, first, count, pixels, &status);
    } else {
        write_mosaic(w, first, count, pixels, &status);
    }
    return result(w, hdu == HDU_GALAXY ? "GALAXY" : "NOISE", status, err);
}

static int write_catalog(shear_field_writer *w, int64_t first, int count,
                         const shear_catalog_columns *c, shear_error *err) {
    int status = 0;
    fits_movabs_hdu(w->out.fits, HDU_CATALOG, NULL, &status);
    int column = 0;
    for (const sf_column_def *def = sf_column_defs; def < sf_column_defs + SF_COLUMNS; def++) {
        const int type = def->form[0] == 'K' ? TLONGLONG : def->form[0] == 'D' ? TDOUBLE : TINT;
        void *values = sf_column_array(c, def->in_rows);
        if ((w->spec.columns & def->bit) == 0)
            continue;
        if (values == NULL) {
            return sf_fail(err, SHEAR_E_INTERNAL, (sf_place){w->out.name, "CATALOG"}, NULL,
                           "no values were given for column %s", def->name);
        }
        fits_write_col(w->out.fits, type, ++column, first + 1, 1, count, values, &status);
    }
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
    if (w->spec.columns != 0)
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
