/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The options of an exposure by name: one table for command lines and jobs. The size of stamps. */
#include "shear/input.h"

#include "shear/plan.h"

#include <errno.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const weight_kinds[] = {"weight", "variance", "rms", NULL};
static const char *const psf_kinds[] = {"auto", "psfex", "piff", "cube", "stars", NULL};
static const char *const noise_kinds[] = {"near", "white", NULL};
static const char *const frames[] = {"auto", "pixel", "sky", "sky-east", NULL};

/* An option: a choice (an int, the word's place), a number from min to max, two of them, or a text.
 */
static const struct {
    const char *name;
    size_t offset;
    const char *const *choices; /* NULL: not a choice */
    int min, max;               /* both 0: a text */
    bool grid;                  /* two such numbers: columns and rows */
} options[] = {
    {"weight-kind", offsetof(shear_exposure, weight_kind), weight_kinds, 0, 0, false},
    {"mask-bad", offsetof(shear_exposure, mask_bad), NULL, 0, 0, false},
    {"columns", offsetof(shear_exposure, columns), NULL, 0, 0, false},
    {"origin", offsetof(shear_exposure, origin), NULL, 0, 1, false},
    {"select", offsetof(shear_exposure, select), NULL, 0, 0, false},
    {"carry", offsetof(shear_exposure, carry), NULL, 0, 0, false},
    {"psf-kind", offsetof(shear_exposure, psf_kind), psf_kinds, 0, 0, false},
    {"stamp", offsetof(shear_exposure, stamp), NULL, SHEAR_MIN_SIDE, SHEAR_MAX_SIDE, false},
    {"noise", offsetof(shear_exposure, noise), noise_kinds, 0, 0, false},
    {"noise-stamps", offsetof(shear_exposure, noise_stamps), NULL, 1, SHEAR_MAX_NOISE_PLANES,
     false},
    {"amplifiers", offsetof(shear_exposure, amplifiers), NULL, 1, SHEAR_MAX_AMPLIFIERS, true},
    {"frame", offsetof(shear_exposure, frame), frames, 0, 0, false},
};
enum { N_OPTIONS = SHEAR_N_EXPOSURE_OPTIONS };
_Static_assert(N_OPTIONS == sizeof options / sizeof options[0], "all are in the table");

static int set_choice(int *member, int i, const char *text, shear_error *err) {
    char all[80] = "";
    for (int k = 0; options[i].choices[k] != NULL; k++) {
        if (strcmp(text, options[i].choices[k]) == 0) {
            *member = k;
            return SHEAR_OK;
        }
        const size_t used = strlen(all);
        snprintf(all + used, sizeof all - used, "%s%s", used > 0 ? ", " : "",
                 options[i].choices[k]);
    }
    return shear_fail(err, SHEAR_E_SETTING, NULL, "%s is '%s', but must be one of: %s",
                      options[i].name, text, all);
}

static int set_number(int *member, int i, const char *text, shear_error *err) {
    char *end = NULL;
    errno = 0;
    const long value = strtol(text, &end, 10);
    if (end == text || *end != '\0' || errno != 0 || value < options[i].min ||
        value > options[i].max) {
        return shear_fail(err, SHEAR_E_SETTING, NULL, "%s is '%s', but must be %d to %d",
                          options[i].name, text, options[i].min, options[i].max);
    }
    *member = (int)value;
    return SHEAR_OK;
}

const char **shear_exposure_text(shear_exposure *e, int i) {
    return options[i].choices == NULL && options[i].max == 0
               ? (const char **)(void *)((char *)e + options[i].offset)
               : NULL;
}

/* Parse a whole number without sign. Return what follows it; NULL: it is not one from min to max.
 */
static const char *parse_number(const char *text, int min, int max, int *number) {
    char *end = NULL;
    const long value = strtol(text, &end, 10);
    if (text[0] < '0' || text[0] > '9' || value < min || value > max)
        return NULL;
    *number = (int)value;
    return end;
}

static int set_grid(shear_amplifiers *member, int i, const char *text, shear_error *err) {
    shear_amplifiers grid;
    const char *rest = parse_number(text, options[i].min, options[i].max, &grid.columns);
    if (rest != NULL) {
        rest = rest[0] == 'x' ? parse_number(rest + 1, options[i].min, options[i].max, &grid.rows)
                              : NULL;
    }
    if (rest == NULL || rest[0] != '\0') {
        return shear_fail(err, SHEAR_E_SETTING, NULL,
                          "%s is '%s', but must be COLUMNSxROWS, each %d to %d", options[i].name,
                          text, options[i].min, options[i].max);
    }
    *member = grid;
    return SHEAR_OK;
}

/* Return the number of the option; -1: there is none of that name. */
static int find(const char *name) {
    int i = N_OPTIONS - 1;
    while (i >= 0 && strcmp(name, options[i].name) != 0)
        i--;
    return i;
}

int shear_exposure_set(shear_exposure *e, const char *name, const char *text, shear_error *err) {
    const int i = find(name);
    if (i < 0)
        return shear_fail(err, SHEAR_E_SETTING, NULL, "an exposure has no option '%s'", name);
    void *member = (char *)e + options[i].offset;
    if (options[i].choices != NULL)
        return set_choice(member, i, text, err);
    if (options[i].grid)
        return set_grid(member, i, text, err);
    if (options[i].max > 0)
        return set_number(member, i, text, err);
    if (text[0] == '\0')
        return shear_fail(err, SHEAR_E_SETTING, "leave it out", "%s is empty", options[i].name);
    memcpy(member, &text, sizeof text);
    return SHEAR_OK;
}

/* Return the text of a grid, in `number`; NULL: it is the default. */
static const char *grid_text(const shear_amplifiers *grid, char *number) {
    const int columns = grid->columns > 0 ? grid->columns : 1;
    const int rows = grid->rows > 0 ? grid->rows : 1;
    snprintf(number, 24, "%dx%d", columns, rows);
    return columns * rows == 1 ? NULL : number;
}

const char *shear_exposure_get(const shear_exposure *e, const char *name, char *number) {
    static const shear_exposure defaults = {.origin = 1};
    const int i = find(name);
    const size_t offset = i >= 0 ? options[i].offset : 0;
    const char *text = NULL;
    int value;
    int normal;
    if (i < 0)
        return NULL;
    if (options[i].choices == NULL && options[i].max == 0) {
        memcpy(&text, (const char *)e + offset, sizeof text);
        return text;
    }
    if (options[i].grid)
        return grid_text((const void *)((const char *)e + offset), number);
    memcpy(&value, (const char *)e + offset, sizeof value);
    memcpy(&normal, (const char *)&defaults + offset, sizeof normal);
    if (value == normal)
        return NULL;
    for (int k = 0; options[i].choices != NULL; k++) {
        if (options[i].choices[k] == NULL || k == value)
            return options[i].choices[k];
    }
    snprintf(number, 24, "%d", value);
    return number;
}

int shear_mosaic_set_size(shear_mosaic *m, const char *text, shear_error *err) {
    int nx = 0;
    int ny = 0;
    const char *rest = parse_number(text, SHEAR_MIN_SIDE, SHEAR_MAX_SIDE, &nx);
    if (rest != NULL && rest[0] == 'x') {
        rest = parse_number(rest + 1, SHEAR_MIN_SIDE, SHEAR_MAX_SIDE, &ny);
    } else {
        ny = nx;
    }
    if (rest == NULL || rest[0] != '\0') {
        return shear_fail(err, SHEAR_E_SETTING, NULL,
                          "stamp-size is '%s', but must be N or NxM, %d to %d pixels", text,
                          SHEAR_MIN_SIDE, SHEAR_MAX_SIDE);
    }
    m->stamp_nx = nx;
    m->stamp_ny = ny;
    return SHEAR_OK;
}

const char *shear_exposure_option(int i) {
    return i >= 0 && i < N_OPTIONS ? options[i].name : NULL;
}
