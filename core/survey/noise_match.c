/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/noise_match.h"

#include "base/cleanup.h"
#include "survey/chip_match.h"

#include <string.h>

static const char *name_of(const void *self, int i) {
    return exposure_images_name(self, i);
}

static int check_size(const exposure *e, int chip, const char *noise, int found, shear_error *err) {
    const char *name = exposure_images_name(e->images, chip);
    int size[2];
    int other[2];
    exposure_images_size(e->images, chip, &size[0], &size[1]);
    exposure_images_size(e->noise_images, found, &other[0], &other[1]);
    if (other[0] == size[0] && other[1] == size[1])
        return SHEAR_OK;
    return shear_fail(err, SHEAR_E_FORMAT, "both must be of the same exposure, and trimmed alike",
                      "file '%s': the noise image of chip %d (%s) has %d x %d pixels, but the "
                      "image has %d x %d",
                      noise, chip + 1, name[0] != '\0' ? name : "no EXTNAME", other[0], other[1],
                      size[0], size[1]);
}

int noise_match(const exposure *e, int chip, const char *image, const char *noise, int *found,
                shear_error *err) {
    if (e->noise_images == NULL)
        return SHEAR_OK;
    const chip_items items = {.what = "images of noise",
                              .file = noise,
                              .n = exposure_images_chips(e->noise_images),
                              .name = name_of,
                              .self = e->noise_images};
    const char *name = exposure_images_name(e->images, chip);
    TRY(chip_match(&items, chip, e->n_chips, name, found, err));
    if (strcmp(noise, image) == 0 &&
        exposure_images_hdu(e->noise_images, *found, SHEAR_PART_IMAGE) ==
            exposure_images_hdu(e->images, chip, SHEAR_PART_IMAGE)) {
        return shear_fail(
            err, SHEAR_E_FORMAT,
            "give an image of noise alone, or --noise near for empty sky of the image",
            "file '%s': is given both as image and as noise", noise);
    }
    return check_size(e, chip, noise, *found, err);
}
