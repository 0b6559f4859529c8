/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Read messages from JSON: numbers, names, times and strings. */
#include "base/cleanup.h"
#include "base/text.h"
#include "message/reader.h"
#include "json/text.h"

#include <inttypes.h>
#include <string.h>

static int read_bool(const msg_reader *r, bool *at, const json_t *value) {
    if (!json_is_boolean(value))
        return reader_wrong_type(r, "true or false", value);
    *at = json_is_true(value);
    return SHEARD_RPC_OK;
}

static int read_integer(const msg_reader *r, int64_t *at, const msg_member *m,
                        const json_t *value) {
    if (!json_is_integer(value))
        return reader_wrong_type(r, "a whole number", value);
    const int64_t given = json_integer_value(value);
    if (reader_is_strict(r) && (given < m->min || given > m->max)) {
        return reader_fail(r, SHEARD_RPC_BAD_PARAMETER,
                           "expected a whole number from %" PRId64 " to %" PRId64 ", not %" PRId64,
                           m->min, m->max, given);
    }
    *at = given;
    return SHEARD_RPC_OK;
}

static int read_real(const msg_reader *r, double *at, const msg_member *m, const json_t *value) {
    if (!json_is_number(value))
        return reader_wrong_type(r, "a number", value);
    const double given = json_number_value(value);
    if (reader_is_strict(r) && !(given >= (double)m->min && given <= (double)m->max)) {
        return reader_fail(r, SHEARD_RPC_BAD_PARAMETER,
                           "expected a number from %" PRId64 " to %" PRId64 ", not %g", m->min,
                           m->max, given);
    }
    *at = given;
    return SHEARD_RPC_OK;
}

/* A text with a NUL in it does not match any name. */
int reader_name_index(const char *const *names, const json_t *value) {
    const char *text = json_string_value(value);
    for (int i = 0; text != NULL && names[i] != NULL; i++) {
        if (names[i][0] != '\0' && strlen(text) == json_string_length(value) &&
            strcmp(names[i], text) == 0) {
            return i;
        }
    }
    return -1;
}

int reader_wrong_name(const msg_reader *r, const char *const *names, const json_t *value) {
    char known[200] = "";
    text_list(known, sizeof known, names + (names[0][0] == '\0')); /* "" stands for null */
    if (!json_is_string(value)) {
        return reader_fail(r, SHEARD_RPC_BAD_PARAMETER, "expected one of %s, not %s", known,
                           json_text_kind(value));
    }
    return reader_fail(r, SHEARD_RPC_BAD_PARAMETER, "expected one of %s, not \"%.60s\"", known,
                       json_string_value(value));
}

/* Read a name. An unknown name of a newer service becomes -1, "unknown"; one of a client is an
 * error. */
static int read_name(const msg_reader *r, int *at, const msg_member *m, const json_t *value) {
    *at = reader_name_index(m->names, value);
    if (*at < 0 && (reader_is_strict(r) || !json_is_string(value)))
        return reader_wrong_name(r, m->names, value);
    return SHEARD_RPC_OK;
}

static int read_time(const msg_reader *r, int64_t *at, const json_t *value) {
    if (!json_is_string(value) || !sheard_time_parse(at, json_string_value(value))) {
        return reader_fail(r, SHEARD_RPC_BAD_PARAMETER,
                           "expected a time such as \"2026-01-31T12:00:00Z\"");
    }
    return SHEARD_RPC_OK;
}

int reader_scalar(const msg_reader *r, void *at, const msg_member *m, const json_t *value) {
    switch (m->type) {
    case MSG_BOOL:
        return read_bool(r, at, value);
    case MSG_INT:
        return read_integer(r, at, m, value);
    case MSG_REAL:
        return read_real(r, at, m, value);
    case MSG_NAME:
        return read_name(r, at, m, value);
    default:
        return read_time(r, at, value);
    }
}

static bool has_control(const char *text) {
    for (; *text != '\0'; text++) {
        if ((unsigned char)*text < 0x20 || *text == 0x7F)
            return true;
    }
    return false;
}

static int check_text(const msg_reader *r, const char *text, size_t n, unsigned flags,
                      int64_t longest) {
    if (strlen(text) != n)
        return reader_fail(r, SHEARD_RPC_BAD_PARAMETER, "has a NUL character in it");
    if (!reader_is_strict(r))
        return SHEARD_RPC_OK;
    if (longest > 0 && n > (size_t)longest) {
        return reader_fail(r, SHEARD_RPC_BAD_PARAMETER,
                           "expected at most %" PRId64 " bytes, not %zu", longest, n);
    }
    if ((flags & MSG_PLAIN) != 0 && n == 0)
        return reader_fail(r, SHEARD_RPC_BAD_PARAMETER, "must not be empty");
    if ((flags & MSG_PLAIN) != 0 && has_control(text))
        return reader_fail(r, SHEARD_RPC_BAD_PARAMETER, "has a control character in it");
    if ((flags & MSG_ABSOLUTE) != 0 && text[0] != '/') {
        return reader_fail(r, SHEARD_RPC_BAD_PARAMETER,
                           "expected a path from the root (\"/data/...\"), not \"%.80s\"", text);
    }
    return SHEARD_RPC_OK;
}

int reader_string(const msg_reader *r, const char **at, unsigned flags, int64_t longest,
                  const json_t *value) {
    if (!json_is_string(value))
        return reader_wrong_type(r, "a string", value);
    const char *text = json_string_value(value);
    const size_t n = json_string_length(value);
    TRY(check_text(r, text, n, flags, longest));
    return reader_copy(r, at, text, n);
}
