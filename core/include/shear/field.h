/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * @file shear/field.h
 * Fields: a streaming reader of stamp pairs, whatever lies behind them (a field file,
 * docs/field-files.md; its parts in separate files; an exposure, docs/exposures.md), and a
 * streaming writer of field files.
 *
 * The reader opens the file itself (regular files only), never through CFITSIO's extended file-name
 * syntax, and checks every dimension against the file's size before it allocates memory. Memory is
 * bounded by the stamps that are requested, not by the file: .gz files are unpacked to an unlinked
 * temporary file (TMPDIR), .fz files are read tile by tile. A handle is used by one thread at a
 * time; several handles may be used at once.
 */
#ifndef SHEAR_FIELD_H
#define SHEAR_FIELD_H

#include "shear/error.h"
#include "shear/input.h"
#include "shear/linkage.h"
#include "shear/plan.h"
#include "shear/stamp.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

SHEAR_BEGIN_C

/** An open field. */
typedef struct shear_field shear_field;

/** How stamps lie in an image HDU. */
enum shear_layout {
    SHEAR_LAYOUT_CUBE = 0, /**< a cube, [stamp][row][column] */
    SHEAR_LAYOUT_MOSAIC    /**< side by side in one image */
};

/** Which PSF image belongs to a stamp. */
enum shear_psf_layout {
    SHEAR_PSF_ONE = 0,   /**< one image for all */
    SHEAR_PSF_PER_STAMP, /**< image i belongs to stamp i */
    SHEAR_PSF_BY_ID,     /**< column PSF_ID has the number of the image */
    SHEAR_PSF_MODELS     /**< column PSF_ID has the number of the model, PSF_TERMS its coefficients;
                            the images are the models' planes */
};

/** Columns of the CATALOG table that a file has. */
enum shear_column {
    SHEAR_COL_ID = 1u << 0,       /**< the caller's own number of the galaxy */
    SHEAR_COL_X = 1u << 1,        /**< position, pixels */
    SHEAR_COL_Y = 1u << 2,        /**< position, pixels */
    SHEAR_COL_RA = 1u << 3,       /**< right ascension, degrees */
    SHEAR_COL_DEC = 1u << 4,      /**< declination, degrees */
    SHEAR_COL_WEIGHT = 1u << 5,   /**< weight */
    SHEAR_COL_PSF_ID = 1u << 6,   /**< number of its PSF image, from 0 */
    SHEAR_COL_R_GAL = 1u << 7,    /**< radius R_G for the filter, pixels */
    SHEAR_COL_FLAGS = 1u << 8,    /**< not 0: the stamp is left out */
    SHEAR_COL_JACOBIAN = 1u << 9, /**< du/dx, du/dy, dv/dx, dv/dy, arcsec per pixel: shear_stamps */
    SHEAR_COL_PSF_TERMS = 1u << 10, /**< coefficients of its PSF model */
    SHEAR_COL_GF1 =
        1u << 12, /**< the shear that the optics' distortion makes, in the pixel frame */
    SHEAR_COL_GF2 = 1u << 13,    /**< the same, other component */
    SHEAR_COL_DROPPED = 1u << 11 /**< bits of enum shear_flag that the reader has found */
};

enum {
    SHEAR_FIELD_NAME_SIZE = 72 /**< bytes of a field's name, including its NUL */
};

/** A column of the input's table that is carried to results: its cells go there as the bytes that
 * they are stored in. Texts are those of FITS keywords, printable; "" = absent. */
typedef struct shear_carried {
    char name[72];  /**< TTYPE in results */
    char form[24];  /**< TFORM, such as "1J" or "16A" */
    char unit[72];  /**< TUNIT */
    char null[24];  /**< TNULL */
    char scale[32]; /**< TSCAL */
    char zero[32];  /**< TZERO */
    int bytes;      /**< of a cell */
} shear_carried;
/** Limits of carried columns. */
enum {
    SHEAR_MAX_CARRIED = 900,       /**< columns */
    SHEAR_MAX_CARRIED_BYTES = 8192 /**< bytes of a row of them */
};

/** The properties of an open field. */
typedef struct shear_field_info {
    char name[SHEAR_FIELD_NAME_SIZE]; /**< FIELD, or the file's base name without .fits, .gz, .fz;
                      "" if there is no FIELD and the file's name is not a valid field name */
    double pixscale;                  /**< arcsec per pixel; NaN = not given. Of stamps with
                                         Jacobians: the median sqrt|det J| */
    enum shear_frame frame;           /**< of the shear; if not PIXEL, stamps have Jacobians */
    bool has_truth;                   /**< SIM_G1 and SIM_G2 are both given */
    double sim_g1;                    /**< true g1 of a simulated field */
    double sim_g2;                    /**< true g2 */
    shear_geometry geometry;          /**< sides of stamps and PSF */
    int64_t n_stamps;                 /**< galaxies */
    int64_t n_psf;                    /**< PSF images, or planes of models */
    int n_models;                     /**< PSF models: shear_field_get_models(); 0: images */
    int psf_terms;                    /**< coefficients of a model */
    int noise_planes;                 /**< noise stamps per galaxy */
    enum shear_layout layout;         /**< of GALAXY */
    enum shear_psf_layout psf_layout; /**< which PSF image belongs to a stamp */
    unsigned columns;                 /**< bits of enum shear_column */
    int n_carried;                    /**< other columns of the table, carried to results */
    int carried_bytes;                /**< bytes of a row of them */
    const shear_carried *carried;     /**< [n_carried]; the field's */
    bool id_unsigned;                 /**< column ID is unsigned, of 64 bits: ids hold the bits */
    int bitpix;                       /**< of GALAXY as stored: 8, 16, 32, 64, -32, -64 */
    bool compressed;                  /**< GALAXY is tile-compressed */
    bool gzipped;       /**< the whole file is; if the parts are in several files, any of them */
    int64_t file_bytes; /**< bytes on disk, of all files */
    bool separate;      /**< the parts are not those of one field file */
    /** HDU of each part (enum shear_part), from 0; -1: the part is absent. Of an exposure, the one
     * that was chosen by number or name; -1: none, or all of that name. */
    int64_t hdu[SHEAR_N_PARTS];
} shear_field_info;

/** Open and check a field file. SHEAR_E_IO (cannot open, not a regular file, no space for a
 * temporary file); SHEAR_E_FORMAT (everything else: the message names the file, the HDU, and what
 * was expected). *field is NULL on error. */
int shear_field_open(shear_field **field, const char *path, shear_error *err);
/** Open a descriptor that is open for reading. It is duplicated, and remains the caller's. `name`
 * is for messages and FIELD. */
int shear_field_open_fd(shear_field **field, int fd, const char *name, shear_error *err);
/**
 * Open a field from one file or from parts in several. FIELD, PIXSCALE and the truth are those of
 * the galaxies' file. A file that holds several parts may be given as several descriptors: it is
 * read as one.
 *
 * @param field  the open field; NULL on error
 * @param input  where it is; paths are only names if descriptors are given
 * @param fds    NULL: the paths are opened. Else descriptors that are open for reading and stay the
 *     caller's: fds[0] of a field file, or fds[SHEAR_N_PARTS] of parts, -1 for those not given
 * @param err    what was wrong, or NULL
 * @return as of shear_field_open()
 */
int shear_field_open_input(shear_field **field, const shear_input *input, const int *fds,
                           shear_error *err);
/** Close the field and free it. NULL is accepted. */
void shear_field_close(shear_field *field);
/** Return the properties of the field; valid while it is open. */
const shear_field_info *shear_field_get_info(const shear_field *field);

/** Set *models to the PSF models, valid while the field is open, and return their number; 0: the
 * PSFs are images. */
int shear_field_get_models(const shear_field *field, const shear_psf_model **models);

/** Check that the field at `path` has a name, for callers that need one. SHEAR_E_FORMAT, with the
 * reason, if it has none. */
int shear_field_need_name(const shear_field_info *info, const char *path, shear_error *err);

/** A reusable block of stamps, with memory for `capacity` pairs of one field. */
typedef struct shear_block {
    shear_stamps stamps; /**< views into the arrays below */
    int capacity;        /**< number of pairs that fit */
    double *galaxy;      /**< [capacity][ny][nx] */
    double *noise;       /**< [capacity][noise_planes][ny][nx] */
    double *psf;         /**< [capacity][psf_ny][psf_nx], or NULL with SHEAR_PSF_ONE */
    int32_t *psf_index;  /**< [capacity], or NULL with SHEAR_PSF_ONE */
    int64_t *psf_id;     /**< [capacity] scratch: the number in the file of each PSF image */
    /** [capacity] column ID, or NULL if the file does not have it; so for all below. */
    int64_t *id;
    double *x;         /**< [capacity] column X */
    double *y;         /**< [capacity] column Y */
    double *ra;        /**< [capacity] column RA */
    double *dec;       /**< [capacity] column DEC */
    double *weight;    /**< [capacity] column WEIGHT */
    double *r_gal;     /**< [capacity] column R_GAL */
    int32_t *mask;     /**< [capacity] column FLAGS */
    double *gf1;       /**< [capacity] column GF1 */
    double *gf2;       /**< [capacity] column GF2 */
    double *jacobian;  /**< [capacity][4] column JACOBIAN */
    double *psf_terms; /**< [capacity][info.psf_terms] column PSF_TERMS */
    uint32_t *dropped; /**< [capacity] column DROPPED */
    uint8_t *carried;  /**< [capacity][info.carried_bytes] cells of carried columns */
    void *memory;      /**< what shear_block_free() frees; NULL if the caller owns the memory */
} shear_block;
/** Allocate a block for `capacity` pairs; *block is NULL on error. */
int shear_block_new(shear_block **block, const shear_field_info *info, int capacity,
                    shear_error *err);
/** Free a block of shear_block_new(). NULL is accepted. */
void shear_block_free(shear_block *block);

/** Return the bytes that a block needs in the caller's own memory: shear_block_place(). */
size_t shear_block_bytes(const shear_field_info *info, int capacity);
/** Make a block in the caller's memory (shared between processes, say). `memory` is aligned to 64
 * bytes, has shear_block_bytes(info, capacity) bytes and outlives the block. Nothing is allocated,
 * and nothing needs to be freed. */
void shear_block_place(shear_block *block, const shear_field_info *info, int capacity,
                       void *memory);
/** Return the bytes of one PSF image, rounded up to a multiple of 64. */
size_t shear_psf_bytes(const shear_field_info *info);

/** Read pairs [first, first+count) into `block`; count <= capacity. Pixels that are not finite
 * (NaN, infinities) are kept, BLANK becomes NaN. SHEAR_E_FORMAT if the data end early. */
int shear_field_read(shear_field *field, int64_t first, int count, shear_block *block,
                     shear_error *err);

/** The same without pixels: only the columns of the table, and which PSF model is whose. */
int shear_field_read_columns(shear_field *field, int64_t first, int count, shear_block *block,
                             shear_error *err);

/** Read PSF image number `index`, from 0, into out[psf_ny][psf_nx]. Of models it is term index %
 * terms of model index / terms, in the lower left corner. */
int shear_field_read_psf(shear_field *field, int64_t index, double *out, shear_error *err);

/** The largest size in bytes that a gzipped file may unpack to, unless the environment variable
 * SHEAR_UNPACK_LIMIT overrides it. */
#define SHEAR_UNPACK_LIMIT (INT64_C(64) << 30)
/** Have gzipped files unpacked into these n files, at most SHEAR_N_PARTS: empty, open for writing,
 * one for each gzipped file. For a process that may not create a temporary file in $TMPDIR or /tmp.
 * Call it once, before any field is opened; the library owns the descriptors from then on. */
void shear_field_use_scratch(const int *fds, int n);

/** Sizes of checksum texts. */
enum {
    SHEAR_CHECKSUM_SIZE = 33 /**< bytes of a checksum's text, including its NUL */
};
/** Compute the content hash of a file (XXH3, 128 bits, lower-case hexadecimal). */
int shear_file_checksum(const char *path, char out[SHEAR_CHECKSUM_SIZE], shear_error *err);
/** Compute the content hash of an open file; `name` is for messages. */
int shear_fd_checksum(int fd, const char *name, char out[SHEAR_CHECKSUM_SIZE], shear_error *err);
/** Compute the checksum that identifies an input. For a field file it is its content hash; for
 * parts, a hash of the hashes of their files and of the HDUs chosen (`info`: of the open field), so
 * that it does not depend on how they were named. Parts that are those of one field file have that
 * file's hash. `fds` is as in shear_field_open_input(). */
int shear_input_checksum(const shear_input *input, const int *fds, const shear_field_info *info,
                         char out[SHEAR_CHECKSUM_SIZE], shear_error *err);

/** A shear_input_checksum() in steps, for a caller with other work to do in between. */
typedef struct shear_hashing shear_hashing;
/** Begin a checksum. `input` and `fds` are borrowed and must live as long. *h is NULL on error. */
int shear_hashing_new(shear_hashing **h, const shear_input *input, const int *fds,
                      const shear_field_info *info, shear_error *err);
/** Free the checksum. NULL is accepted. */
void shear_hashing_free(shear_hashing *h);
/** Read at most about `bytes` more; *done is set at the end. SHEAR_E_IO for a file that grows while
 * it is read. */
int shear_hashing_step(shear_hashing *h, int64_t bytes, bool *done, shear_error *err);
/** Return the bytes read so far. */
int64_t shear_hashing_bytes(const shear_hashing *h);
/** Write the checksum into `out`, after the last step. */
void shear_hashing_text(const shear_hashing *h, char out[SHEAR_CHECKSUM_SIZE]);
/** Compute the content hash of n bytes in memory. */
void shear_bytes_checksum(const void *bytes, size_t n, char out[SHEAR_CHECKSUM_SIZE]);

/** A field file that is being written. */
typedef struct shear_field_writer shear_field_writer;

/** The specification of a field file to be written. */
typedef struct shear_field_spec {
    const char *name;              /**< FIELD, or NULL */
    double pixscale;               /**< arcsec per pixel; NaN = leave out */
    bool has_truth;                /**< write SIM_G1 and SIM_G2 */
    double sim_g1;                 /**< true g1 of a simulated field */
    double sim_g2;                 /**< true g2 */
    shear_geometry geometry;       /**< sides of stamps and PSF */
    int64_t n_stamps;              /**< galaxies */
    int64_t n_psf;                 /**< 1, n_stamps, or fewer with SHEAR_COL_PSF_ID */
    int noise_planes;              /**< noise stamps per galaxy; 0 = 1 */
    enum shear_layout layout;      /**< of GALAXY and NOISE */
    int mosaic_columns;            /**< stamps per row of a mosaic; 0 = about square */
    const shear_psf_model *models; /**< [n_models] PSF models, whose planes are the PSF images; all
                                      of the same number of terms, and no larger than the geometry's
                                      PSF; or NULL */
    int n_models;                  /**< number of models; 0: the PSFs are images */
    enum shear_frame frame;        /**< of the shear */
    unsigned columns;              /**< of CATALOG: bits of enum shear_column; 0 = no table */
    const shear_carried *carried;  /**< [n_carried] its further columns; NULL without */
    int n_carried;                 /**< number of them */
    int bitpix;                    /**< of the stamps and the PSF: -32 or -64 */
    bool overwrite;                /**< replace an existing file */
    const char *const *history;    /**< lines for HISTORY, ended by NULL, or NULL */
} shear_field_spec;

/** Rows of the CATALOG table: arrays of [count], NULL if the column is not in the spec. */
typedef struct shear_catalog_columns {
    const int64_t *id;       /**< column ID */
    const double *x;         /**< column X */
    const double *y;         /**< column Y */
    const double *ra;        /**< column RA */
    const double *dec;       /**< column DEC */
    const double *weight;    /**< column WEIGHT */
    const double *r_gal;     /**< column R_GAL */
    const int32_t *psf_id;   /**< column PSF_ID */
    const int32_t *flags;    /**< column FLAGS */
    const double *gf1;       /**< column GF1 */
    const double *gf2;       /**< column GF2 */
    const double *jacobian;  /**< [count][4] column JACOBIAN */
    const double *psf_terms; /**< [count][terms] column PSF_TERMS */
    const uint32_t *dropped; /**< column DROPPED */
    const uint8_t *carried;  /**< [count][bytes of a row] cells of the spec's carried columns */
} shear_catalog_columns;

/** Create the field file `path`. It appears under its name only after shear_field_finish()
 * (temporary file, fsync, rename). A writer is used by one thread at a time. SHEAR_E_EXISTS if the
 * file exists and spec->overwrite is false. *w is NULL on error. */
int shear_field_create(shear_field_writer **w, const char *path, const shear_field_spec *spec,
                       shear_error *err);
/** Write pairs [first, first+count): galaxy[count][ny][nx], noise[count][noise_planes][ny][nx] and
 * the rows of the table (NULL without one). Pairs may be written in any order and in chunks of any
 * size. */
int shear_field_write(shear_field_writer *w, int64_t first, int count, const double *galaxy,
                      const double *noise, const shear_catalog_columns *columns, shear_error *err);
/** Write PSF image number `index`, from 0: psf[psf_ny][psf_nx]. */
int shear_field_write_psf(shear_field_writer *w, int64_t index, const double *psf,
                          shear_error *err);
/** Put the file in place. Frees w, also on error. */
int shear_field_finish(shear_field_writer *w, shear_error *err);
/** Abandon the file: remove its temporary file and free w. NULL is accepted. */
void shear_field_abort(shear_field_writer *w);

SHEAR_END_C

#endif
