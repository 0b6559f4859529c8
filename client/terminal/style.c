/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "terminal/style.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>
#include <wchar.h>

enum { MIN_COLUMNS = 20, MAX_COLUMNS = 400 };

bool style_is_terminal(int fd) {
    const char *term = getenv("TERM");
    return isatty(fd) != 0 && term != NULL && strcmp(term, "dumb") != 0;
}

bool style_on(FILE *out) {
    const char *no_color = getenv("NO_COLOR");
    return style_is_terminal(fileno(out)) && (no_color == NULL || no_color[0] == '\0');
}

static int clamp_columns(int n) {
    return n < MIN_COLUMNS ? MIN_COLUMNS : n > MAX_COLUMNS ? MAX_COLUMNS : n;
}

int style_columns(int fd, int otherwise) {
    struct winsize size;
    return ioctl(fd, TIOCGWINSZ, &size) != 0 || size.ws_col == 0 ? otherwise
                                                                 : clamp_columns(size.ws_col);
}

int style_rows(int fd, int otherwise) {
    struct winsize size;
    return ioctl(fd, TIOCGWINSZ, &size) != 0 || size.ws_row == 0 ? otherwise : size.ws_row;
}

/* Return the length of the escape sequence at the start of `text` in bytes; 0: there is none. */
static size_t escape_length(const char *text) {
    if (text[0] != '\x1b' || text[1] != '[')
        return 0;
    size_t n = 2;
    while (text[n] != '\0' && (text[n] < '@' || text[n] > '~'))
        n++;
    return text[n] != '\0' ? n + 1 : n;
}

/* Return the bytes of the first character of `text`, and its columns in *columns. */
static size_t step(const char *text, int *columns) {
    wchar_t c = 0;
    mbstate_t state = {0};
    const size_t n = mbrtowc(&c, text, MB_CUR_MAX, &state);
    if (n == 0 || n > MB_CUR_MAX) {
        *columns = 1;
        return 1;
    }
    const int width = wcwidth(c);
    *columns = width < 0 ? 1 : width;
    return n;
}

/* Return the bytes of `text` that fit into `columns`, and the columns that they take in *taken. */
static size_t fit(const char *text, int columns, int *taken) {
    size_t at = 0;
    *taken = 0;
    while (text[at] != '\0') {
        const size_t escape = escape_length(text + at);
        int width = 0;
        const size_t n = escape != 0 ? escape : step(text + at, &width);
        if (width > columns - *taken)
            break;
        *taken += width;
        at += n;
    }
    return at;
}

size_t style_fit(const char *text, int columns) {
    int taken = 0;
    return fit(text, columns, &taken);
}

int style_width(const char *text) {
    int taken = 0;
    fit(text, INT_MAX, &taken);
    return taken;
}
