/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sample.h: many galaxies, drawn in memory and measured in several ways.
 *
 * A scene is how the galaxies look (shear, size, PSF, noise); a series is one way of measuring a
 * scene. All scenes of a sample show the same galaxies (the mocks' draws depend on seed and index
 * only), so that differences between series are far better known than the series themselves.
 *
 * Notes
 *
 * 1. Plans are made once for each PSF, shape and settings; threads work on tiles of stamps; rows
 *    come back in stamp order, so nothing depends on the number of threads.
 *
 * 2. settings.beta_px = NaN becomes beta_ratio times the nominal R_PSF (at least beta_floor_px);
 *    the filter `paper` (and auto) gets the core R_G + 4 beta of the scene's galaxies.
 *
 * 3. Shared noise: the point-source noise of the sample's `noise` spec is drawn once for all scenes
 *    and added with the factor `shared` of each: exact, for the image of points is linear in their
 *    amplitude, up to the rounding of a difference (1e-15 of the brightest pixel). So it is not for
 *    logarithms of nearly empty pixels.
 *
 * 4. Exchange: scenes with shared noise are measured again with the roles of the two noises
 *    exchanged, and a row is the mean of both. That has the same expectation, but the noises' own
 *    powers cancel and only their products with the galaxy are left as noise: many more galaxies'
 *    worth of precision for the price of a measurement.
 */
#ifndef VALIDATION_SAMPLE_H
#define VALIDATION_SAMPLE_H

#include "engine/cache.h"
#include "engine/jackknife.h"
#include "shear/plan.h"

typedef struct scene {
    shear_mock_spec spec; /* n_stamps is set by the sample */
    double shared;        /* times the sample's noise that is added; 0 = none */
} scene;

typedef struct series {
    int scene;
    int psf_oversample; /* samples per pixel of the PSF that the measurement gets; 0 = the spec's */
    shear_settings settings;
} series;

typedef struct sample {
    const char *name; /* of the cache's task: unique in the experiment, no blanks */
    int64_t stamps;   /* 0 = the options' galaxies */
    int n_scenes;
    const scene *scenes;
    int n_series;
    const series *series;
    const shear_mock_spec *noise; /* what scenes share, or NULL */
    bool exchange;                /* note 4 */
    /* Where stamps differ in more than their draws: change the scene's spec into that of a mock of
     * one stamp. NULL = they do not. */
    void (*vary)(const void *context, int64_t stamp, shear_mock_spec *spec);
    const void *context;
} sample;

/* Draw and measure all of it, through the cache, in the options' groups: nearly equal, each a
 * multiple of the rotated copies; fewer where there are fewer galaxies. */
jackknife_sums *sample_measure(const options *o, cache *c, const sample *what);

/* ---- the same by hand, where the rows themselves are wanted ---- */

typedef struct sampler sampler;
/* `threads`: 0 = all cores. Scenes and series are copied. */
sampler *sampler_new(const sample *what, int64_t stamps, int threads);
void sampler_free(sampler *s);
/* Stamps [first, first+count): rows [n_series][count], in stamp order. `first` is a multiple of the
 * rotated copies. */
void sampler_rows(sampler *s, int64_t first, int count, shear_row *rows);
/* The steps of one measurement of a series (shear_inspect); not thread-safe. */
void sampler_inspect(sampler *s, int i_series, const shear_stamps *stamps, int i,
                     shear_inspection *out);

/* A plan for stamps of this mock, whose first PSF is that of all; for shear_plan_free. */
shear_plan *sampler_plan(const shear_mock *mock, const shear_settings *settings);

#endif
