/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fits/header/meds.h"

#include "fits/io/status.h"

#include <strings.h>

static bool has(const sf_file *f, const char *name) {
    for (int i = 1; i < f->count; i++) {
        if (strcasecmp(f->hdus[i].name, name) == 0)
            return true;
    }
    return false;
}

int sf_meds_refuse(const sf_file *f, shear_error *err) {
    if (!has(f, "object_data") || !has(f, "image_info") || !has(f, "image_cutouts"))
        return SHEAR_OK;
    return sf_fail(err, SHEAR_E_FORMAT, (sf_place){f->source.name, NULL},
                   "give the exposures that it was cut from: --image, --weight, --sources, --psf",
                   "is a MEDS file (HDUs object_data, image_info, image_cutouts), which cannot be "
                   "read");
}
