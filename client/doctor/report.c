/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Output of a check's results, as lines of text or as JSON. */
#include "doctor/internal.h"

#include "base/cleanup.h"
#include "terminal/message.h"
#include "terminal/style.h"

#include <stdarg.h>

static void print_line(const sheard_check_result *r) {
    static const char *const names[] = {"OK", "WARN", "FAIL"};
    static const char *const styles[] = {STYLE_GOOD, STYLE_DOUBT, STYLE_BAD};
    const bool colours = style_on(stdout);
    char text[1200];
    printf("%s%-4s%s  %-11s  %s\n", colours ? styles[r->level] : "", names[r->level],
           colours ? STYLE_END : "", r->subject, message_clean(r->message, text, sizeof text));
    if (r->remedy[0] != '\0')
        printf("%19s%s\n", "-> ", message_clean(r->remedy, text, sizeof text));
    fflush(stdout);
}

static void print_json(const sheard_check_result *r) {
    CLEANUP(release_free) char *text = NULL;
    shear_error err = {0};
    if (sheard_check_result_json(&text, r, &err) != SHEAR_OK) {
        message_error(&err);
        return;
    }
    puts(text);
}

void doctor_report(doctor *d, const char *subject, enum sheard_check_level level,
                   const char *remedy, const char *format, ...) {
    char message[1024];
    va_list args;
    va_start(args, format);
    vsnprintf(message, sizeof message, format, args);
    va_end(args);
    const bool wrong = level != SHEARD_CHECK_OK && remedy != NULL;
    const sheard_check_result result = {subject, level, message, wrong ? remedy : ""};
    d->worst = level > d->worst ? level : d->worst;
    if (d->service.json) {
        print_json(&result);
    } else {
        print_line(&result);
    }
}
