/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/chip_match.h"

#include <stdbool.h>
#include <strings.h>

/* Return the only item of that name; -1: there is none, or several. */
static int find_name(const chip_items *items, const char *name) {
    int found = -1;
    for (int i = 0; i < items->n && name[0] != '\0'; i++) {
        if (strcasecmp(items->name(items->self, i), name) != 0)
            continue;
        if (found >= 0)
            return -1;
        found = i;
    }
    return found;
}

/* Return whether an item has a name: then order means nothing for a chip whose name is missing. */
static bool any_named(const chip_items *items) {
    for (int i = 0; i < items->n; i++) {
        if (items->name(items->self, i)[0] != '\0')
            return true;
    }
    return false;
}

int chip_match(const chip_items *items, int chip, int chips, const char *name, int *item,
               shear_error *err) {
    const int named = find_name(items, name);
    *item = named >= 0 ? named : items->n == 1 ? 0 : chip;
    if (named >= 0 || items->n == 1 ||
        (items->n == chips && (name[0] == '\0' || !any_named(items))))
        return SHEAR_OK;
    return shear_fail(err, SHEAR_E_FORMAT,
                      "chips are matched by EXTNAME, else by order: give one for each chip, or "
                      "choose the chip (--image FILE:HDU)",
                      "file '%s': has %d %s, and none is that of chip %d (%s) of %d", items->file,
                      items->n, items->what, chip + 1, name[0] != '\0' ? name : "no EXTNAME",
                      chips);
}
