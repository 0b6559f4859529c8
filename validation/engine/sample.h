/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sample.h: many galaxies, drawn in memory and measured in several ways.
 *
 * A scene is a set of mock parameters (shear, size, PSF, noise); a series is one way of measuring a
 * scene. All scenes of a sample show the same galaxies (the mocks' random numbers depend only on
 * seed and index), so differences between series have much smaller errors than the series.
 *
 * Notes
 *
 * 1. There is one plan for each PSF, shape and settings. Threads work on tiles of stamps. Rows are
 *    returned in the order of the stamps, so nothing depends on the number of threads.
 *
 * 2. settings.beta_px = NaN becomes beta_ratio times the nominal R_PSF (at least beta_floor_px);
 *    the filter `paper` (and auto) gets the core R_G + 4 beta of the scene's galaxies.
 *
 * 3. Shared noise: the point-source noise of the sample's `noise` spec is drawn once for all scenes
 *    and added with the factor `shared` of each. This is exact up to rounding (1e-15 of the
 *    brightest pixel), because the image of points is linear in their amplitude. Do not use it with
 *    logarithms of nearly empty pixels.
 *
 * 4. Exchange: scenes with shared noise are measured twice, the second time with the two noises
 *    exchanged, and a row is the mean of both. The expectation is the same, but the noises' own
 *    powers cancel; only their products with the galaxy remain. One more measurement so gives the
 *    precision of many more galaxies.
 */
#pragma once

#include "engine/cache.h"
#include "engine/jackknife.h"
#include "shear/plan.h"

typedef struct scene {
    shear_mock_spec spec; /* n_stamps is set by the sample */
    double shared;        /* factor of the sample's noise that is added; 0: none */
} scene;

typedef struct series {
    int scene;
    int psf_oversample; /* samples per pixel of the measured PSF image; 0: as in the spec */
    shear_settings settings;
} series;

enum { SAMPLE_MAX_SCENES = MAX_VALUES, SAMPLE_MAX_SERIES = 2 * MAX_VALUES };

typedef struct sample {
    char name[64];  /* of the cache's task: unique in the experiment, without spaces */
    int64_t stamps; /* 0: the options' galaxies */
    int n_scenes, n_series;
    scene scenes[SAMPLE_MAX_SCENES];
    series series[SAMPLE_MAX_SERIES];
    const shear_mock_spec *noise; /* noise shared by the scenes, or NULL */
    bool exchange;                /* note 4 */
    /* Change the scene's spec into that of a mock of one stamp, if stamps differ not only in their
     * random numbers. NULL: they do not. */
    void (*vary)(const void *context, int64_t stamp, shear_mock_spec *spec);
    const void *context;
} sample;

/* Draw and measure the sample through the cache, in the options' groups: of nearly equal size, each
 * a multiple of the rotated copies, and fewer if there are fewer galaxies. Its series are appended
 * to *sums. */
void sample_measure(const options *o, cache *c, const sample *what, jackknife_sums *sums);

/* ---- direct use, for access to the rows ---- */

typedef struct sampler sampler;
/* Create a sampler. `threads`: 0: all cores. */
sampler *sampler_new(const sample *what, int64_t stamps, int threads);
void sampler_free(sampler *s);
CLEANUP_DEFINE(sampler, sampler_free)
/* Measure stamps [first, first+count): rows [n_series][count], in the order of the stamps. `first`
 * is a multiple of the rotated copies. */
void sampler_rows(sampler *s, int64_t first, int count, shear_row *rows);
/* Return the intermediate results of one measurement of a series (shear_inspect). Not thread-safe.
 */
void sampler_inspect(sampler *s, int i_series, const shear_stamps *stamps, int i,
                     shear_inspection *out);

/* Return a plan for stamps of this mock with its first PSF, to be freed by shear_plan_free. */
shear_plan *sampler_plan(const shear_mock *mock, const shear_settings *settings);

/* ---- mocks; the program ends if a spec is wrong ---- */

/* Return a mock of n stamps, to be freed by shear_mock_free. */
shear_mock *sampler_mock(const shear_mock_spec *spec, int64_t n);
CLEANUP_DEFINE(shear_mock, shear_mock_free)
/* Draw n stamp pairs: the galaxies [n][ny][nx], then their noise stamps, to be freed by the caller.
 */
double *sampler_draw(const shear_mock_spec *spec, int n);
