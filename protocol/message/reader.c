/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "message/reader.h"

#include "base/text.h"
#include "json/text.h"

#include <assert.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

bool reader_is_strict(const msg_reader *r) {
    return (r->mode & MSG_STRICT) != 0;
}

size_t reader_enter(msg_reader *r, const char *member) {
    const size_t mark = strlen(r->path);
    text_append(r->path, sizeof r->path, "%s%.60s", mark > 0 ? "." : "", member);
    return mark;
}

size_t reader_enter_item(msg_reader *r, size_t index) {
    const size_t mark = strlen(r->path);
    text_append(r->path, sizeof r->path, "[%zu]", index);
    return mark;
}

void reader_leave(msg_reader *r, size_t mark) {
    assert(mark <= strlen(r->path));
    r->path[mark] = '\0';
}

int reader_fail(const msg_reader *r, int code, const char *format, ...) {
    char said[400];
    va_list args;
    va_start(args, format);
    vsnprintf(said, sizeof said, format, args);
    va_end(args);
    const int told = reader_is_strict(r) ? code : SHEARD_RPC_BAD_REPLY;
    return sheard_rpc_fail_parameter(r->error, told, r->path, NULL, "%s", said);
}

int reader_wrong_type(const msg_reader *r, const char *expected, const json_t *value) {
    return reader_fail(r, SHEARD_RPC_BAD_PARAMETER, "expected %s, not %s", expected,
                       json_text_kind(value));
}

int reader_no_memory(const msg_reader *r) {
    return sheard_rpc_fail(r->error, SHEARD_RPC_OUT_OF_MEMORY, NULL, "out of memory while reading");
}

int reader_copy(const msg_reader *r, const char **at, const char *bytes, size_t n) {
    *at = strndup(bytes, n);
    return *at != NULL ? SHEARD_RPC_OK : reader_no_memory(r);
}
