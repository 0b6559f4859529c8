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

#include "shear/error.h"
#include "shear/linkage.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

SHEAR_BEGIN_C

/** The parts of a field. */
enum shear_part {
    SHEAR_PART_GALAXY = 0, /**< the galaxy stamps */
    SHEAR_PART_NOISE,      /**< the noise stamps */
    SHEAR_PART_PSF,        /**< the PSF images */
    SHEAR_PART_CATALOG,    /**< the table with a row per stamp; optional. Of an exposure: sources */
    SHEAR_PART_IMAGE,      /**< an exposure; then there are no galaxy stamps */
    SHEAR_PART_WEIGHT,     /**< its weight map; optional, like all that follow */
    SHEAR_PART_MASK,       /**< its mask */
    SHEAR_PART_SEGMENTATION, /**< which object a pixel belongs to */
    SHEAR_PART_WCS,          /**< text file of header cards (.head) that replace the image's */
    SHEAR_N_PARTS            /**< how many there are */
};
/** Return "galaxy", "noise", "psf", "catalog", "image", ... for enum shear_part; "unknown" for any
 * other number. */
const char *shear_part_name(int part);

/** The place of one part. */
typedef struct shear_input_part {
    const char *path;    /**< its file; NULL: this part is not given */
    const char *extname; /**< name of the HDU, in any case; NULL: by number, or the default */
    int64_t hdu;         /**< number of the HDU, 0 = the primary; -1: by name, or the default */
} shear_input_part;

/** What the weight map of an exposure holds. */
enum shear_weight_kind {
    SHEAR_WEIGHT_IS_WEIGHT = 0, /**< inverse variances, absolute or relative; 0 = bad */
    SHEAR_WEIGHT_IS_VARIANCE,   /**< variances */
    SHEAR_WEIGHT_IS_RMS         /**< standard deviations */
};
/** What a PSF file holds. */
enum shear_psf_kind {
    SHEAR_PSF_KIND_AUTO = 0, /**< what its HDUs say */
    SHEAR_PSF_KIND_PSFEX,    /**< PSFEx models */
    SHEAR_PSF_KIND_PIFF,     /**< a Piff model: PixelGrid with BasisPolynomial */
    SHEAR_PSF_KIND_CUBE,     /**< images, with a table of their positions if there are several */
    SHEAR_PSF_KIND_STARS     /**< stamps of stars */
};
/** Where an exposure's noise stamps come from. */
enum shear_noise_kind {
    SHEAR_NOISE_NEAR = 0, /**< boxes of empty sky near each galaxy */
    SHEAR_NOISE_WHITE,    /**< random numbers of the local standard deviation */
    SHEAR_NOISE_IMAGE     /**< an image of noise, SHEAR_PART_NOISE, at the galaxy's own place */
};

/** The amplifiers that read a chip out: its pixels in a grid of equal parts. */
typedef struct shear_amplifiers {
    int columns; /**< side by side along x, at most SHEAR_MAX_AMPLIFIERS; 0 = 1 */
    int rows;    /**< the same along y */
} shear_amplifiers;

/** The options of an exposure (docs/exposures.md). All zero, with origin 1, are the defaults. Texts
 * are borrowed; NULL = not given. */
typedef struct shear_exposure {
    enum shear_weight_kind weight_kind; /**< of SHEAR_PART_WEIGHT */
    const char *mask_bad;               /**< "any", "bits=N", "planes=NAME,...", "zero" */
    const char *columns;                /**< "x=XWIN_IMAGE,y=YWIN_IMAGE,..." */
    int origin;                         /**< of catalog positions: the first pixel is 0 or 1 */
    const char *select;                 /**< a row expression: which sources are measured */
    const char *carry;                  /**< columns carried to results: "all" (default), "none",
                                           "NAME,..." */
    enum shear_psf_kind psf_kind;       /**< of SHEAR_PART_PSF */
    int stamp;                          /**< side of the stamps, pixels; 0 = 64 */
    enum shear_noise_kind noise;        /**< of the noise stamps */
    int noise_stamps;                   /**< per galaxy; 0 = 1 */
    shear_amplifiers amplifiers;        /**< of each chip: noise is taken from the galaxy's own */
    int frame;                          /**< enum shear_frame (shear/plan.h) of the shear, plus 1;
                                           0 = sky if the image has a WCS, else pixel */
} shear_exposure;

/** Numbers of options. */
enum {
    SHEAR_MAX_AMPLIFIERS = 64,    /**< of a chip, along one axis */
    SHEAR_N_EXPOSURE_OPTIONS = 12 /**< number of options of an exposure */
};
/** Set an option by its name, as in --NAME of shearctl and in object `exposure` of jobs:
 * weight-kind, mask-bad, columns, origin, select, carry, psf-kind, stamp, noise (near or white),
 * noise-stamps, amplifiers ("4x1"), frame. Texts are borrowed. SHEAR_E_SETTING names the option,
 * the given text and what is expected. */
int shear_exposure_set(shear_exposure *e, const char *name, const char *text, shear_error *err);
/** Return the text that sets an option to its value, in `number` (of 24 bytes) for numbers; NULL if
 * it is the default, or there is no such option. */
const char *shear_exposure_get(const shear_exposure *e, const char *name, char *number);
/** Return the member of option `i`, from 0, if it is a text; else NULL. For owners of copies. */
const char **shear_exposure_text(shear_exposure *e, int i);
/** Return the name of option `i`, from 0; NULL beyond the last. */
const char *shear_exposure_option(int i);

/** The layout of mosaics of stamps without keywords; 0 = by STAMPNX, STAMPNY and NSTAMP. */
typedef struct shear_mosaic {
    int stamp_nx;   /**< columns of a stamp, pixels */
    int stamp_ny;   /**< rows of a stamp, pixels; both are given, or neither */
    int64_t stamps; /**< number of stamps; 0 = as many as there is room for */
} shear_mosaic;
/** Parse "48" or "48x64" as the size of a stamp. SHEAR_E_SETTING. */
int shear_mosaic_set_size(shear_mosaic *m, const char *text, shear_error *err);

/** The place of a field. Paths and names are borrowed. */
typedef struct shear_input {
    const char *path;                      /**< of a field file; NULL: the parts are given */
    shear_input_part parts[SHEAR_N_PARTS]; /**< by enum shear_part, if path is NULL */
    shear_mosaic mosaic;     /**< of GALAXY and NOISE, if they are images without keywords */
    shear_exposure exposure; /**< if the image is given */
} shear_input;

/** Return whether the input is an exposure: SHEAR_PART_IMAGE is given. */
bool shear_input_is_exposure(const shear_input *input);

/** Return the path of the file that gives the field its default name: the field file, the galaxies'
 * or the image's. */
const char *shear_input_name(const shear_input *input);

/** Return the input for this field file. The path is borrowed. */
shear_input shear_input_of_file(const char *path);

/** Sizes of texts. */
enum {
    SHEAR_INPUT_TEXT_SIZE = 4 * 4200 /**< long enough for all paths that the system opens */
};
/** Format the input in one line, for messages and reports: "FILE", or "FILE:HDU + FILE + ..." in
 * the order of the parts, of an exposure from the image on, cut to `size` bytes. Return buf. */
char *shear_input_text(const shear_input *input, char *buf, size_t size);

SHEAR_END_C

#endif
