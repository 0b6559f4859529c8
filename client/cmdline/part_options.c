/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "cmdline/part_options.h"

#include "cmdline/input_path.h"
#include "terminal/message.h"

#include <stdlib.h>
#include <string.h>

bool part_options_is(int value) {
    return value >= PART_OPTION_FIRST && value < PART_OPTION_FIRST + SHEAR_N_PARTS;
}

void part_options_set(part_options *o, int value, const char *argument) {
    o->given[value - PART_OPTION_FIRST] = argument;
}

bool part_options_any(const part_options *o) {
    return o->given[SHEAR_PART_GALAXY] != NULL || o->given[SHEAR_PART_NOISE] != NULL ||
           o->given[SHEAR_PART_PSF] != NULL || o->given[SHEAR_PART_CATALOG] != NULL;
}

static int contradiction(const command *self, const char *text) {
    char hint[64];
    snprintf(hint, sizeof hint, "\"shearctl help %s\"", self->name);
    message_fail(hint, "%s: %s", self->name, text);
    return EXIT_CODE_USAGE;
}

/* Another table for a field file: its parts, and that. */
static void take_file(part_options *o, const char *file) {
    for (int i = 0; i < SHEAR_N_PARTS; i++) {
        o->given[i] = i == SHEAR_PART_CATALOG ? o->given[i] : file;
    }
}

int part_options_settle(part_options *o, const command *self, char **files, int n_files) {
    const bool some = o->given[SHEAR_PART_GALAXY] != NULL || o->given[SHEAR_PART_NOISE] != NULL ||
                      o->given[SHEAR_PART_PSF] != NULL;
    const bool all = o->given[SHEAR_PART_GALAXY] != NULL && o->given[SHEAR_PART_NOISE] != NULL &&
                     o->given[SHEAR_PART_PSF] != NULL;
    if (some && n_files > 0) {
        return contradiction(self, "give either field files, or --galaxy, --noise and --psf");
    }
    if (o->given[SHEAR_PART_CATALOG] != NULL && n_files > 1) {
        return contradiction(self, "--catalog-in goes with one field file");
    }
    if (part_options_any(o) && !all && n_files < 1) {
        return contradiction(self, "--galaxy, --noise and --psf belong together");
    }
    if (o->given[SHEAR_PART_CATALOG] != NULL && n_files == 1) {
        take_file(o, files[0]);
    }
    return !all && n_files < 1 ? contradiction(self, "which files?") : EXIT_CODE_DONE;
}

static int set_part(part_input *p, int i, const char *given, bool absolute, shear_error *err) {
    shear_input_part *part = &p->input.parts[i];
    size_t length = 0;
    int code = input_path_hdu(given, part, &length, err);
    char *file = code != SHEAR_OK ? NULL : strndup(given, length);
    if (code == SHEAR_OK && file == NULL) {
        code = shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory");
    }
    if (code == SHEAR_OK && absolute) {
        code = input_path_absolute(file, &p->paths[i], err);
        free(file);
    } else {
        p->paths[i] = file;
    }
    part->path = p->paths[i];
    return code;
}

int part_input_init(part_input *p, const part_options *o, bool absolute, shear_error *err) {
    int code = SHEAR_OK;
    *p = (part_input){.input = shear_input_of_file(NULL)};
    for (int i = 0; i < SHEAR_N_PARTS && code == SHEAR_OK; i++) {
        code = o->given[i] != NULL ? set_part(p, i, o->given[i], absolute, err) : SHEAR_OK;
    }
    return code;
}

void part_input_deinit(part_input *p) {
    for (int i = 0; i < SHEAR_N_PARTS; i++) {
        free(p->paths[i]);
        p->paths[i] = NULL;
    }
}
