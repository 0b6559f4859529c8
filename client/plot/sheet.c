/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The sheet of a field file: one row per stamp, and the plan below. */
#include "plot/sheet.h"

#include "base/cleanup.h"
#include "plot/text.h"

#include <inttypes.h>

enum { WIDTH = 1330, LEFT = 34, TOP = 96, STAMP_ROW = 172, ROW_GAP = 8, PLAN_ROW = 300, PAD = 14 };

static void draw_title(shear_figure *f, const stamp_reader *b) {
    char text[160];
    const shear_field_info *info = b->info;
    const double width =
        shear_figure_text_width(f, info->name, 16.0) * 1.12; /* bold text is wider */
    shear_figure_text(f, PAD, 24.0, info->name, &(shear_text_style){.size = 16.0, .bold = true});
    plot_print(text, sizeof text, "%" PRId64 " stamps of %d \xc3\x97 %d px", info->n_stamps,
               info->geometry.nx, info->geometry.ny);
    shear_figure_text(f, PAD + width + 16.0, 24.0, text, &(shear_text_style){.size = 13.0});
}

/* Draw row i. The first row is drawn last, followed by the plan with its spectra. */
static int draw_row(shear_figure *f, stamp_reader *b, const shear_grid *grid, int i, int64_t index,
                    shear_error *err) {
    const shear_rect below = {PAD, grid->area.y + grid->area.h + 22.0, WIDTH - 2.0 * PAD,
                              PLAN_ROW - 22.0 - PAD};
    CLEANUP(sheet_stamp_deinit) sheet_stamp stamp = {0};
    TRY(stamp_reader_read(b, index, &stamp, err));
    TRY(sheet_draw_stamp(f, grid, i, b, &stamp, err));
    return i > 0 ? SHEAR_OK : sheet_draw_plan(f, below, b, &stamp, err);
}

static int draw_stamps(shear_figure *f, stamp_reader *b, const int64_t *index, int n,
                       shear_error *err) {
    const shear_grid grid = {
        .area = {LEFT, TOP, WIDTH - LEFT - PAD, n * STAMP_ROW + (n - 1) * ROW_GAP},
        .rows = n,
        .columns = SHEET_COLUMNS,
        .gap_x = 4.0,
        .gap_y = ROW_GAP};
    draw_title(f, b);
    sheet_draw_headings(f, &grid, TOP - 38.0, b);
    for (int i = n - 1; i >= 0; i--)
        TRY(draw_row(f, b, &grid, i, index[i], err));
    return SHEAR_OK;
}

int plot_sheet(shear_figure **figure, shear_field *field, const plot_options *options,
               shear_error *err) {
    CLEANUP(stamp_reader_deinit) stamp_reader b = {0};
    CLEANUP(shear_figure_release) shear_figure *f = NULL;
    int64_t index[PLOT_MAX_STAMPS];
    int n = 0;
    *figure = NULL;
    TRY(stamp_reader_init(&b, field, options->settings, err));
    TRY(stamp_reader_choose(&b, options, index, &n, err));
    TRY(shear_figure_new(&f, WIDTH, TOP + n * STAMP_ROW + (n - 1) * ROW_GAP + PLAN_ROW, err));
    int code = draw_stamps(f, &b, index, n, err);
    *figure = code == SHEAR_OK ? CLEANUP_TAKE(f) : NULL;
    return code;
}
