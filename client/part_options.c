/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "part_options.h"

#include "input_path.h"
#include "message.h"

#include <stdlib.h>
#include <string.h>

bool part_options_is(int value) {
    return value >= PART_OPTION_FIRST && value < PART_OPTION_FIRST + SHEAR_N_PARTS;
}

void part_options_set(struct part_options *o, int value, const char *argument) {
    o->given[value - PART_OPTION_FIRST] = argument;
}

bool part_options_any(const struct part_options *o) {
    return o->given[SHEAR_PART_GALAXY] || o->given[SHEAR_PART_NOISE] || o->given[SHEAR_PART_PSF] ||
           o->given[SHEAR_PART_CATALOG];
}

static int contradiction(const struct command *command, const char *text) {
    char hint[64];
    snprintf(hint, sizeof hint, "\"shearctl help %s\"", command->name);
    message_fail(hint, "%s: %s", command->name, text);
    return EXIT_CODE_USAGE;
}

int part_options_check(const struct part_options *o, const struct command *command, int n_files) {
    const bool all =
        o->given[SHEAR_PART_GALAXY] && o->given[SHEAR_PART_NOISE] && o->given[SHEAR_PART_PSF];
    if (part_options_any(o) && n_files > 0) {
        return contradiction(command, "give either field files, or --galaxy, --noise and --psf");
    }
    if (part_options_any(o) && !all) {
        return contradiction(command, "--galaxy, --noise and --psf belong together");
    }
    return !all && n_files < 1 ? contradiction(command, "which files?") : EXIT_CODE_DONE;
}

static int set_part(struct part_input *p, int i, const char *given, bool absolute,
                    shear_error *err) {
    shear_input_part *part = &p->input.parts[i];
    size_t length = 0;
    int code = input_path_hdu(given, part, &length, err);
    char *file = code ? NULL : strndup(given, length);
    if (!code && !file) {
        code = shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory");
    }
    if (!code && absolute) {
        code = input_path_absolute(file, &p->paths[i], err);
        free(file);
    } else {
        p->paths[i] = file;
    }
    part->path = p->paths[i];
    return code;
}

int part_input_init(struct part_input *p, const struct part_options *o, bool absolute,
                    shear_error *err) {
    int code = SHEAR_OK;
    *p = (struct part_input){.input = shear_input_of_file(NULL)};
    for (int i = 0; i < SHEAR_N_PARTS && !code; i++) {
        code = o->given[i] ? set_part(p, i, o->given[i], absolute, err) : SHEAR_OK;
    }
    return code;
}

void part_input_deinit(struct part_input *p) {
    for (int i = 0; i < SHEAR_N_PARTS; i++) {
        free(p->paths[i]);
        p->paths[i] = NULL;
    }
}
