/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * @file shear/input.h
 * Where a field is read from: one field file, or its parts in separate files or HDUs
 * (docs/field-files.md, "Parts in separate files").
 *
 * A part whose HDU is not chosen is the HDU called GALAXY, NOISE, PSF or CATALOG, as in a field
 * file; if its file has no HDU of that name, it is the first one that holds an image (for CATALOG,
 * the first binary table). If no catalog is given, an HDU CATALOG is looked up in the galaxies'
 * file.
 */
#ifndef SHEAR_INPUT_H
#define SHEAR_INPUT_H

#include "shear/linkage.h"

#include <stddef.h>
#include <stdint.h>

SHEAR_BEGIN_C

/** The parts of a field. */
enum shear_part {
    SHEAR_PART_GALAXY = 0, /**< the galaxy stamps */
    SHEAR_PART_NOISE,      /**< the noise stamps */
    SHEAR_PART_PSF,        /**< the PSF images */
    SHEAR_PART_CATALOG,    /**< the table with a row per stamp; optional */
    SHEAR_N_PARTS          /**< how many there are */
};
/** Return "galaxy", "noise", "psf" or "catalog" for enum shear_part; "unknown" for any other
 * number. */
const char *shear_part_name(int part);

/** The place of one part. */
typedef struct shear_input_part {
    const char *path;    /**< its file; NULL: this part is not given */
    const char *extname; /**< name of the HDU, in any case; NULL: by number, or the default */
    int64_t hdu;         /**< number of the HDU, 0 = the primary; -1: by name, or the default */
} shear_input_part;

/** The place of a field. Paths and names are borrowed. */
typedef struct shear_input {
    const char *path;                      /**< of a field file; NULL: the parts are given */
    shear_input_part parts[SHEAR_N_PARTS]; /**< by enum shear_part, if path is NULL */
} shear_input;

/** Return the input for this field file. The path is borrowed. */
shear_input shear_input_of_file(const char *path);

/** Sizes of texts. */
enum {
    SHEAR_INPUT_TEXT_SIZE = 4 * 4200 /**< long enough for all paths that the system opens */
};
/** Format the input in one line, for messages and reports: "FILE", or "FILE:HDU + FILE + ..." in
 * the order of the parts, cut to `size` bytes. Return buf. */
char *shear_input_text(const shear_input *input, char *buf, size_t size);

SHEAR_END_C

#endif
