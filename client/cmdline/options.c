/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "cmdline/options.h"

#include "base/cleanup.h"
#include "base/spelling.h"
#include "base/text.h"
#include "cmdline/settings_options.h"
#include "terminal/human.h"
#include "terminal/message.h"

#include <assert.h>
#include <getopt.h>
#include <inttypes.h>
#include <stdarg.h>
#include <string.h>

enum { OWN_MAX = 64, ENTRIES_MAX = OWN_MAX + SETTINGS_OPTIONS_MAX };
enum { FIRST_VALUE = 256 }; /* value of the first option without a short form */

/* The arguments of getopt_long, built from the entries. */
typedef struct long_options {
    struct option table[ENTRIES_MAX + 1];
    char letters[ENTRIES_MAX]; /* ":o:": the ':' in front makes it silent */
} long_options;

static int value_of(const option_entry *entries, size_t i) {
    return entries[i].letter != '\0' ? entries[i].letter : FIRST_VALUE + (int)i;
}

static void long_options_init(long_options *l, const option_entry *entries) {
    *l = (long_options){.letters = ":"};
    for (size_t n = 0; entries[n].name != NULL; n++) {
        const option_entry *e = &entries[n];
        const bool bare = e->flag != NULL || e->bare;
        l->table[n] = (struct option){e->name, bare ? no_argument : required_argument, NULL,
                                      value_of(entries, n)};
        if (e->letter != '\0')
            text_append(l->letters, sizeof l->letters, "%c%s", e->letter, bare ? "" : ":");
    }
}

/* Count the options that begin with the given text: getopt_long accepts any unambiguous prefix. */
static int count_beginnings(const char *text, size_t length, const struct option *table) {
    int n = 0;
    for (; table->name != NULL; table++)
        n += strncmp(table->name, text, length) == 0;
    return n;
}

static enum exit_code fail_unknown(const command *self, const char *given,
                                   const struct option *table) {
    const char *text = strncmp(given, "--", 2) == 0 ? given + 2 : given + 1;
    const size_t length = strcspn(text, "=");
    char name[64];
    char hint[160];
    snprintf(name, sizeof name, "%.*s", (int)length, text);
    spelling meant = {.given = name};
    for (const struct option *o = table; o->name != NULL; o++)
        spelling_consider(&meant, o->name);
    const bool ambiguous = count_beginnings(text, length, table) > 1;
    if (meant.best != NULL && !ambiguous) {
        snprintf(hint, sizeof hint, "did you mean --%s?", meant.best);
    } else {
        snprintf(hint, sizeof hint, "\"shearctl help %s\" lists the options", self->name);
    }
    return message_fail(EXIT_CODE_USAGE, hint, "%s: %s option %.*s", self->name,
                        ambiguous ? "ambiguous" : "unknown", (int)(length + (size_t)(text - given)),
                        given);
}

/* Return the name of the option that getopt_long rejected. */
static const char *name_of(int value, const struct option *table) {
    while (table->name != NULL && table->val != value)
        table++;
    return table->name != NULL ? table->name : "?";
}

/* Print why getopt_long returned '?' or ':' (`value`). */
static enum exit_code fail_option(const command *self, int value, char **argv,
                                  const struct option *table) {
    const char *given = argv[optind - 1];
    const char letter[] = {'-', (char)optopt, '\0'};
    const char *fault = value == ':' ? "needs a value" : "takes no value";
    if (value == '?' && optopt == 0)
        return fail_unknown(self, given, table);
    if (value == '?' && strncmp(given, "--", 2) != 0) {
        /* Not `given`: within a group of short options it is the argument before the group. */
        return fail_unknown(self, letter, table);
    }
    return message_fail(EXIT_CODE_USAGE, NULL, "%s: option --%s %s", self->name,
                        name_of(optopt, table), fault);
}

enum exit_code options_fail(const command *self, const char *format, ...) {
    char text[256];
    char hint[64];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    snprintf(hint, sizeof hint, "\"shearctl help %s\"", self->name);
    return message_fail(EXIT_CODE_USAGE, hint, "%s: %s", self->name, text);
}

enum exit_code options_integer(const char *option, const char *text, int64_t min, int64_t max,
                               int64_t *out) {
    int64_t value = 0;
    if (!text_to_int64(text, &value) || value < min || value > max) {
        return message_fail(EXIT_CODE_USAGE, NULL,
                            "--%s %s: expected an integer from %" PRId64 " to %" PRId64, option,
                            text, min, max);
    }
    *out = value;
    return EXIT_CODE_DONE;
}

static enum exit_code set_seconds(const option_entry *e, const char *value) {
    if (!human_parse_duration(value, e->seconds)) {
        return message_fail(EXIT_CODE_USAGE, NULL,
                            "--%s %s: expected a time, as 90, 500ms, 5min, 2h", e->name, value);
    }
    return EXIT_CODE_DONE;
}

static enum exit_code set_entry(const option_entry *e, const char *value) {
    if (e->given != NULL)
        *e->given = true;
    if (e->set != NULL)
        return e->set(e, value);
    if (e->integer != NULL)
        return options_integer(e->name, value, e->min, e->max, e->integer);
    if (e->seconds != NULL)
        return set_seconds(e, value);
    if (e->flag != NULL) {
        *e->flag = true;
    } else {
        assert(e->text != NULL);
        *e->text = value;
    }
    return EXIT_CODE_DONE;
}

static enum exit_code set(int value, const option_entry *entries) {
    size_t i = 0;
    while (value_of(entries, i) != value)
        i++;
    return set_entry(&entries[i], optarg);
}

enum exit_code options_parse(const command *self, int argc, char **argv, const option_entry *own,
                             option_settings *settings) {
    long_options l;
    option_entry entries[ENTRIES_MAX + 1] = {0};
    size_t n = 0;
    for (; own[n].name != NULL; n++) {
        assert(n < OWN_MAX);
        entries[n] = own[n];
    }
    if (settings != NULL)
        settings_options_add(entries + n, settings);
    long_options_init(&l, entries);
    opterr = 0;
    for (;;) {
        const int value = getopt_long(argc, argv, l.letters, l.table, NULL);
        if (value == -1)
            return EXIT_CODE_DONE;
        TRY(value == '?' || value == ':' ? fail_option(self, value, argv, l.table)
                                         : set(value, entries));
    }
}

enum exit_code options_check_settings(const option_settings *settings) {
    shear_error err = {0};
    return shear_settings_check(&settings->values, &err) != SHEAR_OK ? message_error(&err)
                                                                     : EXIT_CODE_DONE;
}

enum exit_code options_count_operands(const command *self, int argc, char **argv, const char *what,
                                      int min, int max) {
    const int n = argc - optind;
    if (n < min) {
        return message_fail(EXIT_CODE_USAGE, NULL, "%s: which %s? \"shearctl help %s\" tells more",
                            self->name, what, self->name);
    }
    if (n > max) {
        return message_fail(EXIT_CODE_USAGE, NULL, "%s: unexpected \"%s\"", self->name,
                            argv[optind + max]);
    }
    return EXIT_CODE_DONE;
}
