/* SPDX-License-Identifier: GPL-3.0-or-later */
/* method_text.h: lines that describe the processing of the stamps: pixels and PSF, filter,
 * background, artefacts. */
#pragma once

#include "shear/plan.h"
#include "shear/settings.h"

#include <stdint.h>
#include <stdio.h>

/* The content of the lines. Lengths are strings with their unit, because the files of a field may
 * differ. */
typedef struct method_lines {
    const char *interpolation, *filter; /* as resolved */
    int oversample;
    const char *r_psf, *beta, *core;
    double width_px;
    bool core_per_stamp, core_found; /* chosen by R_GAL; chosen from the galaxies of the file */
    const char *asked_filter;        /* the setting */
    bool background_kept, artefacts_kept;
    int64_t artefacts; /* number of stamps left out because of an artefact; -1: unknown, or already
                          printed */
} method_lines;

/* Print the lines "  method ...", "  filter ...", "  background ..." and "  artefacts ...". */
void method_text_print(const method_lines *m, FILE *out);

/* Return how many stamps are left out because of an artefact, from shear_result.flagged
 * [SHEAR_N_FLAGS]. */
int64_t method_text_artefacts(const int64_t *flagged);

/* Return the content for a plan and its settings. Members that the plan does not determine are left
 * to the caller. */
method_lines method_text_of(const shear_plan_info *plan, const shear_settings *settings,
                            const char *r_psf, const char *beta, const char *core);
