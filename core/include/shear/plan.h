/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shear/plan.h: plan once, execute many times, from many threads (as with FFTW).
 *
 * A plan holds all that stamps of one shape have in common: the resolved settings (method, fine
 * grid, beta, filter), interpolation tables, FFT plans and, where one PSF serves the field, its
 * transfer T(k). It is immutable once made: any number of threads may use it at the same time. A
 * workspace holds the scratch memory of one thread. shear_measure allocates nothing.
 *
 * No timing enters a plan, so that the same machine returns the same bits in every process. Sides
 * that are products of 2, 3 and 5 are fastest.
 */
#ifndef SHEAR_PLAN_H
#define SHEAR_PLAN_H

#include "shear/error.h"
#include "shear/psf.h"
#include "shear/settings.h"
#include "shear/stamp.h"
#include "shear/sums.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct shear_plan shear_plan;
typedef struct shear_workspace shear_workspace;

typedef struct shear_geometry {
    int nx, ny;         /* stamp, galaxy pixels */
    int psf_nx, psf_ny; /* PSF image, samples */
    int psf_oversample; /* PSF samples per galaxy pixel (keyword OVERSAMP), >= 1 */
} shear_geometry;

/* The wave numbers at which no galaxy has power beside the noise: a PSF of R_PSF leaves none there.
 */
enum shear_noise_band {
    SHEAR_NOISE_BAND_NONE = 0, /* nowhere: narrow PSF, or interpolated; or noise-level is none */
    SHEAR_NOISE_BAND_HIGH,     /* |k| >= 3/4 of Nyquist */
    SHEAR_NOISE_BAND_CORNERS   /* |k| >= Nyquist, the corners of the plane of modes */
};

const char *
shear_noise_band_name(enum shear_noise_band band); /* "none", "high" or "corners"; never NULL */

/* What the plan decided; all lengths in galaxy pixels, k in radians per galaxy pixel. */
typedef struct shear_plan_info {
    shear_geometry geometry;
    enum shear_interpolation interpolation; /* never AUTO */
    int oversample;                         /* s of the galaxy's fine grid; 1 for none */
    int psf_oversample;       /* samples per galaxy pixel at which the PSF is transformed */
    int fine_nx, fine_ny;     /* nx s, ny s */
    double r_psf_px;          /* PSF scale radius */
    double beta_px;           /* target scale radius */
    enum shear_filter filter; /* PAPER, EDGE or NONE; an explicit core counts as PAPER */
    bool filter_per_stamp;    /* PAPER, and the core follows each stamp's R_GAL */
    double core_px;           /* NaN for none or per stamp */
    bool core_found; /* the core is the smallest that leaves the file's own galaxies whole */
    double width_px; /* NaN for none */
    enum shear_noise_band noise_band; /* where the noise level is read off */
    double k_cut; /* modes at |k| >= k_cut are left out; for a plan without PSF, the grid's limit */
    shear_psf_summary psf; /* what the PSF looked like; of several: shear_plan_note_psfs */
} shear_plan_info;

/* By how much stamps that are too small for beta bias the shear, as a part of it or, of stamps that
 * are not square, beside it: a transform takes them for periodic. Of a round Gaussian galaxy 1.5
 * times as large as the PSF, of a shear of 0.02, without noise and filter (docs/method.md, section
 * 3.2). Estimates above 0.1 are orders of magnitude only; a galaxy that is larger has more. */
double shear_plan_periodic_bias(const shear_plan_info *plan);

/* What a plan is made from. Equal requests give equal plans. All pointers are borrowed while the
 * call runs. A member that is zero is not given. */
typedef struct shear_plan_request {
    const shear_settings *settings; /* NULL: the defaults */
    shear_geometry geometry;
    const double *psf; /* [psf_ny][psf_nx] the field's one PSF; NULL: each stamp brings its own
                          (shear_stamps.psf) */
    double r_psf_px;   /* where psf is NULL: the scale radius for the automatic choices
                          (shear_psf_radius) */
    bool has_r_gal;    /* stamps will come with R_GAL, which decides filter = auto */
    double core_px;    /* for filter = auto: found from the galaxies (shear/run.h); 0: none was */
    const shear_psf_quality *psfs; /* [n_psfs] what a sample of the stamps' own PSFs is like */
    int n_psfs, n_unusable;        /* usable and unusable PSFs of that sample */
} shear_plan_request;

/* Make a plan. Errors: SHEAR_E_SETTING, SHEAR_E_BETA (names the smallest beta that works),
 * SHEAR_E_PSF, SHEAR_E_NEGATIVE (a log method on a PSF with samples below -10^-4 of its peak),
 * SHEAR_E_NOMEM. *plan is NULL on error. Thread-safe (planning is serialised). */
int shear_plan_new(shear_plan **plan, const shear_plan_request *request, shear_error *err);
/* Of a plan that stamps bring their PSFs to: what a sample of these looked like, n usable ones and
 * some that are not, for shear_plan_info. Before the plan is shared with other threads. */
void shear_plan_note_psfs(shear_plan *plan, const shear_psf_quality *each, int n, int unusable);
void shear_plan_free(shear_plan *plan);

/* Would the plan use request->core_px (filter = auto, no core of one's own, no R_GAL)? */
bool shear_plan_wants_core(const shear_plan_request *request);

/* The radii that the plan would have. */
typedef struct shear_plan_radii {
    double r_psf_px, beta_px, width_px; /* R_PSF, beta, the width of the filter's fall */
} shear_plan_radii;
/* Errors as of shear_plan_new. */
int shear_plan_find_radii(shear_plan_radii *radii, const shear_plan_request *request,
                          shear_error *err);

const shear_plan_info *shear_plan_get_info(const shear_plan *plan);
const shear_settings *shear_plan_get_settings(const shear_plan *plan);

/* Scratch memory for one thread, bound to `plan` (which must outlive it). */
int shear_workspace_new(shear_workspace **ws, const shear_plan *plan, shear_error *err);
void shear_workspace_free(shear_workspace *ws);

/* What they take, in bytes; allocations' own overhead and small things are not counted. */
int64_t shear_plan_bytes(const shear_plan *plan);
int64_t shear_workspace_bytes(const shear_plan *plan);
/* The same of a plan that is not made yet, without taking much. A workspace may turn out smaller:
 * how much is known once the plan is made. Arguments and errors as of shear_plan_new. */
typedef struct shear_memory {
    int64_t plan;
    int64_t planning;  /* beside it, while it is made */
    int64_t workspace; /* at most */
} shear_memory;
int shear_plan_memory(shear_memory *memory, const shear_plan_request *request, shear_error *err);

/* Measure pair number i of `stamps` into *row. The shape must be the plan's.
 * Returns SHEAR_OK, also for a flagged row; SHEAR_E_NEGATIVE where a log method meets negative
 * pixels (names the stamp); SHEAR_E_INTERNAL for a shape that is not the plan's. */
int shear_measure(const shear_plan *plan, shear_workspace *ws, const shear_stamps *stamps, int i,
                  shear_row *row, shear_error *err);

/* Look at pair number i without measuring it: *row has the flags that this needs no transform for
 * (all but SHEAR_FLAG_OVERFLOW, and SHEAR_FLAG_PSF_UNUSABLE only where the stamp names no PSF) and
 * the artefact's place; its numbers are NaN. Errors: SHEAR_E_INTERNAL as above. */
int shear_examine(const shear_plan *plan, shear_workspace *ws, const shear_stamps *stamps, int i,
                  shear_row *row, shear_error *err);

/* Measure pairs [from, to) of `stamps` into rows[0 .. to-from), on the calling thread. A PSF that
 * serves neighbouring stamps (equal psf_index) is transformed once. Stops at the first error. */
int shear_measure_range(const shear_plan *plan, shear_workspace *ws, const shear_stamps *stamps,
                        int from, int to, shear_row *rows, shear_error *err);

/* Measure all pairs of `stamps` on `threads` OpenMP threads (0: all cores).
 *   ws    array of `threads` workspaces of this plan, or NULL: made and freed inside
 *   rows  [stamps->count], in stamp order
 * The first error by stamp index is returned. The rows do not depend on `threads`, to the last bit.
 */
int shear_measure_batch(const shear_plan *plan, const shear_stamps *stamps, int threads,
                        shear_workspace *const *ws, shear_row *rows, shear_error *err);

/* The scale radius R_PSF = sqrt(A/pi) in galaxy pixels, A the area where the PSF exceeds exp(-1/2)
 * of its peak; exact for a Gaussian. Between samples the logarithm is interpolated (log-bicubic),
 * so that an under-sampled PSF has the right radius too. psf [ny][nx], oversample samples per
 * galaxy pixel SHEAR_E_PSF: not finite, no positive peak, sum not positive. */
int shear_psf_radius(const double *psf, int nx, int ny, int oversample, double *r_psf_px,
                     shear_error *err);

/* The steps of one measurement as images, for pictures and teaching. Call shear_inspection_deinit.
 */
typedef struct shear_inspection {
    int fine_nx, fine_ny;
    double *galaxy_fine, *noise_fine; /* [fine_ny][fine_nx] interpolated */
    double *galaxy_filtered;          /* [fine_ny][fine_nx] interpolated and filtered */
    int spec_nx, spec_ny; /* modes, centred: k = 0 at [spec_ny/2][spec_nx/2], odd sizes */
    double *power;        /* [spec_ny][spec_nx] corrected power before the transfer */
    double *target_power; /* [spec_ny][spec_nx] the same after it: P(k) */
    double *transfer;     /* [spec_ny][spec_nx] T(k) */
} shear_inspection;
int shear_inspect(const shear_plan *plan, shear_workspace *ws, const shear_stamps *stamps, int i,
                  shear_inspection *out, shear_error *err);
void shear_inspection_deinit(shear_inspection *out);

#ifdef __cplusplus
}
#endif

#endif
