/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fits/header/file.h"

#include "base/array.h"
#include "base/cleanup.h"
#include "base/io.h"
#include "base/text.h"
#include "fits/header/card.h"
#include "fits/header/header.h"

#include <errno.h>
#include <string.h>
#include <strings.h>

/* More than any field file has. They bound the time that a malicious file can take. */
enum { MAX_HDUS = 1000, MAX_HEADER_BLOCKS = 4096 };

/* Read the block at `offset`; *n is less than its size if the file ends before the block does. */
static int read_block(const sf_file *f, int64_t offset, char block[SF_BLOCK_BYTES], ssize_t *n,
                      shear_error *err) {
    *n = io_read_at(f->source.fd, block, SF_BLOCK_BYTES, (off_t)offset);
    return *n >= 0 ? SHEAR_OK
                   : sf_fail_errno(err, (sf_place){f->source.name, NULL}, errno, "cannot be read");
}

int64_t sf_padded(int64_t bytes) {
    return (bytes + SF_BLOCK_BYTES - 1) / SF_BLOCK_BYTES * SF_BLOCK_BYTES;
}

static int truncated(const sf_file *f, const sf_header *h, const char *part, int64_t needed,
                     shear_error *err) {
    return sf_fail(err, SHEAR_E_FORMAT, (sf_place){f->source.name, h->label},
                   "the file is truncated, or its header is wrong: copy or make it again",
                   "its %s would end at byte %lld, but the file has %lld bytes", part,
                   (long long)needed, (long long)f->source.size);
}

/* Read the cards of the header at `offset`, up to END, and set the place and hash of its blocks. */
static int read_cards(const sf_file *f, sf_header *h, int64_t offset, shear_error *err) {
    sf_hdu *hdu = &h->hdu;
    hdu->header_offset = offset;
    for (int blocks = 0; !h->ended; blocks++) {
        char block[SF_BLOCK_BYTES];
        ssize_t n = 0;
        TRY(read_block(f, offset + hdu->header_bytes, block, &n, err));
        hdu->header_bytes += SF_BLOCK_BYTES;
        if (n < SF_BLOCK_BYTES)
            return truncated(f, h, "header (no END card so far)", offset + hdu->header_bytes, err);
        if (blocks == MAX_HEADER_BLOCKS) {
            return sf_fail(err, SHEAR_E_FORMAT, (sf_place){f->source.name, h->label}, NULL,
                           "its header has more than %d cards without an END",
                           MAX_HEADER_BLOCKS * (SF_BLOCK_BYTES / SF_CARD));
        }
        hdu->header_hash = sf_header_hash(hdu->header_hash, block);
        TRY(sf_header_block(h, block, err));
    }
    hdu->data_offset = offset + hdu->header_bytes;
    return SHEAR_OK;
}

/* Read the HDU at `offset`; *next becomes the offset behind its data. */
static int read_hdu(const sf_file *f, sf_header *h, int64_t offset, int64_t *next,
                    shear_error *err) {
    const sf_hdu *hdu = &h->hdu;
    TRY(read_cards(f, h, offset, err));
    TRY(sf_header_end(h, err));
    if (__builtin_add_overflow(hdu->data_offset, sf_padded(hdu->data_bytes), next))
        *next = INT64_MAX;
    return *next <= f->source.size ? SHEAR_OK : truncated(f, h, "data", *next, err);
}

static int append(sf_file *f, const sf_hdu *hdu, shear_error *err) {
    const sf_place at = {f->source.name, NULL};
    if (f->count == MAX_HDUS)
        return sf_fail(err, SHEAR_E_FORMAT, at, NULL, "has more than %d HDUs", MAX_HDUS);
    if (!ARRAY_RESERVE(f->hdus, f->capacity, (size_t)f->count + 1))
        return sf_fail_memory(err, at);
    f->hdus[f->count++] = *hdu;
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
static int is_extension(const sf_file *f, int64_t offset, bool *yes, shear_error *err) {
    char block[SF_BLOCK_BYTES];
    ssize_t n = 0;
    TRY(read_block(f, offset, block, &n, err));
    *yes = n >= SF_KEY && memcmp(block, "XTENSION", SF_KEY) == 0;
    if (*yes || n < SF_BLOCK_BYTES || !looks_like_header(block))
        return SHEAR_OK;
    return sf_fail(err, SHEAR_E_FORMAT, (sf_place){f->source.name, NULL},
                   "the file is damaged: copy or make it again",
                   "at byte %lld there is a header that does not begin with XTENSION",
                   (long long)offset);
}

int sf_file_open(sf_file *f, const char *path, int fd, shear_error *err) {
    int64_t offset = 0;
    bool more = true;
    *f = (sf_file){0};
    TRY(sf_source_open(&f->source, path, fd, err));
    while (more) {
        sf_header header;
        sf_header_init(&header, f->count, f->source.name);
        TRY(read_hdu(f, &header, offset, &offset, err));
        TRY(append(f, &header.hdu, err));
        TRY(is_extension(f, offset, &more, err));
    }
    return SHEAR_OK;
}

void sf_file_close(sf_file *f) {
    free(f->hdus);
    sf_source_close(&f->source);
}

static int missing(const sf_file *f, const char *name, shear_error *err) {
    char found[200] = "";
    for (int i = 1; i < f->count; i++) {
        char shown[41]; /* longer names are cut off */
        text_set(shown, sizeof shown, f->hdus[i].name[0] != '\0' ? f->hdus[i].name : "(unnamed)");
        text_append_item(found, sizeof found, shown);
    }
    return sf_fail(
        err, SHEAR_E_FORMAT, (sf_place){f->source.name, NULL},
        strcmp(name, "GALAXY") == 0
            ? "HDUs are found by EXTNAME; the file may also be truncated; an exposure is "
              "given as --image, with --sources and --psf"
            : "HDUs are found by EXTNAME; the file may also be truncated",
        "has no HDU %s (its extensions: %s)", name, f->count > 1 ? found : "none");
}

int sf_file_find(const sf_file *f, const char *name, bool required, const sf_hdu **hdu,
                 shear_error *err) {
    *hdu = NULL;
    for (int i = 1; i < f->count; i++) {
        if (strcasecmp(f->hdus[i].name, name) != 0)
            continue;
        if (*hdu != NULL) {
            return sf_fail(err, SHEAR_E_FORMAT, (sf_place){f->source.name, name}, NULL,
                           "two HDUs (%d and %d, counted from 0) have this EXTNAME", (*hdu)->number,
                           f->hdus[i].number);
        }
        *hdu = &f->hdus[i];
    }
    return *hdu == NULL && required ? missing(f, name, err) : SHEAR_OK;
}
