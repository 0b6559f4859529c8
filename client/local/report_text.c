/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "local/report_text.h"

#include "base/text.h"
#include "shear/settings.h"
#include "shear/stamp.h"
#include "sheard/advice.h"
#include "sheard/no_shear.h"
#include "terminal/human.h"
#include "terminal/text_line.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

static const double EFFECT_MIN = 1e-4; /* of the noise level, to be worth words */

/* ---- The processing of the stamps ---- */

/* Write "2.4 UNIT", or "2.4 to 2.6 UNIT" if files differ, into buf. Returns buf. */
static char *range_text(double from, double to, const char *unit, char *buf, size_t size) {
    if (to > from) {
        snprintf(buf, size, "%.4g to %.4g %s", from, to, unit);
    } else {
        snprintf(buf, size, "%.4g %s", from, unit);
    }
    return buf;
}

static char *length_text(double from, double to, char *buf, size_t size) {
    return range_text(from, to, "px", buf, size);
}

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
              length_text(s->r_psf_px, s->r_psf_to, r_psf, sizeof r_psf),
              length_text(s->beta_px, s->beta_to, beta, sizeof beta));
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
                  length_text(s->core_px, s->core_to, core, sizeof core), source_of_core(s),
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

void report_text_method(const sheard_report_summary *s, int64_t artefacts, FILE *out) {
    print_pixels(s, out);
    print_filter(s, out);
    print_background(s, out);
    print_artefacts(s, artefacts, out);
}

/* Print along which axes the shear is, for results that say so. */
static void print_frame(const sheard_report_summary *s, FILE *out) {
    static const struct {
        const char *frame, *axes;
    } known[] = {{"pixel", "x along rows, y along columns"},
                 {"sky", "x to the West, y to the North"},
                 {"sky-east", "x to the East, y to the North"},
                 {"mixed", "its files were measured along different axes"}};
    char beta[64] = "";
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
        if (strcmp(s->frame, known[i].frame) != 0)
            continue;
        if (isfinite(s->beta_sky))
            range_text(s->beta_sky, s->beta_sky_to, "arcsec", beta, sizeof beta);
        text_line(out, "frame", "%s: %s%s%s", s->frame, known[i].axes,
                  beta[0] != '\0' ? ", beta " : "", beta);
    }
}

/* ---- The quality of the result ---- */

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

void report_text_quality(const sheard_report_summary *s, FILE *out) {
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

/* ---- The whole report ---- */

/* Print "400 of 403 used (2 galaxy_not_finite, 1 masked)"; a stamp may have several flags. */
static void print_stamps(const sheard_report_summary *s, FILE *out) {
    char flags[2048] = "";
    for (int bit = 0; bit < SHEAR_N_FLAGS; bit++) {
        if (s->flagged[bit] > 0) {
            text_append(flags, sizeof flags, "%s%" PRId64 " %s", flags[0] != '\0' ? ", " : " (",
                        s->flagged[bit], shear_flag_name(bit));
        }
    }
    text_line(out, "stamps", "%" PRId64 " of %" PRId64 " used%s%s", s->n_used, s->n_stamps, flags,
              flags[0] != '\0' ? ")" : "");
}

/* Return how many stamps are left out because of an artefact. */
static int64_t count_artefacts(const sheard_report_summary *s) {
    int64_t n = 0;
    for (unsigned bit = 0; bit < SHEAR_N_FLAGS; bit++)
        n += (1u << bit) & (SHEAR_FLAG_ARTEFACT | SHEAR_FLAG_NOISE_ARTEFACT) ? s->flagged[bit] : 0;
    return n;
}

static void print_component(const char *name, double g, double error, double truth, double pull,
                            bool own, FILE *out) {
    char value[96];
    human_value(g, error, value, sizeof value);
    if (!isfinite(g)) {
        text_line(out, name, "not measured");
    } else if (isfinite(truth) && own) {
        text_line(out, name, "%s   truth %+.*f   pull %+.2f", value, human_decimals(error), truth,
                  pull);
    } else if (isfinite(truth)) {
        text_line(out, name, "%s   truth %+.6g   pull %+.2f", value, truth, pull);
    } else {
        text_line(out, name, "%s", value);
    }
}

static void print_summary(const sheard_report_summary *s, const char *reason, bool own, FILE *out) {
    print_stamps(s, out);
    if (s->interpolation[0] != '\0')
        report_text_method(s, count_artefacts(s), out);
    print_frame(s, out);
    if (isfinite(s->g1))
        report_text_quality(s, out);
    print_component("g1", s->g1, s->g1_err, s->true_g1, s->pull_g1, own, out);
    print_component("g2", s->g2, s->g2_err, s->true_g2, s->pull_g2, own, out);
    if (reason != NULL) {
        text_line(out, "reason", "%s", reason);
    } else if (s->no_shear[0] != '\0') {
        const char *words = sheard_no_shear_words(sheard_no_shear_of(s->no_shear));
        text_line(out, "reason", "%s", words != NULL ? words : s->no_shear);
    }
    if (isfinite(s->cov12)) {
        text_line(out, "cov12", "%.3g (correlation %+.2f)", s->cov12,
                  s->cov12 / (s->g1_err * s->g2_err));
    }
    if (isfinite(s->g1) && s->estimator[0] != '\0')
        text_line(out, "estimator", "%s", s->estimator);
    if (isfinite(s->g1) && s->jackknife > 0) {
        text_line(out, "errors", "jackknife over %" PRId64 " groups of blocks", s->jackknife);
    } else if (isfinite(s->g1)) {
        text_line(out, "errors", "%s",
                  strcmp(s->error_method, "symmetry") == 0 ? "from the counts of the symmetry"
                                                           : "delta method");
    }
    for (int64_t i = 0; i < s->n_warnings && !own; i++)
        text_line(out, "warning", "%s", s->warnings[i]);
}

void report_text_print(const char *report, const char *reason, bool own, FILE *out) {
    sheard_report_summary summary;
    shear_error err = {0};
    if (report == NULL)
        return;
    if (sheard_report_summary_parse(&summary, report, &err) != 0) {
        text_line(out, "result", "cannot be shown: %s", err.message);
        return;
    }
    print_summary(&summary, reason, own, out);
    sheard_report_summary_deinit(&summary);
}
