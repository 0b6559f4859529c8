/* SPDX-License-Identifier: GPL-3.0-or-later */
/* method_text.h: lines that describe the processing of the stamps: pixels and PSF, filter,
 * background, artefacts. */
#pragma once

#include "sheard/report_summary.h"

#include <stdio.h>

/* Print the lines "  method ...", "  filter ...", "  background ..." and "  artefacts ...".
 * `artefacts` is the number of stamps left out because of an artefact; -1: unknown, or already
 * printed. */
void method_text_print(const sheard_report_summary *s, int64_t artefacts, FILE *out);

/* Return how many stamps are left out because of an artefact, from shear_result.flagged
 * [SHEAR_N_FLAGS]. */
int64_t method_text_artefacts(const int64_t *flagged);
