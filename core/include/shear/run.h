/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shear/run.h: measure whole field files: reader, workers, sums and catalog joined. */
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

/* Where PSF images come from: `read` gives image `index` of a field as out[psf_ny][psf_nx]. */
typedef struct shear_psf_source {
    void *self;
    int (*read)(void *self, int64_t index, double *out, shear_error *err);
} shear_psf_source;

/* Make the request for a field's plan: its geometry, and its PSF or PSFs, which are read. The
 * settings are borrowed. On an error there is nothing to free. */
int shear_plan_request_read(shear_plan_request *request, const shear_settings *settings,
                            const shear_field_info *info, shear_psf_source psfs, shear_error *err);
/* Free what shear_plan_request_read has read; for requests from there only. */
void shear_plan_request_deinit(shear_plan_request *request);

/* Where the settings want it (shear_plan_wants_core), find request->core_px: from up to 512 stamps
 * in blocks that are evenly spaced in the file, read from slot 0 of the source, at most `capacity`
 * at a time; masked ones, those of weight 0 or a bad one, and those that are not finite do not
 * count. Depends on the field, the settings and the PSF only. METHOD section 2. */
int shear_plan_request_sample(shear_plan_request *request, const shear_field_info *info,
                              shear_source source, int capacity, shear_error *err);

/* The plan for an open field file: reads its PSFs and the sample. */
int shear_plan_for_field(shear_plan **plan, const shear_settings *settings, shear_field *field,
                         shear_error *err);

typedef struct shear_run_options {
    int threads;              /* 0 = all cores */
    const char *catalog_path; /* or NULL */
    bool overwrite;           /* replace an existing catalog */
    shear_symmetry *terms;    /* or NULL: gets the terms of all stamps, whatever the estimator; they
                                 are held twice until the file is done */
    const char *checksum; /* of the input, for the catalog; NULL = computed when one is written */
    /* Called from one thread at a time, at most every `notify_stamps` or so; return non-zero to
     * stop the run (SHEAR_E_CANCELLED). May be NULL. */
    int (*progress)(void *context, int64_t done, int64_t total);
    void *context;
} shear_run_options;

typedef struct shear_run_report {
    shear_field_info field;
    shear_plan_info plan;
    shear_result result; /* of this file alone, by the settings' estimator, no jackknife */
    double seconds;      /* wall clock, open to close */
} shear_run_report;

/* Measure one field file and add its sums to `sums` (and its blocks, in index order, to `jack` if
 * not NULL). On error nothing has been added to any and no catalog is left. */
int shear_run_file(const char *path, const shear_settings *settings,
                   const shear_run_options *options, shear_field_sums *sums, shear_jackknife *jack,
                   shear_run_report *report, shear_error *err);
/* The same of parts in separate files. */
int shear_run_input(const shear_input *input, const shear_settings *settings,
                    const shear_run_options *options, shear_field_sums *sums, shear_jackknife *jack,
                    shear_run_report *report, shear_error *err);

#ifdef __cplusplus
}
#endif

#endif
