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

enum { MOST_COLUMNS = 998, UNIT = 40, BYTES = sizeof(double), FLUSH = 1 << 18 };

static const char blanks[] = " \t\r\v\f";

/* A line of the head. */
typedef struct text_column {
    int64_t first; /* the number of its first value in a row, from 1 */
    char name[SF_NAME];
    char unit[UNIT + 1];
} text_column;

/* A catalog that is being converted. */
typedef struct conversion {
    text_lines lines;
    text_column *columns; /* [n] */
    size_t n, capacity;
    int64_t values; /* of a row; 0 = no row has been read */
    int64_t rows, most_rows;
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
    if (!is)
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

static int put_value(conversion *c, char *word, shear_error *err) {
    double value = 0.0;
    unsigned char bytes[BYTES];
    uint64_t bits = 0;
    if (!text_to_double(word, &value)) {
        char what[80];
        sf_make_printable(word);
        snprintf(what, sizeof what, "'%.30s' is not a number", word);
        return bad(c, what, err);
    }
    memcpy(&bits, &value, sizeof bits);
    for (int k = 0; k < BYTES; k++)
        bytes[k] = (unsigned char)(bits >> (56 - 8 * k));
    buffer_add(&c->out, bytes, BYTES);
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

static int add_row(conversion *c, char *line, shear_error *err) {
    int64_t values = 0;
    if (c->n == 0)
        return bad(c, "no head ('#  1 NUMBER ...') names the columns before the rows", err);
    if (++c->rows > c->most_rows)
        return bad(c, "there are too many rows: split the catalog, one per chip", err);
    for (char *word = line; (word += strspn(word, blanks)), *word != '\0'; values++) {
        char *end = word + strcspn(word, blanks);
        char *next = *end != '\0' ? end + 1 : end;
        *end = '\0';
        TRY(put_value(c, word, err));
        word = next;
    }
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

static void put_form(buffer *b, int number, int64_t values) {
    char form[24];
    snprintf(form, sizeof form, "%lldD", (long long)values);
    put_text(b, "TFORM", number, form);
}

/* Values before the first column are a column without a name. */
static void put_columns(const conversion *c, buffer *b) {
    const int64_t all = c->values > 0 ? c->values : c->columns[c->n - 1].first;
    put_form(b, 1, c->columns[0].first - 1);
    for (size_t i = 0; i < c->n; i++) {
        const int number = (int)i + 2;
        const int64_t next = i + 1 < c->n ? c->columns[i + 1].first : all + 1;
        put_text(b, "TTYPE", number, c->columns[i].name);
        put_form(b, number, next - c->columns[i].first);
        if (c->columns[i].unit[0] != '\0')
            put_text(b, "TUNIT", number, c->columns[i].unit);
    }
}

static void put_headers(const conversion *c, buffer *b) {
    const int64_t all = c->values > 0 ? c->values : c->columns[c->n - 1].first;
    put_card(b, "SIMPLE", "                   T");
    put_number(b, "BITPIX", 8);
    put_number(b, "NAXIS", 0);
    put_card(b, "EXTEND", "                   T");
    end_header(b);
    put_text(b, "XTENSION", 0, "BINTABLE");
    put_number(b, "BITPIX", 8);
    put_number(b, "NAXIS", 2);
    put_number(b, "NAXIS1", all * BYTES);
    put_number(b, "NAXIS2", c->rows);
    put_number(b, "PCOUNT", 0);
    put_number(b, "GCOUNT", 1);
    put_number(b, "TFIELDS", (int64_t)c->n + 1);
    put_text(b, "EXTNAME", 0, "OBJECTS");
    put_columns(c, b);
    end_header(b);
}

/* Write the headers to the file's beginning. They have one size, whatever the number of rows. */
static int write_headers(conversion *c, shear_error *err) {
    if (lseek(c->fd, 0, SEEK_SET) != 0)
        return sf_fail_errno(err, c->lines.at, errno, "cannot write a temporary copy");
    put_headers(c, &c->out);
    return flush(c, err);
}

/* Write what has been collected, zeros up to a whole block, and the headers. */
static int finish(conversion *c, shear_error *err) {
    static const char zeros[SF_BLOCK_BYTES];
    const int64_t bytes = c->rows * c->values * BYTES;
    buffer_add(&c->out, zeros, (size_t)(sf_padded(bytes) - bytes));
    TRY(flush(c, err));
    return write_headers(c, err);
}

static bool is_row(const char *line) {
    return line[strspn(line, blanks)] != '\0';
}

/* Write headers at the first row, to be overwritten at the end. */
static int convert_line(conversion *c, char *line, shear_error *err) {
    if (line[0] == '#')
        return add_column(c, line + 1, err);
    if (!is_row(line))
        return SHEAR_OK;
    if (c->rows == 0 && c->n > 0)
        TRY(write_headers(c, err));
    return add_row(c, line, err);
}

int text_table_convert(int fd, sf_place at, int64_t most_rows, int *out, shear_error *err) {
    CLEANUP(conversion_deinit) conversion c = {.fd = -1, .most_rows = most_rows};
    char *line = NULL;
    TRY(text_lines_init(&c.lines, fd, at, TEXT_TABLE_LINE, err));
    TRY(sf_scratch_open(at, &c.fd, err));
    do {
        TRY(text_lines_next(&c.lines, &line, err));
        TRY(line != NULL ? convert_line(&c, line, err) : SHEAR_OK);
    } while (line != NULL);
    if (c.n == 0)
        return bad(&c, "the text ends without a head that names columns", err);
    TRY(finish(&c, err));
    *out = c.fd;
    c.fd = -1;
    return SHEAR_OK;
}
