/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "rpc/scan.h"

#include <assert.h>
#include <string.h>

const sheard_rpc_limits sheard_rpc_request_limits = {
    .line = 65536, .depth = 8, .values = 4096, .text = 32768};
const sheard_rpc_limits sheard_rpc_reply_limits = {
    .line = 32u << 20, .depth = 16, .values = 4u << 20, .text = 32u << 20};

typedef struct scanner {
    const char *line;
    size_t at; /* the current byte */
    int depth, deepest;
    size_t values;  /* separators and openings: at least the number of members and elements */
    size_t longest; /* longest string so far */
    bool in_string, escaped;
    size_t text_at;    /* first byte of the last string */
    bool key, strange; /* the last string of the outermost object is "id"; contains an escape */
    bool id_open;      /* the id's value has begun */
} scanner;

static void end_string(scanner *s) {
    assert(s->in_string && s->at >= s->text_at);
    const size_t n = s->at - s->text_at;
    const char *text = s->line + s->text_at;
    s->in_string = false;
    s->longest = n > s->longest ? n : s->longest;
    s->key = s->depth == 1 && n == 2 && memcmp(text, "id", 2) == 0;
    s->strange = s->depth == 1 && memchr(text, '\\', n) != NULL;
}

static void in_string(scanner *s, char c) {
    if (s->escaped) {
        s->escaped = false;
    } else if (c == '\\') {
        s->escaped = true;
    } else if (c == '"') {
        end_string(s);
    }
}

static void end_id(scanner *s, rpc_scan *scan) {
    if (s->id_open && s->depth == 1) {
        scan->id_end = s->at;
        s->id_open = false;
    }
}

/* Count the names "id". A name with an escape may be "id", too: then the id is unknown. */
static void colon(scanner *s, rpc_scan *scan) {
    s->values++;
    if (s->depth == 1 && s->strange) {
        scan->n_ids += 2;
    } else if (s->depth == 1 && s->key) {
        scan->n_ids++;
        scan->id_at = s->at + 1;
        s->id_open = true;
    }
}

static void outside_string(scanner *s, rpc_scan *scan, char c) {
    switch (c) {
    case '"':
        s->in_string = true;
        s->text_at = s->at + 1;
        break;
    case '{':
    case '[':
        s->values++;
        s->depth++;
        s->deepest = s->depth > s->deepest ? s->depth : s->deepest;
        break;
    case '}':
    case ']':
        end_id(s, scan);
        s->depth -= s->depth > 0;
        break;
    case ',':
        s->values++;
        end_id(s, scan);
        break;
    case ':':
        colon(s, scan);
        break;
    default:
        break;
    }
}

static int check_limits(const scanner *s, const sheard_rpc_limits *limits,
                        sheard_rpc_error *error) {
    if (s->deepest > limits->depth) {
        return sheard_rpc_fail(error, SHEARD_RPC_TOO_COMPLEX, NULL,
                               "objects and arrays are %d deep; at most %d are accepted",
                               s->deepest, limits->depth);
    }
    if (s->values > limits->values) {
        return sheard_rpc_fail(error, SHEARD_RPC_TOO_COMPLEX, NULL,
                               "there are %zu members and elements; at most %zu are accepted",
                               s->values, limits->values);
    }
    const size_t longest =
        s->in_string && s->at - s->text_at > s->longest ? s->at - s->text_at : s->longest;
    if (longest > limits->text) {
        return sheard_rpc_fail(error, SHEARD_RPC_TOO_COMPLEX, NULL,
                               "a string has %zu bytes; at most %zu are accepted", longest,
                               limits->text);
    }
    return SHEARD_RPC_OK;
}

int rpc_scan_line(rpc_scan *scan, const char *line, size_t n, const sheard_rpc_limits *limits,
                  sheard_rpc_error *error) {
    *scan = (rpc_scan){0};
    if (n > limits->line) {
        return sheard_rpc_fail(error, SHEARD_RPC_LINE_TOO_LONG, NULL,
                               "%zu bytes; at most %zu are accepted", n, limits->line);
    }
    if (memchr(line, '\0', n) != NULL)
        return sheard_rpc_fail(error, SHEARD_RPC_NUL_BYTE, NULL, "there is a NUL byte in the text");
    scanner s = {.line = line};
    for (; s.at < n; s.at++) {
        if (s.in_string) {
            in_string(&s, line[s.at]);
        } else {
            outside_string(&s, scan, line[s.at]);
        }
    }
    return check_limits(&s, limits, error);
}
