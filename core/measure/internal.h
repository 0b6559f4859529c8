/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/internal.h: the members of a plan and a workspace, for the files that execute them. */
#pragma once

#include "fft/fft.h"
#include "measure/filter.h"
#include "measure/galaxy_transfer.h"
#include "measure/high_power.h"
#include "measure/moments.h"
#include "measure/photometry.h"
#include "measure/plateau.h"
#include "measure/psf_basis.h"
#include "measure/psf_direct.h"
#include "measure/psf_sky.h"
#include "measure/psf_transform.h"
#include "measure/sharpness.h"
#include "measure/surface.h"
#include "measure/transfer.h"
#include "shear/plan.h"

/* A PSF model. */
typedef struct plan_model {
    shear_psf_model model; /* with samples of the plan's own */
    psf_basis basis;       /* unless it lies along the sky's axes: ... */
    psf_sky sky;           /* ... then this */
} plan_model;

struct shear_plan {
    shear_settings settings;
    shear_plan_info info;
    bool needs_jacobians;        /* for the frame, or a PSF model */
    double pixel_scale;          /* arcsec; 0: not known */
    double unit;                 /* of the frame, per pixel: 1, or arcsec; and */
    double r_psf;                /* R_PSF in it */
    surface_grid grid;           /* from stamps to the fine grid */
    fft_plan *along_x, *along_y; /* lengths fine_nx and fine_ny */
    transfer_plan transfer_plan;
    double psf_side;             /* samples per pixel of the PSFs, at least */
    bool by_fft;                 /* PSFs are images with a whole number of samples per pixel: ... */
    psf_transform psf_transform; /* ... so they are transformed */
    psf_waves waves;             /* or with any other number: so */
    bool has_psf;                /* one image serves all stamps: ... */
    double *power;               /* ... its |W|^2 */
    transfer transfer;           /* ... and its transfer, in the pixel frame */
    bool has_transfer;           /* which serves all stamps */
    int n_models;                /* PSF models: ... */
    plan_model *models;          /* ... [n_models], and ... */
    int model_nx, model_ny;      /* ... the longest sides of their images */
    sharpness suspicious;        /* a stamp that is as sharp as that is looked at closely */
    filter_pair filter;          /* if there is one, and it does not differ from stamp to stamp */
    high_band high;              /* the modes of the noise level */
    plateau plateau;             /* if shot_noise is PLATEAU */
    moments flat;                /* moments of a flat power of 1 under `transfer` */
    sharpness sharpness;         /* of the field's one PSF, if there is one */
    void *memory;                /* of all tables, */
    size_t bytes;                /* so many */
};

/* Fill the tables of the models; look at the PSF of the request's typical galaxy, if it has one.
 * SHEAR_E_BETA, SHEAR_E_PSF, SHEAR_E_NOMEM. */
int plan_models_fill(shear_plan *plan, const shear_plan_request *request, shear_error *err);
/* Note the cut of the field's one PSF or a typical galaxy's, in the pixel frame, and how far modes
 * count: a little farther than with it, unless a cut has ended them. */
void plan_note_transfer(shear_plan *plan, const transfer *t);
/* Count the bytes that plan_models_fill takes for a while. */
void plan_models_scratch(const shear_plan *plan, const shear_plan_request *request, arena *a);

/* Begin a plan without tables: what the request's settings leave open is resolved. Errors as of
 * shear_plan_new. */
int plan_resolve(shear_plan *plan, const shear_plan_request *request, shear_error *err);

struct shear_workspace {
    void *memory; /* of all arrays */
    surface galaxy, noise;
    fft_lanes strip;    /* [fine_ny + 1][FFT_LANES] galaxy + i noise, a strip of columns */
    fft_lanes lanes[3]; /* [longer side + 1][FFT_LANES] for transforms */
    /* subtracted from galaxy and noise stamp before the filter; 0: nothing */
    double level, noise_level;
    double *modes;           /* the pair, transformed along y: see pack.c */
    size_t lane_size;        /* size of one part of `modes` */
    filter_pair filter;      /* if it differs from stamp to stamp */
    psf_scratch psf_scratch; /* if each stamp has its own PSF image: by FFT ... */
    psf_direct direct;       /* ... or directly */
    psf_sky_scratch psf_sky; /* the samples of the stamp's PSF, from its model */
    double *power;           /* |W|^2 of the stamp's own PSF */
    target_aim aim;          /* at the target in the stamp's frame */
    transfer transfer;       /* unless the plan's serves all */
    /* brightest pixel of each strip of the galaxy stamp */
    double strip_most[SHEAR_MAX_SIDE / FFT_LANES];
    sharpness sharpness;        /* if each stamp has its own PSF: ... */
    const double *sharpness_of; /* ... of this image, in this batch; NULL: none */
    const double *power_of;     /* the image that `power` was made from; NULL: none */
    const double *transfer_of;  /* the image that `transfer` was made from; NULL: none */
};

/* Pack a pair as galaxy + i noise on the fine grid, filter it, and transform it along y into
 * ws->modes, for the groups of rows of modes that a measurement with `t` needs. Always fill *ph,
 * the photometry of the pixels. If the background is subtracted, the galaxy stamp loses the noise
 * stamp's mean, and the noise stamp its own level (photometry_level); with `own_levels` (for two
 * noise stamps) each loses its own. Return false if a log method meets a negative pixel: *failure
 * says where. */
typedef struct pack_failure {
    int x, y;
    bool in_noise;
} pack_failure;
bool pack_pair(const shear_plan *plan, shear_workspace *ws, const filter_pair *filters,
               const double *galaxy, const double *noise, bool own_levels, const transfer *t,
               photometry *ph, pack_failure *failure);
/* Transform one of these groups along x, too. The rows are valid until the next call. */
mode_rows pack_transform_rows(const shear_plan *plan, shear_workspace *ws, int group);
/* Return the last group that a measurement with `t` needs; for a plateau or the noise level, that
 * may lie beyond t's own. */
int mode_groups_last(const shear_plan *plan, const transfer *t);
bool mode_groups_want(const shear_plan *plan, const transfer *t, int group);

/* A stamp pair while it is measured. */
typedef struct stamp_pair {
    const shear_plan *plan;
    shear_workspace *ws;
    const shear_stamps *stamps;
    int i; /* its number among these */
    const double *galaxy, *noise;
    size_t pixels;             /* of a stamp */
    int planes;                /* noise stamps */
    const filter_pair *filter; /* NULL: none */
    const transfer *transfer;  /* NULL: none, or the row is flagged already */
    photometry ph;
    bool packed;
    bool noisy; /* one of its noise stamps varies by more than rounding */
    pack_failure failure;
} stamp_pair;

/* Begin with pair i: no filter and no transfer yet. */
stamp_pair measure_pair_at(const shear_plan *plan, shear_workspace *ws, const shear_stamps *stamps,
                           int i);
/* Choose the pair's filter or transfer. If one cannot be made, set the reason in *flags. */
void measure_choose_filter(stamp_pair *s, uint32_t *flags);
void pair_transfer_choose(stamp_pair *s, uint32_t *flags);
/* Return the pair's own PSF image; NULL if there is none. */
const double *pair_transfer_image(const stamp_pair *s);
/* Return the number of its PSF model, and set *terms to its coefficients; -1 if there is none. */
int pair_transfer_model(const stamp_pair *s, const double **terms);
/* Return whether it has any PSF, the plan's or its own. */
bool pair_transfer_has_psf(const stamp_pair *s);
