/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Read lines on behalf of inih, and find what it ignores. inih reports values, but neither lines
 * nor sections, and only the first bad line. So next_line examines each line before inih reads it,
 * and settle checks that it had the expected effect. */
#include "ini_text.h"

#include <assert.h>
#include <ctype.h>
#include <ini.h>
#include <stdio.h>
#include <string.h>

struct reader {
    const char *at, *end;
    int line;
    bool indented; /* the line begins with white space */
    bool has_key;  /* this section has a key already: an indented line continues it */
    bool expects;  /* the line should become a value */
    const ini_events *events;
};

static void fault(const struct reader *r, const char *advice, const char *message) {
    r->events->fault(r->events->context, r->line, advice, message);
}

/* Report the last line if it should have become a value and did not: it has no '='. */
static void settle(struct reader *r) {
    if (r->expects)
        fault(r, "write key = value; comments begin with '#' or ';'", "this line has no '='");
    r->expects = false;
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
        bool line_end = p[i] == '\r' && i + 1 == n;
        if (iscntrl((unsigned char)p[i]) && p[i] != '\t' && !line_end)
            return true;
    }
    return false;
}

/* Report the section of the line p[0..n), which begins with '[', and its faults. */
static void read_section(struct reader *r, const char *p, size_t n) {
    char name[64];
    const char *close = memchr(p, ']', n);
    const char *first = p + 1 + leading_blanks(p + 1, n - 1);
    const char *last = close != NULL ? close : p + n;
    while (last > first && is_blank(last[-1]))
        last--;
    snprintf(name, sizeof name, "%.*s", (int)(last - first), first);
    if (close == NULL) {
        fault(r, "write [section]", "this section has no ']'");
    } else {
        const char *rest = close + 1;
        rest += leading_blanks(rest, (size_t)(p + n - rest));
        if (rest < p + n && *rest != ';' && *rest != '#')
            fault(r, "settings go on lines of their own", "there is text after the section's ']'");
    }
    r->has_key = false;
    r->events->section(r->events->context, r->line, name);
}

enum kind { LINE_EMPTY, LINE_SECTION, LINE_VALUE };

/* Determine the kind of the line p[0..n) and report its faults. inih takes at most `most` bytes. */
static enum kind examine(struct reader *r, const char *p, size_t n, size_t most) {
    size_t i = leading_blanks(p, n);
    r->indented = i > 0;
    bool empty = i == n || p[i] == '#' || p[i] == ';';
    if (empty && memchr(p, '\0', n) == NULL)
        return LINE_EMPTY;
    if (has_control(p, n)) {
        fault(r, "is this a text file?", "this line has control characters");
        return LINE_EMPTY;
    }
    if (n > most) {
        char message[96];
        snprintf(message, sizeof message, "this line has %zu bytes; at most %zu are possible", n,
                 most);
        fault(r, "a list may go on in further lines that begin with a space", message);
        return LINE_EMPTY;
    }
    if (p[i] == '[' && !(r->indented && r->has_key)) {
        read_section(r, p + i, n - i);
        return LINE_SECTION;
    }
    return LINE_VALUE;
}

/* Read the next line for inih, like fgets. Each section line becomes "[x]", so that inih accepts
 * it. */
static char *next_line(char *buf, int size, void *stream) {
    struct reader *r = stream;
    settle(r);
    if (r->at == r->end || size < 8)
        return NULL;
    const char *newline = memchr(r->at, '\n', (size_t)(r->end - r->at));
    const char *p = r->at;
    size_t n = (size_t)((newline != NULL ? newline : r->end) - p);
    r->at = newline != NULL ? newline + 1 : r->end;
    r->line++;
    enum kind kind = examine(r, p, n, (size_t)size - 2);
    r->expects = kind == LINE_VALUE;
    if (kind == LINE_VALUE) {
        snprintf(buf, (size_t)size, "%.*s\n", (int)n, p);
    } else {
        snprintf(buf, (size_t)size, "%s", kind == LINE_SECTION ? "[x]\n" : "\n");
    }
    return buf;
}

/* Remove the comment from a further line of a value, where inih leaves it. */
static void cut_comment(char *text) {
    size_t end = strlen(text);
    for (size_t i = 0; text[i] != '\0'; i++) {
        if (text[i] == ';' && (i == 0 || is_blank(text[i - 1]))) {
            end = i;
            break;
        }
    }
    while (end > 0 && is_blank(text[end - 1]))
        end--;
    text[end] = '\0';
}

static bool has_hash_comment(const char *value) {
    for (const char *p = value; (p = strchr(p, '#')) != NULL; p++) {
        if (p == value || is_blank(p[-1]))
            return true;
    }
    return false;
}

/* Pass a value on; inih's handler. */
static int on_value(void *user, const char *section, const char *key, const char *value) {
    struct reader *r = user;
    (void)section;
    bool continued = r->indented && r->has_key;
    char text[512];
    snprintf(text, sizeof text, "%s", value);
    if (continued)
        cut_comment(text);
    r->expects = false;
    r->has_key = key[0] != '\0';
    if (has_hash_comment(text)) {
        fault(r, "begin the comment with ' ;', or put it on a line of its own",
              "'#' does not begin a comment after a value");
    } else if (key[0] == '\0') {
        fault(r, "write key = value", "there is no key before the '='");
    } else {
        r->events->value(r->events->context, r->line, key, text, continued);
    }
    return 1;
}

int ini_text_read(const char *text, size_t size, const ini_events *events, shear_error *err) {
    static const char mark[] = "\xef\xbb\xbf";
    size_t skip = size >= 3 && memcmp(text, mark, 3) == 0 ? 3 : 0;
    struct reader r = {.at = text + skip, .end = text + size, .events = events};
    int code = ini_parse_stream(next_line, &r, on_value, &r);
    if (code == -2)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for reading the configuration");
    return SHEAR_OK;
}
