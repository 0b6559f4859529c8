/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "exposure/image_file.h"

#include "base/cleanup.h"
#include "base/io.h"
#include "value.h"

#include <assert.h>
#include <endian.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <math.h>
#include <sys/stat.h>

enum { CARD = 80, BLOCK = 2880, SLAB = 4096 };

/* ---- cards ---- */
static void add_card(buffer *cards, const char *text) {
    char card[CARD + 1];
    snprintf(card, sizeof card, "%-80.80s", text);
    buffer_add(cards, card, CARD);
}

static void add_value(buffer *cards, const char *key, const char *value, const char *comment) {
    char text[2 * CARD];
    snprintf(text, sizeof text, "%-8.8s= %20s%s%s", key, value, comment != NULL ? " / " : "",
             comment != NULL ? comment : "");
    add_card(cards, text);
}

void image_card_int(buffer *cards, const char *key, int64_t value, const char *comment) {
    char text[32];
    snprintf(text, sizeof text, "%" PRId64, value);
    add_value(cards, key, text, comment);
}

void image_card_real(buffer *cards, const char *key, double value, const char *comment) {
    char digits[32];
    char text[40];
    value_of_double(value, digits);
    char *exponent = strchr(digits, 'e');
    if (exponent != NULL)
        *exponent = 'E';
    snprintf(text, sizeof text, "%s%s", digits, strpbrk(digits, ".E") == NULL ? ".0" : "");
    add_value(cards, key, text, comment);
}

void image_card_text(buffer *cards, const char *key, const char *value, const char *comment) {
    char text[CARD];
    snprintf(text, sizeof text, "'%-8.60s'", value);
    char padded[CARD];
    snprintf(padded, sizeof padded, "%-20s", text);
    add_value(cards, key, padded, comment);
}

void image_card_logical(buffer *cards, const char *key, bool value, const char *comment) {
    add_value(cards, key, value ? "T" : "F", comment);
}

void image_card_history(buffer *cards, const char *text) {
    char card[CARD + 1];
    snprintf(card, sizeof card, "HISTORY %.72s", text);
    add_card(cards, card);
}

/* ---- bytes ---- */
static int write_bytes(const image_file *f, const void *bytes, size_t n, shear_error *err) {
    if (n == 0 || fwrite(bytes, 1, n, f->stream) == n) /* `bytes` may be NULL */
        return SHEAR_OK;
    return shear_fail(err, errno == ENOSPC ? SHEAR_E_FULL : SHEAR_E_IO, NULL, "cannot write %s: %s",
                      f->path, strerror(errno));
}

/* Fill the block of FITS that `n` bytes have begun. */
static int pad(const image_file *f, size_t n, char fill, shear_error *err) {
    char bytes[BLOCK];
    memset(bytes, fill, sizeof bytes);
    return write_bytes(f, bytes, (BLOCK - n % BLOCK) % BLOCK, err);
}

/* Write a header: the mandatory cards, those of the caller, END. */
static int write_header(const image_file *f, buffer *first, const buffer *cards, shear_error *err) {
    if (cards != NULL)
        buffer_add(first, cards->bytes, cards->n);
    add_card(first, "END");
    if (first->failed || (cards != NULL && cards->failed))
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a header of %s", f->path);
    TRY(write_bytes(f, first->bytes, first->n, err));
    return pad(f, first->n, ' ', err);
}

static size_t put_pixel(int bitpix, double value, unsigned char *out) {
    if (bitpix == 16) {
        const uint16_t bits = htobe16((uint16_t)(int16_t)value);
        memcpy(out, &bits, sizeof bits);
        return sizeof bits;
    }
    const float number = (float)value;
    uint32_t bits;
    memcpy(&bits, &number, sizeof bits);
    bits = htobe32(bits);
    memcpy(out, &bits, sizeof bits);
    return sizeof bits;
}

static int write_pixels(const image_file *f, int bitpix, const double *pixels, size_t n,
                        shear_error *err) {
    unsigned char slab[SLAB * sizeof(float)];
    size_t written = 0;
    for (size_t i = 0; i < n;) {
        size_t used = 0;
        for (size_t k = 0; k < SLAB && i < n; k++, i++)
            used += put_pixel(bitpix, pixels[i], slab + used);
        TRY(write_bytes(f, slab, used, err));
        written += used;
    }
    return pad(f, written, '\0', err);
}

/* ---- files ---- */
static char *with_suffix(const char *path, const char *suffix) {
    const size_t size = strlen(path) + strlen(suffix) + 1;
    char *out = malloc(size);
    if (out != NULL)
        snprintf(out, size, "%s%s", path, suffix);
    return out;
}

static int fail_create(const image_file *f, shear_error *err) {
    return shear_fail(err, SHEAR_E_IO, NULL, "cannot create %s: %s", f->path, strerror(errno));
}

int image_file_create(image_file *f, const char *path, bool overwrite, const buffer *cards,
                      shear_error *err) {
    struct stat st;
    *f = (image_file){.path = with_suffix(path, ""),
                      .temporary = with_suffix(path, ".part"),
                      .overwrite = overwrite};
    if (f->path == NULL || f->temporary == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for the name %s", path);
    if (!overwrite && lstat(path, &st) == 0) {
        return shear_fail(err, SHEAR_E_EXISTS, "give another name, or replace the file",
                          "%s exists", path);
    }
    f->stream = fopen(f->temporary, "we");
    if (f->stream == NULL)
        return fail_create(f, err);
    CLEANUP(buffer_deinit) buffer first = {0};
    image_card_logical(&first, "SIMPLE", true, NULL);
    image_card_int(&first, "BITPIX", 8, NULL);
    image_card_int(&first, "NAXIS", 0, NULL);
    image_card_logical(&first, "EXTEND", true, NULL);
    return write_header(f, &first, cards, err);
}

/* Begin an extension's header. */
static void begin_extension(buffer *cards, const char *kind, int bitpix, int64_t nx, int64_t ny) {
    image_card_text(cards, "XTENSION", kind, NULL);
    image_card_int(cards, "BITPIX", bitpix, NULL);
    image_card_int(cards, "NAXIS", 2, NULL);
    image_card_int(cards, "NAXIS1", nx, NULL);
    image_card_int(cards, "NAXIS2", ny, NULL);
    image_card_int(cards, "PCOUNT", 0, NULL);
    image_card_int(cards, "GCOUNT", 1, NULL);
}

int image_file_add_image(image_file *f, const char *name, int bitpix, int nx, int ny,
                         const double *pixels, const buffer *cards, shear_error *err) {
    CLEANUP(buffer_deinit) buffer first = {0};
    begin_extension(&first, "IMAGE", bitpix, nx, ny);
    image_card_text(&first, "EXTNAME", name, NULL);
    TRY(write_header(f, &first, cards, err));
    return write_pixels(f, bitpix, pixels, (size_t)nx * (size_t)ny, err);
}

void image_row_double(buffer *rows, double value) {
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    bits = htobe64(bits);
    buffer_add(rows, &bits, sizeof bits);
}

void image_row_int(buffer *rows, int32_t value) {
    const uint32_t bits = htobe32((uint32_t)value);
    buffer_add(rows, &bits, sizeof bits);
}

static void add_columns(buffer *cards, const image_column *columns, int n) {
    image_card_int(cards, "TFIELDS", n, NULL);
    for (int i = 0; i < n; i++) {
        const char type[] = {'1', columns[i].type, '\0'};
        char key[24];
        snprintf(key, sizeof key, "TTYPE%d", i + 1);
        image_card_text(cards, key, columns[i].name, NULL);
        snprintf(key, sizeof key, "TFORM%d", i + 1);
        image_card_text(cards, key, type, NULL);
        snprintf(key, sizeof key, "TUNIT%d", i + 1);
        if (columns[i].unit != NULL)
            image_card_text(cards, key, columns[i].unit, NULL);
    }
}

int image_file_add_table(image_file *f, const char *name, const image_column *columns, int n,
                         const buffer *rows, const buffer *cards, shear_error *err) {
    CLEANUP(buffer_deinit) buffer first = {0};
    size_t width = 0;
    assert(n > 0);
    for (int i = 0; i < n; i++)
        width += columns[i].type == 'J' ? sizeof(int32_t) : sizeof(double);
    if (rows->failed)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for the rows of %s", f->path);
    begin_extension(&first, "BINTABLE", 8, (int64_t)width, (int64_t)(rows->n / width));
    add_columns(&first, columns, n);
    image_card_text(&first, "EXTNAME", name, NULL);
    TRY(write_header(f, &first, cards, err));
    TRY(write_bytes(f, rows->bytes, rows->n, err));
    return pad(f, rows->n, '\0', err);
}

int image_file_finish(image_file *f, shear_error *err) {
    FILE *stream = f->stream;
    f->stream = NULL;
    int error = fclose(stream) != 0 ? errno : 0;
    if (error == 0)
        error = io_rename(AT_FDCWD, f->temporary, f->path, f->overwrite);
    if (error != 0)
        unlink(f->temporary);
    const int code = error == 0        ? SHEAR_OK
                     : error == EEXIST ? SHEAR_E_EXISTS
                     : error == ENOSPC ? SHEAR_E_FULL
                                       : SHEAR_E_IO;
    if (code != SHEAR_OK)
        shear_fail(err, code, NULL, "cannot write %s: %s", f->path, strerror(error));
    image_file_abort(f);
    return code;
}

void image_file_abort(image_file *f) {
    if (f->stream != NULL) {
        fclose(f->stream);
        unlink(f->temporary);
    }
    free(f->path);
    free(f->temporary);
    *f = (image_file){0};
}
