/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Warn of doubtful PSFs, in words. */
#include "sheard/advice.h"

#include "report/advice_say.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

static double percent(double part) {
    return 100.0 * part;
}

/* Describe a bias in words. The estimates are good if they are small. */
static const char *how_much(double bias, char buf[32]) {
    if (bias > 0.05) {
        snprintf(buf, 32, "more than 5 %%");
    } else {
        snprintf(buf, 32, "about %.1g %%", percent(bias));
    }
    return buf;
}

/* The flaws, of the worst PSF, in words. */

static const char *pedestal(const shear_psf_quality *q, double beta_px, char *buf, size_t size) {
    char much[32];
    return advice_say(
        buf, size,
        "the PSF's border is at %.2g %% of its peak and does not fall, which biases the "
        "shear by %s: was its background left in, or taken off twice? subtract "
        "what the border has",
        percent(q->border), how_much(shear_psf_border_bias(q, beta_px), much));
}

static const char *cut(const shear_psf_quality *q, double beta_px, char *buf, size_t size) {
    char much[32];
    return advice_say(
        buf, size,
        "the PSF's wings are cut off where they are at %.2g %% of the peak (about %.2g %% of "
        "the light is missing), which biases the shear by %s: give a larger image "
        "of the PSF, with no background left in",
        percent(q->border), percent(q->cut), how_much(shear_psf_border_bias(q, beta_px), much));
}

static const char *noisy(const shear_psf_quality *q, double beta_px, char *buf, size_t size) {
    const double m = shear_psf_noise_bias(q, beta_px);
    return advice_say(
        buf, size,
        "the PSF is noisy, which makes errors of about %.1g %% of the shear and of %.1g "
        "besides, and the errors given do not contain them: give a model of the PSF, or the "
        "mean of more stars",
        percent(m), 0.7 * m);
}

static const char *undersampled(const shear_psf_quality *q, double beta_px, char *buf,
                                size_t size) {
    char much[32];
    return advice_say(
        buf, size,
        "the PSF is under-sampled: its radius R_PSF is only %.2g of its samples, which "
        "biases the shear by %s: give it with more samples per pixel (OVERSAMP)",
        q->sampling, how_much(shear_psf_sampling_bias(q, beta_px), much));
}

static const char *negative(const shear_psf_quality *q, double beta_px, char *buf, size_t size) {
    (void)beta_px;
    return advice_say(
        buf, size,
        "the PSF falls to %.2g %% of its peak, and no light is negative: a bad pixel, or "
        "ringing of whatever resampled it?",
        percent(q->lowest));
}

static const char *unusable(const shear_psf_summary *s, char *buf, size_t size) {
    return advice_say(
        buf, size,
        "%" PRId64 " of %" PRId64 " PSFs examined are unusable (not finite, flat, no flux, "
        "or with their peak at the image's edge): their stamps are flagged psf_unusable",
        s->unusable, s->looked_at);
}

typedef const char *flaw_text(const shear_psf_quality *q, double beta_px, char *buf, size_t size);

/* Add "3 of 64 PSFs examined (the worst): ", if there are several, and the text. */
static void add_flaw(sheard_advice_list *list, const shear_plan_info *plan, int64_t count,
                     flaw_text *text_of) {
    char *line = list->text[list->n];
    line[0] = '\0';
    if (plan->psf.looked_at > 1) {
        advice_say(line, SHEARD_ADVICE_SIZE,
                   "%" PRId64 " of %" PRId64 " PSFs examined (the worst): ", count,
                   plan->psf.looked_at);
    }
    const size_t used = strlen(line);
    text_of(&plan->psf.worst, plan->beta_px, line + used, SHEARD_ADVICE_SIZE - used);
    list->lines[list->n++] = line;
}

void sheard_advice_psf(sheard_advice_list *list, const shear_plan_info *plan) {
    static flaw_text *const flaws[SHEAR_N_PSF_FLAWS] = {[SHEAR_PSF_PEDESTAL] = pedestal,
                                                        [SHEAR_PSF_CUT] = cut,
                                                        [SHEAR_PSF_NOISY] = noisy,
                                                        [SHEAR_PSF_UNDERSAMPLED] = undersampled,
                                                        [SHEAR_PSF_NEGATIVE] = negative};
    if (plan->psf.unusable > 0) {
        list->lines[list->n] = unusable(&plan->psf, list->text[list->n], SHEARD_ADVICE_SIZE);
        list->n++;
    }
    for (int i = 0; i < SHEAR_N_PSF_FLAWS; i++) {
        if (plan->psf.flawed[i] > 0)
            add_flaw(list, plan, plan->psf.flawed[i], flaws[i]);
    }
}

const char *sheard_advice_other_psfs(const sheard_report_file *files, size_t n, const char *first,
                                     char *buf, size_t size) {
    sheard_advice_list said = {.n = 0};
    const char *example = NULL; /* may have no path */
    size_t others = 0;
    size_t doubtful = 0;
    for (size_t i = 0; i < n; i++) {
        sheard_advice_list list = {.n = 0};
        if (files[i].path != NULL && first != NULL && strcmp(files[i].path, first) == 0)
            continue;
        others++;
        if (files[i].plan != NULL)
            sheard_advice_psf(&list, files[i].plan);
        if (list.n > 0 && doubtful++ == 0) {
            sheard_advice_psf(&said, files[i].plan);
            example = files[i].path;
        }
    }
    if (doubtful == 0)
        return NULL;
    return advice_say(buf, size, "%zu of %zu files after the first have doubtful PSFs: %.200s: %s",
                      doubtful, others, example != NULL ? example : "a file", said.lines[0]);
}
