/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "local/method_text.h"

#include "local/value_text.h"
#include "shear/settings.h"
#include "shear/stamp.h"
#include "terminal/text_line.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

static bool is_filter(const char *name, enum shear_filter filter) {
    return strcmp(name, shear_filter_name(filter)) == 0;
}

static bool filters(const sheard_report_summary *s) {
    return !is_filter(s->filter, SHEAR_FILTER_NONE);
}

static void print_pixels(const sheard_report_summary *s, FILE *out) {
    char fine[32] = "";
    char r_psf[64];
    char beta[64];
    if (s->oversample > 1)
        snprintf(fine, sizeof fine, " to %" PRId64 " x", s->oversample);
    text_line(out, "method", "interpolation %s%s, R_PSF %s, beta %s", s->interpolation, fine,
              value_text_length(s->r_psf_px, s->r_psf_to, r_psf, sizeof r_psf),
              value_text_length(s->beta_px, s->beta_to, beta, sizeof beta));
}

static const char *source_of_core(const sheard_report_summary *s) {
    return s->core_found                             ? "found: it leaves the galaxies whole"
           : is_filter(s->filter, SHEAR_FILTER_EDGE) ? "the widest that fits the stamps"
                                                     : "given";
}

static void print_filter(const sheard_report_summary *s, FILE *out) {
    char core[64];
    if (!filters(s)) {
        text_line(out, "filter", "none%s",
                  is_filter(s->asked_filter, SHEAR_FILTER_AUTO)
                      ? " (no core leaves the galaxies whole, or there are too few stamps to tell)"
                      : "");
    } else if (!isfinite(s->core_px)) {
        text_line(out, "filter", "core by each stamp's R_GAL, width %.4g px", s->width_px);
    } else {
        text_line(out, "filter", "core %s (%s), width %.4g px",
                  value_text_length(s->core_px, s->core_to, core, sizeof core), source_of_core(s),
                  s->width_px);
    }
}

static void print_background(const sheard_report_summary *s, FILE *out) {
    const bool crossed = strcmp(s->estimator, "pdf-sym-cross") == 0;
    const bool kept = strcmp(s->background, "keep") == 0 && !crossed;
    const char *words = !filters(s) ? "left in: without a filter it changes nothing"
                        : kept      ? "kept: it ends at the filter's edge"
                                    : "the noise stamps' level is taken off both stamps";
    text_line(out, "background", "%s", words);
}

static void print_artefacts(const sheard_report_summary *s, int64_t n, FILE *out) {
    if (strcmp(s->artefacts, "keep") == 0) {
        text_line(out, "artefacts", "not looked for (artefacts = keep)");
    } else if (n == 0) {
        text_line(out, "artefacts", "none found");
    } else if (n > 0) {
        text_line(out, "artefacts", "%" PRId64 " %s with a pixel that no sky can produce: left out",
                  n, n == 1 ? "stamp" : "stamps");
    }
}

void method_text_print(const sheard_report_summary *s, int64_t artefacts, FILE *out) {
    print_pixels(s, out);
    print_filter(s, out);
    print_background(s, out);
    print_artefacts(s, artefacts, out);
}

int64_t method_text_artefacts(const int64_t *flagged) {
    int64_t n = 0;
    for (unsigned bit = 0; bit < SHEAR_N_FLAGS; bit++)
        n += (1u << bit) & (SHEAR_FLAG_ARTEFACT | SHEAR_FLAG_NOISE_ARTEFACT) ? flagged[bit] : 0;
    return n;
}
