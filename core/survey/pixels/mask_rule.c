/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/pixels/mask_rule.h"

#include "base/cleanup.h"
#include "base/spelling.h"
#include "base/text.h"

#include <errno.h>
#include <stdbool.h>
#include <string.h>
#include <strings.h>

/* Planes of LSST's masks whose pixels are unusable. Not among them: DETECTED, which marks the
 * footprint of every source, and INTRP, whose pixels have been filled. */
static const char *const usual_planes[] = {"BAD",     "SAT",         "CR",        "EDGE", "NO_DATA",
                                           "SUSPECT", "UNMASKEDNAN", "CROSSTALK", NULL};

static const char forms[] = "it is 'any', 'zero', 'bits=N' or 'planes=NAME,NAME,...'";

/* ---- planes of a header ---- */

enum { LONGEST_PLANE = SF_CARD };

/* Parse a card such as "MP_BAD = 0", or "HIERARCH MP_NO_DATA = 8". Return false if it is not one.
 */
static bool parse_plane(const char *card, char name[LONGEST_PLANE], int64_t *bit) {
    const bool hierarch = memcmp(card, "HIERARCH MP_", 12) == 0;
    if (!hierarch && memcmp(card, "MP_", 3) != 0)
        return false;
    const char *begin = card + (hierarch ? 12 : 3);
    const char *equals = memchr(begin, '=', (size_t)(card + SF_CARD - begin));
    if (equals == NULL)
        return false;
    const char *end = equals;
    while (end > begin && end[-1] == ' ')
        end--;
    memcpy(name, begin, (size_t)(end - begin));
    name[end - begin] = '\0';
    char plain[SF_CARD]; /* the value, where a card without HIERARCH has it */
    memset(plain, ' ', sizeof plain);
    plain[SF_KEY] = '=';
    const size_t rest = (size_t)(card + SF_CARD - (equals + 1));
    const size_t room = sizeof plain - SF_KEY - 2;
    memcpy(plain + SF_KEY + 2, equals + 1, rest < room ? rest : room);
    return sf_card_int(plain, bit) && *bit >= 0 && *bit < MASK_MAX_BITS;
}

/* Return the bit of a plane, or 0. */
static uint64_t find_plane(const sf_cards *mask, const char *wanted) {
    char name[LONGEST_PLANE];
    int64_t bit = 0;
    for (int64_t i = 0; i < mask->count; i++) {
        if (parse_plane(mask->text + i * SF_CARD, name, &bit) && strcasecmp(name, wanted) == 0)
            return UINT64_C(1) << bit;
    }
    return 0;
}

/* List the planes in out[size], and find the one whose name is nearest. Return how many there are.
 */
static int list_planes(const sf_cards *mask, char *out, size_t size, spelling *nearest,
                       char best[LONGEST_PLANE]) {
    char name[LONGEST_PLANE];
    int64_t bit = 0;
    int n = 0;
    out[0] = '\0';
    for (int64_t i = 0; i < mask->count; i++) {
        if (!parse_plane(mask->text + i * SF_CARD, name, &bit))
            continue;
        sf_make_printable(name);
        text_append_item(out, size, name);
        n++;
        spelling_consider(nearest, name);
        if (nearest->best == name) { /* which the next plane overwrites */
            text_set(best, LONGEST_PLANE, name);
            nearest->best = best;
        }
    }
    return n;
}

static int unknown_plane(const sf_cards *mask, const char *wanted, shear_error *err) {
    char planes[240];
    char best[LONGEST_PLANE] = "";
    char advice[LONGEST_PLANE + 32] = "use 'bits=N' for masks without named planes";
    char shown[60];
    spelling nearest = {.given = wanted};
    sf_printable_name(shown, sizeof shown, wanted);
    const int n = list_planes(mask, planes, sizeof planes, &nearest, best);
    if (nearest.best != NULL)
        snprintf(advice, sizeof advice, "did you mean %s?", best);
    return sf_fail(err, SHEAR_E_FORMAT, mask->at, n == 0 || nearest.best != NULL ? advice : NULL,
                   "the mask has no plane '%s', a keyword MP_%s (its planes: %s)", shown, shown,
                   n > 0 ? planes : "none");
}

/* ---- the families ---- */

static void add_plane(mask_rule *rule, const char *name, uint64_t bit) {
    if (strcasecmp(name, "SAT") == 0) {
        rule->saturated |= bit;
    } else {
        rule->bad |= bit;
    }
}

static int parse_planes(mask_rule *rule, const char *names, const sf_cards *mask,
                        shear_error *err) {
    CLEANUP(release_free) char *copy = strdup(names);
    if (copy == NULL)
        return sf_fail_memory(err, mask->at);
    char *rest = NULL;
    for (char *name = strtok_r(copy, ", ", &rest); name != NULL;
         name = strtok_r(NULL, ", ", &rest)) {
        const uint64_t bit = find_plane(mask, name);
        if (bit == 0)
            return unknown_plane(mask, name, err);
        add_plane(rule, name, bit);
    }
    return (rule->bad | rule->saturated) != 0
               ? SHEAR_OK
               : shear_fail(err, SHEAR_E_SETTING, forms, "bad mask values: 'planes=' names none");
}

static int parse_bits(mask_rule *rule, const char *number, shear_error *err) {
    char *end = NULL;
    const bool hex = number[0] == '0' && (number[1] == 'x' || number[1] == 'X');
    errno = 0;
    rule->bad = strtoull(number, &end, hex ? 16 : 10);
    const bool whole = number[0] >= '0' && number[0] <= '9' && *end == '\0' && errno == 0;
    if (whole && rule->bad != 0 && rule->bad >> MASK_MAX_BITS == 0)
        return SHEAR_OK;
    return shear_fail(err, SHEAR_E_SETTING,
                      "give the sum of the bad bits' values, such as 5 or 0x5",
                      "bad mask values: 'bits=%.40s' is not a number from 1 to 2^%d - 1", number,
                      (int)MASK_MAX_BITS);
}

/* The rule for a mask of which nothing was said. */
static int use_default(mask_rule *rule, const sf_cards *mask, shear_error *err) {
    char name[LONGEST_PLANE];
    int64_t bit = 0;
    bool planes = false;
    for (int64_t i = 0; i < mask->count && !planes; i++)
        planes = parse_plane(mask->text + i * SF_CARD, name, &bit);
    if (!planes)
        return SHEAR_OK;
    rule->family = MASK_BITS;
    for (int i = 0; usual_planes[i] != NULL; i++)
        add_plane(rule, usual_planes[i], find_plane(mask, usual_planes[i]));
    if ((rule->bad | rule->saturated) != 0)
        return SHEAR_OK;
    char all[120];
    text_list(all, sizeof all, usual_planes);
    return sf_fail(err, SHEAR_E_FORMAT, mask->at, "say which planes are bad: 'planes=NAME,...'",
                   "the mask has planes (MP_%s, ...), but none of %s", name, all);
}

int mask_rule_init(mask_rule *rule, const char *text, const sf_cards *mask, shear_error *err) {
    *rule = (mask_rule){.family = MASK_ANY};
    if (text == NULL)
        return use_default(rule, mask, err);
    if (strcmp(text, "any") == 0)
        return SHEAR_OK;
    rule->family = strcmp(text, "zero") == 0 ? MASK_ZERO : MASK_BITS;
    if (rule->family == MASK_ZERO)
        return SHEAR_OK;
    if (strncmp(text, "bits=", 5) == 0)
        return parse_bits(rule, text + 5, err);
    if (strncmp(text, "planes=", 7) == 0)
        return parse_planes(rule, text + 7, mask, err);
    char shown[60];
    sf_printable_name(shown, sizeof shown, text);
    return shear_fail(err, SHEAR_E_SETTING, forms, "bad mask values: '%s' is unknown", shown);
}
