/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "doctor/conf_text.h"

#include "base/text.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

static const char *next_line(const char *line) {
    const char *end = strchr(line, '\n');
    return end != NULL ? end + 1 : line + strlen(line);
}

/* Return whether the line is "[section]". */
static bool is_section(const char *line, const char *section) {
    const size_t n = strlen(section);
    return line[0] == '[' && strncmp(line + 1, section, n) == 0 && line[1 + n] == ']';
}

/* Return the text after "key =" in the line, or NULL. */
static const char *value_of(const char *line, const char *key) {
    const size_t n = strlen(key);
    if (strncmp(line, key, n) != 0)
        return NULL;
    line += n + strspn(line + n, " ");
    return *line == '=' ? line + 1 : NULL;
}

/* Collect the rest of the line and the following lines that begin with a space, each trimmed. */
static char *collect(const char *at) {
    const size_t size = strlen(at) + 2;
    char *value = calloc(1, size);
    while (value != NULL) {
        at += strspn(at, " ");
        size_t n = strcspn(at, "\n");
        const char *next = next_line(at);
        while (n > 0 && at[n - 1] == ' ')
            n--;
        text_append(value, size, "%s%.*s", value[0] != '\0' && n > 0 ? " " : "", (int)n, at);
        if (*next != ' ')
            break;
        at = next;
    }
    return value;
}

char *conf_text_value(const char *text, const char *section, const char *key) {
    bool inside = false;
    for (const char *line = text; *line != '\0'; line = next_line(line)) {
        if (*line == '[')
            inside = is_section(line, section);
        const char *value = inside ? value_of(line, key) : NULL;
        if (value != NULL)
            return collect(value);
    }
    return NULL;
}
