/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/sources/source_list.h"

#include "base/arena.h"
#include "base/cleanup.h"
#include "survey/sources/catalog_file.h"
#include "survey/sources/isophote.h"
#include "survey/sources/row_choice.h"
#include "survey/sources/source_columns.h"

#include <math.h>
#include <string.h>

struct source_catalog {
    sf_file file;
    source_names names;
    object_tables objects;
    int origin;
    char *select; /* or NULL */
    row_choice choice;
};
enum { MOST_SOURCES = 4000000 }; /* of a chip */

/* ---- the file ---- */

void source_catalog_close(source_catalog *c) {
    if (c == NULL)
        return;
    object_tables_deinit(&c->objects);
    sf_file_close(&c->file);
    row_choice_deinit(&c->choice);
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
        s->row[i] = c->first + i;
        s->id[i] = c->first + i + 1;
    }
    return c->by[SOURCE_ID] == NULL
               ? SHEAR_OK
               : sf_table_integers(c->table, c->by[SOURCE_ID], c->first, s->n, -1, s->id, err);
}

static int read_sizes(source_list *s, const source_columns *c, shear_error *err) {
    TRY(read_if(c, SOURCE_WEIGHT, s->weight, err));
    TRY(s->a != NULL ? isophote_read(c, s->a, s->b, s->theta, err) : SHEAR_OK);
    TRY(read_if(c, SOURCE_R_GAL, s->r_gal, err));
    const double factor = source_columns_is(c, SOURCE_R_GAL, "FLUX_RADIUS") ? 2.0 : 1.0;
    for (int64_t i = 0; i < s->n && s->r_gal != NULL; i++) {
        const double r = factor * s->r_gal[i];
        s->r_gal[i] = r > 0.0 && isfinite(r) ? r : NAN;
    }
    return SHEAR_OK;
}

static int find_context(const source_columns *c, const char *name, const sf_column **column,
                        shear_error *err) {
    TRY(sf_table_find_number(c->table, name, column, err));
    if (*column != NULL)
        return SHEAR_OK;
    char advice[sizeof((shear_error *)0)->advice];
    sf_table_advise(c->table, name, advice, sizeof advice);
    return sf_fail(err, SHEAR_E_FORMAT, c->table->cards->at, advice,
                   "there is no column %.70s, on which the PSF model depends", name);
}

static int read_contexts(source_list *s, const source_columns *c, const char *const *names,
                         shear_error *err) {
    const sf_column *column = NULL;
    CLEANUP(release_free) double *scratch = malloc((size_t)(s->n + 1) * sizeof *scratch);
    if (scratch == NULL)
        return sf_fail_memory(err, c->table->cards->at);
    for (int k = 0; k < s->n_contexts; k++) {
        TRY(find_context(c, names[k], &column, err));
        TRY(sf_table_doubles(c->table, column, c->first, s->n, scratch, err));
        for (int64_t i = 0; i < s->n; i++)
            s->context[i * s->n_contexts + k] = scratch[i];
    }
    return SHEAR_OK;
}

/* Read the rows of `c`, of which there are s->n. */
static int read_rows(source_list *s, const source_columns *c, int origin,
                     const char *const *contexts, shear_error *err) {
    TRY(read_positions(s, c, origin, err));
    TRY(read_ids(s, c, err));
    TRY(read_sizes(s, c, err));
    return read_contexts(s, c, contexts, err);
}

/* Append row `i` of a part. */
static void append(source_list *s, const source_list *part, int64_t i, bool selected) {
    double *const to[] = {s->x, s->y, s->ra, s->dec, s->r_gal, s->weight, s->a, s->b, s->theta};
    double *const from[] = {part->x,      part->y, part->ra, part->dec,  part->r_gal,
                            part->weight, part->a, part->b,  part->theta};
    for (size_t k = 0; k < sizeof to / sizeof *to; k++) {
        if (to[k] != NULL)
            to[k][s->n] = from[k][i];
    }
    for (int k = 0; k < s->n_contexts; k++)
        s->context[s->n * s->n_contexts + k] = part->context[i * s->n_contexts + k];
    s->id[s->n] = part->id[i];
    s->row[s->n] = part->row[i];
    s->selected[s->n++] = selected;
}

/* Append the rows that are kept, chunk by chunk. */
static int append_kept(source_list *s, source_list *part, source_catalog *c, open_table *t,
                       const char *const *contexts, shear_error *err) {
    const int64_t rows = t->cards.hdu->axes[1];
    for (int64_t first = 0; first < rows; first += ROW_CHUNK) {
        const uint8_t *marks = c->choice.marks + first;
        part->n = rows - first < ROW_CHUNK ? rows - first : ROW_CHUNK;
        if (!row_choice_any(&c->choice, first, part->n))
            continue;
        t->columns.first = first;
        t->columns.n = part->n;
        TRY(read_rows(part, &t->columns, c->origin, contexts, err));
        for (int64_t i = 0; i < part->n; i++) {
            if ((marks[i] & ROW_KEPT) != 0)
                append(s, part, i, (marks[i] & ROW_SELECTED) != 0);
        }
    }
    return SHEAR_OK;
}

static int check_kept(const row_choice *r, const open_table *t, shear_error *err) {
    return r->kept <= MOST_SOURCES
               ? SHEAR_OK
               : sf_fail(err, SHEAR_E_FORMAT, t->cards.at,
                         "cut the catalog to the image (fitscopy 'CATALOG[1][RA > 149 && RA < "
                         "151]' CUT.fits, of CFITSIO), or give a table for each chip",
                         "%lld of its rows are of one chip, more than %d", (long long)r->kept,
                         MOST_SOURCES);
}

int source_catalog_load(source_catalog *c, int i, const char *const *contexts, int n_contexts,
                        source_cap *cap, source_list *out, shear_error *err) {
    CLEANUP(open_table_deinit) open_table t = {0};
    CLEANUP(source_list_deinit) source_list part = {.n = ROW_CHUNK, .n_contexts = n_contexts};
    const sf_column *context = NULL;
    *out = (source_list){.n_contexts = n_contexts};
    TRY(open_catalog_table(c, i, &t, err));
    for (int k = 0; k < n_contexts; k++)
        TRY(find_context(&t.columns, contexts[k], &context, err));
    TRY(row_choice_select(&c->choice, &t, c->select, err));
    TRY(row_choice_keep(&c->choice, &t, c->objects.tables[i].extension, cap, err));
    TRY(check_kept(&c->choice, &t, err));
    out->rows = c->choice.rows;
    out->rows_selected = c->choice.selected;
    out->r_gal_measured = source_columns_is(&t.columns, SOURCE_R_GAL, "FLUX_RADIUS");
    out->n = c->choice.kept;
    TRY(allocate(out, &t.columns, err));
    out->n = 0;
    TRY(allocate(&part, &t.columns, err));
    return append_kept(out, &part, c, &t, contexts, err);
}

void source_list_deinit(source_list *s) {
    free(s->memory);
    *s = (source_list){0};
}
