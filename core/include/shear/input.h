/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * @file shear/input.h
 * What a field is read from: one field file, or its parts in separate files or HDUs
 * (docs/field-files.md, "Parts in separate files").
 *
 * A part whose HDU is not chosen is the HDU called GALAXY, NOISE, PSF or CATALOG, as in a field
 * file; if its file has no HDU of that name, it is the first one that holds an image (CATALOG: the
 * first binary table). If no catalog is given, the galaxies' file is searched for an HDU CATALOG.
 */
#ifndef SHEAR_INPUT_H
#define SHEAR_INPUT_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** The parts of a field. */
enum shear_part {
    SHEAR_PART_GALAXY = 0, /**< the galaxy stamps */
    SHEAR_PART_NOISE,      /**< the noise stamps */
    SHEAR_PART_PSF,        /**< the PSF images */
    SHEAR_PART_CATALOG,    /**< the table with a row per stamp; optional */
    SHEAR_N_PARTS          /**< how many there are */
};
/** "galaxy", "noise", "psf" or "catalog" for enum shear_part; "unknown" for any other number. */
const char *shear_part_name(int part);

/** Where one part is. */
typedef struct shear_input_part {
    const char *path;    /**< its file; NULL: this part is not given */
    const char *extname; /**< the HDU by its name, in any case; NULL: by number, or the default */
    int64_t hdu;         /**< the HDU by its number, 0 = the primary; -1: by name, or the default */
} shear_input_part;

/** Where a field is. Paths and names are borrowed. */
typedef struct shear_input {
    const char *path;                      /**< of a field file; NULL: the parts are given */
    shear_input_part parts[SHEAR_N_PARTS]; /**< by enum shear_part, if path is NULL */
} shear_input;

/** The input that is this field file; the path is borrowed. */
shear_input shear_input_of_file(const char *path);

/** Sizes of texts. */
enum {
    SHEAR_INPUT_TEXT_SIZE = 4 * 4200 /**< enough for all paths that the system opens */
};
/** The input in one line, for people and reports: "FILE", or "FILE:HDU + FILE + ..." in the order
 * of the parts, cut to `size` bytes. Returns buf. */
char *shear_input_text(const shear_input *input, char *buf, size_t size);

#ifdef __cplusplus
}
#endif

#endif
