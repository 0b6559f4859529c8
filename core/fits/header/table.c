/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fits/header/table.h"

#include "base/cleanup.h"
#include "fits/io/bits.h"

#include <assert.h>
#include <ctype.h>
#include <math.h>
#include <string.h>
#include <strings.h>

enum { MAX_COLUMNS = 999, BUFFER = 1 << 15 };

/* ---- layout ---- */

static int bad(const sf_table *t, const char *root, int i, const char *what, shear_error *err) {
    return sf_fail(err, SHEAR_E_FORMAT, t->cards->at, NULL, "keyword %s%d %s", root, i + 1, what);
}

/* Return the bytes of one element; 0 for an unknown type. */
static int64_t width_of(char type) {
    static const char types[] = "LBIJKAEDCMPQ";
    static const int widths[] = {1, 1, 2, 4, 8, 1, 4, 8, 8, 16, 8, 16};
    const char *at = type != '\0' ? strchr(types, type) : NULL;
    return at != NULL ? widths[at - types] : 0;
}

static char upper(char c) {
    return (char)(c >= 'a' && c <= 'z' ? c - 'a' + 'A' : c);
}

/* Parse rT, where r is a count (1 if absent) and T a letter; P and Q are followed by another
 * letter. */
static bool parse_form(const char *form, sf_column *c) {
    int64_t repeat = 0;
    const char *p = form;
    for (; isdigit((unsigned char)*p); p++) {
        if (repeat > INT64_MAX / 100)
            return false;
        repeat = 10 * repeat + (*p - '0');
    }
    c->repeat = p == form ? 1 : repeat;
    c->type = upper(*p);
    if (*p != '\0')
        c->element = upper(p[1]);
    if (c->type == 'X') {
        c->width = c->repeat / 8 + (c->repeat % 8 != 0 ? 1 : 0);
        return true;
    }
    return width_of(c->type) > 0 &&
           !__builtin_mul_overflow(c->repeat, width_of(c->type), &c->width);
}

static int set_form(sf_table *t, int i, const char *card, shear_error *err) {
    char form[SF_CARD];
    sf_column *c = &t->columns[i];
    if (c->type != '\0')
        return bad(t, "TFORM", i, "is given twice", err);
    const bool sound = sf_card_string(card, form, sizeof form) && parse_form(form, c);
    return sound ? SHEAR_OK : bad(t, "TFORM", i, "is no format of a binary table's column", err);
}

static int set_name(sf_table *t, int i, const char *card, shear_error *err) {
    sf_column *c = &t->columns[i];
    if (c->name[0] != '\0')
        return bad(t, "TTYPE", i, "is given twice", err);
    if (!sf_card_string(card, c->name, sizeof c->name)) {
        c->name[0] = '\0'; /* a name that is never looked up */
    }
    return SHEAR_OK;
}

static void note_scaling(sf_scaling *s, const char **slot, const char *card) {
    s->twice = s->twice || *slot != NULL;
    *slot = card;
}

static int set_card(sf_table *t, const char *card, shear_error *err) {
    static const char *const roots[] = {"TTYPE", "TFORM", "TSCAL", "TZERO", "TNULL"};
    char key[SF_KEY + 1];
    sf_card_key(card, key);
    for (int k = 0; key[0] == 'T' && k < 5; k++) {
        const int i = sf_card_index(key, roots[k]) - 1;
        if (i < 0 || i >= t->n || !sf_card_has_value(card))
            continue;
        sf_scaling *s = &t->columns[i].by;
        if (k < 2)
            return k == 0 ? set_name(t, i, card, err) : set_form(t, i, card, err);
        note_scaling(s, k == 2 ? &s->scale_card : k == 3 ? &s->zero_card : &s->null_card, card);
    }
    return SHEAR_OK;
}

/* Parse TSCALn, TZEROn and TNULLn; `wrong` says what is wrong with them. */
static void parse_scaling(sf_scaling *s, char type) {
    const bool scaled = type != 'L'; /* logicals are not */
    s->has_null = s->null_card != NULL && strchr("BIJK", type) != NULL;
    s->scale = 1.0;
    s->wrong = s->twice ? "is given twice" : NULL;
    if (s->scale_card != NULL && (!sf_card_double(s->scale_card, &s->scale) || s->scale == 0.0)) {
        s->wrong = "(TSCALn) is 0 or not a finite number";
    } else if (s->zero_card != NULL && !sf_card_double(s->zero_card, &s->zero)) {
        s->wrong = "(TZEROn) is not a finite number";
    } else if (s->has_null && !sf_card_int(s->null_card, &s->null)) {
        s->wrong = "(TNULLn) is not an integer (of up to 64 bits)";
    }
    s->scale = scaled ? s->scale : 1.0;
    s->zero = scaled ? s->zero : 0.0;
    const bool exact = scaled && s->zero_card != NULL && sf_card_int(s->zero_card, &s->whole_zero);
    s->whole = s->scale == 1.0 && (exact || (s->zero == floor(s->zero) && fabs(s->zero) < 0x1p63));
    s->whole_zero = exact ? s->whole_zero : s->whole ? (int64_t)s->zero : 0;
    s->is_unsigned = type == 'K' && s->scale == 1.0 && s->zero == 0x1p63;
}

static int lay_out(sf_table *t, shear_error *err) {
    const int64_t row = t->cards->hdu->axes[0];
    int64_t end = 0;
    for (int i = 0; i < t->n; i++) {
        sf_column *c = &t->columns[i];
        if (c->type == '\0')
            return bad(t, "TFORM", i, "is missing", err);
        parse_scaling(&c->by, c->type);
        c->offset = end;
        if (__builtin_add_overflow(end, c->width, &end) || end > row)
            return bad(t, "TFORM", i, "goes beyond the row: NAXIS1 is smaller", err);
    }
    return end == row ? SHEAR_OK
                      : sf_fail(err, SHEAR_E_FORMAT, t->cards->at, NULL,
                                "its columns (TFORMn) have %lld bytes in all, but NAXIS1 is %lld",
                                (long long)end, (long long)row);
}

int sf_table_init(sf_table *t, const sf_cards *cards, shear_error *err) {
    const sf_hdu *hdu = cards->hdu;
    *t = (sf_table){.cards = cards};
    if (hdu->kind != SF_TABLE || hdu->naxis != 2 || hdu->bitpix != 8 || hdu->gcount != 1) {
        return sf_fail(err, SHEAR_E_FORMAT, cards->at, NULL,
                       "must be a binary table (BINTABLE) with BITPIX 8, NAXIS 2 and GCOUNT 1");
    }
    int64_t n = 0;
    TRY(sf_need_int(cards, "TFIELDS", 0, MAX_COLUMNS, &n, err));
    t->columns = calloc((size_t)n + 1, sizeof *t->columns);
    if (t->columns == NULL)
        return sf_fail_memory(err, cards->at);
    t->n = (int)n;
    for (int64_t i = 0; i < cards->count; i++)
        TRY(set_card(t, cards->text + i * SF_CARD, err));
    return lay_out(t, err);
}

void sf_table_deinit(sf_table *t) {
    free(t->columns);
    t->columns = NULL;
    t->n = 0;
}

int sf_table_find(const sf_table *t, const char *name, const sf_column **column, shear_error *err) {
    *column = NULL;
    for (int i = 0; i < t->n; i++) {
        if (strcasecmp(t->columns[i].name, name) != 0)
            continue;
        if (*column != NULL) {
            return sf_fail(err, SHEAR_E_FORMAT, t->cards->at, NULL, "it has two columns called %s",
                           name);
        }
        *column = &t->columns[i];
    }
    return SHEAR_OK;
}

/* Return what keeps a column from holding `repeat` numbers, or one number, per row; NULL: nothing.
 */
static const char *unfit(const sf_column *c, bool several) {
    if (c->type == 'P' || c->type == 'Q')
        return "has a variable length";
    if (c->type == 'A')
        return "holds strings";
    if (several ? c->repeat < 1 : c->repeat != 1)
        return "has another repeat count";
    return strchr("LBIJKED", c->type) == NULL ? "has another type" : NULL;
}

static int find_numeric(const sf_table *t, const char *name, bool several, const sf_column **column,
                        shear_error *err) {
    TRY(sf_table_find(t, name, column, err));
    const sf_column *c = *column;
    if (c == NULL)
        return SHEAR_OK;
    const char *what = unfit(c, several);
    if (what != NULL) {
        return sf_fail(err, SHEAR_E_FORMAT, t->cards->at, "correct the column, or rename it",
                       "column %s must hold %s per row (TFORM B, I, J, K, E, D or L), but %s", name,
                       several ? "numbers" : "one number", what);
    }
    return c->by.wrong == NULL ? SHEAR_OK
                               : sf_fail(err, SHEAR_E_FORMAT, t->cards->at, NULL,
                                         "column %s: its keyword TSCALn, TZEROn or TNULLn %s",
                                         c->name, c->by.wrong);
}

int sf_table_find_number(const sf_table *t, const char *name, const sf_column **column,
                         shear_error *err) {
    return find_numeric(t, name, false, column, err);
}

int sf_table_find_numbers(const sf_table *t, const char *name, const sf_column **column,
                          shear_error *err) {
    return find_numeric(t, name, true, column, err);
}

/* Parse "(12, 34)" into at most SF_AXES axes. Return their product; 0 if it is something else. */
static int64_t parse_shape(const char *text, int64_t axes[SF_AXES]) {
    int64_t product = 1;
    const char *p = text + strspn(text, " ");
    for (int k = 0; k < SF_AXES && (k == 0 ? *p == '(' : *p == ','); k++) {
        char *end = NULL;
        axes[k] = strtoll(p + 1, &end, 10);
        if (end == p + 1 || axes[k] < 1 || __builtin_mul_overflow(product, axes[k], &product))
            return 0;
        p = end + strspn(end, " ");
    }
    return *p == ')' ? product : 0;
}

int sf_table_shape(const sf_table *t, const sf_column *column, int64_t axes[SF_AXES],
                   shear_error *err) {
    char key[SF_INDEXED];
    CLEANUP(release_free) char *text = NULL;
    for (int k = 0; k < SF_AXES; k++)
        axes[k] = k == 0 ? column->repeat : 1;
    sf_card_indexed(key, "TDIM", (int)(column - t->columns) + 1);
    TRY(sf_key_string(t->cards, key, &text, err));
    if (text == NULL || parse_shape(text, axes) == column->repeat)
        return SHEAR_OK;
    sf_make_printable(text);
    return sf_fail(err, SHEAR_E_FORMAT, t->cards->at, "correct TDIMn or TFORMn",
                   "keyword %s is %s, but must give 1 to %d axes of %lld elements in all", key,
                   text, SF_AXES, (long long)column->repeat);
}

/* ---- rows, converted and scaled ---- */

sf_rows sf_table_rows(const sf_table *t) {
    return (sf_rows){.fd = t->cards->file->source.fd,
                     .at = t->cards->at,
                     .start = t->cards->hdu->data_offset,
                     .width = t->cards->hdu->axes[0]};
}

int sf_table_bytes(const sf_table *t, int64_t row, int64_t offset, int64_t bytes, void *out,
                   shear_error *err) {
    const sf_rows rows = sf_table_rows(t);
    return sf_rows_bytes(&rows, row, offset, bytes, out, err);
}

/* A cell as stored: an integer or a floating-point number, or undefined. */
typedef struct stored_cell {
    bool floating, undefined;
    int64_t integer;
    double real;
} stored_cell;

static stored_cell real_of(double v) {
    return (stored_cell){.floating = true, .real = v, .undefined = isnan(v)};
}

static stored_cell integer_of(const sf_scaling *by, int64_t v) {
    return (stored_cell){.integer = v, .undefined = by->has_null && v == by->null};
}

static stored_cell stored_cell_of(const sf_column *c, const unsigned char *bytes) {
    const uint64_t bits = sf_bits_big_endian(bytes, c->width);
    switch (c->type) {
    case 'L':
        return (stored_cell){.integer = bits == 'T' ? 1 : 0,
                             .undefined = bits != 'T' && bits != 'F'};
    case 'B':
    case 'K':
        return integer_of(&c->by, (int64_t)bits);
    case 'I':
        return integer_of(&c->by, (int16_t)bits);
    case 'J':
        return integer_of(&c->by, (int32_t)bits);
    case 'E': {
        const uint32_t low = (uint32_t)bits;
        float v;
        memcpy(&v, &low, sizeof v);
        return real_of((double)v);
    }
    default: {
        double v;
        memcpy(&v, &bits, sizeof v);
        return real_of(v);
    }
    }
}

typedef struct sink {
    const sf_column *column;
    double *doubles; /* output: either doubles or integers is set */
    int64_t *integers;
    int64_t undefined;
} sink;

static double as_double(const sf_scaling *by, stored_cell c) {
    if (c.undefined)
        return NAN;
    const double v = c.floating ? c.real : (double)c.integer;
    return by->scale == 1.0 && by->zero == 0.0 ? v : v * by->scale + by->zero;
}

static int64_t as_integer(const sf_scaling *by, stored_cell c, int64_t undefined) {
    int64_t sum = 0;
    if (!c.floating && !c.undefined) {
        if (by->is_unsigned)
            return (int64_t)((uint64_t)c.integer + (UINT64_C(1) << 63));
        if (by->whole)
            return __builtin_add_overflow(c.integer, by->whole_zero, &sum) ? undefined : sum;
    }
    const double v = as_double(by, c);
    return v == floor(v) && fabs(v) < 0x1p63 ? (int64_t)v : undefined; /* NaN fails both tests */
}

static void put(const sink *s, int64_t i, const unsigned char *bytes) {
    const stored_cell c = stored_cell_of(s->column, bytes);
    if (s->doubles != NULL) {
        s->doubles[i] = as_double(&s->column->by, c);
    } else {
        s->integers[i] = as_integer(&s->column->by, c, s->undefined);
    }
}

/* Read whole rows at a time if they are short, else cell by cell. */
static int read_rows(const sf_table *t, const sink *s, int64_t first, int64_t count,
                     shear_error *err) {
    unsigned char buffer[BUFFER] = {0};
    const sf_column *c = s->column;
    const int64_t row = t->cards->hdu->axes[0];
    const int64_t many = row <= BUFFER ? BUFFER / row : 1;
    const bool cells = row > BUFFER;
    for (int64_t done = 0; done < count;) {
        const int64_t n = count - done < many ? count - done : many;
        TRY(sf_table_bytes(t, first + done, cells ? c->offset : 0, cells ? c->width : n * row,
                           buffer, err));
        for (int64_t i = 0; i < n; i++)
            put(s, done + i, buffer + (cells ? 0 : i * row + c->offset));
        done += n;
    }
    return SHEAR_OK;
}

int sf_table_doubles(const sf_table *t, const sf_column *column, int64_t first, int64_t count,
                     double *out, shear_error *err) {
    const sink s = {.column = column, .doubles = out};
    return read_rows(t, &s, first, count, err);
}

int sf_table_integers(const sf_table *t, const sf_column *column, int64_t first, int64_t count,
                      int64_t undefined, int64_t *out, shear_error *err) {
    const sink s = {.column = column, .integers = out, .undefined = undefined};
    return read_rows(t, &s, first, count, err);
}

int sf_table_cell(const sf_table *t, const sf_column *column, int64_t row, double *out,
                  shear_error *err) {
    unsigned char buffer[BUFFER] = {0};
    sf_column element = *column;
    element.width = width_of(column->type);
    assert(element.width > 0 && out != NULL);
    const sink s = {.column = &element, .doubles = out};
    const int64_t many = BUFFER / element.width;
    for (int64_t done = 0; done < column->repeat;) {
        const int64_t n = column->repeat - done < many ? column->repeat - done : many;
        TRY(sf_table_bytes(t, row, column->offset + done * element.width, n * element.width, buffer,
                           err));
        for (int64_t i = 0; i < n; i++)
            put(&s, done + i, buffer + i * element.width);
        done += n;
    }
    return SHEAR_OK;
}

int sf_table_text(const sf_table *t, const sf_column *column, int64_t row, char *out, size_t size,
                  shear_error *err) {
    const size_t n = (size_t)column->width < size ? (size_t)column->width : size - 1;
    TRY(sf_table_bytes(t, row, column->offset, (int64_t)n, out, err));
    out[n] = '\0';
    sf_make_printable(out);
    for (size_t end = strlen(out); end > 0 && out[end - 1] == ' '; end--)
        out[end - 1] = '\0';
    return SHEAR_OK;
}
