/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/sources/text_lines.h"

#include "base/cleanup.h"
#include "base/io.h"

#include <errno.h>
#include <string.h>

int text_lines_init(text_lines *l, int fd, sf_place at, size_t longest, shear_error *err) {
    *l = (text_lines){.fd = fd, .at = at, .capacity = longest + 1};
    l->bytes = malloc(l->capacity + 1);
    return l->bytes != NULL ? SHEAR_OK : sf_fail_memory(err, at);
}

void text_lines_deinit(text_lines *l) {
    free(l->bytes);
    l->bytes = NULL;
}

void text_lines_rewind(text_lines *l) {
    l->offset = 0;
    l->begin = l->end = 0;
    l->at_end = false;
    l->number = 0;
}

/* Move what is left to the front, and fill the rest from the file. */
static int refill(text_lines *l, shear_error *err) {
    memmove(l->bytes, l->bytes + l->begin, l->end - l->begin);
    l->end -= l->begin;
    l->begin = 0;
    const ssize_t n = io_read_at(l->fd, l->bytes + l->end, l->capacity - l->end, (off_t)l->offset);
    if (n < 0)
        return sf_fail_errno(err, l->at, errno, "cannot be read");
    l->at_end = (size_t)n < l->capacity - l->end;
    l->end += (size_t)n;
    l->offset += n;
    return SHEAR_OK;
}

static char *newline(const text_lines *l) {
    return memchr(l->bytes + l->begin, '\n', l->end - l->begin);
}

int text_lines_next(text_lines *l, char **line, shear_error *err) {
    *line = NULL;
    char *end = newline(l);
    if (end == NULL && !l->at_end) {
        TRY(refill(l, err));
        end = newline(l);
    }
    if (l->begin == l->end)
        return SHEAR_OK;
    l->number++;
    if (end == NULL && !l->at_end) {
        return sf_fail(err, SHEAR_E_FORMAT, l->at, "give a catalog of SExtractor, or a FITS table",
                       "line %lld is longer than %zu bytes", (long long)l->number, l->capacity - 1);
    }
    end = end != NULL ? end : l->bytes + l->end;
    char *text = l->bytes + l->begin;
    if (memchr(text, '\0', (size_t)(end - text)) != NULL) {
        return sf_fail(err, SHEAR_E_FORMAT, l->at, "give a catalog of SExtractor, or a FITS table",
                       "line %lld has a zero byte: it is no text", (long long)l->number);
    }
    l->begin = (size_t)(end - l->bytes) + (end < l->bytes + l->end ? 1 : 0);
    *end = '\0';
    *line = text;
    return SHEAR_OK;
}
