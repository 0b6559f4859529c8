/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/sources/text_table.h"

#include "base/array.h"
#include "base/buffer.h"
#include "base/cleanup.h"
#include "base/io.h"
#include "base/text.h"
#include "fits/header/card.h"
#include "fits/header/file.h"
#include "fits/io/bits.h"
#include "fits/io/scratch.h"
#include "survey/sources/text_lines.h"

#include <ctype.h>
#include <errno.h>
#include <string.h>

enum { MOST_COLUMNS = 998, UNIT = 40, FLUSH = 1 << 18 };

static const char blanks[] = " \t\r\v\f";

/* A line of the head. */
typedef struct text_column {
    int64_t first; /* the number of its first value in a row, from 1 */
    char name[SF_NAME];
    char unit[UNIT + 1];
    int64_t width; /* how many values it has in a row */
    char type; /* of TFORM: J or K if it is one integer, of 32 or 64 bits, in all rows; else D */
} text_column;

/* A catalog that is being converted. The text is read twice: for the number of rows and the types
 * of the columns, which the header tells, then for the rows. */
typedef struct conversion {
    text_lines lines;
    text_column *columns; /* [n] */
    size_t n, capacity;
    int64_t values; /* of a row; 0 = no row has been read */
    int64_t rows, most_rows;
    bool writing; /* the second time */
    int64_t written;
    buffer out; /* rows that are to be written */
    int fd;
} conversion;

static void conversion_deinit(conversion *c) {
    text_lines_deinit(&c->lines);
    free(c->columns);
    buffer_deinit(&c->out);
    release_fd(&c->fd);
}

static int bad(const conversion *c, const char *what, shear_error *err) {
    return sf_fail(err, SHEAR_E_FORMAT, c->lines.at,
                   "write the catalog with CATALOG_TYPE FITS_LDAC, or ASCII_HEAD", "line %lld: %s",
                   (long long)c->lines.number, what);
}

/* ---- the head ---- */

/* Copy the next word; false if there is none, or it is too long or not printable. */
static bool take_word(const char **text, char *out, size_t size) {
    *text += strspn(*text, blanks);
    const size_t n = strcspn(*text, blanks);
    for (size_t i = 0; i < n; i++) {
        if (!isgraph((unsigned char)(*text)[i]) || (*text)[i] == '\'')
            return false;
    }
    snprintf(out, size, "%.*s", (int)(n < size ? n : size - 1), *text);
    *text += n;
    return n > 0 && n < size;
}

/* Copy what is in the last brackets, which is the unit. */
static void take_unit(const char *text, char unit[UNIT + 1]) {
    const char *open = strrchr(text, '[');
    const char *close = open != NULL ? strchr(open, ']') : NULL;
    unit[0] = '\0';
    if (close == NULL || close - open > UNIT)
        return;
    snprintf(unit, UNIT + 1, "%.*s", (int)(close - open - 1), open + 1);
    sf_make_printable(unit);
    for (char *quote = unit; (quote = strchr(quote, '\'')) != NULL;)
        *quote = '?';
}

/* Parse a line after its '#'. It is a comment, *is false, unless it begins with a number. */
static bool parse_column(const char *text, text_column *column, bool *is) {
    char number[24];
    *is = take_word(&text, number, sizeof number) && text_to_int64(number, &column->first);
    take_unit(text, column->unit);
    return !*is || take_word(&text, column->name, sizeof column->name);
}

static int add_column(conversion *c, const char *text, shear_error *err) {
    text_column column = {0};
    bool is = false;
    if (!parse_column(text, &column, &is))
        return bad(c, "a column's number must be followed by its name", err);
    if (!is || c->writing)
        return SHEAR_OK;
    if (c->values > 0)
        return bad(c, "a second head follows the rows: give each chip's catalog its own file", err);
    const int64_t before = c->n > 0 ? c->columns[c->n - 1].first : 0;
    if (column.first <= before || column.first > TEXT_TABLE_VALUES)
        return bad(c, "the numbers of the columns must increase, up to 100000", err);
    if (c->n == MOST_COLUMNS)
        return bad(c, "there are more than 998 columns", err);
    if (!ARRAY_RESERVE(c->columns, c->capacity, c->n + 1))
        return sf_fail_memory(err, c->lines.at);
    column.type = 'J';
    c->columns[c->n++] = column;
    return SHEAR_OK;
}

/* ---- rows ---- */

static int flush(conversion *c, shear_error *err) {
    if (c->out.failed)
        return sf_fail_memory(err, c->lines.at);
    const int error = io_write(c->fd, c->out.bytes, c->out.n);
    c->out.n = 0;
    return error == 0 ? SHEAR_OK
                      : sf_fail_errno(err, c->lines.at, error, "cannot write a temporary copy");
}

static int64_t bytes_of(char type) {
    return type == 'J' ? 4 : 8;
}

static void put_bits(conversion *c, char type, uint64_t bits) {
    unsigned char bytes[8];
    const int64_t n = bytes_of(type);
    for (int64_t k = 0; k < n; k++)
        bytes[k] = (unsigned char)(bits >> (8 * (n - 1 - k)));
    buffer_add(&c->out, bytes, (size_t)n);
}

static char type_of(char before, bool whole, int64_t number) {
    if (before == 'D' || !whole)
        return 'D';
    return before == 'J' && number >= INT32_MIN && number <= INT32_MAX ? 'J' : 'K';
}

/* Take a number of `column`, or of none if it is NULL. */
static int take_value(conversion *c, text_column *column, char *word, shear_error *err) {
    int64_t number = 0;
    double value = 0.0;
    uint64_t bits = 0;
    char before = 'D';
    if (column != NULL)
        before = column->type;
    const bool whole = before != 'D' && text_to_int64(word, &number);
    const char type = type_of(before, whole, number);
    if (type == 'D' && !text_to_double(word, &value)) {
        char what[80];
        sf_make_printable(word);
        snprintf(what, sizeof what, "'%.30s' is not a number", word);
        return bad(c, what, err);
    }
    if (c->writing && type != before)
        return bad(c, "the file has changed while it was read", err);
    if (column != NULL)
        column->type = type;
    memcpy(&bits, type == 'D' ? (void *)&value : (void *)&number, sizeof bits);
    if (c->writing)
        put_bits(c, type, bits);
    return SHEAR_OK;
}

/* Check that a row has as many values as the first one, which must reach the last column. */
static int check_values(conversion *c, int64_t values, shear_error *err) {
    char what[100];
    const int64_t last = c->columns[c->n - 1].first;
    if (c->values == 0 && values >= last)
        c->values = values;
    if (values == c->values && values <= TEXT_TABLE_VALUES)
        return SHEAR_OK;
    snprintf(what, sizeof what, "it has %lld values, not %lld", (long long)values,
             (long long)(c->values > 0 ? c->values : last));
    return bad(c, what, err);
}

/* Take all values of a row; *values is their number. */
static int take_values(conversion *c, char *line, int64_t *values, shear_error *err) {
    size_t next = 0; /* column */
    for (char *word = line; (word += strspn(word, blanks)), *word != '\0'; ++*values) {
        char *end = word + strcspn(word, blanks);
        char *after = *end != '\0' ? end + 1 : end;
        *end = '\0';
        while (next < c->n && c->columns[next].first <= *values + 1)
            next++;
        TRY(take_value(c, next > 0 ? &c->columns[next - 1] : NULL, word, err));
        word = after;
    }
    return SHEAR_OK;
}

static int take_row(conversion *c, char *line, shear_error *err) {
    int64_t values = 0;
    if (c->n == 0)
        return bad(c, "no head ('#  1 NUMBER ...') names the columns before the rows", err);
    int64_t *rows = c->writing ? &c->written : &c->rows;
    if (++*rows > (c->writing ? c->rows : c->most_rows))
        return bad(c, "there are too many rows: split the catalog, one per chip", err);
    TRY(take_values(c, line, &values, err));
    TRY(check_values(c, values, err));
    return c->out.n >= FLUSH ? flush(c, err) : SHEAR_OK;
}

/* ---- the FITS file ---- */

static void put_card(buffer *b, const char *key, const char *value) {
    char text[SF_CARD + 1];
    char card[SF_CARD + 1];
    snprintf(text, sizeof text, value[0] != '\0' ? "%-8.8s= %.70s" : "%.8s", key, value);
    snprintf(card, sizeof card, "%-80s", text);
    buffer_add(b, card, SF_CARD);
}

static void put_number(buffer *b, const char *key, int64_t value) {
    char text[24];
    snprintf(text, sizeof text, "%20lld", (long long)value);
    put_card(b, key, text);
}

static void put_text(buffer *b, const char *root, int number, const char *value) {
    char key[SF_INDEXED];
    char text[SF_CARD + 3];
    snprintf(text, sizeof text, "'%-8s'", value);
    put_card(b, number > 0 ? sf_card_indexed(key, root, number) : root, text);
}

static void end_header(buffer *b) {
    put_card(b, "END", "");
    while (!b->failed && b->n % SF_BLOCK_BYTES != 0)
        buffer_add(b, " ", 1);
}

static void put_form(buffer *b, int number, int64_t values, char type) {
    char form[24];
    snprintf(form, sizeof form, "%lld%c", (long long)values, type);
    put_text(b, "TFORM", number, form);
}

/* Values before the first column are a column without a name. */
static void put_columns(const conversion *c, buffer *b) {
    put_form(b, 1, c->columns[0].first - 1, 'D');
    for (size_t i = 0; i < c->n; i++) {
        const text_column *column = &c->columns[i];
        const int number = (int)i + 2;
        put_text(b, "TTYPE", number, column->name);
        put_form(b, number, column->width, column->type);
        if (column->unit[0] != '\0')
            put_text(b, "TUNIT", number, column->unit);
    }
}

static int64_t row_bytes(const conversion *c) {
    int64_t bytes = 8 * (c->columns[0].first - 1);
    for (size_t i = 0; i < c->n; i++)
        bytes += c->columns[i].width * bytes_of(c->columns[i].type);
    return bytes;
}

static void put_headers(const conversion *c, buffer *b) {
    put_card(b, "SIMPLE", "                   T");
    put_number(b, "BITPIX", 8);
    put_number(b, "NAXIS", 0);
    put_card(b, "EXTEND", "                   T");
    end_header(b);
    put_text(b, "XTENSION", 0, "BINTABLE");
    put_number(b, "BITPIX", 8);
    put_number(b, "NAXIS", 2);
    put_number(b, "NAXIS1", row_bytes(c));
    put_number(b, "NAXIS2", c->rows);
    put_number(b, "PCOUNT", 0);
    put_number(b, "GCOUNT", 1);
    put_number(b, "TFIELDS", (int64_t)c->n + 1);
    put_text(b, "EXTNAME", 0, "OBJECTS");
    put_columns(c, b);
    end_header(b);
}

/* Set widths, once all rows have been seen. */
static void lay_out(conversion *c) {
    if (c->values == 0)
        c->values = c->columns[c->n - 1].first;
    for (size_t i = 0; i < c->n; i++) {
        const int64_t next = i + 1 < c->n ? c->columns[i + 1].first : c->values + 1;
        c->columns[i].width = next - c->columns[i].first;
        if (c->columns[i].width > 1)
            c->columns[i].type = 'D';
    }
}

/* Read the text, up to a second head. */
static int read_text(conversion *c, shear_error *err) {
    char *line = NULL;
    for (;;) {
        TRY(text_lines_next(&c->lines, &line, err));
        if (line == NULL)
            return SHEAR_OK;
        if (line[0] == '#') {
            TRY(add_column(c, line + 1, err));
        } else if (line[strspn(line, blanks)] != '\0') {
            TRY(take_row(c, line, err));
        }
    }
}

/* Write the headers, the rows, and zeros up to a whole block. */
static int write_table(conversion *c, shear_error *err) {
    static const char zeros[SF_BLOCK_BYTES];
    c->writing = true;
    lay_out(c);
    const int64_t bytes = c->rows * row_bytes(c);
    put_headers(c, &c->out);
    text_lines_rewind(&c->lines);
    TRY(read_text(c, err));
    if (c->written != c->rows)
        return bad(c, "the file has changed while it was read", err);
    buffer_add(&c->out, zeros, (size_t)(sf_padded(bytes) - bytes));
    return flush(c, err);
}

int text_table_convert(int fd, sf_place at, int64_t most_rows, int *out, shear_error *err) {
    CLEANUP(conversion_deinit) conversion c = {.fd = -1, .most_rows = most_rows};
    TRY(text_lines_init(&c.lines, fd, at, TEXT_TABLE_LINE, err));
    TRY(read_text(&c, err));
    if (c.n == 0)
        return bad(&c, "the text ends without a head that names columns", err);
    TRY(sf_scratch_open(at, &c.fd, err));
    TRY(write_table(&c, err));
    *out = c.fd;
    c.fd = -1;
    return SHEAR_OK;
}
