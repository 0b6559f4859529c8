/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * @file shear/catalog.h
 * Result catalogs: a FITS binary table SHEAR with one row per stamp, in stamp order.
 *
 * Columns: ID, X, Y, RA, DEC if the field file has them, then N1 N2 D U V M20 M02 M11 M4 NOISE_N1
 * NOISE_N2 NOISE_D HIGH_G HIGH_N FLUX SNR WEIGHT (doubles), FLAGS (a 32-bit integer;
 * shear/stamp.h), ART_X and ART_Y (the artefact's pixel, from 1; 0: none). The header holds every
 * setting (shear/settings.h), what the plan resolved them to, the field's result, the input's name
 * and checksum, and the version of the software.
 *
 * A handle is used by one thread at a time.
 */
#ifndef SHEAR_CATALOG_H
#define SHEAR_CATALOG_H

#include "shear/error.h"
#include "shear/field.h"
#include "shear/linkage.h"
#include "shear/plan.h"
#include "shear/sums.h"

SHEAR_BEGIN_C

/** A catalog that is being written. */
typedef struct shear_catalog shear_catalog;

/** Create the catalog `path` for the stamps of `info`. It appears under its name only when it is
 * finished (temporary file, fsync, rename). SHEAR_E_EXISTS if the file exists and `overwrite` is
 * false. *c is NULL on error. */
int shear_catalog_create(shear_catalog **c, const char *path, const shear_field_info *info,
                         bool overwrite, shear_error *err);
/** Write rows [first, first+count); `block` supplies ID, X, Y, RA, DEC. Rows may be written in any
 * order and in chunks of any size. */
int shear_catalog_write(shear_catalog *c, int64_t first, int count, const shear_row *rows,
                        const shear_block *block, shear_error *err);
/** Write the header and put the file in place. Frees c, also on error. */
int shear_catalog_finish(shear_catalog *c, const shear_plan *plan, const shear_result *result,
                         const char *input_name, const char *checksum, shear_error *err);
/** Abandon the catalog: remove its temporary file and free c. NULL is accepted. */
void shear_catalog_abort(shear_catalog *c);

/**
 * @name Catalogs of work that outlives its process
 * Their temporary file is called ".NAME.part". It remains when the process ends, for whatever
 * reason, and can be continued: it contains rows [0, rows) if shear_catalog_sync() returned
 * SHEAR_OK for them. `checksum` (of the input) and n_stamps tie it to its input; the caller must
 * keep settings and path the same. The finished file has the same bytes, whether it was interrupted
 * or not.
 * @{
 */

/** Begin from the start, whatever exists; an existing catalog is replaced in the end. */
int shear_catalog_begin(shear_catalog **c, const char *path, const shear_field_info *info,
                        const char *checksum, shear_error *err);
/** Continue after row `rows`; later rows must be written again. SHEAR_E_IO or SHEAR_E_FORMAT if no
 * file can be continued: begin from the start then. */
int shear_catalog_resume(shear_catalog **c, const char *path, const shear_field_info *info,
                         const char *checksum, int64_t rows, shear_error *err);
/** Sync rows [0, rows), all of which have been written, to disk. */
int shear_catalog_sync(shear_catalog *c, int64_t rows, shear_error *err);
/** Close the temporary file, keep it, and free c. NULL is accepted. */
void shear_catalog_suspend(shear_catalog *c);
/** Remove the temporary file of `path`, if there is one. */
int shear_catalog_discard(const char *path, shear_error *err);
/** @} */

/** A catalog in memory (for plots and tests). */
typedef struct shear_catalog_table {
    int64_t n;                         /**< rows */
    char field[SHEAR_FIELD_NAME_SIZE]; /**< the field's name */
    bool has_truth;                    /**< sim_g1 and sim_g2 are known */
    double sim_g1;                     /**< true g1 of a simulated field */
    double sim_g2;                     /**< true g2 */
    double beta_px;                    /**< the plan's beta */
    double r_psf_px;                   /**< the plan's R_PSF */
    shear_result result; /**< the numbers that the header holds; NaN or 0 for others */
    shear_row *rows;     /**< [n]; members without a column are NaN */
} shear_catalog_table;
/** Read a result catalog; *t is NULL on error. */
int shear_catalog_read(shear_catalog_table **t, const char *path, shear_error *err);
/** Free the table. NULL is accepted. */
void shear_catalog_table_free(shear_catalog_table *t);

SHEAR_END_C

#endif
