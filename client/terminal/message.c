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

static enum exit_code exit_code_of(int shear_code) {
    switch (shear_code) {
    case SHEAR_OK:
        return EXIT_CODE_DONE;
    case SHEAR_E_SETTING:
        return EXIT_CODE_USAGE;
    case SHEAR_E_IO:
    case SHEAR_E_FORMAT:
    case SHEAR_E_BETA:
    case SHEAR_E_PSF:
    case SHEAR_E_NEGATIVE:
        return EXIT_CODE_INPUT;
    default:
        return EXIT_CODE_OTHER;
    }
}

enum exit_code message_error(const shear_error *err) {
    return message_fail(exit_code_of(err->code), err->advice, "%s", err->message);
}

/* Print "shearctl: KIND: ...", formatted as by vprintf. */
__attribute__((format(printf, 2, 0))) static void say(const char *kind, const char *format,
                                                      va_list args) {
    char text[1024];
    char clean[1024];
    vsnprintf(text, sizeof text, format, args);
    fprintf(stderr, "shearctl: %s: %s\n", kind, message_clean(text, clean, sizeof clean));
}

enum exit_code message_fail(enum exit_code code, const char *advice, const char *format, ...) {
    va_list args;
    va_start(args, format);
    say("error", format, args);
    va_end(args);
    if (advice != NULL && advice[0] != '\0')
        message_say("advice", "%s", advice);
    return code;
}

enum exit_code message_no_memory(void) {
    return message_fail(EXIT_CODE_OTHER, NULL, "out of memory");
}

void message_say(const char *kind, const char *format, ...) {
    va_list args;
    va_start(args, format);
    say(kind, format, args);
    va_end(args);
}
