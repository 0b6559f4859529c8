/* SPDX-License-Identifier: GPL-3.0-or-later */
/* method_text.h: what was done to the stamps, in a line each: pixels and PSF, filter, background,
 * artefacts. */
#ifndef CLIENT_LOCAL_METHOD_TEXT_H
#define CLIENT_LOCAL_METHOD_TEXT_H

#include "shear/plan.h"
#include "shear/settings.h"

#include <stdint.h>
#include <stdio.h>

/* Lengths are texts with their unit, since the files of a field may differ in them. */
typedef struct method_lines {
    const char *interpolation, *filter; /* as resolved */
    int oversample;
    const char *r_psf, *beta, *core;
    double width_px;
    bool core_per_stamp, core_found; /* by R_GAL; from the galaxies themselves */
    const char *asked_filter;        /* the setting */
    bool background_kept, artefacts_kept;
    int64_t artefacts; /* stamps that are left out because of one; -1: not known, or told already */
} method_lines;

/* The lines "  method ...", "  filter ...", "  background ..." and "  artefacts ...". */
void method_text_print(const method_lines *m, FILE *out);

/* How many stamps are left out because of one: of shear_result.flagged, [SHEAR_N_FLAGS]. */
int64_t method_text_artefacts(const int64_t *flagged);

/* Of a plan and the settings it was made with. What the plan cannot know is left to the caller. */
method_lines method_text_of(const shear_plan_info *plan, const shear_settings *settings,
                            const char *r_psf, const char *beta, const char *core);

#endif
