/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "cmdline/options.h"

#include "terminal/message.h"

#include <errno.h>
#include <inttypes.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

enum { NAME_MAX_LENGTH = 48, NEAR = 3 };

static int min3(int a, int b, int c) {
    int ab = a < b ? a : b;
    return ab < c ? ab : c;
}

/* Levenshtein's distance; names that are too long to be a slip of the finger are far. */
static int distance(const char *a, const char *b) {
    int row[NAME_MAX_LENGTH + 1];
    int n = (int)strnlen(b, NAME_MAX_LENGTH + 1);
    if (n > NAME_MAX_LENGTH || strnlen(a, NAME_MAX_LENGTH + 1) > NAME_MAX_LENGTH) {
        return NAME_MAX_LENGTH;
    }
    for (int j = 0; j <= n; j++) {
        row[j] = j;
    }
    for (int i = 1; a[i - 1]; i++) {
        int diagonal = row[0];
        row[0] = i;
        for (int j = 1; j <= n; j++) {
            int above = row[j];
            row[j] = min3(above + 1, row[j - 1] + 1, diagonal + (a[i - 1] != b[j - 1]));
            diagonal = above;
        }
    }
    return row[n];
}

const char *options_nearest(const char *name, const char *const *names) {
    const char *nearest = NULL;
    int least = NEAR;
    for (; *names; names++) {
        int d = distance(name, *names);
        /* Three letters of "plot" may not change, or it is another word. */
        if (d < least && d < (int)strlen(*names) - 1) {
            least = d;
            nearest = *names;
        }
    }
    return nearest;
}

/* How many options begin with the given text: getopt_long takes any unambiguous beginning. */
static int count_beginnings(const char *text, size_t length, const struct option *options) {
    int n = 0;
    for (; options->name; options++) {
        n += strncmp(options->name, text, length) == 0;
    }
    return n;
}

static void say_unknown(const command *self, const char *given, const struct option *options) {
    const char *text = strncmp(given, "--", 2) == 0 ? given + 2 : given + 1;
    size_t length = strcspn(text, "=");
    char name[NAME_MAX_LENGTH + 1];
    const char *names[128];
    size_t n = 0;
    for (const struct option *o = options; o->name != NULL && n + 1 < sizeof names / sizeof *names;
         o++) {
        names[n++] = o->name;
    }
    names[n] = NULL;
    snprintf(name, sizeof name, "%.*s", (int)length, text);
    const char *nearest = options_nearest(name, names);
    bool ambiguous = count_beginnings(text, length, options) > 1;
    char hint[160];
    if (nearest != NULL && !ambiguous) {
        snprintf(hint, sizeof hint, "did you mean --%s?", nearest);
    } else {
        snprintf(hint, sizeof hint, "\"shearctl help %s\" lists the options", self->name);
    }
    message_fail(hint, "%s: %s option %.*s", self->name, ambiguous ? "ambiguous" : "unknown",
                 (int)(length + (size_t)(text - given)), given);
}

static const char *name_of(int value, const struct option *options) {
    for (; options->name; options++) {
        if (options->val == value) {
            return options->name;
        }
    }
    return "?";
}

int options_bad(const command *self, int value, char **argv, const struct option *options) {
    const char *given = argv[optind - 1];
    if (value == ':') {
        message_fail(NULL, "%s: option --%s needs a value", self->name, name_of(optopt, options));
    } else if (optopt != 0 && strncmp(given, "--", 2) == 0) {
        message_fail(NULL, "%s: option --%s takes no value", self->name, name_of(optopt, options));
    } else if (optopt != 0) {
        /* A bundle of short options: argv[optind] may still be that bundle. */
        char letter[] = {'-', (char)optopt, '\0'};
        say_unknown(self, letter, options);
    } else {
        say_unknown(self, given, options);
    }
    return EXIT_CODE_USAGE;
}

int options_int(const char *option, const char *text, int64_t min, int64_t max, int64_t *out) {
    char *end = NULL;
    errno = 0;
    intmax_t value = strtoimax(text, &end, 10);
    if (end == text || *end || errno || value < min || value > max) {
        message_fail(NULL, "--%s %s: expected an integer from %" PRId64 " to %" PRId64, option,
                     text, min, max);
        return EXIT_CODE_USAGE;
    }
    *out = value;
    return 0;
}
