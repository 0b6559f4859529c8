/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "terminal/message.h"

#include "shear/text.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

/* Replace non-ASCII bytes: a terminal without UTF-8 takes them for other letters or control
 * characters. */
static void only_ascii(char *text) {
    char *out = text;
    for (const char *c = text; *c != '\0';) {
        const size_t n = shear_text_shown(c);
        *out++ = '?';
        if (n == 1)
            out[-1] = *c;
        c += n > 0 ? n : 1;
    }
    *out = '\0';
}

char *message_clean(const char *text, char *buf, size_t size) {
    shear_text_clean(text, buf, size);
    if (MB_CUR_MAX == 1)
        only_ascii(buf);
    return buf;
}

static void say(const char *kind, const char *text) {
    char clean[1024];
    fprintf(stderr, "shearctl: %s: %s\n", kind, message_clean(text, clean, sizeof clean));
}

void message_error(const shear_error *err) {
    say("error", err->message);
    if (err->advice[0] != '\0')
        say("advice", err->advice);
}

enum exit_code message_no_memory(void) {
    message_fail(NULL, "out of memory");
    return EXIT_CODE_OTHER;
}

/* Print "shearctl: KIND: ...", formatted as by vprintf. */
__attribute__((format(printf, 2, 0))) static void say_formatted(const char *kind,
                                                                const char *format, va_list args) {
    char text[1024];
    vsnprintf(text, sizeof text, format, args);
    say(kind, text);
}

void message_fail(const char *hint, const char *format, ...) {
    va_list args;
    va_start(args, format);
    say_formatted("error", format, args);
    va_end(args);
    if (hint != NULL)
        say("advice", hint);
}

void message_warning(const char *format, ...) {
    va_list args;
    va_start(args, format);
    say_formatted("warning", format, args);
    va_end(args);
}

void message_note(const char *format, ...) {
    va_list args;
    va_start(args, format);
    say_formatted("note", format, args);
    va_end(args);
}
