/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "plot/text.h"

#include <ctype.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

enum { TEXT_SIZE = 256 }; /* before minus signs are replaced, which makes text longer */

/* Return whether the hyphen is a minus sign, not inside a word ("log-bicubic"). */
static bool is_minus(const char *text, size_t i) {
    const bool begins = i == 0 || !isalnum((unsigned char)text[i - 1]) || text[i - 1] == 'e';
    return text[i] == '-' && begins && isdigit((unsigned char)text[i + 1]);
}

static void copy_with_minus(char *buf, size_t size, const char *text) {
    static const char minus[] = "\xe2\x88\x92";
    size_t used = 0;
    for (size_t i = 0; text[i] != '\0' && used + sizeof minus < size; i++) {
        if (is_minus(text, i)) {
            memcpy(buf + used, minus, sizeof minus - 1);
            used += sizeof minus - 1;
        } else {
            buf[used++] = text[i];
        }
    }
    buf[used] = '\0';
}

__attribute__((format(printf, 3, 0))) static void print_args(char *buf, size_t size,
                                                             const char *format, va_list args) {
    char text[TEXT_SIZE];
    vsnprintf(text, sizeof text, format, args);
    copy_with_minus(buf, size, text);
}

char *plot_print(char *buf, size_t size, const char *format, ...) {
    va_list args;
    va_start(args, format);
    print_args(buf, size, format, args);
    va_end(args);
    return buf;
}

void plot_table_add(plot_table *t, const char *key, const char *format, ...) {
    if (t->n == PLOT_TABLE_ROWS)
        return;
    va_list args;
    va_start(args, format);
    print_args(t->values[t->n], sizeof t->values[0], format, args);
    va_end(args);
    snprintf(t->keys[t->n], sizeof t->keys[0], "%s", key);
    t->n++;
}

void plot_table_draw(const plot_table *t, shear_figure *f, shear_rect cell, const char *title) {
    const char *keys[PLOT_TABLE_ROWS];
    const char *values[PLOT_TABLE_ROWS];
    for (int i = 0; i < t->n; i++) {
        keys[i] = t->keys[i];
        values[i] = t->values[i];
    }
    shear_figure_table(f, cell, title, t->n, keys, values);
}
