/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Text with sub- and superscripts, and tables of text. */
#include "internal.h"

#include "base/utf8.h"

#include <math.h>
#include <string.h>

static const char FONT[] = "DejaVu Sans";
static const double SCRIPT_SIZE = 0.72; /* relative to the line's size */
static const double SCRIPT_RISE = 0.38;
static const double SCRIPT_DROP = 0.18;
static const double CAPITAL = 0.729; /* height of DejaVu's capitals */
static const double LINE = 1.55;     /* line spacing of a table */

/* Fontconfig, which cairo uses, does not free its memory at exit. This suppression is here because
 * the leak sanitizer reads it only from a file that is always linked. */
#if defined(__SANITIZE_ADDRESS__)
#define UNDER_LEAK_SANITIZER 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define UNDER_LEAK_SANITIZER 1
#endif
#endif
#ifdef UNDER_LEAK_SANITIZER
__attribute__((visibility("default"))) const char *__lsan_default_suppressions(void);
__attribute__((visibility("default"))) const char *__lsan_default_options(void);
const char *__lsan_default_suppressions(void) {
    return "leak:libfontconfig";
}
const char *__lsan_default_options(void) {
    return "print_suppressions=0";
}
#endif

/* A part of the text at one level. */
typedef struct run {
    char text[128];
    double size;
    double rise; /* above the baseline, pixels */
} run;

/* Text cut inside a character would be invalid, and cairo would reject it. */
size_t label_cut(const char *text, size_t most) {
    size_t length = strnlen(text, most);
    while (length > 0 && ((unsigned char)text[length] & 0xc0) == 0x80)
        length--;
    return length;
}

/* Replace invalid bytes by '?': file names may contain them, and cairo would reject the whole
 * figure. */
static void make_valid(char *p) {
    uint32_t point = 0;
    while (*p != '\0') {
        const size_t length = utf8_decode(p, &point);
        if (length == 0 || point < 0x20) {
            *p++ = '?';
        } else {
            p += length;
        }
    }
}

/* Take the next run from *text. Returns false at the end. */
static bool next_run(const char **text, double size, run *out) {
    const char *p = *text;
    size_t length = 0;
    const bool script = (p[0] == '_' || p[0] == '^') && p[1] == '{';
    *out = (run){.size = size};
    if (*p == '\0')
        return false;
    if (script) {
        out->size = SCRIPT_SIZE * size;
        out->rise = p[0] == '^' ? SCRIPT_RISE * size : -SCRIPT_DROP * size;
        p += 2;
        length = strcspn(p, "}");
        *text = p + length + (p[length] == '}');
    } else {
        length =
            1 +
            strcspn(p + 1, "_^"); /* a single '_' or '^' is an ordinary character of the next run */
        *text = p + length;
    }
    if (length >= sizeof out->text) {
        length = label_cut(p, sizeof out->text - 1);
        *text = p + length;
    }
    memcpy(out->text, p, length);
    make_valid(out->text);
    return true;
}

static void select_font(shear_figure *f, double size, bool bold) {
    cairo_select_font_face(f->cr, FONT, CAIRO_FONT_SLANT_NORMAL,
                           bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(f->cr, size);
}

/* Draw the text from (x, baseline), or only measure it. Returns its width. */
static double set_text(shear_figure *f, double x, double baseline, const char *text, double size,
                       bool bold, bool draw) {
    double width = 0.0;
    run r;
    while (next_run(&text, size, &r)) {
        cairo_text_extents_t extents;
        select_font(f, r.size, bold);
        cairo_text_extents(f->cr, r.text, &extents);
        if (draw) {
            cairo_move_to(f->cr, x + width, baseline - r.rise);
            cairo_show_text(f->cr, r.text);
        }
        width += extents.x_advance;
    }
    return width;
}

double shear_figure_text_width(shear_figure *figure, const char *text, double size) {
    return figure_good(figure) ? set_text(figure, 0.0, 0.0, text, size, false, false) : 0.0;
}

void shear_figure_text(shear_figure *figure, double x, double y, const char *text,
                       const shear_text_style *style) {
    if (!figure_good(figure) || text == NULL || !isfinite(x) || !isfinite(y))
        return;
    const double size = style->size > 0.0 ? style->size : LABEL_SIZE;
    const double width = set_text(figure, 0.0, 0.0, text, size, style->bold, false);
    cairo_save(figure->cr);
    figure_set_colour(figure, style->colour);
    cairo_translate(figure->cr, x, y);
    if (style->upward)
        cairo_rotate(figure->cr, -1.5707963267948966);
    set_text(figure, -style->align * width, CAPITAL * size / 2.0, text, size, style->bold, true);
    cairo_restore(figure->cr);
}

void shear_figure_table(shear_figure *figure, shear_rect cell, const char *title, int n,
                        const char *const *keys, const char *const *values) {
    const double step = LINE * LABEL_SIZE;
    double key_width = 0.0;
    for (int i = 0; i < n; i++) {
        const double width = shear_figure_text_width(figure, keys[i], LABEL_SIZE);
        key_width = width > key_width ? width : key_width;
    }
    double y = cell.y + 0.6 * step;
    if (title != NULL) {
        shear_figure_text(figure, cell.x, y, title,
                          &(shear_text_style){.size = TITLE_SIZE, .bold = true});
        y += 1.25 * step;
    }
    for (int i = 0; i < n; i++) {
        const shear_text_style key = {.colour = shear_palette_faint(SHEAR_BLACK, 0.62)};
        shear_figure_text(figure, cell.x, y, keys[i], &key);
        shear_figure_text(figure, cell.x + key_width + 14.0, y, values[i], &(shear_text_style){0});
        y += step;
    }
}
