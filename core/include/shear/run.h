/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * @file shear/run.h
 * Measure whole field files: reader, workers, sums and catalog together. For stamps in memory see
 * shear/arrays.h.
 */
#ifndef SHEAR_RUN_H
#define SHEAR_RUN_H

#include "shear/catalog.h"
#include "shear/error.h"
#include "shear/field.h"
#include "shear/plan.h"
#include "shear/settings.h"
#include "shear/sums.h"
#include "shear/symmetry.h"
#include "shear/work.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Where PSF images come from. */
typedef struct shear_psf_source {
    void *self; /**< the first argument of `read` */
    /** Gives image `index` of a field, from 0, as out[psf_ny][psf_nx]. */
    int (*read)(void *self, int64_t index, double *out, shear_error *err);
} shear_psf_source;

/** Make the request for a field's plan: its geometry, and its PSF or PSFs, which are read; of
 * several, up to 256 that are evenly spaced, and r_psf_px is their median radius. The settings are
 * borrowed. On error there is nothing to free. */
int shear_plan_request_read(shear_plan_request *request, const shear_settings *settings,
                            const shear_field_info *info, shear_psf_source psfs, shear_error *err);
/** Free what shear_plan_request_read() has read; only for requests that it has made. */
void shear_plan_request_deinit(shear_plan_request *request);

/** If the settings ask for it (shear_plan_wants_core()), find request->core_px: from up to 512
 * stamps in blocks that are evenly spaced in the file, read from slot 0 of the source, at most
 * `capacity` at a time. Masked stamps, stamps of weight 0 or a bad one, and stamps that are not
 * finite do not count. The core depends on the field, the settings and the PSF only (docs/method.md
 * section 2). */
int shear_plan_request_sample(shear_plan_request *request, const shear_field_info *info,
                              shear_source source, int capacity, shear_error *err);

/** The plan for an open field file: reads its PSFs and the sample. */
int shear_plan_for_field(shear_plan **plan, const shear_settings *settings, shear_field *field,
                         shear_error *err);

/** How a file is measured, and what else is wanted. */
typedef struct shear_run_options {
    int threads;              /**< 0 = all cores */
    const char *catalog_path; /**< where the rows are written to, or NULL */
    bool overwrite;           /**< replace an existing catalog */
    shear_symmetry *terms; /**< gets the terms of all stamps, whatever the estimator; they are held
                              twice until the file is done. Or NULL */
    const char *checksum; /**< of the input, for the catalog; NULL = computed when one is written */
    /** Called by one thread at a time, after each of its work units (shear/work.h), with the number
     * of stamps done; the run stops with SHEAR_E_CANCELLED when it returns non-zero. May be NULL.
     */
    int (*progress)(void *context, int64_t done, int64_t total);
    void *context; /**< the first argument of `progress` */
} shear_run_options;

/** What came of a file. */
typedef struct shear_run_report {
    shear_field_info field; /**< what it consists of */
    shear_plan_info plan;   /**< what the plan decided */
    shear_result result;    /**< of this file alone, by the settings' estimator, no jackknife */
    double seconds;         /**< wall clock, open to close */
} shear_run_report;

/**
 * Measure one field file and add its sums. Thread-safe for different sums.
 *
 * @param path      the field file
 * @param settings  the choices of the measurement
 * @param options   or NULL
 * @param sums      the file's sums are added to them
 * @param jack      its blocks are added to it in index order; or NULL
 * @param report    memory for what came of it
 * @param err       what was wrong, or NULL
 * @return SHEAR_OK; errors of opening, planning and measuring. On error nothing has been added to
 *     anything, and no catalog is left
 */
int shear_run_file(const char *path, const shear_settings *settings,
                   const shear_run_options *options, shear_field_sums *sums, shear_jackknife *jack,
                   shear_run_report *report, shear_error *err);
/** shear_run_file() for a field whose parts may be in separate files. */
int shear_run_input(const shear_input *input, const shear_settings *settings,
                    const shear_run_options *options, shear_field_sums *sums, shear_jackknife *jack,
                    shear_run_report *report, shear_error *err);

#ifdef __cplusplus
}
#endif

#endif
