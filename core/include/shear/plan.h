/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * @file shear/plan.h
 * Plan once, execute many times, from many threads (as with FFTW).
 *
 * A plan holds all that stamps of one shape have in common: the resolved settings (method, fine
 * grid, beta, filter), interpolation tables, FFT plans and, if one PSF serves the field, its
 * transfer T(k). It is immutable once made: any number of threads may use it at the same time. A
 * workspace holds the scratch memory of one thread. shear_measure() allocates nothing.
 *
 * A plan does not depend on timing, so that the same machine returns the same bits in every
 * process. Sides that are products of 2, 3 and 5 are fastest. Lengths are in galaxy pixels, wave
 * numbers k in radians per galaxy pixel.
 */
#ifndef SHEAR_PLAN_H
#define SHEAR_PLAN_H

#include "shear/centring.h"
#include "shear/error.h"
#include "shear/linkage.h"
#include "shear/psf.h"
#include "shear/settings.h"
#include "shear/stamp.h"
#include "shear/sums.h"

SHEAR_BEGIN_C

/** A plan; immutable. */
typedef struct shear_plan shear_plan;
/** One thread's scratch memory for a plan. */
typedef struct shear_workspace shear_workspace;

/** The shapes of stamps and PSF images. */
typedef struct shear_geometry {
    int nx;                /**< columns of a stamp, galaxy pixels */
    int ny;                /**< rows of a stamp, galaxy pixels */
    int psf_nx;            /**< columns of a PSF image, samples */
    int psf_ny;            /**< rows of a PSF image, samples */
    double psf_oversample; /**< PSF samples per galaxy pixel (keyword OVERSAMP), at least 0.1; need
                              not be a whole number */
} shear_geometry;

/** The wave numbers at which galaxies have no power, so that only noise is left. They depend on
 * R_PSF. */
enum shear_noise_band {
    SHEAR_NOISE_BAND_NONE = 0, /**< none: narrow PSF, or interpolated; or noise-level is none */
    SHEAR_NOISE_BAND_HIGH,     /**< |k| >= 3/4 of Nyquist */
    SHEAR_NOISE_BAND_CORNERS   /**< |k| >= Nyquist, the corners of the plane of modes */
};

/** Return "none", "high" or "corners"; "unknown" for any other number. */
const char *shear_noise_band_name(enum shear_noise_band band);

/** The decisions of a plan. */
typedef struct shear_plan_info {
    shear_geometry geometry;                /**< as requested */
    enum shear_interpolation interpolation; /**< never AUTO */
    int oversample;                         /**< s of the galaxy's fine grid; 1 for none */
    double psf_oversample;    /**< samples per galaxy pixel at which the PSF is transformed */
    int fine_nx;              /**< nx s */
    int fine_ny;              /**< ny s */
    double r_psf_px;          /**< PSF scale radius */
    double beta_px;           /**< target scale radius */
    enum shear_frame frame;   /**< of the moments */
    double beta;              /**< target scale radius in the frame's unit: pixels, or arcsec */
    enum shear_filter filter; /**< PAPER, EDGE or NONE; an explicit core counts as PAPER */
    bool filter_per_stamp;    /**< PAPER, and the core follows each stamp's R_GAL */
    double core_px;           /**< NaN without a filter, and if it differs from stamp to stamp */
    bool core_found;          /**< the core is the smallest that leaves the file's galaxies whole */
    double width_px;          /**< NaN without a filter */
    enum shear_noise_band noise_band; /**< where the noise level is measured */
    double k_cut; /**< modes at |k| >= k_cut are left out; for a plan without a PSF, the grid's
                     limit */
    shear_psf_summary psf;   /**< quality of the PSF; of several: shear_plan_note_psfs() */
    shear_centring centring; /**< as requested */
} shear_plan_info;

/** Return the bias of the shear from stamps that are too small for beta, which arises because a
 * transform treats them as periodic: as a fraction of the shear or, for stamps that are not square,
 * as an additive bias if that is larger. It is computed for a round Gaussian galaxy 1.5 times as
 * large as the PSF and a shear of 0.02, without noise and filter (docs/method.md section 3.2).
 * Estimates above 0.1 are orders of magnitude only; for a larger galaxy the bias is larger. */
double shear_plan_periodic_bias(const shear_plan_info *plan);

/** What a plan is made from. Equal requests give equal plans. All pointers are borrowed during a
 * call. A member that is zero is not given. */
typedef struct shear_plan_request {
    const shear_settings *settings; /**< NULL: the defaults */
    shear_geometry geometry;        /**< must be given */
    const double *psf; /**< [psf_ny][psf_nx] the field's one PSF; NULL: each stamp has its own
                          (shear_stamps.psf) */
    double r_psf_px; /**< the PSFs' scale radius from shear_psf_radius(), for the automatic choices;
                        must be given if psf is NULL */
    /** [n_models] models of the PSF, instead of `psf`: each stamp has the number of its model and
     * its coefficients (shear_stamps.psf_terms). All have the same number of terms. */
    const shear_psf_model *models;
    int n_models;           /**< 0: no models */
    const double *terms;    /**< coefficients of a typical galaxy, which show whether beta is large
                               enough, and how sharp the PSF is; or NULL */
    int model;              /**< its model */
    enum shear_frame frame; /**< of the moments; stamps must have Jacobians unless it is PIXEL */
    double pixel_scale; /**< arcsec per pixel, the median sqrt|det J| of the stamps; needed unless
                           the frame is PIXEL: beta = beta_px times it */
    bool has_r_gal;     /**< stamps will have R_GAL, which decides filter = auto */
    double core_px;     /**< for filter = auto: the core found by shear_plan_request_sample() */
    const shear_psf_quality *psfs; /**< [n_psfs] quality of a sample of the stamps' own PSFs */
    int n_psfs;                    /**< usable PSFs of that sample */
    int n_unusable;                /**< unusable PSFs of that sample */
    shear_centring centring;       /**< of a sample of stamps with positions, for a warning */
} shear_plan_request;

/**
 * Make a plan. Thread-safe (planning is serialized).
 *
 * @param plan     the plan, to be freed by shear_plan_free(); NULL on error
 * @param request  what it is made from
 * @param err      what was wrong, or NULL
 * @return SHEAR_OK; SHEAR_E_SETTING; SHEAR_E_BETA (names the smallest beta that works);
 * SHEAR_E_PSF; SHEAR_E_NEGATIVE (a log method on a PSF with samples below -1e-4 of its peak);
 * SHEAR_E_FORMAT for impossible shapes; SHEAR_E_NOMEM
 */
int shear_plan_new(shear_plan **plan, const shear_plan_request *request, shear_error *err);
/** Add a sample of the stamps' own PSFs to shear_plan_info.psf: n usable ones, and the number of
 * unusable ones. Call it only before the plan is shared with other threads. */
void shear_plan_note_psfs(shear_plan *plan, const shear_psf_quality *each, int n, int unusable);
/** Free a plan that is no longer in use. NULL is accepted. */
void shear_plan_free(shear_plan *plan);

/** Return whether the plan would use request->core_px (filter = auto, no explicit core, no
 * R_GAL). */
bool shear_plan_wants_core(const shear_plan_request *request);

/** The radii of a plan. */
typedef struct shear_plan_radii {
    double r_psf_px; /**< PSF scale radius */
    double beta_px;  /**< target scale radius */
    double width_px; /**< width of the filter's Gaussian edge */
} shear_plan_radii;
/** Compute the radii that the plan of this request would have. Errors as of shear_plan_new(). */
int shear_plan_find_radii(shear_plan_radii *radii, const shear_plan_request *request,
                          shear_error *err);

/** Return the plan's decisions; valid as long as the plan. */
const shear_plan_info *shear_plan_get_info(const shear_plan *plan);
/** Return the settings of the request; valid as long as the plan. */
const shear_settings *shear_plan_get_settings(const shear_plan *plan);

/** Allocate the scratch memory of one thread for `plan`, which must outlive it. *ws is NULL on
 * error. */
int shear_workspace_new(shear_workspace **ws, const shear_plan *plan, shear_error *err);
/** Free the workspace. NULL is accepted. */
void shear_workspace_free(shear_workspace *ws);

/** Return the bytes of a plan, without the overhead of allocations and small items. */
int64_t shear_plan_bytes(const shear_plan *plan);
/** Return the bytes of a workspace of this plan, likewise. */
int64_t shear_workspace_bytes(const shear_plan *plan);
/** The memory that a plan needs, in bytes. */
typedef struct shear_memory {
    int64_t plan;      /**< of the plan itself */
    int64_t planning;  /**< in addition, while the plan is made */
    int64_t workspace; /**< of each workspace, at most; shear_workspace_bytes() is exact once the
                          plan is made */
} shear_memory;
/** Compute the memory of a plan without making it. Errors as of shear_plan_new(); *memory is 0
 * then. */
int shear_plan_memory(shear_memory *memory, const shear_plan_request *request, shear_error *err);

/** Measure pair i of `stamps` into *row. The shape must be the plan's. Returns SHEAR_OK also for a
 * flagged row; SHEAR_E_NEGATIVE if a log method meets negative pixels (names the stamp);
 * SHEAR_E_INTERNAL for a shape that is not the plan's. */
int shear_measure(const shear_plan *plan, shear_workspace *ws, const shear_stamps *stamps, int i,
                  shear_row *row, shear_error *err);

/** Examine pair i without measuring it: *row gets the flags that need no transform (all but
 * SHEAR_FLAG_OVERFLOW, and SHEAR_FLAG_PSF_UNUSABLE only if the stamp has no PSF) and the artefact's
 * place; its numbers are NaN. SHEAR_E_INTERNAL as above. */
int shear_examine(const shear_plan *plan, shear_workspace *ws, const shear_stamps *stamps, int i,
                  shear_row *row, shear_error *err);

/** Measure pairs [from, to) of `stamps` into rows[0 .. to-from), on the calling thread. A PSF that
 * serves consecutive stamps (equal psf_index) is transformed once. Stops at the first error. */
int shear_measure_range(const shear_plan *plan, shear_workspace *ws, const shear_stamps *stamps,
                        int from, int to, shear_row *rows, shear_error *err);

/**
 * Measure all pairs of `stamps` on several OpenMP threads. The rows do not depend on the number of
 * threads, to the last bit.
 *
 * @param plan     the plan
 * @param stamps   the pairs
 * @param threads  number of threads; 0: all cores
 * @param ws       array of `threads` workspaces of this plan, or NULL: they are made and freed
 * inside
 * @param rows     [stamps->count] the results, in stamp order
 * @param err      what was wrong, or NULL
 * @return the first error by stamp index, as of shear_measure()
 */
int shear_measure_batch(const shear_plan *plan, const shear_stamps *stamps, int threads,
                        shear_workspace *const *ws, shear_row *rows, shear_error *err);

/** Compute the scale radius R_PSF = sqrt(A/pi) in galaxy pixels of psf[ny][nx], with `oversample`
 * samples per galaxy pixel, which need not be a whole number. A is the area in which the PSF
 * exceeds exp(-1/2) of its peak, which is exact for a Gaussian. Between samples the logarithm is
 * interpolated (log-bicubic), so that the radius of an under-sampled PSF is right, too.
 * SHEAR_E_PSF: not finite, no positive peak, sum not positive. */
int shear_psf_radius(const double *psf, int nx, int ny, double oversample, double *r_psf_px,
                     shear_error *err);

/** The steps of one measurement as images, for figures and teaching. The modes are centred: k = 0
 * is at [spec_ny/2][spec_nx/2], and both sides are odd. */
typedef struct shear_inspection {
    int fine_nx;             /**< columns of the fine images */
    int fine_ny;             /**< rows of the fine images */
    double *galaxy_fine;     /**< [fine_ny][fine_nx] the galaxy, interpolated */
    double *noise_fine;      /**< [fine_ny][fine_nx] the noise, interpolated */
    double *galaxy_filtered; /**< [fine_ny][fine_nx] the galaxy, interpolated and filtered */
    int spec_nx;             /**< columns of the spectra */
    int spec_ny;             /**< rows of the spectra */
    double *power;           /**< [spec_ny][spec_nx] noise-corrected power before the transfer */
    double *target_power;    /**< [spec_ny][spec_nx] the same after it: P(k) */
    double *transfer;        /**< [spec_ny][spec_nx] T(k) */
} shear_inspection;
/** Fill *out for pair i; free it with shear_inspection_deinit(). Errors as of shear_measure(), and
 * SHEAR_E_NOMEM. */
int shear_inspect(const shear_plan *plan, shear_workspace *ws, const shear_stamps *stamps, int i,
                  shear_inspection *out, shear_error *err);
/** Free the images. An inspection that is all zero is accepted. */
void shear_inspection_deinit(shear_inspection *out);

SHEAR_END_C

#endif
