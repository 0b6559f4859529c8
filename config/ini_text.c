/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "ini_text.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

struct reader {
    int line;
    bool has_key; /* this section has a key already: an indented line continues it */
    const ini_events *events;
};

static void fault(const struct reader *r, const char *advice, const char *message) {
    r->events->fault(r->events->context, r->line, advice, message);
}

static bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\r';
}

static size_t leading_blanks(const char *p, size_t n) {
    size_t i = 0;
    while (i < n && is_blank(p[i]))
        i++;
    return i;
}

static bool has_control(const char *p, size_t n) {
    for (size_t i = 0; i < n; i++) {
        const bool line_end = p[i] == '\r' && i + 1 == n;
        if (iscntrl((unsigned char)p[i]) && p[i] != '\t' && !line_end)
            return true;
    }
    return false;
}

/* Return the text without white space at its ends; it is cut. */
static char *trim(char *text) {
    size_t n = strlen(text);
    while (n > 0 && is_blank(text[n - 1]))
        n--;
    text[n] = '\0';
    return text + leading_blanks(text, n);
}

/* Return the first of `stops` in the text, or the ';' of a comment, or the end. */
static char *find(char *text, const char *stops) {
    char *p = text;
    while (*p != '\0' && strchr(stops, *p) == NULL && !(*p == ';' && p > text && is_blank(p[-1])))
        p++;
    return p;
}

static bool has_hash_comment(const char *value) {
    for (const char *p = value; (p = strchr(p, '#')) != NULL; p++) {
        if (p == value || is_blank(p[-1]))
            return true;
    }
    return false;
}

/* Read a line that begins with '['. */
static void read_section(struct reader *r, char *text) {
    char *close = strchr(text, ']');
    if (close == NULL) {
        fault(r, "write [section]", "this section has no ']'");
    } else {
        *close = '\0';
        const char *rest = trim(close + 1);
        if (*rest != '\0' && *rest != ';' && *rest != '#')
            fault(r, "settings go on lines of their own", "there is text after the section's ']'");
    }
    r->has_key = false;
    r->events->section(r->events->context, r->line, trim(text + 1));
}

/* Read "key = value", or with key NULL the value alone. */
static void read_value(struct reader *r, const char *key, char *value) {
    *find(value, "") = '\0';
    value = trim(value);
    if (has_hash_comment(value)) {
        fault(r, "begin the comment with ' ;', or put it on a line of its own",
              "'#' does not begin a comment after a value");
    } else if (key != NULL && key[0] == '\0') {
        fault(r, "write key = value", "there is no key before the '='");
    } else {
        r->events->value(r->events->context, r->line, key, value);
    }
}

/* Read a line that begins with a key. */
static void read_key(struct reader *r, char *text) {
    char *equals = find(text, "=:");
    if (*equals != '=' && *equals != ':') {
        fault(r, "write key = value; comments begin with '#' or ';'", "this line has no '='");
        return;
    }
    *equals = '\0';
    const char *key = trim(text);
    r->has_key = key[0] != '\0';
    read_value(r, key, equals + 1);
}

/* Read the line p[0..n). */
static void read_line(struct reader *r, const char *p, size_t n) {
    char text[INI_LINE_MAX + 1];
    const size_t indent = leading_blanks(p, n);
    const bool empty = indent == n || p[indent] == '#' || p[indent] == ';';
    if (empty && memchr(p, '\0', n) == NULL)
        return;
    if (has_control(p, n)) {
        fault(r, "is this a text file?", "this line has control characters");
        return;
    }
    if (n > INI_LINE_MAX) {
        snprintf(text, sizeof text, "this line has %zu bytes; at most %d are possible", n,
                 INI_LINE_MAX);
        fault(r, "a list may go on in further lines that begin with a space", text);
        return;
    }
    snprintf(text, sizeof text, "%.*s", (int)(n - indent), p + indent);
    if (indent > 0 && r->has_key) {
        read_value(r, NULL, text);
    } else if (text[0] == '[') {
        read_section(r, text);
    } else {
        read_key(r, text);
    }
}

void ini_text_read(const char *text, size_t size, const ini_events *events) {
    static const char mark[] = "\xef\xbb\xbf";
    const char *end = text + size;
    struct reader r = {.events = events};
    if (size >= 3 && memcmp(text, mark, 3) == 0)
        text += 3;
    while (text < end) {
        const char *newline = memchr(text, '\n', (size_t)(end - text));
        const char *line_end = newline != NULL ? newline : end;
        r.line++;
        read_line(&r, text, (size_t)(line_end - text));
        text = newline != NULL ? newline + 1 : end;
    }
}
