/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/field_sums.h"

#include <ctype.h>
#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The text form: "shear-sums 1", then n_stamps, n_used, the flags' counts and the terms,
 * blank-separated. */
static const char magic[] = "shear-sums 1";

int shear_field_sums_new(shear_field_sums **out, shear_error *err) {
    shear_field_sums *f = calloc(1, sizeof *f);
    if (f != NULL) {
        f->sums = exact_new(SHEAR_N_TERMS);
    }
    if (f == NULL || f->sums == NULL) {
        shear_field_sums_free(f);
        *out = NULL;
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a field's sums");
    }
    *out = f;
    return SHEAR_OK;
}

void shear_field_sums_free(shear_field_sums *f) {
    if (f != NULL) {
        exact_free(f->sums, SHEAR_N_TERMS);
        free(f);
    }
}

void shear_field_sums_add(shear_field_sums *f, const shear_block_sums *b) {
    f->n_stamps += b->n_stamps;
    f->n_used += b->n_used;
    for (int i = 0; i < SHEAR_N_FLAGS; i++) {
        f->flagged[i] += b->flagged[i];
    }
    for (int i = 0; i < SHEAR_N_TERMS; i++) {
        exact_add(f->sums, i, b->hi[i]);
        exact_add(f->sums, i, b->lo[i]);
    }
}

void shear_field_sums_join(shear_field_sums *f, const shear_field_sums *g) {
    f->n_stamps += g->n_stamps;
    f->n_used += g->n_used;
    for (int i = 0; i < SHEAR_N_FLAGS; i++) {
        f->flagged[i] += g->flagged[i];
    }
    exact_join(f->sums, g->sums, SHEAR_N_TERMS);
}

void shear_field_sums_leave(shear_field_sums *f, const shear_field_sums *g) {
    f->n_stamps -= g->n_stamps;
    f->n_used -= g->n_used;
    for (int i = 0; i < SHEAR_N_FLAGS; i++) {
        f->flagged[i] -= g->flagged[i];
    }
    exact_leave(f->sums, g->sums, SHEAR_N_TERMS);
}

static bool write_text(const shear_field_sums *f, FILE *out) {
    fprintf(out, "%s %" PRId64 " %" PRId64, magic, f->n_stamps, f->n_used);
    for (int i = 0; i < SHEAR_N_FLAGS; i++) {
        fprintf(out, " %" PRId64, f->flagged[i]);
    }
    for (int i = 0; i < SHEAR_N_TERMS; i++) {
        char *term = exact_format(f->sums, i);
        if (term == NULL) {
            return false;
        }
        fprintf(out, " %s", term);
        free(term);
    }
    return ferror(out) == 0;
}

int shear_field_sums_format(const shear_field_sums *f, char **text, shear_error *err) {
    size_t size = 0;
    *text = NULL;
    FILE *out = open_memstream(text, &size);
    bool written = out != NULL && write_text(f, out);
    if (out != NULL) {
        written = fclose(out) == 0 && written;
    }
    if (!written) {
        free(*text);
        *text = NULL;
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a field's sums as text");
    }
    return SHEAR_OK;
}

/* The next blank-separated word of *rest, which is cut out of it; NULL at the end. */
static char *next_word(char **rest) {
    return strsep(rest, " ");
}

static bool read_count(char **rest, int64_t *count) {
    const char *word = next_word(rest);
    char *end = NULL;
    if (word == NULL || !isdigit((unsigned char)*word)) {
        return false;
    }
    errno = 0;
    *count = strtoll(word, &end, 10);
    return *end == '\0' && errno == 0;
}

static bool read_text(shear_field_sums *f, char *rest) {
    bool good = read_count(&rest, &f->n_stamps) && read_count(&rest, &f->n_used) &&
                f->n_used <= f->n_stamps;
    for (int i = 0; good && i < SHEAR_N_FLAGS; i++) {
        good = read_count(&rest, &f->flagged[i]) && f->flagged[i] <= f->n_stamps - f->n_used;
    }
    for (int i = 0; good && i < SHEAR_N_TERMS; i++) {
        const char *word = next_word(&rest);
        good = word != NULL && exact_parse(f->sums, i, word);
    }
    return good && rest == NULL;
}

int shear_field_sums_parse(shear_field_sums **out, const char *text, shear_error *err) {
    const int code = shear_field_sums_new(out, err);
    if (code != SHEAR_OK) {
        return code;
    }
    const size_t head = sizeof magic - 1;
    bool good = strncmp(text, magic, head) == 0 && text[head] == ' ';
    char *copy = good ? strdup(text + head + 1) : NULL;
    const bool no_memory = good && copy == NULL;
    good = copy != NULL && read_text(*out, copy);
    free(copy);
    if (no_memory) {
        shear_field_sums_free(*out);
        *out = NULL;
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a field's sums");
    }
    if (!good) {
        shear_field_sums_free(*out);
        *out = NULL;
        return shear_fail(err, SHEAR_E_FORMAT, NULL,
                          "these are not the sums of a field (expected '%s ...')", magic);
    }
    return SHEAR_OK;
}
