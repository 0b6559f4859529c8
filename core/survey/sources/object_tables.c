/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/sources/object_tables.h"

#include "base/cleanup.h"
#include "base/text.h"

#include <string.h>
#include <strings.h>

enum { MOST_CARDS = 100000 }; /* of an image's header */

/* ---- one table ---- */

static void name_table(object_table *o, const sf_hdu *hdu) {
    o->hdu = hdu;
    snprintf(o->label, sizeof o->label, "%d%s%s%s", hdu->number, hdu->name[0] != '\0' ? " (" : "",
             hdu->name, hdu->name[0] != '\0' ? ")" : "");
}

static bool is_table(const sf_hdu *hdu) {
    return hdu->kind == SF_TABLE && !hdu->zimage && !hdu->ztable;
}

static bool is_called(const sf_hdu *hdu, const char *name) {
    return is_table(hdu) && strcasecmp(hdu->name, name) == 0;
}

void open_table_deinit(open_table *t) {
    sf_table_deinit(&t->table);
    sf_cards_deinit(&t->cards);
}

static int check_hdu(const sf_file *file, const object_table *o, shear_error *err) {
    const sf_place at = {file->source.name, o->label};
    if (!is_table(o->hdu)) {
        return sf_fail(err, SHEAR_E_FORMAT, at,
                       "choose the HDU of the catalog's table; unpack compressed tables (funpack)",
                       "must be a binary table of sources");
    }
    if (o->hdu->axes[1] > OBJECT_TABLE_ROWS) {
        return sf_fail(err, SHEAR_E_FORMAT, at, "split the catalog: one table per chip",
                       "it has %lld rows, more than %d", (long long)o->hdu->axes[1],
                       OBJECT_TABLE_ROWS);
    }
    return SHEAR_OK;
}

int open_table_init(open_table *t, const sf_file *file, const object_table *object,
                    const source_names *names, shear_error *err) {
    *t = (open_table){0};
    TRY(check_hdu(file, object, err));
    TRY(sf_cards_init(&t->cards, file, object->hdu, object->label, err));
    TRY(sf_table_init(&t->table, &t->cards, err));
    return source_columns_find(&t->columns, names, &t->table, err);
}

/* ---- the image's header ---- */

static void find_chip(object_table *o) {
    char key[SF_KEY + 1];
    for (int64_t i = 0; i < o->cards && o->chip[0] == '\0'; i++) {
        sf_card_key(o->header + i * SF_CARD, key);
        if (strcmp(key, "EXTNAME") == 0 &&
            !sf_card_string(o->header + i * SF_CARD, o->chip, sizeof o->chip)) {
            o->chip[0] = '\0';
        }
    }
    sf_make_printable(o->chip);
}

static int read_header(object_table *o, const sf_table *t, shear_error *err) {
    const sf_column *c = NULL;
    TRY(sf_table_find(t, "Field Header Card", &c, err));
    if (c == NULL || t->cards->hdu->axes[1] == 0)
        return SHEAR_OK;
    if (c->type != 'A' || c->width % SF_CARD != 0 || c->width > (int64_t)MOST_CARDS * SF_CARD) {
        return sf_fail(err, SHEAR_E_FORMAT, t->cards->at, NULL,
                       "column %s must hold at most %d cards of 80 characters (TFORM nA)", c->name,
                       MOST_CARDS);
    }
    o->header = calloc(1, (size_t)c->width + 1);
    if (o->header == NULL)
        return sf_fail_memory(err, t->cards->at);
    o->cards = c->width / SF_CARD;
    TRY(sf_table_bytes(t, 0, c->offset, c->width, o->header, err));
    find_chip(o);
    return SHEAR_OK;
}

/* Read the header that stands before the objects in a FITS_LDAC file. */
static int find_header(object_table *o, const sf_file *file, shear_error *err) {
    CLEANUP(sf_cards_deinit) sf_cards cards = {0};
    CLEANUP(sf_table_deinit) sf_table table = {0};
    if (o->hdu->number == 0)
        return SHEAR_OK;
    const sf_hdu *before = o->hdu - 1;
    if (!is_called(before, "LDAC_IMHEAD") && !is_called(before, "FIELDS"))
        return SHEAR_OK;
    TRY(sf_cards_init(&cards, file, before, before->name, err));
    TRY(sf_table_init(&table, &cards, err));
    return read_header(o, &table, err);
}

/* ---- the tables of a file ---- */

static int add(object_tables *o, const sf_file *file, const sf_hdu *hdu, shear_error *err) {
    object_table *t = &o->tables[o->n++];
    name_table(t, hdu);
    return find_header(t, file, err);
}

static int add_named(object_tables *o, const sf_file *file, const char *name, shear_error *err) {
    for (int i = 0; i < file->count; i++) {
        if (is_called(&file->hdus[i], name))
            TRY(add(o, file, &file->hdus[i], err));
    }
    return SHEAR_OK;
}

static bool same_columns(const sf_table *a, const sf_table *b) {
    bool same = a->n == b->n;
    for (int i = 0; same && i < a->n; i++)
        same = strcasecmp(a->columns[i].name, b->columns[i].name) == 0;
    return same;
}

/* Open a table to see if it is one of sources; if not, *why is the reason. */
static int try_table(open_table *t, const sf_file *file, const sf_hdu *hdu,
                     const source_names *names, bool *yes, shear_error *why) {
    object_table object = {0};
    *yes = false;
    if (!is_table(hdu))
        return SHEAR_OK;
    name_table(&object, hdu);
    const int code = open_table_init(t, file, &object, names, why);
    *yes = code == SHEAR_OK;
    return code == SHEAR_E_FORMAT ? SHEAR_OK : code;
}

/* Find the first table of sources. If there is none, the error is that of the first table. */
static int find_first(const sf_file *file, const source_names *names, int *first,
                      shear_error *err) {
    shear_error refusal = {0};
    for (int i = 0; i < file->count; i++) {
        CLEANUP(open_table_deinit) open_table t = {0};
        bool yes = false;
        shear_error why = {0};
        if (try_table(&t, file, &file->hdus[i], names, &yes, &why) != SHEAR_OK)
            return shear_fail(err, why.code, why.advice, "%s", why.message);
        *first = i;
        if (yes)
            return SHEAR_OK;
        refusal = refusal.code == SHEAR_OK ? why : refusal;
    }
    if (refusal.code != SHEAR_OK)
        return shear_fail(err, refusal.code, refusal.advice, "%s", refusal.message);
    return sf_fail(err, SHEAR_E_FORMAT, (sf_place){file->source.name, NULL},
                   "give a catalog of SExtractor, or a binary table", "it has no binary table");
}

/* Add the first table of sources, and those that have the same columns. */
static int add_alike(object_tables *o, const sf_file *file, const source_names *names,
                     shear_error *err) {
    CLEANUP(open_table_deinit) open_table first = {0};
    bool yes = false;
    int i = 0;
    TRY(find_first(file, names, &i, err));
    TRY(try_table(&first, file, &file->hdus[i], names, &yes, err));
    TRY(add(o, file, &file->hdus[i], err));
    while (++i < file->count) {
        CLEANUP(open_table_deinit) open_table t = {0};
        TRY(try_table(&t, file, &file->hdus[i], names, &yes, err));
        if (yes && same_columns(&first.table, &t.table))
            TRY(add(o, file, &file->hdus[i], err));
    }
    return SHEAR_OK;
}

static int find_chosen(object_tables *o, const sf_file *file, const shear_input_part *part,
                       shear_error *err) {
    if (part->extname != NULL) {
        const sf_hdu *found = NULL;
        TRY(add_named(o, file, part->extname, err));
        return o->n > 0 ? SHEAR_OK : sf_file_find(file, part->extname, true, &found, err);
    }
    if (part->hdu >= file->count) {
        return sf_fail(err, SHEAR_E_FORMAT, (sf_place){file->source.name, NULL}, NULL,
                       "there is no HDU %lld: the last is %d, counted from 0", (long long)part->hdu,
                       file->count - 1);
    }
    return add(o, file, &file->hdus[part->hdu], err);
}

static int find_all(object_tables *o, const sf_file *file, const source_names *names,
                    shear_error *err) {
    TRY(add_named(o, file, "LDAC_OBJECTS", err));
    if (o->n == 0)
        TRY(add_named(o, file, "OBJECTS", err));
    return o->n > 0 ? SHEAR_OK : add_alike(o, file, names, err);
}

/* ---- chips of one table ---- */

static const sf_column *extension_column(const sf_table *t) {
    const sf_column *c = source_columns_number(t, "EXT_NUMBER");
    return c != NULL ? c : source_columns_number(t, "FIELD_POS");
}

int open_table_extensions(const open_table *t, int64_t first, int64_t n, int64_t *out,
                          shear_error *err) {
    return sf_table_integers(&t->table, extension_column(&t->table), first, n, 0, out, err);
}

/* The numbers that were found. */
typedef struct extension_range {
    int64_t low, high; /* 0: none yet */
} extension_range;

static int add_extension(extension_range *r, const open_table *t, int64_t row, int64_t number,
                         shear_error *err) {
    if (number < 1 || number > OBJECT_TABLE_CHIPS) {
        return sf_fail(err, SHEAR_E_FORMAT, t->cards.at, "leave the column out",
                       "row %lld: %s is not a number of a chip, from 1 to %d", (long long)row + 1,
                       extension_column(&t->table)->name, OBJECT_TABLE_CHIPS);
    }
    r->low = r->low == 0 || number < r->low ? number : r->low;
    r->high = number > r->high ? number : r->high;
    return SHEAR_OK;
}

/* Find the largest number; 0 = no chips are told apart, or there is only one. */
static int last_extension(const open_table *t, int64_t *last, shear_error *err) {
    enum { CHUNK = 4096 };
    const int64_t rows = t->cards.hdu->axes[1];
    int64_t number[CHUNK];
    extension_range found = {0, 0};
    *last = 0;
    if (extension_column(&t->table) == NULL)
        return SHEAR_OK;
    for (int64_t first = 0; first < rows; first += CHUNK) {
        const int64_t n = rows - first < CHUNK ? rows - first : CHUNK;
        TRY(open_table_extensions(t, first, n, number, err));
        for (int64_t i = 0; i < n; i++)
            TRY(add_extension(&found, t, first + i, number[i], err));
    }
    *last = found.low < found.high ? found.high : 0;
    return SHEAR_OK;
}

/* Make a table of several chips one for each of them. */
static int split(object_tables *o, const open_table *t, shear_error *err) {
    int64_t last = 0;
    TRY(last_extension(t, &last, err));
    if (last < 2)
        return SHEAR_OK;
    object_table *each = calloc((size_t)last, sizeof *each);
    if (each == NULL)
        return sf_fail_memory(err, t->cards.at);
    for (int64_t i = 0; i < last; i++) {
        name_table(&each[i], o->tables[0].hdu);
        each[i].extension = i + 1;
    }
    object_tables_deinit(o);
    *o = (object_tables){each, (int)last};
    return SHEAR_OK;
}

static int check_table(object_tables *o, int i, const sf_file *file, const source_names *names,
                       shear_error *err) {
    CLEANUP(open_table_deinit) open_table t = {0};
    TRY(open_table_init(&t, file, &o->tables[i], names, err));
    return o->n == 1 ? split(o, &t, err) : SHEAR_OK;
}

int object_tables_init(object_tables *o, const sf_file *file, const shear_input_part *part,
                       const source_names *names, shear_error *err) {
    *o = (object_tables){.tables = calloc((size_t)file->count + 1, sizeof *o->tables)};
    if (o->tables == NULL)
        return sf_fail_memory(err, (sf_place){file->source.name, NULL});
    TRY(part->extname != NULL || part->hdu >= 0 ? find_chosen(o, file, part, err)
                                                : find_all(o, file, names, err));
    const int n = o->n;
    for (int i = 0; i < n; i++)
        TRY(check_table(o, i, file, names, err));
    return SHEAR_OK;
}

void object_tables_deinit(object_tables *o) {
    for (int i = 0; i < o->n; i++)
        free(o->tables[i].header);
    free(o->tables);
    *o = (object_tables){0};
}
