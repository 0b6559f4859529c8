/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "cmdline/settings_parse.h"

#include "cmdline/options.h"
#include "cmdline/settings_options.h"
#include "terminal/message.h"

#include <stdio.h>
#include <string.h>

enum { OWN_MAX = 64 };

static int usage(const shear_error *err) {
    message_error(err);
    return EXIT_CODE_USAGE;
}

int settings_parse(settings_parser *p, int argc, char **argv) {
    struct option options[OWN_MAX + SETTINGS_OPTIONS_MAX + 1];
    char letters[OWN_MAX] = ":";
    bool given[SETTINGS_OPTIONS_MAX] = {false};
    shear_error err = {0};
    memcpy(options, p->own, p->n_own * sizeof *options);
    settings_options_fill(options + p->n_own, SETTINGS_OPTIONS_MAX + 1);
    snprintf(letters, sizeof letters, ":%s", p->letters != NULL ? p->letters : "");
    opterr = 0;
    int value = 0;
    while ((value = getopt_long(argc, argv, letters, options, NULL)) != -1) {
        if (value == '?' || value == ':') {
            return options_bad(p->self, value, argv, options);
        }
        if (settings_options_is(value)) {
            p->given = true;
            if (settings_options_handle(value, optarg, p->settings, given, &err) != 0) {
                return usage(&err);
            }
            continue;
        }
        const int code = p->handle(value, optarg, p->context);
        if (code != SHEAR_OK) {
            return code;
        }
    }
    return shear_settings_check(p->settings, &err) != 0 ? usage(&err) : EXIT_CODE_DONE;
}
