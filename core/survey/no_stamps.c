/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/no_stamps.h"

#include "shear/stamp.h"

#include <inttypes.h>

void source_count_add(source_count *c, const source_list *sources, bool shared) {
    if (shared)
        *c = (source_count){0};
    c->rows += sources->rows;
    c->selected += sources->rows_selected;
    c->by_sky = sources->x == NULL;
}

static int64_t count_without(const exposure *e, uint32_t flags) {
    int64_t n = 0;
    for (int c = 0; c < e->n_chips; c++) {
        const chip_stamps *s = &e->chips[c].stamps;
        for (int64_t i = 0; i < s->n; i++)
            n += (s->flags[i] & flags) == 0;
    }
    return n;
}

int no_stamps_check(const exposure *e, const source_count *c, const char *catalog,
                    shear_error *err) {
    if (c->rows == 0) {
        return shear_fail(err, SHEAR_E_FORMAT, "give the catalog of the exposure's objects",
                          "file '%s': has no sources: its tables are empty", catalog);
    }
    if (c->selected == 0) {
        return shear_fail(err, SHEAR_E_FORMAT,
                          "look at the catalog's FLAGS and at --select: which sources remain?",
                          "file '%s': no source is selected, of %" PRId64, catalog, c->rows);
    }
    if (count_without(e, SHEAR_FLAG_NO_POSITION) == 0) {
        return shear_fail(
            err, SHEAR_E_FORMAT,
            c->by_sky ? "is it the catalog of this exposure? RA and Dec must be degrees, or "
                        "TUNIT say what they are; the image's coordinates must be right"
                      : "is it the catalog of this exposure? see which columns are its "
                        "pixel positions: --columns x=...,y=...",
            "file '%s': none of %" PRId64 " selected sources is on the image", catalog,
            c->selected);
    }
    return count_without(e, SHEAR_FLAGS_WITHOUT_PSF) > 0
               ? SHEAR_OK
               : shear_fail(err, SHEAR_E_PSF,
                            "is it the PSF of this exposure? galaxies must not be far from its "
                            "stars, and the models of their chips must not have failed",
                            "file '%s': none of %" PRId64 " selected sources has a PSF", catalog,
                            c->selected);
}
