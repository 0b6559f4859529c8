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
static void print_unchecked(const sheard_report_summary *s, FILE *out) {
    if (s->r_psf_px < 1.0) {
        text_line(out, "level",
                  "noise assumed to be that of the noise stamps: cannot be checked if R_PSF is "
                  "below 1 px");
    } else if (strcmp(s->interpolation, "none") != 0) {
        text_line(out, "level",
                  "noise assumed to be that of the noise stamps: cannot be checked if stamps "
                  "are interpolated");
    } else {
        text_line(out, "level", "noise assumed to be that of the noise stamps, as requested");
    }
}

static void print_level(const sheard_report_summary *s, FILE *out) {
    char effect[64];
    char words[96] = "";
    if (!isfinite(s->noise_level)) {
        if (s->noise_share != 0.0) { /* photon noise exists, and is subtracted */
            print_unchecked(s, out);
        }
        return;
    }
    if (strncmp(s->estimator, "pdf-sym", 7) != 0 && fabs(s->noise_effect) >= EFFECT_MIN) {
        snprintf(words, sizeof words, "; without it %s",
                 sheard_advice_without_level(s->noise_effect, effect, sizeof effect));
    }
    text_line(out, "level", "noise %.4f +- %.2g times the noise stamps' variance%s%s",
              s->noise_level, s->noise_level_err, place_of(s->noise_band), words);
}

void quality_text_print(const sheard_report_summary *s, FILE *out) {
    const bool named = s->top_file[0] != '\0' && s->n_files != 1;
    if (!isfinite(s->n_eff))
        return;
    print_level(s, out);
    if (s->top_stamp >= 0 && isfinite(s->top_share)) {
        text_line(out, "influence",
                  "%" PRId64 " stamps count as %.1f equal ones; stamp %" PRId64
                  "%s%s counts most, with %.3g %% of the sum of w D",
                  s->n_used, s->n_eff, s->top_stamp, named ? " of " : "", named ? s->top_file : "",
                  100.0 * s->top_share);
    } else {
        text_line(out, "influence", "%" PRId64 " stamps count as %.1f equal ones", s->n_used,
                  s->n_eff);
    }
}
