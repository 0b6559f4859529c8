/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/psf/piff.h"

#include "base/cleanup.h"
#include "base/text.h"
#include "survey/psf/piff_grid.h"
#include "survey/psf/record.h"

#include <ctype.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static const char render[] =
    "draw the PSF with Piff, psf.draw(x, y, stamp_size=64), at many places into a cube of images, "
    "write a table of X and Y beside it, and give that file (docs/exposures.md)";
/* A model whose chi-square per degree of freedom is larger does not describe its stars. */
static const double worst_chi2 = 100.0;

/* ---- tables by name ---- */

/* Open the table "prefix_name", or "prefix" if name is "". *there is false if it is absent. */
static int open_table(psf_record *r, const psf_models *p, const char *prefix, const char *name,
                      bool *there, shear_error *err) {
    char full[2 * SF_NAME];
    const sf_hdu *hdu = NULL;
    snprintf(full, sizeof full, "%s%s%s", prefix, name[0] != '\0' ? "_" : "", name);
    TRY(sf_file_find(&p->file, full, false, &hdu, err));
    *there = hdu != NULL && psf_record_is_table(hdu);
    return *there ? psf_record_init(r, &p->file, hdu, err) : SHEAR_OK;
}

static int need_table(psf_record *r, const psf_models *p, const char *prefix, const char *name,
                      shear_error *err) {
    bool there = false;
    TRY(open_table(r, p, prefix, name, &there, err));
    return there ? SHEAR_OK
                 : sf_fail(err, SHEAR_E_FORMAT, (sf_place){p->file.source.name, NULL}, NULL,
                           "has no table %s_%s, which files of Piff have", prefix, name);
}

/* Check that the table's `type` is the one that is read. */
static int check_type(const psf_record *r, const char *wanted, const char *what, shear_error *err) {
    char type[SF_NAME];
    TRY(psf_record_text(r, "type", type, sizeof type, err));
    return strcmp(type, wanted) == 0
               ? SHEAR_OK
               : sf_fail(err, SHEAR_E_PSF, r->cards.at, render,
                         "%s '%s' of Piff needs Piff itself; only %s is read", what, type, wanted);
}

/* ---- the polynomial ---- */

typedef struct piff_keys {
    char name[POLYNOMIAL_VARIABLES][SF_NAME];
    int order[POLYNOMIAL_VARIABLES];
    int n;
} piff_keys;

static bool is_name(char c) {
    return isalnum((unsigned char)c) || c == '_';
}

/* Append the names in a text such as "('x', 'y')". */
static void add_names(piff_keys *k, const char *text) {
    for (size_t n = 0; *text != '\0'; text += n) {
        text += strcspn(text, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_");
        for (n = 0; is_name(text[n]); n++)
            ;
        if (n > 0 && n < SF_NAME && k->n < POLYNOMIAL_VARIABLES) {
            memcpy(k->name[k->n], text, n);
            k->name[k->n++][n] = '\0';
        }
    }
}

/* Read the column `keys`: an array of texts, or one text. Without it they are u and v. */
static int read_names(piff_keys *k, const psf_record *r, shear_error *err) {
    const sf_column *column = NULL;
    char text[POLYNOMIAL_VARIABLES * SF_NAME];
    int64_t axes[SF_AXES];
    TRY(sf_table_find(&r->table, "keys", &column, err));
    if (column == NULL || column->type != 'A') {
        add_names(k, "u v");
        return SHEAR_OK;
    }
    TRY(sf_table_shape(&r->table, column, axes, err));
    TRY(sf_table_text(&r->table, column, 0, text, sizeof text, err));
    const size_t length = strlen(text);
    const size_t width = axes[1] > 1 && (size_t)axes[0] < length ? (size_t)axes[0] : length;
    for (size_t at = 0; at < length; at += width) {
        char one[sizeof text];
        snprintf(one, sizeof one, "%.*s", (int)width, text + at);
        add_names(k, one);
    }
    return k->n > 0 ? SHEAR_OK : psf_record_fail(r, "keys", "has no name", err);
}

/* Read the column `order`: a number, or one per key. */
static int read_orders(piff_keys *k, const psf_record *r, shear_error *err) {
    CLEANUP(release_free) double *orders = NULL;
    int64_t axes[SF_AXES];
    TRY(psf_record_array(r, "order", axes, &orders, err));
    if (axes[1] != 1 || axes[2] != 1 || (axes[0] != 1 && axes[0] != k->n))
        return psf_record_fail(r, "order", "must be a number, or one per key", err);
    for (int i = 0; i < k->n; i++) {
        const double order = orders[axes[0] == 1 ? 0 : i];
        if (!(order >= 0.0 && order <= POLYNOMIAL_DEGREE) || order != floor(order))
            return psf_record_fail(r, "order", "is not a number from 0 to 12", err);
        k->order[i] = (int)order;
    }
    return SHEAR_OK;
}

/* Piff's last key runs fastest: variable i is key n - 1 - i. */
static int read_polynomial(psf_chip *c, piff_keys *k, const psf_record *r, shear_error *err) {
    int most = 0;
    *k = (piff_keys){0};
    TRY(read_names(k, r, err));
    TRY(read_orders(k, r, err));
    for (int i = 0; i < k->n; i++)
        most = k->order[i] > most ? k->order[i] : most;
    TRY(psf_record_int(r, "max_order", 0, POLYNOMIAL_DEGREE, &most, err));
    c->terms = polynomial_of(most > 0 ? k->n : 0, most);
    for (int i = 0; i < c->terms.variables; i++) {
        const int key = k->n - 1 - i;
        psf_variable *v = &c->variables[i];
        psf_chip_set_variable(c, i, k->name[key]);
        c->terms.highest[i] = k->order[key];
        v->scale = 1.0;
        v->width = INFINITY;
    }
    return SHEAR_OK;
}

/* ---- what the stars covered, and the pointing ---- */

static int read_stars(psf_chip *c, const psf_record *r, shear_error *err) {
    for (int i = 0; i < c->terms.variables; i++) {
        psf_variable *v = &c->variables[i];
        double min = NAN;
        double max = NAN;
        TRY(psf_record_range(r, v->name, &min, &max, err));
        if (max > min && isfinite(max - min)) {
            v->middle = 0.5 * (min + max);
            v->width = max - min;
        }
    }
    return SHEAR_OK;
}

/* Read the pointing: hours and degrees in the table of the WCS, else degrees in that of the
 * stars. */
static int read_pointing(psf_chip *c, const psf_record *wcs, const psf_record *stars,
                         shear_error *err) {
    double hours = NAN;
    c->ra0 = c->dec0 = NAN;
    TRY(psf_record_double(wcs, "ra", &hours, err));
    TRY(psf_record_double(wcs, "dec", &c->dec0, err));
    c->ra0 = 15.0 * hours;
    if (isnan(c->ra0 + c->dec0) && stars->rows > 0) {
        TRY(psf_record_double(stars, "point_ra", &c->ra0, err));
        TRY(psf_record_double(stars, "point_dec", &c->dec0, err));
    }
    for (int i = 0; i < c->terms.variables; i++) {
        const enum psf_quantity q = c->variables[i].quantity;
        if ((q == PSF_QUANTITY_U || q == PSF_QUANTITY_V) && isnan(c->ra0 + c->dec0)) {
            return sf_fail(err, SHEAR_E_PSF, wcs->cards.at, render,
                           "has no pointing (ra, dec), so that u and v of a galaxy are unknown");
        }
    }
    return SHEAR_OK;
}

static int read_surroundings(psf_chip *c, const psf_models *p, const char *prefix, int64_t *n_stars,
                             shear_error *err) {
    CLEANUP(psf_record_deinit) psf_record stars = {0};
    CLEANUP(psf_record_deinit) psf_record wcs = {0};
    bool there = false;
    TRY(open_table(&stars, p, prefix, "stars", &there, err));
    TRY(need_table(&wcs, p, prefix, "wcs", err));
    if (there)
        TRY(read_stars(c, &stars, err));
    *n_stars = there ? stars.rows : 0;
    return read_pointing(c, &wcs, &stars, err);
}

/* Read chi-square per degree of freedom; NaN if it is not given. */
static int read_chi2(double *chi2, const psf_models *p, const char *prefix, shear_error *err) {
    CLEANUP(psf_record_deinit) psf_record r = {0};
    double sum = NAN;
    double dof = NAN;
    bool there = false;
    TRY(open_table(&r, p, prefix, "chisq", &there, err));
    if (there) {
        TRY(psf_record_double(&r, "chisq", &sum, err));
        TRY(psf_record_double(&r, "dof", &dof, err));
    }
    *chi2 = dof > 0.0 ? sum / dof : NAN;
    return SHEAR_OK;
}

/* ---- models ---- */

static void describe(psf_chip *c, const piff_keys *k, int64_t n_stars, double chi2) {
    char names[POLYNOMIAL_VARIABLES * SF_NAME] = "";
    for (int i = 0; i < k->n; i++)
        text_append_item(names, sizeof names, k->name[i]);
    text_append(c->text, sizeof c->text, "Piff, PixelGrid %d x %d of %.2f arcsec", c->model.nx,
                c->model.ny, c->model.step);
    if (c->terms.variables > 0)
        text_append(c->text, sizeof c->text, ", degree %d in %s", c->terms.degree[0], names);
    if (n_stars > 0)
        text_append(c->text, sizeof c->text, ", %lld stars", (long long)n_stars);
    if (!isnan(chi2))
        text_append(c->text, sizeof c->text, ", chi2/dof %.2f", chi2);
}

static void note_failure(psf_chip *c, int64_t n_stars, double chi2) {
    const char *why = chi2 > worst_chi2 ? "it does not describe its stars (chisq)"
                      : n_stars > 0 && n_stars < c->model.terms
                          ? "fewer stars than terms of the polynomial"
                          : psf_chip_failure(c);
    c->failed = why != NULL;
    if (c->failed) {
        text_set(c->text, sizeof c->text, "Piff, failed: ");
        text_append(c->text, sizeof c->text, "%s", why);
    }
}

/* Read the model of one chip, whose tables are called `prefix`_stars and so on. */
static int read_simple(psf_models *p, const char *prefix, shear_error *err) {
    CLEANUP(psf_record_deinit) psf_record model = {0};
    CLEANUP(psf_record_deinit) psf_record interp = {0};
    CLEANUP(psf_record_deinit) psf_record solution = {0};
    psf_chip *c = NULL;
    piff_keys keys;
    int64_t n_stars = 0;
    double chi2 = NAN;
    TRY(psf_chip_new(p, &c, err));
    TRY(need_table(&model, p, prefix, "model", err));
    TRY(check_type(&model, "PixelGrid", "the model", err));
    TRY(need_table(&interp, p, prefix, "interp", err));
    TRY(check_type(&interp, "BasisPolynomial", "the interpolation", err));
    TRY(read_polynomial(c, &keys, &interp, err));
    TRY(need_table(&solution, p, prefix, "interp_solution", err));
    TRY(piff_grid_read(c, &model, &solution, render, err));
    TRY(read_surroundings(c, p, prefix, &n_stars, err));
    TRY(read_chi2(&chi2, p, prefix, err));
    c->stars = n_stars < INT_MAX ? (int)n_stars : INT_MAX;
    describe(c, &keys, n_stars, chi2);
    note_failure(c, n_stars, chi2);
    return SHEAR_OK;
}

/* Read the type of a PSF, whose ending "PSF" newer files leave out. */
static int read_type(const psf_record *r, char type[SF_NAME], shear_error *err) {
    TRY(psf_record_text(r, "type", type, SF_NAME, err));
    if (text_ends_with(type, "PSF"))
        type[strlen(type) - 3] = '\0';
    return SHEAR_OK;
}

static int check_simple(const psf_record *r, shear_error *err) {
    char type[SF_NAME];
    TRY(read_type(r, type, err));
    return strcmp(type, "Simple") == 0 ? SHEAR_OK : check_type(r, "SimplePSF", "the PSF", err);
}

/* Read a model per chip: psf_1, psf_2, ..., whose numbers are in the table psf_chipnums. */
static int read_chips(psf_models *p, shear_error *err) {
    CLEANUP(psf_record_deinit) psf_record chips = {0};
    TRY(need_table(&chips, p, "psf", "chipnums", err));
    for (chips.row = 0; chips.row < chips.rows; chips.row++) {
        CLEANUP(psf_record_deinit) psf_record one = {0};
        char number[SF_NAME];
        char prefix[SF_NAME];
        int chip = 0;
        TRY(psf_record_int(&chips, "chipnums", -1000000, 1000000, &chip, err));
        snprintf(number, sizeof number, "%d", chip);
        snprintf(prefix, sizeof prefix, "psf_%d", chip);
        TRY(need_table(&one, p, "psf", number, err));
        TRY(check_simple(&one, err));
        TRY(read_simple(p, prefix, err));
        text_append(p->chips[p->n - 1].text, PSF_TEXT, ", chip %d", chip);
    }
    return SHEAR_OK;
}

int piff_read(psf_models *p, shear_error *err) {
    CLEANUP(psf_record_deinit) psf_record r = {0};
    char type[SF_NAME] = "";
    bool there = false;
    TRY(open_table(&r, p, "psf", "", &there, err));
    if (there)
        TRY(read_type(&r, type, err));
    if (type[0] == '\0')
        return SHEAR_OK;
    if (strcmp(type, "SingleChip") == 0)
        return read_chips(p, err);
    TRY(check_simple(&r, err));
    return read_simple(p, "psf", err);
}
