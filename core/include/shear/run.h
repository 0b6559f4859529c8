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
#include "shear/linkage.h"
#include "shear/plan.h"
#include "shear/settings.h"
#include "shear/sums.h"
#include "shear/symmetry.h"
#include "shear/work.h"

SHEAR_BEGIN_C

/** A source of PSF images, or of PSF models and their coefficients. */
typedef struct shear_psf_source {
    void *self; /**< the first argument of the functions */
    /** Read image `index` of a field, from 0, into out[psf_ny][psf_nx]. */
    int (*read)(void *self, int64_t index, double *out, shear_error *err);
    /** [info->n_models] the models, instead of images. The request borrows them. */
    const shear_psf_model *models;
    /** Read the coefficients [terms] of stamp `stamp`, and set *model to the number of its model;
     * -1: it has none (SHEAR_FLAGS_WITHOUT_PSF). Stamps that are left out for their pixels count:
     * not every reader knows of them yet. Only with models. */
    int (*read_terms)(void *self, int64_t stamp, int *model, double *terms, shear_error *err);
} shear_psf_source;

/** Make the request for a field's plan: its geometry, and its PSF, which is read. If there are
 * several, up to 256 that are evenly spaced are read, and r_psf_px is their median radius. Likewise
 * with models, whose PSFs are those of evenly spaced stamps that have one; frame and pixel scale
 * are the field's. The settings are borrowed. On error there is nothing to free. */
int shear_plan_request_read(shear_plan_request *request, const shear_settings *settings,
                            const shear_field_info *info, shear_psf_source psfs, shear_error *err);
/** Free what shear_plan_request_read() has read. Only for requests that it has made. */
void shear_plan_request_deinit(shear_plan_request *request);

/** If the settings need it (shear_plan_wants_core()), find request->core_px from up to 512 stamps,
 * in blocks that are evenly spaced in the file. They are read from slot 0 of the source, at most
 * `capacity` at a time. Stamps that are masked, not finite, or have a weight of 0 or a bad one are
 * left out. If the stamps were cut at positions (an exposure), find request->centring, too, from
 * the first 64 that are not dropped. The core depends only on the field, the settings and the PSF
 * (docs/method.md section 2). */
int shear_plan_request_sample(shear_plan_request *request, const shear_field_info *info,
                              shear_source source, int capacity, shear_error *err);

/** Make the plan for an open field file, reading its PSFs and the sample. *plan is NULL on
 * error. */
int shear_plan_for_field(shear_plan **plan, const shear_settings *settings, shear_field *field,
                         shear_error *err);

/** Options and additional outputs. All zero, or NULL: the defaults. */
typedef struct shear_run_options {
    int threads;              /**< 0 = all cores */
    const char *catalog_path; /**< where to write the rows, or NULL */
    bool overwrite;           /**< replace an existing catalog */
    shear_sink rows;          /**< gets the rows, flagged ones, too; {0}: nobody */
    shear_symmetry *terms; /**< gets the terms of all stamps, whatever the estimator; they are held
                              twice until the file is done; or NULL */
    const char *checksum;  /**< of the input, for the catalog; NULL = it is computed if a catalog is
                              written */
    /** Called by one thread at a time, after each of its work units (shear/work.h), with the number
     * of stamps done. The run stops with SHEAR_E_CANCELLED if it returns non-zero. May be NULL. */
    int (*progress)(void *context, int64_t done, int64_t total);
    void *context; /**< the first argument of `progress` */
} shear_run_options;

/** The results of a file. */
typedef struct shear_run_report {
    shear_field_info field; /**< properties of the field */
    shear_plan_info plan;   /**< what the plan decided */
    shear_result result;    /**< of this file alone, by the settings' estimator, no jackknife */
    double seconds;         /**< wall clock, open to close */
} shear_run_report;

/**
 * Measure one field file and add its sums. Thread-safe for different sums.
 *
 * @param path      the field file
 * @param settings  the settings of the measurement
 * @param options   options and additional outputs, or NULL
 * @param sums      sums to which the file's are added
 * @param jack      jackknife to which the file's blocks are added in order, or NULL
 * @param report    memory for the results
 * @param err       what was wrong, or NULL
 * @return SHEAR_OK; errors of opening, planning and measuring. On error sums, jack and terms are
 *     unchanged, and no catalog is left
 */
int shear_run_file(const char *path, const shear_settings *settings,
                   const shear_run_options *options, shear_field_sums *sums, shear_jackknife *jack,
                   shear_run_report *report, shear_error *err);
/** As shear_run_file(), for a field whose parts may be in separate files. */
int shear_run_input(const shear_input *input, const shear_settings *settings,
                    const shear_run_options *options, shear_field_sums *sums, shear_jackknife *jack,
                    shear_run_report *report, shear_error *err);

SHEAR_END_C

#endif
