/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/sources/source_columns.h"

#include "base/cleanup.h"
#include "base/spelling.h"
#include "base/text.h"

#include <math.h>
#include <string.h>
#include <strings.h>

/* ---- names ---- */

static const char *const keys[] = {"x",     "y",  "ra",    "dec",    "a",     "b",
                                   "theta", "id", "r_gal", "weight", "flags", NULL};

/* Keys that are found together, and their usual names in order of preference. */
typedef struct group {
    enum source_key first;
    int n;
    const char *names[6][3];
} group;

static const group groups[] = {
    {SOURCE_X, 2, {{"X_IMAGE", "Y_IMAGE"}, {"XWIN_IMAGE", "YWIN_IMAGE"}, {"X", "Y"}}},
    {SOURCE_RA,
     2,
     {{"ALPHA_J2000", "DELTA_J2000"},
      {"ALPHAWIN_J2000", "DELTAWIN_J2000"},
      {"ALPHA_SKY", "DELTA_SKY"},
      {"RA", "DEC"},
      {"coord_ra", "coord_dec"}}},
    {SOURCE_A, 3, {{"A_IMAGE", "B_IMAGE", "THETA_IMAGE"}}},
    {SOURCE_ID, 1, {{"NUMBER"}, {"ID"}}},
    {SOURCE_R_GAL, 1, {{"R_GAL"}, {"FLUX_RADIUS"}}},
    {SOURCE_WEIGHT, 1, {{"WEIGHT"}}},
    {SOURCE_FLAGS, 1, {{"FLAGS"}}}};
static enum source_key key_of(const group *g, int k) {
    return (enum source_key)((int)g->first + k);
}

enum { GROUPS = sizeof groups / sizeof *groups };

/* ---- the user's choice ---- */

static int unknown_key(const char *key, shear_error *err) {
    char advice[sizeof((shear_error *)0)->advice] = "";
    spelling s = {.given = key};
    for (int k = 0; k < SOURCE_KEYS; k++)
        spelling_consider(&s, keys[k]);
    if (s.best != NULL)
        text_append(advice, sizeof advice, "did you mean %s? ", s.best);
    text_append(advice, sizeof advice, "keys: ");
    char *list = advice + strlen(advice);
    text_list(list, sizeof advice - strlen(advice), keys);
    return shear_fail(err, SHEAR_E_SETTING, advice, "columns: there is no key '%.60s'", key);
}

static int choose(source_names *names, char *item, shear_error *err) {
    char *name = strchr(item, '=');
    if (name == NULL || name[1] == '\0') {
        return shear_fail(err, SHEAR_E_SETTING, "write KEY=COLUMN,..., such as x=XWIN_IMAGE",
                          "columns: '%.60s' is not KEY=COLUMN", item);
    }
    *name++ = '\0';
    int key = 0;
    while (keys[key] != NULL && strcasecmp(keys[key], item) != 0) {
        key++;
    }
    if (keys[key] == NULL)
        return unknown_key(item, err);
    if (names->given[key][0] != '\0')
        return shear_fail(err, SHEAR_E_SETTING, NULL, "columns: %s is given twice", item);
    if (!text_set(names->given[key], SF_NAME, name)) {
        return shear_fail(err, SHEAR_E_SETTING, NULL,
                          "columns: the name '%.60s...' is longer than FITS allows", name);
    }
    return SHEAR_OK;
}

static int check_groups(const source_names *names, shear_error *err) {
    for (const group *g = groups; g < groups + GROUPS; g++) {
        for (int k = 1; k < g->n; k++) {
            const bool with = names->given[key_of(g, k)][0] != '\0';
            if (with != (names->given[g->first][0] != '\0')) {
                return shear_fail(err, SHEAR_E_SETTING, "give both columns",
                                  "columns: %s is given without %s", keys[key_of(g, with ? k : 0)],
                                  keys[key_of(g, with ? 0 : k)]);
            }
        }
    }
    return SHEAR_OK;
}

int source_names_parse(source_names *names, const char *text, shear_error *err) {
    memset(names, 0, sizeof *names);
    if (text == NULL)
        return SHEAR_OK;
    CLEANUP(release_free) char *copy = strdup(text);
    if (copy == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory");
    char *rest = copy;
    while (rest != NULL)
        TRY(choose(names, strsep(&rest, ","), err));
    return check_groups(names, err);
}

/* ---- the columns of a table ---- */

const sf_column *source_columns_number(const sf_table *t, const char *name) {
    const sf_column *c = NULL;
    return sf_table_find_number(t, name, &c, NULL) == SHEAR_OK ? c : NULL;
}

static int find_given(source_columns *c, const char *name, enum source_key key, shear_error *err) {
    TRY(sf_table_find_number(c->table, name, &c->by[key], err));
    if (c->by[key] != NULL)
        return SHEAR_OK;
    char advice[sizeof((shear_error *)0)->advice];
    sf_table_advise(c->table, name, advice, sizeof advice);
    return sf_fail(err, SHEAR_E_FORMAT, c->table->cards->at, advice,
                   "there is no column %.70s, which columns gives for %s", name, keys[key]);
}

/* Look up the usual names of a group; all of one line must be there. */
static void find_usual(source_columns *c, const group *g) {
    bool found = false;
    for (int i = 0; i < 6 && g->names[i][0] != NULL && !found; i++) {
        found = true;
        for (int k = 0; k < g->n; k++) {
            c->by[key_of(g, k)] = source_columns_number(c->table, g->names[i][k]);
            found = found && c->by[key_of(g, k)] != NULL;
        }
    }
    for (int k = 0; k < g->n && !found; k++)
        c->by[key_of(g, k)] = NULL;
}

int source_columns_find(source_columns *c, const source_names *names, const sf_table *t,
                        shear_error *err) {
    *c = (source_columns){.table = t};
    for (const group *g = groups; g < groups + GROUPS; g++) {
        const bool given = names->given[g->first][0] != '\0';
        for (int k = 0; k < g->n && given; k++)
            TRY(find_given(c, names->given[key_of(g, k)], key_of(g, k), err));
        if (!given && (g->first != SOURCE_X || names->given[SOURCE_RA][0] == '\0'))
            find_usual(c, g);
    }
    if (c->by[SOURCE_X] != NULL || c->by[SOURCE_RA] != NULL)
        return SHEAR_OK;
    char advice[sizeof((shear_error *)0)->advice] =
        "say --columns x=NAME,y=NAME or ra=NAME,dec=NAME; ";
    char *list = advice + strlen(advice);
    sf_table_advise(t, "", list, sizeof advice - strlen(advice));
    return sf_fail(err, SHEAR_E_FORMAT, t->cards->at, advice,
                   "it has no positions: no numbers X_IMAGE and Y_IMAGE (or XWIN_, X), nor "
                   "ALPHA_J2000 and DELTA_J2000 (or RA, DEC)");
}

bool source_columns_is(const source_columns *c, enum source_key key, const char *name) {
    return c->by[key] != NULL && strcasecmp(c->by[key]->name, name) == 0;
}

/* ---- units ---- */

static bool begins(const char *text, const char *with) {
    return strncasecmp(text, with, strlen(with)) == 0;
}

/* Set the factor to degrees; without a unit an angle is in degrees. */
static int find_factor(const source_columns *c, enum source_key key, double *factor,
                       shear_error *err) {
    char card[SF_INDEXED];
    CLEANUP(release_free) char *unit = NULL;
    *factor = 1.0;
    if (key != SOURCE_RA && key != SOURCE_DEC && key != SOURCE_THETA)
        return SHEAR_OK;
    sf_card_indexed(card, "TUNIT", (int)(c->by[key] - c->table->columns) + 1);
    TRY(sf_key_string(c->table->cards, card, &unit, err));
    if (unit == NULL || unit[0] == '\0' || begins(unit, "deg"))
        return SHEAR_OK;
    if (begins(unit, "rad")) {
        *factor = 180.0 / M_PI;
    } else if (key == SOURCE_RA && (begins(unit, "hour") || strcasecmp(unit, "h") == 0)) {
        *factor = 15.0;
    } else {
        sf_make_printable(unit);
        return sf_fail(err, SHEAR_E_FORMAT, c->table->cards->at,
                       "convert the column to degrees, and correct TUNIT",
                       "column %s has the unit '%.40s', not deg or rad", c->by[key]->name, unit);
    }
    return SHEAR_OK;
}

int source_columns_read(const source_columns *c, enum source_key key, double *out,
                        shear_error *err) {
    double factor = 1.0;
    TRY(find_factor(c, key, &factor, err));
    TRY(sf_table_doubles(c->table, c->by[key], c->first, c->n, out, err));
    for (int64_t i = 0; i < c->n && factor != 1.0; i++)
        out[i] *= factor;
    return SHEAR_OK;
}
