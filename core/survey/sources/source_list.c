/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/sources/source_list.h"

#include "base/arena.h"
#include "base/cleanup.h"
#include "fits/select/expression.h"
#include "fits/select/row_filter.h"
#include "survey/sources/catalog_file.h"
#include "survey/sources/isophote.h"
#include "survey/sources/object_tables.h"
#include "survey/sources/source_columns.h"

#include <math.h>
#include <string.h>

struct source_catalog {
    sf_file file;
    source_names names;
    object_tables objects;
    int origin;
    char *select; /* or NULL */
};

/* ---- the file ---- */

void source_catalog_close(source_catalog *c) {
    if (c == NULL)
        return;
    object_tables_deinit(&c->objects);
    sf_file_close(&c->file);
    free(c->select);
    free(c);
}

CLEANUP_DEFINE(source_catalog, source_catalog_close)

static int set_options(source_catalog *c, const shear_exposure *exposure, shear_error *err) {
    if (exposure->origin != 0 && exposure->origin != 1)
        return shear_fail(err, SHEAR_E_SETTING, NULL, "origin must be 0 or 1");
    c->origin = exposure->origin;
    c->select = exposure->select != NULL ? strdup(exposure->select) : NULL;
    if (exposure->select != NULL && c->select == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory");
    return source_names_parse(&c->names, exposure->columns, err);
}

int source_catalog_open(source_catalog **c, const shear_input_part *part, int fd,
                        const shear_exposure *exposure, shear_error *err) {
    *c = NULL;
    CLEANUP(source_catalog_release) source_catalog *made = calloc(1, sizeof *made);
    if (made == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory");
    made->file.source.fd = -1;
    TRY(set_options(made, exposure, err));
    TRY(catalog_file_open(&made->file, part->path, fd, err));
    TRY(object_tables_init(&made->objects, &made->file, part, &made->names, err));
    *c = CLEANUP_TAKE(made);
    return SHEAR_OK;
}

int source_catalog_tables(const source_catalog *c) {
    return c->objects.n;
}

int64_t source_catalog_hdu(const source_catalog *c) {
    for (int i = 1; i < c->objects.n; i++) {
        if (c->objects.tables[i].hdu != c->objects.tables[0].hdu)
            return -1;
    }
    return c->objects.n > 0 ? c->objects.tables[0].hdu->number : -1;
}

const char *source_catalog_chip(const source_catalog *c, int i) {
    return c->objects.tables[i].chip;
}

const char *source_catalog_header(const source_catalog *c, int i, int64_t *count) {
    *count = c->objects.tables[i].cards;
    return c->objects.tables[i].header;
}

/* ---- columns that are carried ---- */

static int open_catalog_table(source_catalog *c, int i, open_table *t, shear_error *err) {
    return open_table_init(t, &c->file, &c->objects.tables[i], &c->names, err);
}

int source_catalog_carry(source_catalog *c, const char *names, carry_list *l, shear_error *err) {
    const bool named = names != NULL && strcmp(names, "all") != 0;
    for (int i = 0; i < c->objects.n; i++) {
        CLEANUP(open_table_deinit) open_table t = {0};
        TRY(open_catalog_table(c, i, &t, err));
        TRY(i == 0 ? carry_list_init(l, &t.table, names, false, err)
                   : carry_list_match(l, &t.table, named, err));
    }
    return SHEAR_OK;
}

int source_catalog_carried(source_catalog *c, int i, const carry_list *l, carry_rows *r,
                           shear_error *err) {
    const sf_place at = {c->file.source.name, c->objects.tables[i].label};
    CLEANUP(open_table_deinit) open_table t = {0};
    TRY(open_catalog_table(c, i, &t, err));
    return carry_rows_init(r, l, &t.table, at, err);
}

/* ---- the sources of a table ---- */

static double *place_if(bool wanted, int64_t n, arena *a) {
    return wanted ? arena_doubles(a, (size_t)n) : NULL;
}

static void place(source_list *s, const source_columns *c, arena *a) {
    const bool ellipse = isophote_known(c);
    s->x = place_if(c->by[SOURCE_X] != NULL, s->n, a);
    s->y = place_if(c->by[SOURCE_X] != NULL, s->n, a);
    s->ra = place_if(c->by[SOURCE_RA] != NULL, s->n, a);
    s->dec = place_if(c->by[SOURCE_RA] != NULL, s->n, a);
    s->r_gal = place_if(c->by[SOURCE_R_GAL] != NULL, s->n, a);
    s->weight = place_if(c->by[SOURCE_WEIGHT] != NULL, s->n, a);
    s->a = place_if(ellipse, s->n, a);
    s->b = place_if(ellipse, s->n, a);
    s->theta = place_if(ellipse, s->n, a);
    s->context = place_if(s->n_contexts > 0, s->n * s->n_contexts, a);
    s->id = arena_take(a, (size_t)s->n * sizeof *s->id);
    s->row = arena_take(a, (size_t)s->n * sizeof *s->row);
    s->selected = arena_take(a, (size_t)s->n * sizeof *s->selected);
}

static int allocate(source_list *s, const source_columns *c, shear_error *err) {
    arena a = {0};
    place(s, c, &a);
    s->memory = arena_allocate(&a);
    if (s->memory == NULL)
        return sf_fail_memory(err, c->table->cards->at);
    place(s, c, &a);
    return SHEAR_OK;
}

static int read_if(const source_columns *c, enum source_key key, double *out, shear_error *err) {
    return out != NULL ? source_columns_read(c, key, out, err) : SHEAR_OK;
}

static int read_positions(source_list *s, const source_columns *c, int origin, shear_error *err) {
    TRY(read_if(c, SOURCE_X, s->x, err));
    TRY(read_if(c, SOURCE_Y, s->y, err));
    TRY(read_if(c, SOURCE_RA, s->ra, err));
    TRY(read_if(c, SOURCE_DEC, s->dec, err));
    for (int64_t i = 0; i < s->n && s->x != NULL; i++) {
        s->x[i] += 1 - origin;
        s->y[i] += 1 - origin;
    }
    return SHEAR_OK;
}

static int read_ids(source_list *s, const source_columns *c, shear_error *err) {
    for (int64_t i = 0; i < s->n; i++) {
        s->row[i] = i;
        s->id[i] = i + 1;
    }
    return c->by[SOURCE_ID] == NULL
               ? SHEAR_OK
               : sf_table_integers(c->table, c->by[SOURCE_ID], 0, s->n, -1, s->id, err);
}

static int read_sizes(source_list *s, const source_columns *c, shear_error *err) {
    TRY(read_if(c, SOURCE_WEIGHT, s->weight, err));
    TRY(s->a != NULL ? isophote_read(c, s->a, s->b, s->theta, err) : SHEAR_OK);
    TRY(read_if(c, SOURCE_R_GAL, s->r_gal, err));
    s->r_gal_measured = source_columns_is(c, SOURCE_R_GAL, "FLUX_RADIUS");
    const double factor = s->r_gal_measured ? 2.0 : 1.0;
    for (int64_t i = 0; i < s->n && s->r_gal != NULL; i++) {
        const double r = factor * s->r_gal[i];
        s->r_gal[i] = r > 0.0 && isfinite(r) ? r : NAN;
    }
    return SHEAR_OK;
}

static int read_context(source_list *s, const source_columns *c, int k, const char *name,
                        double *scratch, shear_error *err) {
    const sf_column *column = NULL;
    TRY(sf_table_find_number(c->table, name, &column, err));
    if (column == NULL) {
        char advice[sizeof((shear_error *)0)->advice];
        sf_table_advise(c->table, name, advice, sizeof advice);
        return sf_fail(err, SHEAR_E_FORMAT, c->table->cards->at, advice,
                       "there is no column %.70s, on which the PSF model depends", name);
    }
    TRY(sf_table_doubles(c->table, column, 0, s->n, scratch, err));
    for (int64_t i = 0; i < s->n; i++)
        s->context[i * s->n_contexts + k] = scratch[i];
    return SHEAR_OK;
}

static int read_contexts(source_list *s, const source_columns *c, const char *const *names,
                         shear_error *err) {
    CLEANUP(release_free) double *scratch = malloc((size_t)(s->n + 1) * sizeof *scratch);
    if (scratch == NULL)
        return sf_fail_memory(err, c->table->cards->at);
    for (int k = 0; k < s->n_contexts; k++)
        TRY(read_context(s, c, k, names[k], scratch, err));
    return SHEAR_OK;
}

/* Select by the expression, and by FLAGS unless the expression does. Until the end `id` is not
 * needed: its memory holds the flags. */
static int select_rows(source_list *s, const source_columns *c, const char *expression,
                       shear_error *err) {
    const sf_column *flags = c->by[SOURCE_FLAGS];
    memset(s->selected, 1, (size_t)s->n);
    if (expression != NULL)
        TRY(sf_row_filter(c->table, expression, s->selected, err));
    if (flags == NULL || (expression != NULL && sf_expression_names(expression, flags->name)))
        return SHEAR_OK;
    TRY(sf_table_integers(c->table, flags, 0, s->n, -1, s->id, err));
    for (int64_t i = 0; i < s->n; i++) {
        if (s->id[i] < 0 || s->id[i] >= 4)
            s->selected[i] = 0;
    }
    return SHEAR_OK;
}

void source_list_keep(source_list *s, const int64_t *key, int64_t wanted) {
    double *const columns[] = {s->x,      s->y, s->ra, s->dec,  s->r_gal,
                               s->weight, s->a, s->b,  s->theta};
    const int per_row = s->n_contexts;
    int64_t n = 0;
    for (int64_t i = 0; i < s->n; i++) {
        if (key[i] != wanted)
            continue;
        for (size_t k = 0; k < sizeof columns / sizeof *columns; k++) {
            if (columns[k] != NULL)
                columns[k][n] = columns[k][i];
        }
        for (int k = 0; k < per_row; k++)
            s->context[n * per_row + k] = s->context[i * per_row + k];
        s->id[n] = s->id[i];
        s->row[n] = s->row[i];
        s->selected[n] = s->selected[i];
        n++;
    }
    s->n = n;
}

static int choose_chip(source_list *s, const open_table *t, int64_t wanted, shear_error *err) {
    if (wanted == 0)
        return SHEAR_OK;
    CLEANUP(release_free) int64_t *extension = calloc((size_t)s->n + 1, sizeof *extension);
    if (extension == NULL)
        return sf_fail_memory(err, t->cards.at);
    TRY(open_table_extensions(t, extension, err));
    source_list_keep(s, extension, wanted);
    return SHEAR_OK;
}

int source_catalog_load(source_catalog *c, int i, const char *const *contexts, int n_contexts,
                        source_list *out, shear_error *err) {
    CLEANUP(open_table_deinit) open_table t = {0};
    *out = (source_list){.n_contexts = n_contexts};
    TRY(open_catalog_table(c, i, &t, err));
    out->n = t.cards.hdu->axes[1];
    TRY(allocate(out, &t.columns, err));
    TRY(select_rows(out, &t.columns, c->select, err));
    TRY(read_positions(out, &t.columns, c->origin, err));
    TRY(read_ids(out, &t.columns, err));
    TRY(read_sizes(out, &t.columns, err));
    TRY(read_contexts(out, &t.columns, contexts, err));
    return choose_chip(out, &t, c->objects.tables[i].extension, err);
}

void source_list_deinit(source_list *s) {
    free(s->memory);
    *s = (source_list){0};
}
