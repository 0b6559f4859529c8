/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "sheard/frame.h"

#include "base/array.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

/* Bytes that an idle connection keeps. */
enum { SMALL = 4096 };

void sheard_frame_init(sheard_frame *f, size_t limit) {
    assert(limit >= 1);
    *f = (sheard_frame){.limit = limit};
}

void sheard_frame_deinit(sheard_frame *f) {
    free(f->kept);
    *f = (sheard_frame){.limit = f->limit};
}

size_t sheard_frame_pending(const sheard_frame *f) {
    return f->delivered ? 0 : f->used;
}

static void reset(sheard_frame *f) {
    f->used = 0;
    f->delivered = false;
    if (f->size > SMALL) {
        free(f->kept);
        f->kept = NULL;
        f->size = 0;
    }
}

/* Enlarge `kept` by doubling, up to the limit, so that a line that arrives byte by byte costs time
 * in proportion to its length. */
static enum sheard_frame_event reserve(sheard_frame *f, size_t n) {
    assert(n <= f->limit);
    if (n <= f->size)
        return SHEARD_FRAME_MORE;
    const size_t wanted = array_next_capacity(f->size, n, 1);
    const size_t size = wanted < f->limit ? wanted : f->limit;
    char *larger = realloc(f->kept, size);
    if (larger == NULL)
        return SHEARD_FRAME_NOMEM;
    f->kept = larger;
    f->size = size;
    return SHEARD_FRAME_MORE;
}

/* Return the fault of the line that continues with these n bytes, or SHEARD_FRAME_MORE. The first
 * wrong byte decides, so that the result does not depend on the pieces. */
static enum sheard_frame_event first_fault(const sheard_frame *f, const char *bytes, size_t n) {
    assert(f->used <= f->size && f->size <= f->limit);
    const size_t left = f->limit - f->used;
    const char *nul = memchr(bytes, '\0', n < left ? n : left);
    return nul != NULL ? SHEARD_FRAME_NUL : n > left ? SHEARD_FRAME_TOO_LONG : SHEARD_FRAME_MORE;
}

static enum sheard_frame_event append(sheard_frame *f, const char *bytes, size_t n) {
    const enum sheard_frame_event event = reserve(f, f->used + n);
    if (event == SHEARD_FRAME_MORE) {
        memcpy(f->kept + f->used, bytes, n);
        f->used += n;
    }
    return event;
}

/* End a line, which may begin in `kept`, with these n bytes. An empty line is not an event. */
static enum sheard_frame_event end_line(sheard_frame *f, const char *bytes, size_t n,
                                        const char **line, size_t *length) {
    *line = bytes;
    *length = n;
    if (f->used > 0) {
        const enum sheard_frame_event event = n > 0 ? append(f, bytes, n) : SHEARD_FRAME_MORE;
        if (event != SHEARD_FRAME_MORE)
            return event;
        *line = f->kept;
        *length = f->used;
        f->delivered = true;
    }
    if (*length > 0 && (*line)[*length - 1] == '\r')
        --*length;
    return *length > 0 ? SHEARD_FRAME_LINE : SHEARD_FRAME_MORE;
}

/* Add n bytes of one line; `ended` means that \n follows. */
static enum sheard_frame_event add_bytes(sheard_frame *f, const char *bytes, size_t n, bool ended,
                                         const char **line, size_t *length) {
    if (f->skipping) {
        f->skipping = !ended;
        return SHEARD_FRAME_MORE;
    }
    enum sheard_frame_event event = first_fault(f, bytes, n);
    if (event == SHEARD_FRAME_MORE) {
        event = ended   ? end_line(f, bytes, n, line, length)
                : n > 0 ? append(f, bytes, n)
                        : SHEARD_FRAME_MORE;
    }
    if (event != SHEARD_FRAME_MORE && event != SHEARD_FRAME_LINE) {
        reset(f);
        f->skipping = !ended;
    }
    return event;
}

enum sheard_frame_event sheard_frame_next(sheard_frame *f, const char **input, size_t *n,
                                          const char **line, size_t *length) {
    *line = NULL;
    *length = 0;
    for (;;) {
        if (f->delivered)
            reset(f);
        if (*n == 0)
            return SHEARD_FRAME_MORE;
        const char *bytes = *input;
        const char *newline = memchr(bytes, '\n', *n);
        const size_t taken = newline != NULL ? (size_t)(newline - bytes) : *n;
        *input += taken + (newline != NULL);
        *n -= taken + (newline != NULL);
        const enum sheard_frame_event event =
            add_bytes(f, bytes, taken, newline != NULL, line, length);
        if (event != SHEARD_FRAME_MORE)
            return event;
    }
}
