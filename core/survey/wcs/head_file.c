/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/wcs/head_file.h"

#include "base/array.h"
#include "base/buffer.h"
#include "base/cleanup.h"
#include "base/io.h"
#include "fits/io/source.h"
#include "survey/wcs/sky_keywords.h"

#include <assert.h>
#include <errno.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

enum { LIMIT = 64 << 20 }; /* bytes: 10,000 chips */

/* The file while it is read. */
typedef struct reading {
    sf_place at;
    buffer text, cards;
    size_t capacity; /* of head_file.first */
    int line;        /* its number, from 1 */
    bool typed;      /* the block has CTYPE1 */
    bool open;       /* it has any line behind the last END */
} reading;

static void reading_deinit(reading *r) {
    buffer_deinit(&r->text);
    buffer_deinit(&r->cards);
}

static int load(reading *r, const char *path, int fd, shear_error *err) {
    CLEANUP(release_fd) int in = -1;
    int64_t bytes = 0;
    TRY(sf_open_regular(path, fd, r->at, &in, &bytes, err));
    if (bytes > LIMIT) {
        return sf_fail(err, SHEAR_E_FORMAT, r->at, "give the text file that SCAMP writes (.head)",
                       "has %lld bytes, more than any text of header cards", (long long)bytes);
    }
    CLEANUP(release_free) char *content = malloc((size_t)bytes + 1);
    if (content == NULL)
        return sf_fail_memory(err, r->at);
    const ssize_t n = io_read_at(in, content, (size_t)bytes, 0);
    if (n < 0)
        return sf_fail_errno(err, r->at, errno, "cannot be read");
    return buffer_add(&r->text, content, (size_t)n) ? SHEAR_OK : sf_fail_memory(err, r->at);
}

static int end_block(reading *r, head_file *h, shear_error *err) {
    if (!r->typed) {
        return sf_fail(err, SHEAR_E_FORMAT, r->at, "give the text file that SCAMP writes (.head)",
                       "its block %d, which ends in line %d, has no CTYPE1", h->n + 1, r->line);
    }
    if (!ARRAY_RESERVE(h->first, r->capacity, (size_t)h->n + 2))
        return sf_fail_memory(err, r->at);
    h->first[0] = 0;
    h->first[++h->n] = (int64_t)(r->cards.n / SF_CARD);
    r->typed = r->open = false;
    return SHEAR_OK;
}

/* Copy the line as a card. Return false if there are bytes in it that no text has. */
static bool card_of(const char *line, size_t n, char card[SF_CARD]) {
    memset(card, ' ', SF_CARD);
    for (size_t i = 0; i < n; i++) {
        const char c = line[i];
        if (c >= 0 && c < ' ' && c != '\t')
            return false;
        if (i < SF_CARD && c != '\t')
            card[i] = c;
    }
    return true;
}

static int read_line(reading *r, head_file *h, const char *line, size_t n, shear_error *err) {
    char card[SF_CARD], key[SF_KEY + 1];
    r->line++;
    while (n > 0 && (line[n - 1] == ' ' || line[n - 1] == '\r'))
        n--;
    if (n == 0)
        return SHEAR_OK;
    if (!card_of(line, n, card) || (n > SF_CARD && sky_keywords_has(card))) {
        return sf_fail(err, SHEAR_E_FORMAT, r->at, "give the text file that SCAMP writes (.head)",
                       "line %d is not a header card", r->line);
    }
    sf_card_key(card, key);
    if (strcmp(key, "END") == 0)
        return end_block(r, h, err);
    r->open = true;
    r->typed = r->typed || strcmp(key, "CTYPE1") == 0;
    if (sky_keywords_has(card) && !buffer_add(&r->cards, card, SF_CARD))
        return sf_fail_memory(err, r->at);
    return SHEAR_OK;
}

static int read_lines(reading *r, head_file *h, shear_error *err) {
    const char *line = r->text.bytes;
    const char *const end = r->text.n > 0 ? line + r->text.n : line;
    while (line < end) {
        const char *const stop = memchr(line, '\n', (size_t)(end - line));
        const size_t n = (size_t)((stop != NULL ? stop : end) - line);
        TRY(read_line(r, h, line, n, err));
        line = stop != NULL ? stop + 1 : end;
    }
    if (h->n > 0 && !r->open)
        return SHEAR_OK;
    return sf_fail(err, SHEAR_E_FORMAT, r->at, "end the cards of each chip with a line END",
                   "its last block has no END: it is cut off, or no text of header cards");
}

int head_file_init(head_file *h, const char *path, int fd, shear_error *err) {
    char name[161];
    sf_printable_name(name, sizeof name, path);
    CLEANUP(reading_deinit) reading r = {.at = {name, NULL}};
    *h = (head_file){0};
    TRY(load(&r, path, fd, err));
    TRY(read_lines(&r, h, err));
    h->cards = buffer_take(&r.cards, NULL);
    return h->cards != NULL ? SHEAR_OK : sf_fail_memory(err, r.at);
}

void head_file_deinit(head_file *h) {
    free(h->cards);
    free(h->first);
    *h = (head_file){0};
}

char *head_file_merge(const head_file *h, int i, const char *cards, int64_t *count) {
    assert(i >= 0 && i < h->n);
    CLEANUP(buffer_deinit) buffer merged = {0};
    for (int64_t n = 0; n < *count; n++) {
        if (!sky_keywords_has(cards + n * SF_CARD))
            buffer_add(&merged, cards + n * SF_CARD, SF_CARD);
    }
    const int64_t first = h->first[i], last = h->first[i + 1];
    buffer_add(&merged, h->cards + first * SF_CARD, (size_t)(last - first) * SF_CARD);
    size_t bytes = 0;
    char *const text = buffer_take(&merged, &bytes);
    if (text != NULL)
        *count = (int64_t)(bytes / SF_CARD);
    return text;
}
