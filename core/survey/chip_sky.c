/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/chip_sky.h"

#include "base/cleanup.h"
#include "base/text.h"
#include "common/release.h"
#include "shear/plan.h"

void chip_sky_place(const exposure *e, int chip, const char *image, char where[CHIP_SKY_PLACE]) {
    const char *name = exposure_images_name(e->images, chip);
    where[0] = '\0';
    text_append(where, CHIP_SKY_PLACE, "file '%s', HDU ", image);
    if (name[0] != '\0') {
        text_append(where, CHIP_SKY_PLACE, "%s", name);
    } else {
        text_append(where, CHIP_SKY_PLACE, "%lld",
                    (long long)exposure_images_hdu(e->images, chip, SHEAR_PART_IMAGE));
    }
}

static int make(sky_map **map, const exposure *e, const char *cards, int64_t count,
                const char *where, shear_error *err) {
    const int code = sky_map_new(map, cards, count, where, err);
    const bool needless = e->options.frame == SHEAR_FRAME_PIXEL + 1;
    return code == SHEAR_E_FORMAT && needless ? SHEAR_OK : code;
}

int chip_sky_map(sky_map **map, const exposure *e, int chip, const char *image,
                 const head_file *head, const char *wcs, shear_error *err) {
    int64_t count = 0;
    char where[CHIP_SKY_PLACE];
    const int block = head->n == 1 ? 0 : chip;
    const char *cards = exposure_images_header(e->images, chip, &count);
    chip_sky_place(e, chip, image, where);
    if (head->n == 0)
        return make(map, e, cards, count, where, err);
    if (head->n != 1 && head->n != e->n_chips) {
        return shear_fail(err, SHEAR_E_FORMAT, "give a block of cards, ended by END, for each chip",
                          "file '%s': has %d blocks for %d chips", wcs, head->n, e->n_chips);
    }
    CLEANUP(release_free) char *merged = head_file_merge(head, block, cards, &count);
    if (merged == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a header");
    where[0] = '\0';
    text_append(where, sizeof where, "file '%s', block %d", wcs, block + 1);
    return make(map, e, merged, count, where, err);
}
