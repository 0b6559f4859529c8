/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shear/input.h: what a field is read from: one field file, or its parts in separate files or HDUs
 * (docs/field-files.md, "Parts in separate files").
 *
 * A part whose HDU is not chosen is the one called GALAXY, NOISE, PSF or CATALOG, as in a field
 * file; where its file has none of that name, the first HDU that holds an image (CATALOG: the first
 * binary table). Where no catalog is given, the galaxies' file is asked for an HDU CATALOG.
 */
#ifndef SHEAR_INPUT_H
#define SHEAR_INPUT_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

enum shear_part {
    SHEAR_PART_GALAXY = 0,
    SHEAR_PART_NOISE,
    SHEAR_PART_PSF,
    SHEAR_PART_CATALOG, /* optional */
    SHEAR_N_PARTS
};
/* "galaxy", "noise", "psf", "catalog"; "unknown" for what is none. */
const char *shear_part_name(int part);

typedef struct shear_input_part {
    const char *path;    /* NULL: this part is not given */
    const char *extname; /* the HDU by its name, in any case; NULL: by number, or the default */
    int64_t hdu;         /* the HDU by its number, 0 = the primary; -1: by name, or the default */
} shear_input_part;

typedef struct shear_input {
    const char *path;                      /* of a field file; NULL: the parts are given */
    shear_input_part parts[SHEAR_N_PARTS]; /* where path is NULL */
} shear_input;

/* The input that is this field file. */
shear_input shear_input_of_file(const char *path);

/* The input in one line, for people and reports: "FILE", or "FILE:HDU + FILE + ..." in the order of
 * the parts. Cut to `size` bytes; SHEAR_INPUT_TEXT_SIZE is enough for paths that the system opens.
 * Returns buf. */
enum { SHEAR_INPUT_TEXT_SIZE = 4 * 4200 };
char *shear_input_text(const shear_input *input, char *buf, size_t size);

#ifdef __cplusplus
}
#endif

#endif
