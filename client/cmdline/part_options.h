/* SPDX-License-Identifier: GPL-3.0-or-later */
/* part_options.h: the options that give a field's parts in separate files or HDUs: --galaxy,
 * --noise, --psf and --catalog-in, each FILE or FILE:HDU. */
#ifndef CLIENT_CMDLINE_PART_OPTIONS_H
#define CLIENT_CMDLINE_PART_OPTIONS_H

#include "cmdline/options.h"
#include "shear/error.h"
#include "shear/input.h"

#include <stdbool.h>

/* For a subcommand's table of options, and for its help. */
#define PART_OPTIONS(parts)                                                                        \
    {.name = "galaxy", .text = &(parts)->given[SHEAR_PART_GALAXY]},                                \
        {.name = "noise", .text = &(parts)->given[SHEAR_PART_NOISE]},                              \
        {.name = "psf", .text = &(parts)->given[SHEAR_PART_PSF]}, {                                \
        .name = "catalog-in", .text = &(parts)->given[SHEAR_PART_CATALOG]                          \
    }
#define PART_OPTIONS_HELP                                                                          \
    "  --galaxy FILE[:HDU]     galaxy stamps in a file of their own. HDU is a number from 0 or\n"  \
    "                          a name (default: GALAXY, else the first that holds an image)\n"     \
    "  --noise FILE[:HDU]      noise stamps (default: NOISE, else the first image)\n"              \
    "  --psf FILE[:HDU]        PSF image or images (default: PSF, else the first image)\n"         \
    "  --catalog-in FILE[:HDU]  the table that goes with them (default: CATALOG of the "           \
    "galaxies'\n"                                                                                  \
    "                          file, where there is one); with a field file: in place of its "     \
    "own\n"

/* What was given: "FILE" or "FILE:HDU", or NULL. Begin as {0}. */
typedef struct part_options {
    const char *given[SHEAR_N_PARTS];
} part_options;

/* Is any given? */
bool part_options_any(const part_options *o);
/* All that belong together, and no field files beside them? But a catalog alone goes with one
 * field file, whose own it replaces: then that file becomes the other parts. `files` [n_files] must
 * stay. Returns an exit code, with an error printed. */
enum exit_code part_options_settle(part_options *o, const command *self, char **files, int n_files);

/* The input that they name, and what its texts are kept in. */
typedef struct part_input {
    shear_input input;
    char *paths[SHEAR_N_PARTS];
} part_input;
/* `absolute`: with absolute paths, as the service wants them. SHEAR_E_SETTING (no HDU can be called
 * so), SHEAR_E_IO, SHEAR_E_NOMEM; deinit it either way. */
int part_input_init(part_input *p, const part_options *o, bool absolute, shear_error *err);
void part_input_deinit(part_input *p);

#endif
