/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "local/method_text.h"

#include "shear/stamp.h"
#include "terminal/text_line.h"

#include <inttypes.h>
#include <string.h>

static bool is_filter(const char *name, enum shear_filter filter) {
    return strcmp(name, shear_filter_name(filter)) == 0;
}

static bool filters(const method_lines *m) {
    return !is_filter(m->filter, SHEAR_FILTER_NONE);
}

static void print_pixels(const method_lines *m, FILE *out) {
    char fine[32] = "";
    if (m->oversample > 1)
        snprintf(fine, sizeof fine, " to %d x", m->oversample);
    text_line(out, "method", "interpolation %s%s, R_PSF %s, beta %s", m->interpolation, fine,
              m->r_psf, m->beta);
}

static const char *source_of_core(const method_lines *m) {
    return m->core_found                             ? "found: it leaves the galaxies whole"
           : is_filter(m->filter, SHEAR_FILTER_EDGE) ? "the widest that fits the stamps"
                                                     : "given";
}

static void print_filter(const method_lines *m, FILE *out) {
    if (!filters(m)) {
        text_line(out, "filter", "none%s",
                  is_filter(m->asked_filter, SHEAR_FILTER_AUTO)
                      ? " (no core leaves the galaxies whole, or there are too few stamps to tell)"
                      : "");
    } else if (m->core_per_stamp) {
        text_line(out, "filter", "core by each stamp's R_GAL, width %.4g px", m->width_px);
    } else {
        text_line(out, "filter", "core %s (%s), width %.4g px", m->core, source_of_core(m),
                  m->width_px);
    }
}

static void print_background(const method_lines *m, FILE *out) {
    const char *words = !filters(m)          ? "left in: without a filter it changes nothing"
                        : m->background_kept ? "kept: it ends at the filter's edge"
                                             : "the noise stamps' level is taken off both stamps";
    text_line(out, "background", "%s", words);
}

static void print_artefacts(const method_lines *m, FILE *out) {
    if (m->artefacts_kept) {
        text_line(out, "artefacts", "not looked for (artefacts = keep)");
    } else if (m->artefacts == 0) {
        text_line(out, "artefacts", "none found");
    } else if (m->artefacts > 0) {
        text_line(out, "artefacts", "%" PRId64 " %s with a pixel that no sky can produce: left out",
                  m->artefacts, m->artefacts == 1 ? "stamp" : "stamps");
    }
}

void method_text_print(const method_lines *m, FILE *out) {
    print_pixels(m, out);
    print_filter(m, out);
    print_background(m, out);
    print_artefacts(m, out);
}

method_lines method_text_of(const shear_plan_info *plan, const shear_settings *settings,
                            const char *r_psf, const char *beta, const char *core) {
    return (method_lines){
        .interpolation = shear_interpolation_name(plan->interpolation),
        .filter = shear_filter_name(plan->filter),
        .oversample = plan->interpolation == SHEAR_INTERP_NONE ? 1 : plan->oversample,
        .r_psf = r_psf,
        .beta = beta,
        .core = core,
        .width_px = plan->width_px,
        .core_per_stamp = plan->filter_per_stamp,
        .core_found = plan->core_found,
        .asked_filter = shear_filter_name(settings->filter),
        .background_kept = shear_settings_keep_background(settings),
        .artefacts_kept = settings->artefacts == SHEAR_ARTEFACTS_KEEP,
        .artefacts = -1,
    };
}

int64_t method_text_artefacts(const int64_t *flagged) {
    int64_t n = 0;
    for (unsigned bit = 0; bit < SHEAR_N_FLAGS; bit++)
        n += (1u << bit) & (SHEAR_FLAG_ARTEFACT | SHEAR_FLAG_NOISE_ARTEFACT) ? flagged[bit] : 0;
    return n;
}
