/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fits/header/hdu_index.h"

#include "base/array.h"
#include "base/cleanup.h"
#include "base/text.h"
#include "fits/header/card.h"
#include "fits/header/header.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>
#include <xxhash.h>

/* More than any field file has. They bound the time that a malicious file can take. */
enum { MAX_HDUS = 1000, MAX_HEADER_BLOCKS = 4096, BUFFER_BLOCKS = 8 };

/* Reads the header blocks of a file in order. */
typedef struct reader {
    int fd;
    int64_t size;
    const char *file;
    char buffer[BUFFER_BLOCKS * SF_BLOCK_BYTES];
    int64_t start; /* offset of the buffer in the file */
    int64_t held;  /* bytes in the buffer */
    XXH3_state_t *hash;
} reader;

/* Read the whole block at `offset`; *block is NULL if the file ends before the block does. */
static int read_block(reader *r, int64_t offset, const char **block, shear_error *err) {
    *block = NULL;
    if (offset < r->start || offset + SF_BLOCK_BYTES > r->start + r->held) {
        const ssize_t n = pread(r->fd, r->buffer, sizeof r->buffer, (off_t)offset);
        if (n < 0)
            return sf_fail_errno(err, (sf_place){r->file, NULL}, errno, "cannot be read");
        r->start = offset;
        r->held = n;
    }
    if (offset + SF_BLOCK_BYTES <= r->start + r->held)
        *block = r->buffer + (offset - r->start);
    return SHEAR_OK;
}

static int truncated(const reader *r, const sf_header *h, const char *part, int64_t needed,
                     shear_error *err) {
    char label[SF_NAME];
    return sf_fail(err, SHEAR_E_FORMAT, (sf_place){r->file, sf_header_label(h, label)},
                   "the file is truncated, or its header is wrong: copy or make it again",
                   "its %s would end at byte %lld, but the file has %lld bytes", part,
                   (long long)needed, (long long)r->size);
}

static int endless(const reader *r, const sf_header *h, shear_error *err) {
    char label[SF_NAME];
    return sf_fail(err, SHEAR_E_FORMAT, (sf_place){r->file, sf_header_label(h, label)}, NULL,
                   "its header has more than %d cards without an END",
                   MAX_HEADER_BLOCKS * (SF_BLOCK_BYTES / SF_CARD));
}

/* Parse the cards of one block; *ended is set at END. */
static int parse_block(sf_header *h, const char *block, bool *ended, const char *file,
                       shear_error *err) {
    sf_header_find_label(h, block);
    for (int i = 0; i < SF_BLOCK_BYTES && !*ended; i += SF_CARD) {
        char key[SF_KEY + 1];
        sf_card_key(block + i, key);
        if (strcmp(key, "END") == 0) {
            *ended = true;
            break;
        }
        TRY(sf_header_card(h, block + i, file, err));
    }
    return SHEAR_OK;
}

/* Read the cards of the header at `offset`, up to END, and set the place and hash of its blocks. */
static int read_cards(reader *r, sf_header *h, int64_t offset, XXH3_state_t *hash,
                      shear_error *err) {
    bool ended = false;
    int64_t *end = &h->hdu.data_offset;
    *end = offset;
    XXH3_64bits_reset(hash);
    for (int blocks = 0; !ended; blocks++) {
        const char *block = NULL;
        TRY(read_block(r, *end, &block, err));
        *end += SF_BLOCK_BYTES;
        if (block == NULL)
            return truncated(r, h, "header (no END card so far)", *end, err);
        if (blocks == MAX_HEADER_BLOCKS)
            return endless(r, h, err);
        XXH3_64bits_update(hash, block, SF_BLOCK_BYTES);
        TRY(parse_block(h, block, &ended, r->file, err));
    }
    h->hdu.header_offset = offset;
    h->hdu.header_bytes = *end - offset;
    h->hdu.header_hash = XXH3_64bits_digest(hash);
    return SHEAR_OK;
}

/* Read the HDU at `offset`; *next becomes the offset behind its data. */
static int read_hdu(reader *r, sf_header *h, int64_t offset, int64_t *next, shear_error *err) {
    sf_hdu *hdu = &h->hdu;
    TRY(read_cards(r, h, offset, r->hash, err));
    TRY(sf_header_end(h, r->file, err));
    const int64_t padded = (hdu->data_bytes + SF_BLOCK_BYTES - 1) / SF_BLOCK_BYTES * SF_BLOCK_BYTES;
    if (__builtin_add_overflow(hdu->data_offset, padded, next))
        *next = INT64_MAX;
    return *next <= r->size ? SHEAR_OK : truncated(r, h, "data", *next, err);
}

static int append(sf_hdu_index *s, const sf_hdu *hdu, shear_error *err) {
    if (s->count == MAX_HDUS) {
        return sf_fail(err, SHEAR_E_FORMAT, (sf_place){s->file, NULL}, NULL,
                       "has more than %d HDUs", MAX_HDUS);
    }
    if (!ARRAY_RESERVE(s->hdus, s->capacity, (size_t)s->count + 1))
        return sf_fail_memory(err, (sf_place){s->file, NULL});
    s->hdus[s->count++] = *hdu;
    return SHEAR_OK;
}

static bool looks_like_header(const char block[SF_BLOCK_BYTES]) {
    for (int i = 0; i < SF_BLOCK_BYTES; i += SF_CARD) {
        if (memcmp(block + i, "BITPIX  = ", 10) == 0)
            return true;
    }
    return false;
}

/* FITS allows other records behind the last HDU; only XTENSION begins another one. But an HDU whose
 * XTENSION is damaged must not be ignored silently, with the weights that it may hold. */
static int is_extension(reader *r, int64_t offset, bool *yes, shear_error *err) {
    char head[8];
    const char *block = NULL;
    const ssize_t n = pread(r->fd, head, sizeof head, (off_t)offset);
    if (n < 0)
        return sf_fail_errno(err, (sf_place){r->file, NULL}, errno, "cannot be read");
    *yes = n == (ssize_t)sizeof head && memcmp(head, "XTENSION", sizeof head) == 0;
    const int rc = *yes ? SHEAR_OK : read_block(r, offset, &block, err);
    if (rc != SHEAR_OK || block == NULL || !looks_like_header(block))
        return rc;
    return sf_fail(err, SHEAR_E_FORMAT, (sf_place){r->file, NULL},
                   "the file is damaged: copy or make it again",
                   "at byte %lld there is a header that does not begin with XTENSION",
                   (long long)offset);
}

/* Read all HDUs in order. */
static int read_all(sf_hdu_index *s, reader *r, shear_error *err) {
    int64_t offset = 0;
    bool more = true;
    while (more) {
        sf_header header;
        sf_header_init(&header, s->count);
        TRY(read_hdu(r, &header, offset, &offset, err));
        TRY(append(s, &header.hdu, err));
        TRY(is_extension(r, offset, &more, err));
    }
    return SHEAR_OK;
}

static void reader_free(reader *r) {
    if (r != NULL) {
        XXH3_freeState(r->hash);
        free(r);
    }
}

CLEANUP_DEFINE(reader, reader_free)

int sf_hdu_index_init(sf_hdu_index *s, int fd, int64_t size, const char *file, shear_error *err) {
    *s = (sf_hdu_index){.file = file};
    CLEANUP(reader_release) reader *r = calloc(1, sizeof *r);
    if (r == NULL)
        return sf_fail_memory(err, (sf_place){file, NULL});
    r->fd = fd;
    r->size = size;
    r->file = file;
    r->hash = XXH3_createState();
    return r->hash != NULL ? read_all(s, r, err) : sf_fail_memory(err, (sf_place){file, NULL});
}

void sf_hdu_index_deinit(sf_hdu_index *s) {
    free(s->hdus);
    *s = (sf_hdu_index){0};
}

static int missing(const sf_hdu_index *s, const char *name, shear_error *err) {
    char found[200] = "";
    for (int i = 1; i < s->count; i++) {
        char shown[41]; /* longer names are cut off */
        text_set(shown, sizeof shown, s->hdus[i].name[0] != '\0' ? s->hdus[i].name : "(unnamed)");
        text_append_item(found, sizeof found, shown);
    }
    return sf_fail(err, SHEAR_E_FORMAT, (sf_place){s->file, NULL},
                   "HDUs are found by EXTNAME; the file may also be truncated",
                   "has no HDU %s (its extensions: %s)", name, s->count > 1 ? found : "none");
}

int sf_hdu_index_find(const sf_hdu_index *s, const char *name, bool required, const sf_hdu **hdu,
                      shear_error *err) {
    *hdu = NULL;
    for (int i = 1; i < s->count; i++) {
        if (strcasecmp(s->hdus[i].name, name) != 0)
            continue;
        if (*hdu != NULL) {
            return sf_fail(err, SHEAR_E_FORMAT, (sf_place){s->file, name}, NULL,
                           "two HDUs (%d and %d, counted from 0) have this EXTNAME", (*hdu)->number,
                           s->hdus[i].number);
        }
        *hdu = &s->hdus[i];
    }
    return *hdu == NULL && required ? missing(s, name, err) : SHEAR_OK;
}
