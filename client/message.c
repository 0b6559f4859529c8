/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "message.h"

#include <stdio.h>

char *message_clean(const char *text, char *buf, size_t size) {
    size_t i = 0;
    for (; text[i] && i + 1 < size; i++) {
        unsigned char c = (unsigned char)text[i];
        buf[i] = text[i];
        if (c < 0x20 || c == 0x7F) {
            buf[i] = '?';
        }
    }
    buf[i] = '\0';
    return buf;
}

static void say(const char *kind, const char *text) {
    char clean[1024];
    fprintf(stderr, "shearctl: %s: %s\n", kind, message_clean(text, clean, sizeof clean));
}

void message_error(const shear_error *err) {
    say("error", err->message);
    if (err->advice[0]) {
        say("advice", err->advice);
    }
}

void message_fail(const char *hint, const char *format, ...) {
    char text[1024];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    say("error", text);
    if (hint) {
        say("advice", hint);
    }
}

void message_warning(const char *format, ...) {
    char text[1024];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    say("warning", text);
}

void message_note(const char *format, ...) {
    char text[1024];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    say("note", text);
}
