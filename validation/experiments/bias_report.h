/* SPDX-License-Identifier: GPL-3.0-or-later */
/* bias_report.h: the results of the experiment `bias`; their table and figure. */
#pragma once

#include "engine/bias_fit.h"
#include "report/chart.h"
#include "report/run.h"

enum { MAX_CASES = 48, MAX_LINES = 2 * MAX_CASES, MAX_LARGE = 8 };
enum bias_noise { CLEAN = 0, WHITE, SOURCES };

typedef struct bias_case {
    enum shear_mock_galaxy kind;
    enum shear_mock_psf psf;
    enum bias_noise noise;
    bool interpolated; /* by Log-Bicubic and Log-Spline */
    bool large;        /* the shears for the test of higher orders */
} bias_case;

/* A row of the table. */
typedef struct line {
    bias_case of;
    int way; /* 0: none, 1: Log-Bicubic, 2: Log-Spline */
    double n;
    bias_fit bias;
    bias_cubic cubic; /* from large shears */
} line;

typedef struct lines {
    int n;
    line of[MAX_LINES];
    int n_large; /* relative deviation against |g|, by kind and PSF */
    curve large[MAX_LARGE];
    char large_label[MAX_LARGE][64];
} lines;

/* Names. */
extern const char *const bias_kinds[]; /* enum shear_mock_galaxy */
extern const char *const bias_psfs[];  /* enum shear_mock_psf */
extern const char *const bias_noises[];

/* Fill the run's table and draw its figure. */
void bias_report(run *r, const lines *all);
