/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shear/catalog.h: result catalogs: FITS binary table SHEAR, one row a stamp, in stamp order.
 *
 * Columns: ID, X, Y, RA, DEC where the field file gives them, then N1 N2 D U V M20 M02 M11 M4 FLUX
 * SNR WEIGHT (D) and FLAGS (J; shear/stamp.h). The header holds every setting (shear/settings.h),
 * what the plan resolved them to, the field's result, the input's name and checksum, and the
 * software's version.
 */
#ifndef SHEAR_CATALOG_H
#define SHEAR_CATALOG_H

#include "shear/error.h"
#include "shear/field.h"
#include "shear/plan.h"
#include "shear/sums.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct shear_catalog shear_catalog; /* a catalog being written */

/* Begin `path` for the stamps of `info`; temporary file, fsync and rename as for field files. Not
 * thread-safe. */
int shear_catalog_create(shear_catalog **c, const char *path, const shear_field_info *info,
                         bool overwrite, shear_error *err);
/* Rows [first, first+count); `block` supplies ID, X, Y, RA, DEC. Any order, any chunking. */
int shear_catalog_write(shear_catalog *c, int64_t first, int count, const shear_row *rows,
                        const shear_block *block, shear_error *err);
/* Write the header and put the file in place. Frees c, whatever it returns. */
int shear_catalog_finish(shear_catalog *c, const shear_plan *plan, const shear_result *result,
                         const char *input_name, const char *checksum, shear_error *err);
void shear_catalog_abort(shear_catalog *c);

/* ---- catalogs of work that outlives its process ----
 *
 * Their temporary file is called ".NAME.part", stays where the process ends, however it ends, and
 * can be gone on with: rows [0, rows) are there if shear_catalog_sync said so. `checksum` (of the
 * input) and n_stamps tie it to its input; settings and path are the caller's to keep the same. The
 * finished file has the same bytes, whether it was interrupted or not. */

/* Begin anew, whatever is there; an existing catalog is replaced in the end. */
int shear_catalog_begin(shear_catalog **c, const char *path, const shear_field_info *info,
                        const char *checksum, shear_error *err);
/* Go on behind row `rows`; later ones are written again. SHEAR_E_IO, SHEAR_E_FORMAT: there is none
 * that could be gone on with; then begin anew. */
int shear_catalog_resume(shear_catalog **c, const char *path, const shear_field_info *info,
                         const char *checksum, int64_t rows, shear_error *err);
/* Bring rows [0, rows), all of which have been written, to disk. */
int shear_catalog_sync(shear_catalog *c, int64_t rows, shear_error *err);
/* Close, and let the temporary file stay. NULL is accepted. */
void shear_catalog_suspend(shear_catalog *c);
/* Remove the temporary file of `path`, where there is one. SHEAR_E_IO. */
int shear_catalog_discard(const char *path, shear_error *err);

/* Reading one back (for plots and tests). */
typedef struct shear_catalog_table {
    int64_t n;
    char field[72];
    bool has_truth;
    double sim_g1, sim_g2;
    double beta_px, r_psf_px;
    shear_result result; /* valid, g1, g2, errors, cov12, jackknife, estimator, counts */
    shear_row *rows;     /* [n]; members that the table does not hold are NaN */
} shear_catalog_table;
int shear_catalog_read(shear_catalog_table **t, const char *path, shear_error *err);
void shear_catalog_table_free(shear_catalog_table *t);

#ifdef __cplusplus
}
#endif

#endif
