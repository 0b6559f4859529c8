/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "local/quality_text.h"

#include "sheard/advice.h"
#include "terminal/text_line.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

static const double EFFECT_MIN = 1e-4;

static const char *place_of(const char *band) {
    return strcmp(band, "high") == 0      ? ", measured beyond 3/4 of Nyquist"
           : strcmp(band, "corners") == 0 ? ", measured beyond Nyquist"
                                          : "";
}

/* Print why the noise level was not determined. */
static void print_unchecked(const quality_lines *q, FILE *out) {
    if (q->r_psf_px < 1.0) {
        text_line(out, "level",
                  "noise assumed to be that of the noise stamps: cannot be checked if R_PSF "
                  "is below 1 px");
    } else if (strcmp(q->interpolation, "none") != 0) {
        text_line(out, "level",
                  "noise assumed to be that of the noise stamps: cannot be checked if stamps "
                  "are interpolated");
    } else {
        text_line(out, "level", "noise assumed to be that of the noise stamps, as requested");
    }
}

static void print_level(const quality_lines *q, FILE *out) {
    char effect[64];
    char words[96] = "";
    if (!isfinite(q->noise_level)) {
        if (q->noise_share != 0.0) { /* photon noise exists, and is subtracted */
            print_unchecked(q, out);
        }
        return;
    }
    if (!q->symmetric && fabs(q->noise_effect) >= EFFECT_MIN) {
        snprintf(words, sizeof words, "; without it %s",
                 sheard_advice_without_level(q->noise_effect, effect, sizeof effect));
    }
    text_line(out, "level", "noise %.4f +- %.2g times the noise stamps' variance%s%s",
              q->noise_level, q->noise_level_err, place_of(q->noise_band), words);
}

quality_lines quality_text_of(const shear_result *r, const shear_plan_info *plan) {
    return (quality_lines){.noise_band = shear_noise_band_name(plan->noise_band),
                           .interpolation = shear_interpolation_name(plan->interpolation),
                           .r_psf_px = plan->r_psf_px,
                           .symmetric = shear_estimator_is_symmetric(r->estimator),
                           .noise_level = r->noise_level,
                           .noise_level_err = r->noise_level_err,
                           .noise_effect = r->noise_effect,
                           .noise_share = r->noise_share,
                           .n_eff = r->n_eff,
                           .top_share = r->top_share,
                           .n_used = r->n_used,
                           .top_stamp = r->top_stamp};
}

void quality_text_print(const quality_lines *q, FILE *out) {
    if (!isfinite(q->n_eff))
        return;
    print_level(q, out);
    if (q->top_stamp >= 0 && isfinite(q->top_share)) {
        text_line(out, "influence",
                  "%" PRId64 " stamps count as %.1f equal ones; stamp %" PRId64
                  "%s%s counts most, with %.3g %% of the sum of w D",
                  q->n_used, q->n_eff, q->top_stamp, q->top_file != NULL ? " of " : "",
                  q->top_file != NULL ? q->top_file : "", 100.0 * q->top_share);
    } else {
        text_line(out, "influence", "%" PRId64 " stamps count as %.1f equal ones", q->n_used,
                  q->n_eff);
    }
}
