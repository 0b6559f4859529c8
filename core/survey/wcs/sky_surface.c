/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/wcs/sky_surface.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Copy the string of a card to out[PIECE]. What lies behind it is blank: blanks at its end mean
 * something, and may have been cut off. */
static void copy_piece(const char card[SF_CARD], char *out) {
    int n = 0;
    memset(out, ' ', SKY_SURFACE_PIECE);
    const char *c = memchr(card + SF_KEY, '\'', SF_CARD - SF_KEY);
    for (c = c != NULL ? c + 1 : card + SF_CARD; c < card + SF_CARD && *c != '\''; c++) {
        if (n<SKY_SURFACE_PIECE && * c> ' ' && *c <= '~')
            out[n] = *c;
        n++;
    }
}

bool sky_surface_add(sky_surface_text text[2], const char card[SF_CARD], bool *too_long) {
    if (memcmp(card, "WAT", 3) != 0 || (card[3] != '1' && card[3] != '2') || card[4] != '_')
        return false;
    int number = 0;
    for (int i = 5; i < SF_KEY; i++) {
        if (card[i] < '0' || card[i] > '9')
            return false;
        number = 10 * number + (card[i] - '0');
    }
    *too_long = number > SKY_SURFACE_CARDS;
    if (number < 1 || *too_long)
        return true;
    char *const all = text[card[3] - '1'].text;
    /* cards that are missing before this one are blank */
    size_t length = strlen(all);
    const size_t at = (size_t)(number - 1) * SKY_SURFACE_PIECE;
    for (; length < at + SKY_SURFACE_PIECE; length++)
        all[length] = ' ';
    all[length] = '\0';
    copy_piece(card, all + at);
    return true;
}

/* Read a number at *text, and move it behind the number. Return false if there is none. */
static bool read_number(const char **text, double *value) {
    char *end = NULL;
    *value = strtod(*text, &end);
    const bool found = end != *text && isfinite(*value);
    *text = end;
    return found;
}

/* The same for a whole number in [min, max]. */
static bool read_whole(const char **text, int min, int max, int *value) {
    double v = NAN;
    if (!read_number(text, &v) || v < min || v > max || v != floor(v))
        return false;
    *value = (int)v;
    return true;
}

/* Read the coefficients, x running fastest. */
static bool read_terms(sky_surface *s, const char *text, int nx, int ny, int cross) {
    enum { NO_CROSS = 0, HALF_CROSS = 2 };
    const int most = nx > ny ? nx : ny;
    for (int n = 0; n < ny; n++) {
        for (int m = 0; m < nx; m++) {
            if ((cross == NO_CROSS && m > 0 && n > 0) || (cross == HALF_CROSS && m + n >= most))
                continue;
            if (!read_number(&text, &s->c[m][n]) ||
                (m + n >= SKY_SURFACE_ORDER && s->c[m][n] != 0.0))
                return false;
        }
    }
    return true;
}

static const char *read_surface(sky_surface *s, const char *text) {
    int kind = 0, nx = 0, ny = 0, cross = 0;
    if (!read_whole(&text, 1, 3, &kind) || !read_whole(&text, 1, SKY_SURFACE_ORDER, &nx) ||
        !read_whole(&text, 1, SKY_SURFACE_ORDER, &ny) || !read_whole(&text, 0, 2, &cross)) {
        return "its polynomial's kind must be 1 to 3, its orders 1 to 10, its cross terms 0 to 2";
    }
    for (int i = 0; i < 2; i++) {
        if (!read_number(&text, &s->low[i]) || !read_number(&text, &s->high[i]) ||
            s->low[i] == s->high[i]) {
            return "its polynomial has no range";
        }
    }
    if (!read_terms(s, text, nx, ny, cross))
        return "its polynomial has too few coefficients, or a degree above 9";
    s->kind = (enum sky_surface_kind)kind;
    return NULL;
}

/* Read "projp1=1.0", which ZPX has. */
static const char *read_projp(sky_surface *s, const char *text) {
    for (text = strstr(text, "projp"); text != NULL; text = strstr(text, "projp")) {
        int m = 0;
        text += strlen("projp");
        if (!read_whole(&text, 0, SKY_SURFACE_PROJP - 1, &m) || *text != '=')
            return "it has a parameter that is none of projp0 to projp29";
        text++;
        if (!read_number(&text, &s->projp[m]))
            return "the value of a parameter projp is no number";
    }
    return NULL;
}

const char *sky_surface_parse(sky_surface *s, const sky_surface_text *text) {
    *s = (sky_surface){.kind = SKY_SURFACE_NONE};
    for (int m = 0; m < SKY_SURFACE_PROJP; m++)
        s->projp[m] = NAN;
    const char *wrong = read_projp(s, text->text);
    const char *begin = strstr(text->text, "lngcor");
    if (begin == NULL)
        begin = strstr(text->text, "latcor");
    if (wrong != NULL || begin == NULL)
        return wrong;
    begin = strchr(begin, '"');
    return begin == NULL ? "its polynomial is not in quotes" : read_surface(s, begin + 1);
}
