/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fits/carry/carry_list.h"

#include "base/cleanup.h"
#include "fits/schema/field_columns.h"
#include "fits/schema/result_columns.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* ---- names ---- */

static bool is_of_field(const char *name) {
    for (int i = 0; i < SF_COLUMNS; i++) {
        if (strcasecmp(sf_column_defs[i].name, name) == 0)
            return true;
    }
    return false;
}

static bool is_of_results(const char *name) {
    for (int i = 0; i < SF_CATALOG_MEMBERS; i++) {
        if (strcasecmp(sf_catalog_members[i].name, name) == 0)
            return true;
    }
    return false;
}

/* Write the name that a column has in results, as much of it as a card holds. */
static void name_carried(char *out, size_t size, const char *name) {
    const bool taken = is_of_field(name) || is_of_results(name);
    if (taken) {
        snprintf(out, size, "CAT_%.64s", name);
    } else {
        snprintf(out, size, "%.68s", name);
    }
    sf_make_printable(out);
}

/* Return the first column of that name; NULL: none. */
static const sf_column *first_called(const sf_table *t, const char *name) {
    for (int k = 0; k < t->n; k++) {
        if (strcasecmp(t->columns[k].name, name) == 0)
            return &t->columns[k];
    }
    return NULL;
}

const sf_column *carry_list_find(const carry_list *l, int i, const sf_table *t) {
    return first_called(t, l->sources[i]);
}

/* ---- columns ---- */

static void form_of(char *out, size_t size, const sf_column *c) {
    snprintf(out, size, "%lld%c", (long long)c->repeat, c->type);
}

/* Describe the column, whose numbers have valid scalings. A unit that cannot be read is left out.
 */
static void describe(shear_carried *d, const sf_table *t, const sf_column *c) {
    char key[SF_INDEXED];
    CLEANUP(release_free) char *unit = NULL;
    const sf_scaling *by = &c->by;
    *d = (shear_carried){.bytes = (int)c->width};
    name_carried(d->name, sizeof d->name, c->name);
    form_of(d->form, sizeof d->form, c);
    sf_card_indexed(key, "TUNIT", (int)(c - t->columns) + 1);
    (void)sf_key_string(t->cards, key, &unit, NULL);
    snprintf(d->unit, sizeof d->unit, "%s", unit != NULL ? unit : "");
    sf_make_printable(d->unit);
    if (by->has_null)
        snprintf(d->null, sizeof d->null, "%lld", (long long)by->null);
    if (by->scale != 1.0)
        snprintf(d->scale, sizeof d->scale, "%.17G", by->scale);
    if (by->whole && by->whole_zero != 0) {
        snprintf(d->zero, sizeof d->zero, "%lld", (long long)by->whole_zero);
    } else if (by->zero != 0.0) { /* 2^63, of unsigned numbers, has 19 digits */
        const bool digits = by->zero == floor(by->zero) && fabs(by->zero) < 1e19;
        snprintf(d->zero, sizeof d->zero, digits ? "%.0f" : "%.17G", by->zero);
    }
}

/* Return the name in the table of the column that has this one's name in results; NULL: none. */
static const char *namesake(const carry_list *l, const char *name) {
    char carried[sizeof l->columns[0].name];
    name_carried(carried, sizeof carried, name);
    for (int i = 0; i < l->n; i++) {
        if (strcasecmp(l->columns[i].name, carried) == 0)
            return l->sources[i];
    }
    return NULL;
}

/* Return what keeps a column from being carried; NULL: nothing. */
static const char *unfit(const carry_list *l, const sf_column *c, int most) {
    if (c->type == 'P' || c->type == 'Q')
        return "has a variable length";
    if (c->width < 1 || c->width > most)
        return c->width < 1 ? "is empty" : "is too wide: 4096 bytes at most";
    if (c->by.wrong != NULL)
        return c->by.wrong;
    return l->n == SHEAR_MAX_CARRIED || l->bytes + c->width > CARRY_ROW
               ? "has no room: 900 columns and 8192 bytes in all"
               : NULL;
}

static void add(carry_list *l, const sf_table *t, const sf_column *c) {
    describe(&l->columns[l->n], t, c);
    memcpy(l->sources[l->n], c->name, sizeof c->name);
    l->bytes += l->columns[l->n++].bytes;
}

static void add_all(carry_list *l, const sf_table *t, bool of_field) {
    for (const sf_column *c = t->columns; c < t->columns + t->n; c++) {
        const bool wanted = c->name[0] != '\0' && first_called(t, c->name) == c &&
                            !(of_field && is_of_field(c->name)) &&
                            unfit(l, c, CARRY_CELL) == NULL && namesake(l, c->name) == NULL;
        if (wanted)
            add(l, t, c);
    }
}

static int add_named(carry_list *l, const sf_table *t, const char *name, bool of_field,
                     shear_error *err) {
    const sf_column *c = NULL;
    TRY(sf_table_find(t, name, &c, err));
    if (c == NULL) {
        char advice[sizeof err->advice];
        sf_table_advise(t, name, advice, sizeof advice);
        return sf_fail(err, SHEAR_E_FORMAT, t->cards->at, advice,
                       "there is no column %.70s to be carried", name);
    }
    const char *other = namesake(l, name);
    if ((other != NULL && strcasecmp(other, name) == 0) || (of_field && is_of_field(name)))
        return SHEAR_OK;
    const char *what = other != NULL ? "would be called like another one in results, where those "
                                       "named like columns of results are called CAT_NAME"
                                     : unfit(l, c, CARRY_NAMED_CELL);
    if (what != NULL) {
        return sf_fail(err, SHEAR_E_FORMAT, t->cards->at, "leave it out of --carry",
                       "column %s cannot be carried: %s %s", c->name,
                       what == c->by.wrong ? "its keyword TSCALn, TZEROn or TNULLn" : "it", what);
    }
    add(l, t, c);
    return SHEAR_OK;
}

static int add_list(carry_list *l, const sf_table *t, const char *names, bool of_field,
                    shear_error *err) {
    CLEANUP(release_free) char *copy = strdup(names);
    char *rest = NULL;
    if (copy == NULL)
        return sf_fail_memory(err, t->cards->at);
    for (char *name = strtok_r(copy, ",", &rest); name != NULL; name = strtok_r(NULL, ",", &rest))
        TRY(add_named(l, t, name, of_field, err));
    return SHEAR_OK;
}

int carry_list_init(carry_list *l, const sf_table *t, const char *names, bool of_field,
                    shear_error *err) {
    *l = (carry_list){0};
    l->columns = calloc((size_t)t->n + 1, sizeof *l->columns);
    l->sources = calloc((size_t)t->n + 1, sizeof *l->sources);
    if (l->columns == NULL || l->sources == NULL)
        return sf_fail_memory(err, t->cards->at);
    if (names != NULL && strcmp(names, "none") == 0)
        return SHEAR_OK;
    if (names != NULL && strcmp(names, "all") != 0)
        return add_list(l, t, names, of_field, err);
    add_all(l, t, of_field);
    return SHEAR_OK;
}

/* Return whether the column's cells mean the same as those of a carried one. */
static bool is_alike(const sf_table *t, const sf_column *c, const shear_carried *d) {
    shear_carried other;
    if (c == NULL || c->by.wrong != NULL)
        return false;
    describe(&other, t, c);
    return strcmp(other.form, d->form) == 0 && strcmp(other.unit, d->unit) == 0 &&
           strcmp(other.null, d->null) == 0 && strcmp(other.scale, d->scale) == 0 &&
           strcmp(other.zero, d->zero) == 0;
}

int carry_list_match(carry_list *l, const sf_table *t, bool named, shear_error *err) {
    const int n = l->n;
    l->n = l->bytes = 0;
    for (int i = 0; i < n; i++) {
        const shear_carried *d = &l->columns[i];
        if (is_alike(t, carry_list_find(l, i, t), d)) {
            l->bytes += d->bytes;
            memmove(l->sources[l->n], l->sources[i], sizeof l->sources[i]);
            l->columns[l->n++] = *d;
        } else if (named) {
            return sf_fail(err, SHEAR_E_FORMAT, t->cards->at,
                           "leave it out of --carry, or write all tables of the catalog alike",
                           "there is no column %s of the form %s%s%s, as the first table has, with "
                           "the same TNULL, TSCAL and TZERO",
                           d->name, d->form, d->unit[0] != '\0' ? " and the unit " : "", d->unit);
        }
    }
    return SHEAR_OK;
}

void carry_list_deinit(carry_list *l) {
    free(l->columns);
    free(l->sources);
    *l = (carry_list){0};
}
