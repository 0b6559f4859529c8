/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/field_sums.h"

#include "base/cleanup.h"
#include "base/text.h"
#include "common/release.h"

#include <ctype.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The text form: "shear-sums 2", n_stamps, n_used, the number of flags and their counts, the number
 * of terms and the terms, and the stamp that counts most, separated by blanks. Flags and terms that
 * are missing are 0. */
static const char magic[] = "shear-sums 2";
/* The text form of version 0.1: 8 flags and these terms, without their numbers. */
static const char old_magic[] = "shear-sums 1";
enum { OLD_FLAGS = 8 };
#define PRODUCT(i, j) ((int)SHEAR_S_PRODUCT + (j) * ((j) + 1) / 2 + (i))
static const int old_terms[] = {
    SHEAR_S_W,
    SHEAR_S_COMPONENT + SHEAR_C_N1,
    SHEAR_S_COMPONENT + SHEAR_C_N2,
    SHEAR_S_COMPONENT + SHEAR_C_D,
    PRODUCT(SHEAR_C_N1, SHEAR_C_N1),
    PRODUCT(SHEAR_C_N2, SHEAR_C_N2),
    PRODUCT(SHEAR_C_N1, SHEAR_C_N2),
    PRODUCT(SHEAR_C_N1, SHEAR_C_D),
    PRODUCT(SHEAR_C_N2, SHEAR_C_D),
    PRODUCT(SHEAR_C_D, SHEAR_C_D),
    SHEAR_S_FLUX,
    SHEAR_S_REMOVED,
    SHEAR_S_REMOVED2,
    SHEAR_S_BORDER_MEAN,
    SHEAR_S_BORDER_MEAN2,
    SHEAR_S_BORDER_VAR,
    SHEAR_S_BORDER_VAR2,
    SHEAR_S_BORDER_NOISE,
};
enum { N_OLD_TERMS = sizeof old_terms / sizeof old_terms[0] };

int shear_field_sums_new(shear_field_sums **out, shear_error *err) {
    *out = NULL;
    CLEANUP(shear_field_sums_release) shear_field_sums *f = calloc(1, sizeof *f);
    if (f != NULL)
        f->sums = exact_new(SHEAR_N_TERMS);
    if (f == NULL || f->sums == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a field's sums");
    *out = CLEANUP_TAKE(f);
    return SHEAR_OK;
}

void shear_field_sums_free(shear_field_sums *f) {
    if (f != NULL) {
        exact_free(f->sums, SHEAR_N_TERMS);
        free(f);
    }
}

/* Return the larger influence, in either order; unknown if one of them is. */
static shear_influence larger(shear_influence a, shear_influence b) {
    if (isnan(a.size) || isnan(b.size))
        return (shear_influence){.size = NAN, .stamp = -1};
    const bool first = a.size > b.size || (a.size == b.size && a.stamp <= b.stamp);
    return first ? a : b;
}

shear_influence shear_field_sums_top(const shear_field_sums *f) {
    return f->top;
}

void shear_field_sums_set_top(shear_field_sums *f, shear_influence top) {
    f->top = top;
}

/* Add or subtract (sign -1) numbers of stamps. */
static void count(shear_field_sums *f, int sign, int64_t n_stamps, int64_t n_used,
                  const int64_t *flagged, const int64_t *framed) {
    f->n_stamps += sign * n_stamps;
    f->n_used += sign * n_used;
    for (int i = 0; i < SHEAR_N_FLAGS; i++)
        f->flagged[i] += sign * flagged[i];
    for (int i = 0; i < SHEAR_N_FRAMES; i++)
        f->framed[i] += sign * framed[i];
}

int shear_field_sums_frame(const shear_field_sums *f) {
    int frame = SHEAR_FRAME_PIXEL;
    int n = 0;
    for (int i = 0; i < SHEAR_N_FRAMES; i++) {
        if (f->framed[i] != 0) {
            frame = i;
            n++;
        }
    }
    return n > 1 ? SHEAR_N_FRAMES : frame;
}

void shear_field_sums_add(shear_field_sums *f, const shear_block_sums *b) {
    count(f, 1, b->n_stamps, b->n_used, b->flagged, b->framed);
    for (int i = 0; i < SHEAR_N_TERMS; i++) {
        exact_add(f->sums, i, b->hi[i]);
        exact_add(f->sums, i, b->lo[i]);
    }
    f->top = larger(f->top, b->top);
}

void shear_field_sums_join(shear_field_sums *f, const shear_field_sums *g) {
    count(f, 1, g->n_stamps, g->n_used, g->flagged, g->framed);
    exact_join(f->sums, g->sums, SHEAR_N_TERMS);
    f->top = larger(f->top, g->top);
}

void shear_field_sums_subtract(shear_field_sums *f, const shear_field_sums *g) {
    count(f, -1, g->n_stamps, g->n_used, g->flagged, g->framed);
    exact_leave(f->sums, g->sums, SHEAR_N_TERMS);
    if (!(f->top.size > g->top.size))
        f->top = (shear_influence){.size = NAN, .stamp = -1};
}

static bool write_text(const shear_field_sums *f, FILE *out) {
    fprintf(out, "%s %" PRId64 " %" PRId64 " %d", magic, f->n_stamps, f->n_used, SHEAR_N_FLAGS);
    for (int i = 0; i < SHEAR_N_FLAGS; i++)
        fprintf(out, " %" PRId64, f->flagged[i]);
    fprintf(out, " %d", SHEAR_N_TERMS);
    for (int i = 0; i < SHEAR_N_TERMS; i++) {
        char *term = exact_format(f->sums, i);
        if (term == NULL)
            return false;
        fprintf(out, " %s", term);
        free(term);
    }
    fprintf(out, " %a %" PRId64, f->top.size, f->top.stamp);
    for (int i = 0; i < SHEAR_N_FRAMES && f->framed[SHEAR_FRAME_PIXEL] != f->n_stamps; i++)
        fprintf(out, " %" PRId64, f->framed[i]);
    return ferror(out) == 0;
}

int shear_field_sums_format(const shear_field_sums *f, char **text, shear_error *err) {
    size_t size = 0;
    *text = NULL;
    FILE *out = open_memstream(text, &size);
    bool written = out != NULL && write_text(f, out);
    if (out != NULL)
        written = fclose(out) == 0 && written;
    if (!written) {
        free(*text);
        *text = NULL;
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a field's sums as text");
    }
    return SHEAR_OK;
}

static bool read_count(char **rest, int64_t *count) {
    const char *word = strsep(rest, " ");
    return word != NULL && isdigit((unsigned char)*word) && text_to_int64(word, count);
}

static bool read_flags(shear_field_sums *f, int64_t n, char **rest) {
    bool good = n <= SHEAR_N_FLAGS;
    for (int64_t i = 0; good && i < n; i++)
        good = read_count(rest, &f->flagged[i]) && f->flagged[i] <= f->n_stamps - f->n_used;
    return good;
}

/* Read n terms. `where` says which they are; NULL: the first ones. */
static bool read_terms(shear_field_sums *f, int64_t n, const int *where, char **rest) {
    bool good = n <= SHEAR_N_TERMS;
    for (int i = 0; good && i < (int)n; i++) {
        const char *word = strsep(rest, " ");
        good = word != NULL && exact_parse(f->sums, where != NULL ? where[i] : i, word);
    }
    return good;
}

/* Return whether the sums may have this top stamp. A file cannot hold more stamps than bytes. The
 * sums of a part of a field may have fewer stamps than the stamp's number. */
static bool top_is_possible(const shear_field_sums *f) {
    static const int64_t most = INT64_MAX / (SHEAR_MIN_SIDE * SHEAR_MIN_SIDE);
    const shear_influence top = f->top;
    return isnan(top.size) ? top.stamp == -1
           : top.size > 0.0
               ? isfinite(top.size) && top.stamp >= 0 && top.stamp < most && f->n_used > 0
               : top.size == 0.0 && (top.stamp == 0 || top.stamp == -1);
}

static bool read_top(shear_field_sums *f, char **rest) {
    const char *size = strsep(rest, " ");
    const char *stamp = strsep(rest, " ");
    return size != NULL && stamp != NULL && text_to_double(size, &f->top.size) &&
           text_to_int64(stamp, &f->top.stamp) && top_is_possible(f);
}

/* Read how many stamps each frame has. Without it all are those of pixels. */
static bool read_frames(shear_field_sums *f, char **rest) {
    int64_t left = f->n_stamps;
    if (*rest == NULL) {
        f->framed[SHEAR_FRAME_PIXEL] = f->n_stamps;
        return true;
    }
    for (int i = 0; i < SHEAR_N_FRAMES; i++) {
        if (!read_count(rest, &f->framed[i]) || f->framed[i] > left)
            return false;
        left -= f->framed[i];
    }
    return left == 0;
}

/* Return NULL, or the name of the part of the text that is wrong. */
static const char *read_text(shear_field_sums *f, bool old, char *rest) {
    int64_t n_flags = OLD_FLAGS;
    int64_t n_terms = N_OLD_TERMS;
    if (!read_count(&rest, &f->n_stamps) || !read_count(&rest, &f->n_used) ||
        f->n_used > f->n_stamps) {
        return "the numbers of stamps";
    }
    if ((!old && !read_count(&rest, &n_flags)) || !read_flags(f, n_flags, &rest))
        return "the flags' counts";
    if ((!old && !read_count(&rest, &n_terms)) ||
        !read_terms(f, n_terms, old ? old_terms : NULL, &rest)) {
        return "the terms";
    }
    f->top = (shear_influence){.size = NAN, .stamp = -1};
    if (!old && !read_top(f, &rest))
        return "the stamp that counts most";
    if (!read_frames(f, &rest))
        return "the numbers of stamps by frame";
    return rest == NULL ? NULL : "what follows them";
}

int shear_field_sums_parse(shear_field_sums **out, const char *text, shear_error *err) {
    _Static_assert(sizeof magic == sizeof old_magic, "of one length");
    const size_t head = sizeof magic - 1;
    const bool old = strncmp(text, old_magic, head) == 0;
    *out = NULL;
    if (!(old || strncmp(text, magic, head) == 0) || text[head] != ' ') {
        return shear_fail(err, SHEAR_E_FORMAT, NULL,
                          "these are not the sums of a field (expected '%s ...')", magic);
    }
    CLEANUP(shear_field_sums_release) shear_field_sums *f = NULL;
    CLEANUP(release_free) char *copy = strdup(text + head + 1);
    TRY(shear_field_sums_new(&f, err));
    if (copy == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a field's sums");
    const char *wrong = read_text(f, old, copy);
    if (wrong != NULL) {
        return shear_fail(err, SHEAR_E_FORMAT, NULL,
                          "these are not the sums of a field: %s cannot be right", wrong);
    }
    *out = CLEANUP_TAKE(f);
    return SHEAR_OK;
}
