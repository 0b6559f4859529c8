/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The figure of one chip of an exposure. */
#include "plot/plot.h"

#include "base/cleanup.h"
#include "plot/chip_map.h"
#include "plot/text.h"
#include "shear/run.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum {
    WIDTH = 1330,
    PAD = 14,
    TOP = 64,
    MAP_WIDTH = 920,
    SIDE_WIDTH = WIDTH - MAP_WIDTH - 3 * PAD,
    BAR = 24,
    TABLE_HEIGHT = 250
};

CLEANUP_DEFINE(shear_plan, shear_plan_free)

static void draw_title(shear_figure *f, const chip_survey *s, const shear_field_info *info) {
    static const char *const axes[] = {[SHEAR_FRAME_PIXEL] = "pixel: x along rows, y along columns",
                                       [SHEAR_FRAME_SKY] = "sky: x to the West, y to the North",
                                       [SHEAR_FRAME_SKY_EAST] =
                                           "sky-east: x to the East, y to the North"};
    char text[256];
    snprintf(text, sizeof text, "%.100s%s%.80s", info->name[0] != '\0' ? info->name : "exposure",
             s->chip.name[0] != '\0' ? ", chip " : "", s->chip.name);
    shear_figure_text(f, PAD, 22.0, text, &(shear_text_style){.size = 16.0, .bold = true});
    plot_print(text, sizeof text,
               "shear in the frame %s.  Circles: galaxies.  Green: noise stamps.  Pink: bad pixels",
               axes[info->frame]);
    shear_figure_text(f, PAD, 46.0, text, &(shear_text_style){.size = 12.5});
}

/* ---- the legend: how many galaxies of each kind ---- */

typedef struct legend {
    int n;
    const char *names[CHIP_KINDS];
    int kinds[CHIP_KINDS];
    int64_t counts[CHIP_KINDS];
} legend;

/* Collect the kinds that occur, from the bottom up. */
static void legend_init(legend *l, const chip_survey *s) {
    int64_t counts[CHIP_KINDS] = {0};
    *l = (legend){0};
    for (int64_t i = 0; i < s->chip.n_stamps; i++)
        counts[chip_kind_of(&s->galaxies[i])]++;
    for (int kind = CHIP_KINDS - 1; kind >= 0; kind--) {
        if (counts[kind] > 0 || kind == 0) {
            l->names[l->n] = chip_kinds[kind].name;
            l->kinds[l->n] = kind;
            l->counts[l->n++] = counts[kind];
        }
    }
}

static void draw_legend(shear_figure *f, shear_rect cell, const legend *l) {
    double most = 1.0;
    for (int i = 0; i < l->n; i++)
        most = fmax(most, (double)l->counts[i]);
    const shear_axes axes = {
        .cell = cell,
        .title = "galaxies, by the first reason to leave them out",
        .x = {.range = {0.0, 1.2 * most}, .bare = true},
        .y = {.range = {-0.6, l->n - 0.4}, .n_names = l->n, .names = l->names}};
    shear_axes_begin(f, &axes);
    for (int i = 0; i < l->n; i++) {
        char text[32];
        shear_axes_bar(
            f, true, i, 0.6, 0.0, (double)l->counts[i],
            &(shear_style){.colour = shear_palette(chip_kinds[l->kinds[i]].hue), .fill = 0.7});
        snprintf(text, sizeof text, "%" PRId64, l->counts[i]);
        shear_axes_text(f, (double)l->counts[i] + 0.02 * most, i, false, text,
                        &(shear_text_style){.size = 11.5});
    }
    shear_axes_end(f);
}

/* ---- numbers ---- */

static void add_psf(plot_table *t, const chip_survey *s) {
    shear_range fwhm = {NAN, NAN};
    double e1 = 0.0;
    double e2 = 0.0;
    double e = 0.0;
    for (int i = 0; i < s->n_psfs; i++) {
        const chip_psf *p = &s->psfs[i];
        fwhm = shear_range_join(fwhm, (shear_range){p->fwhm, p->fwhm});
        e1 += p->e1 / s->n_psfs;
        e2 += p->e2 / s->n_psfs;
        e = fmax(e, p->e);
    }
    if (s->n_psfs == 0)
        return;
    plot_table_add(t, "PSF FWHM", "%.2f to %.2f px", fwhm.lo, fwhm.hi);
    plot_table_add(t, "PSF e_{1}, e_{2}", "mean %+.4f, %+.4f; |e| up to %.4f", e1, e2, e);
}

/* Add the model's description, broken at commas. */
static void add_model(plot_table *t, const char *text) {
    enum { LINE = 40 };
    const char *key = "PSF model";
    while (text[0] != '\0') {
        size_t n = strlen(text);
        size_t cut = n;
        for (size_t i = 0; n > LINE && i + 2 < n && (i < LINE || cut == n); i++)
            cut = text[i] == ',' ? i + 2 : cut;
        plot_table_add(t, key, "%.*s", (int)cut, text);
        key = "";
        text += cut;
    }
}

static void draw_numbers(shear_figure *f, shear_rect cell, const chip_survey *s) {
    plot_table t = {0};
    const double *j = s->jacobian;
    const double scale = sqrt(fabs(j[0] * j[3] - j[1] * j[2]));
    if (s->bin > 1) {
        plot_table_add(&t, "size", "%d \xc3\x97 %d px, binned here by %d", s->chip.nx, s->chip.ny,
                       s->bin);
    } else {
        plot_table_add(&t, "size", "%d \xc3\x97 %d px", s->chip.nx, s->chip.ny);
    }
    if (isfinite(scale)) {
        plot_table_add(&t, "pixel", "%.4f arcsec%s", scale,
                       j[0] * j[3] - j[1] * j[2] < 0.0 ? ", mirrored" : "");
    }
    plot_table_add(&t, "bad pixels", "%.2f %%", 100.0 * s->bad);
    plot_table_add(&t, "sources", "%" PRId64 " on it, %" PRId64 " selected", s->chip.n_sources,
                   s->chip.n_stamps);
    add_psf(&t, s);
    add_model(&t, s->chip.psf);
    plot_table_draw(&t, f, cell, "chip");
}

/* ---- the figure ---- */

/* Return the height of the map's cell: that of the chip at the full width, within limits. */
static int map_height(const chip_survey *s) {
    const double aspect = (double)s->chip.ny / s->chip.nx;
    return (int)fmin(fmax((MAP_WIDTH - 64) * aspect + 60.0, 320.0), 1060.0);
}

/* Heights, pixels. The PSF's panel takes what is left beside a tall map. */
typedef struct heights {
    int map, psf, bars, all;
} heights;

static heights heights_of(const chip_survey *s, const legend *l) {
    enum { GAP = 8, PSF_LEAST = 400, PSF_MOST = 620 };
    heights h = {.map = map_height(s), .psf = PSF_LEAST, .bars = BAR * l->n + 56};
    const int rest = h.map - h.bars - TABLE_HEIGHT - 2 * GAP;
    if (rest > h.psf)
        h.psf = rest < PSF_MOST ? rest : PSF_MOST;
    const int side = h.psf + h.bars + TABLE_HEIGHT + 2 * GAP;
    h.all = TOP + (h.map > side ? h.map : side) + PAD;
    return h;
}

static int draw(shear_figure *f, const chip_survey *s, const shear_field_info *info,
                const legend *l, const heights *h, shear_error *err) {
    const double x = MAP_WIDTH + 2.0 * PAD;
    const double y = TOP + h->psf + 8.0;
    draw_title(f, s, info);
    TRY(chip_map_draw(f, (shear_rect){PAD, TOP, MAP_WIDTH, h->map}, s, info->geometry.nx, err));
    chip_map_draw_psf(f, (shear_rect){x, TOP, SIDE_WIDTH, h->psf}, s);
    draw_legend(f, (shear_rect){x, y, SIDE_WIDTH, h->bars}, l);
    draw_numbers(f, (shear_rect){x, y + h->bars + 8.0, SIDE_WIDTH, TABLE_HEIGHT}, s);
    return SHEAR_OK;
}

int plot_chip(shear_figure **figure, shear_field *field, const plot_options *options,
              shear_error *err) {
    CLEANUP(chip_survey_deinit) chip_survey s = {0};
    CLEANUP(shear_plan_release) shear_plan *plan = NULL;
    CLEANUP(shear_figure_release) shear_figure *f = NULL;
    legend l;
    int chip = 0;
    *figure = NULL;
    TRY(chip_survey_find(field, options->chip, &chip, err));
    TRY(shear_plan_for_field(&plan, options->settings, field, err));
    TRY(chip_survey_init(&s, field, chip, plan, err));
    legend_init(&l, &s);
    const heights h = heights_of(&s, &l);
    TRY(shear_figure_new(&f, WIDTH, h.all, err));
    TRY(draw(f, &s, shear_field_get_info(field), &l, &h, err));
    *figure = CLEANUP_TAKE(f);
    return SHEAR_OK;
}
