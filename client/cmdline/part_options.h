/* SPDX-License-Identifier: GPL-3.0-or-later */
/* part_options.h: the options --galaxy, --noise, --psf and --catalog-in, which name a field's parts
 * in separate files or HDUs, each as FILE or FILE:HDU; and those of an exposure. */
#pragma once

#include "cmdline/options.h"
#include "shear/error.h"
#include "shear/input.h"

#include <stdbool.h>

/* Entries for a subcommand's table of options, and the text for its help. */
#define PART_OPTIONS(parts)                                                                        \
    {.name = "galaxy", .text = &(parts)->given[SHEAR_PART_GALAXY]},                                \
        {.name = "noise", .text = &(parts)->given[SHEAR_PART_NOISE]},                              \
        {.name = "psf", .text = &(parts)->given[SHEAR_PART_PSF]},                                  \
        {.name = "catalog-in", .text = &(parts)->given[SHEAR_PART_CATALOG]},                       \
        {.name = "stamp-size", .set = part_options_set_size, .context = (parts)}, {                \
        .name = "stamps", .integer = &(parts)->mosaic.stamps, .min = 1, .max = INT32_MAX           \
    }

/* Further entries for subcommands that read exposures; PART_OPTIONS go before them. */
#define EXPOSURE_OPTION(parts, option)                                                             \
    { .name = (option), .set = part_options_set, .context = (parts) }
#define EXPOSURE_OPTIONS(parts)                                                                    \
    {.name = "image", .text = &(parts)->given[SHEAR_PART_IMAGE]},                                  \
        {.name = "weight", .text = &(parts)->given[SHEAR_PART_WEIGHT]},                            \
        {.name = "mask", .text = &(parts)->given[SHEAR_PART_MASK]},                                \
        {.name = "segmentation", .text = &(parts)->given[SHEAR_PART_SEGMENTATION]},                \
        {.name = "wcs", .text = &(parts)->given[SHEAR_PART_WCS]},                                  \
        {.name = "sources", .text = &(parts)->sources}, EXPOSURE_OPTION(parts, "weight-kind"),     \
        EXPOSURE_OPTION(parts, "mask-bad"), EXPOSURE_OPTION(parts, "columns"),                     \
        EXPOSURE_OPTION(parts, "origin"), EXPOSURE_OPTION(parts, "select"),                        \
        EXPOSURE_OPTION(parts, "carry"), EXPOSURE_OPTION(parts, "psf-kind"),                       \
        EXPOSURE_OPTION(parts, "stamp"), EXPOSURE_OPTION(parts, "noise-stamps"),                   \
        EXPOSURE_OPTION(parts, "amplifiers"), EXPOSURE_OPTION(parts, "frame")

/* The arguments of these options: "FILE", "FILE:HDU", or NULL if not given. Initialize with
 * PART_OPTIONS_INIT. */
typedef struct part_options {
    const char *given[SHEAR_N_PARTS];
    const char *sources; /* --sources, which is SHEAR_PART_CATALOG of an exposure */
    shear_mosaic mosaic;
    shear_exposure exposure;
    const char *of_exposure; /* one of its options that was given, or NULL */
} part_options;

#define PART_OPTIONS_INIT                                                                          \
    {                                                                                              \
        .exposure = {.origin = 1 }                                                                 \
    }

/* Set the size of stamps: `set` of an option_entry. */
enum exit_code part_options_set_size(const option_entry *entry, const char *value);
/* Set an option of the exposure: `set` of an option_entry. */
enum exit_code part_options_set(const option_entry *entry, const char *value);
/* Return whether any of these options was given. */
bool part_options_any(const part_options *o);
/* Check that the options form a complete input, without field files beside them. The exception is
 * --catalog-in alone, which replaces the catalog of a single field file: that file is then set as
 * the other parts. `files` [n_files] must outlive *o. Returns an exit code; on failure an error has
 * been printed. */
enum exit_code part_options_settle(part_options *o, const command *self, char **files, int n_files);

/* The input that the options describe, and the memory for its paths. */
typedef struct part_input {
    shear_input input;
    char *paths[SHEAR_N_PARTS];
} part_input;
/* Fill *p from the options, with absolute paths if `absolute` (the service requires them). Returns
 * SHEAR_OK, SHEAR_E_SETTING (not a valid HDU), SHEAR_E_IO or SHEAR_E_NOMEM. Call part_input_deinit
 * in either case. */
int part_input_init(part_input *p, const part_options *o, bool absolute, shear_error *err);
void part_input_deinit(part_input *p);
