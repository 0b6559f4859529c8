/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Warn of what is doubtful on the chips of an exposure, in words. */
#include "local/chip_scan.h"
#include "local/psf_size.h"
#include "local/segmentation.h"
#include "local/sources_away.h"
#include "local/weight_map.h"

#include "sheard/advice.h"

#include <inttypes.h>
#include <stdio.h>

static const double MASKED_MAX = 0.2;
enum { FEWEST_STARS = 10, STARS_PER_TERM = 3, LINE = SHEARD_ADVICE_SIZE };

typedef struct context {
    const sheard_validation_report *v;
    const shear_input *input;
} context;

/* Write what is doubtful, and return it; NULL: nothing. */
typedef const char *chip_warning(const sheard_chip_report *r, const context *c, char *line);

static int64_t flagged(const sheard_chip_report *r, unsigned flag) {
    int64_t n = 0;
    for (unsigned bit = 0; bit < SHEAR_N_FLAGS; bit++)
        n += 1u << bit == flag ? r->flags[bit] : 0;
    return n;
}

static const char *of_positions(const sheard_chip_report *r, const context *c, char *line) {
    char said[LINE];
    return c->v->plan != NULL &&
                   sheard_advice_positions(&c->v->plan->centring, said, sizeof said) == NULL
               ? sheard_advice_positions(&r->centring, line, LINE)
               : NULL; /* of the exposure as a whole */
}

static const char *of_catalog(const sheard_chip_report *r, const context *c, char *line) {
    const int64_t n = r->chip.n_stamps;
    const int64_t flagged_away = flagged(r, SHEAR_FLAG_NO_POSITION);
    const int64_t away =
        n - r->chip.n_sources > flagged_away ? n - r->chip.n_sources : flagged_away;
    (void)c;
    if (n > 0 && 2 * away <= n)
        return NULL;
    if (sources_away_warning(&r->chip, line, LINE) != NULL)
        return line;
    if (n == 0) {
        snprintf(line, LINE,
                 "none of its %" PRId64 " sources is selected: look at FLAGS and at --select",
                 r->chip.n_sources);
    } else {
        snprintf(
            line, LINE,
            "%" PRId64 " of %" PRId64
            " sources are not on it: is this its catalog, and are the WCS and --columns right?",
            away, n);
    }
    return line;
}

static const char *of_noise(const sheard_chip_report *r, const context *c, char *line) {
    const int64_t without = flagged(r, SHEAR_FLAG_NO_NOISE);
    const shear_geometry *g = &c->v->field->geometry;
    if (without <= r->n_measurable)
        return NULL;
    snprintf(line, LINE,
             "there is no empty sky near %" PRId64 " galaxies for noise stamps of %d x %d px, but "
             "near %" PRId64 ": make --stamp smaller, or give --noise white or an image of noise",
             without, g->nx, g->ny, r->n_measurable);
    return line;
}

static const char *of_mask(const sheard_chip_report *r, const context *c, char *line) {
    (void)c;
    if (!(r->masked > MASKED_MAX))
        return NULL;
    snprintf(line, LINE,
             "%.0f %% of its pixels are bad: does the mask mean this (--mask-bad), and is the "
             "weight map of this kind (--weight-kind)?",
             100.0 * r->masked);
    return line;
}

static const char *of_segmentation(const sheard_chip_report *r, const context *c, char *line) {
    (void)c;
    return segmentation_warning(r->n_segmented, r->n_unowned, line, LINE);
}

static const char *of_weight(const sheard_chip_report *r, const context *c, char *line) {
    return weight_map_warning(r, c->input->exposure.weight_kind, line, LINE);
}

static const char *of_stars(const sheard_chip_report *r, const context *c, char *line) {
    const int stars = r->chip.psf_stars;
    (void)c;
    if (stars < 0 || (stars >= FEWEST_STARS && stars >= STARS_PER_TERM * r->chip.psf_terms))
        return NULL;
    snprintf(line, LINE,
             "its PSF model was made from %d stars, for %d coefficients: take more stars, or a "
             "polynomial of a lower degree",
             stars, r->chip.psf_terms);
    return line;
}

static const char *of_psf_size(const sheard_chip_report *r, const context *c, char *line) {
    (void)c;
    return psf_size_warning(&r->chip, line, LINE);
}

static const char *of_resolution(const sheard_chip_report *r, const context *c, char *line) {
    return c->v->n_chips > 1 && c->v->measured /* of one chip the result itself is the exposure's */
               ? sheard_advice_broad_psf_of(r->n_bright, r->n_sharp, &c->v->result, c->v->plan,
                                            line, LINE)
               : NULL;
}

static const char *of_wcs(const sheard_chip_report *r, const context *c, char *line) {
    if (r->chip.has_wcs || c->input->exposure.frame != 0)
        return NULL;
    snprintf(line, LINE,
             "it has no WCS: the shear is in the frame of the pixels, and includes the camera's "
             "distortion; give --wcs, or --frame pixel if that is meant");
    return line;
}

const char *chip_scan_name(const sheard_chip_report *r, char *buf, size_t size) {
    if (r->chip.name[0] != '\0') {
        snprintf(buf, size, "%s", r->chip.name);
    } else {
        snprintf(buf, size, "of HDU %" PRId64, r->chip.hdu[SHEAR_PART_IMAGE]);
    }
    return buf;
}

static void add(warning_list *w, const sheard_chip_report *r, int n, int chips, const char *line) {
    char name[96];
    if (chips == 1) {
        warnings_add(w, "%s", line);
    } else {
        warnings_add(w, "%d of %d chips, the first %s: %s", n, chips,
                     chip_scan_name(r, name, sizeof name), line);
    }
}

void chip_scan_warn(const sheard_validation_report *v, const shear_input *input, warning_list *w) {
    static chip_warning *const kinds[] = {of_positions,    of_catalog, of_noise, of_mask,
                                          of_segmentation, of_weight,  of_stars, of_psf_size,
                                          of_resolution,   of_wcs};
    const context c = {v, input};
    for (size_t k = 0; k < sizeof kinds / sizeof kinds[0]; k++) {
        char line[LINE];
        char other[LINE];
        int first = -1;
        int n = 0;
        for (int i = 0; i < v->n_chips; i++) {
            if (kinds[k](&v->chips[i], &c, n == 0 ? line : other) != NULL) {
                first = n == 0 ? i : first;
                n++;
            }
        }
        if (n > 0)
            add(w, &v->chips[first], n, v->n_chips, line);
    }
}
