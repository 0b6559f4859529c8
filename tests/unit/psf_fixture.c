/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "psf_fixture.h"
#include "scarce.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static void write_column(fitsfile *f, int number, int rows, const psf_fixture_column *c) {
    char key[16];
    int status = 0;
    int type = 0;
    long repeat = 0;
    fits_get_coltype(f, number, &type, &repeat, NULL, &status);
    for (int row = 1; c->text != NULL && row <= rows; row++)
        fits_write_col_str(f, number, row, 1, 1, &(char *){(char *)c->text}, &status);
    if (c->numbers != NULL)
        fits_write_col_dbl(f, number, 1, 1, repeat * rows, (double *)c->numbers, &status);
    snprintf(key, sizeof key, "TDIM%d", number);
    if (c->dim != NULL)
        fits_update_key_str(f, key, c->dim, NULL, &status);
    assert_int_equal(status, 0);
}

void psf_fixture_table(fitsfile *f, const char *name, int rows, const psf_fixture_column *columns) {
    char *names[64];
    char *forms[64];
    int status = 0;
    int n = 0;
    for (; columns[n].name != NULL; n++) {
        names[n] = (char *)columns[n].name;
        forms[n] = (char *)columns[n].form;
    }
    fits_create_tbl(f, BINARY_TBL, rows, n, names, forms, NULL, name[0] != '\0' ? name : NULL,
                    &status);
    assert_int_equal(status, 0);
    for (int i = 0; i < n; i++)
        write_column(f, i + 1, rows, &columns[i]);
}

void psf_fixture_keys(fitsfile *f, const char *const *cards) {
    int status = 0;
    for (; *cards != NULL; cards++)
        fits_write_record(f, *cards, &status);
    assert_int_equal(status, 0);
}

psf_models *psf_fixture_open(const char *path, enum shear_psf_kind kind, int stamp) {
    const shear_input_part part = {.path = path, .hdu = -1};
    shear_error err = {0};
    psf_models *p = NULL;
    if (psf_models_open(&p, &part, -1, kind, stamp, &err) != SHEAR_OK)
        fail_msg("%s (%s)", err.message, err.advice);
    return p;
}

void psf_fixture_refuse(const char *path, enum shear_psf_kind kind, int code, ...) {
    const shear_input_part part = {.path = path, .hdu = -1};
    shear_error err = {0};
    psf_models *p = NULL;
    char text[sizeof err.message + sizeof err.advice + 4];
    const int got = psf_models_open(&p, &part, -1, kind, 32, &err);
    assert_true((got == SHEAR_OK) == (p != NULL));
    psf_models_close(p);
    snprintf(text, sizeof text, "%s | %s", err.message, err.advice);
    va_list words;
    va_start(words, code);
    if (got != code) {
        va_arg(words, const char *);
        fail_msg("code %d (%s) instead of %d; %s", got, text, code, va_arg(words, const char *));
    }
    for (const char *w = va_arg(words, const char *); w != NULL; w = va_arg(words, const char *)) {
        if (strstr(text, w) == NULL)
            fail_msg("\"%s\" does not contain \"%s\"", text, w);
    }
    va_end(words);
}

void psf_fixture_samples(const psf_models *p, int i, const psf_place *place, double *out) {
    const shear_psf_model *m = psf_models_get(p, i);
    const size_t plane = (size_t)m->nx * (size_t)m->ny;
    double c[512];
    assert_true(psf_models_terms(p, i, place, c));
    for (size_t k = 0; k < plane; k++) {
        out[k] = 0.0;
        for (int t = 0; t < m->terms; t++)
            out[k] += c[t] * m->samples[(size_t)t * plane + k];
    }
}

void psf_fixture_near(double a, double b, double tolerance) {
    if (!(fabs(a - b) <= tolerance))
        fail_msg("%.15g is not %.15g within %g", a, b, tolerance);
}

/* Evaluate all models, whatever they are. */
static void evaluate(const psf_models *p) {
    const double contexts[8] = {1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0};
    const psf_place place = {100.0, 200.0, 15.0, 60.0, contexts};
    const char *const *names = NULL;
    for (int i = 0; i < psf_models_count(p); i++) {
        const shear_psf_model *m = psf_models_get(p, i);
        double *c = calloc((size_t)m->terms, sizeof *c);
        double sum = 0.0;
        assert_non_null(c);
        assert_true(m->terms == psf_models_get(p, 0)->terms);
        psf_models_terms(p, i, &place, c);
        for (int64_t k = 0; k < (int64_t)m->terms * m->nx * m->ny; k++)
            sum += c[k / m->nx / m->ny] * m->samples[k];
        assert_true(sum != 0.1 && psf_models_contexts(p, i, &names) <= 8);
        assert_true(strlen(psf_models_text(p, i)) > 0);
        free(c);
    }
}

void psf_fixture_spoil(const char *path, int rounds) {
    const shear_input_part part = {.path = fixture_path("spoilt.fits"), .hdu = -1};
    size_t size = 0;
    unsigned char *bytes = fixture_load(path, &size);
    uint64_t random = 12345;
    for (int round = 0; round < rounds; round++) {
        unsigned char saved[4];
        size_t at[4];
        psf_models *p = NULL;
        shear_error err = {0};
        for (int i = 0; i < 4; i++) {
            random = random * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
            at[i] = (random >> 20) % size;
            saved[i] = bytes[at[i]];
            if (i <= round % 4)
                bytes[at[i]] = (unsigned char)((random >> 56) % 4 == 0 ? random >> 48
                                                                       : '-' + (random >> 48) % 14);
        }
        fixture_save(part.path, bytes, size);
        if (psf_models_open(&p, &part, -1, SHEAR_PSF_KIND_AUTO, 16, &err) == SHEAR_OK) {
            evaluate(p);
        } else {
            assert_true(p == NULL && err.message[0] != '\0');
        }
        psf_models_close(p);
        for (int i = 3; i >= 0; i--)
            bytes[at[i]] = saved[i];
    }
    free(bytes);
}

void psf_fixture_starve(const char *path) {
    const shear_input_part part = {.path = path, .hdu = -1};
    for (long n = 1;; n++) {
        psf_models *p = NULL;
        shear_error err = {0};
        scarce_after(n, false);
        const int code = psf_models_open(&p, &part, -1, SHEAR_PSF_KIND_AUTO, 16, &err);
        const bool refused = scarce_end();
        assert_int_equal(code, refused ? SHEAR_E_NOMEM : SHEAR_OK);
        assert_true((p == NULL) == refused);
        psf_models_close(p);
        if (!refused)
            return;
    }
}

const char *psf_fixture_real(const char *name) {
    static char path[512];
    snprintf(path, sizeof path, "%s/survey/%s", SHEAR_SHARED, name);
    return access(path, R_OK) == 0 ? path : NULL;
}

double *psf_fixture_image(const char *path, int hdu, int *nx, int *ny) {
    fitsfile *f = NULL;
    int status = 0;
    long axes[2] = {0};
    fits_open_diskfile(&f, path, READONLY, &status);
    fits_movabs_hdu(f, hdu, NULL, &status);
    fits_get_img_size(f, 2, axes, &status);
    assert_int_equal(status, 0);
    double *pixels = calloc((size_t)(axes[0] * axes[1]), sizeof *pixels);
    assert_non_null(pixels);
    fits_read_img(f, TDOUBLE, 1, axes[0] * axes[1], NULL, pixels, NULL, &status);
    fits_close_file(f, &status);
    assert_int_equal(status, 0);
    *nx = (int)axes[0];
    *ny = (int)axes[1];
    return pixels;
}

double psf_fixture_uniform(uint64_t *seed) {
    *seed = *seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (double)(*seed >> 11) * 0x1p-53;
}

double psf_fixture_normal(uint64_t *seed) {
    const double r = sqrt(-2.0 * log(1.0 - psf_fixture_uniform(seed)));
    return r * cos(2.0 * acos(-1.0) * psf_fixture_uniform(seed));
}
