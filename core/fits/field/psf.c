/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Open the PSFs: their shape and number, and which stamp each belongs to. */
#include "base/cleanup.h"
#include "fits/field/internal.h"

static int check_sides(const shear_field *f, shear_error *err) {
    const int64_t *axes = f->psf.axes;
    for (int k = 0; k < 2; k++) {
        if (axes[k] < SF_PSF_MIN_SIDE || axes[k] > SF_PSF_MAX_SIDE) {
            return sf_fail(err, SHEAR_E_FORMAT, f->psf.cards.at, NULL,
                           "its images are %lld x %lld samples, but a side must have %d to %d",
                           (long long)axes[0], (long long)axes[1], SF_PSF_MIN_SIDE,
                           SF_PSF_MAX_SIDE);
        }
    }
    return SHEAR_OK;
}

static int find_oversampling(const sf_cards *cards, int64_t *oversample, shear_error *err) {
    return sf_key_int(cards, "OVERSAMP", 1, SF_MAX_OVERSAMPLE, oversample, err);
}

/* Read OVERSAMP: from the PSFs' HDU, else the primary header, else 1. */
static int read_oversampling(shear_field *f, shear_error *err) {
    const sf_file *file = f->parts.of[SHEAR_PART_PSF].file;
    CLEANUP(sf_cards_deinit) sf_cards primary = {0};
    int64_t oversample = SF_ABSENT;
    TRY(find_oversampling(&f->psf.cards, &oversample, err));
    if (oversample == SF_ABSENT) {
        oversample = 1;
        TRY(sf_cards_init(&primary, file, &file->hdus[0], "primary", err));
        TRY(find_oversampling(&primary, &oversample, err));
    }
    f->info.geometry.psf_oversample = (int)oversample;
    return SHEAR_OK;
}

static int assign(shear_field *f, shear_error *err) {
    shear_field_info *info = &f->info;
    info->n_psf = f->psf.axes[2];
    if (info->n_psf == 1) {
        info->psf_layout = SHEAR_PSF_ONE;
    } else if ((info->columns & SHEAR_COL_PSF_ID) != 0) {
        info->psf_layout = SHEAR_PSF_BY_ID;
    } else if (info->n_psf == info->n_stamps) {
        info->psf_layout = SHEAR_PSF_PER_STAMP;
    } else {
        return sf_fail(
            err, SHEAR_E_FORMAT, f->psf.cards.at,
            "give one image, or one per stamp, or a column PSF_ID in CATALOG",
            "it has %lld images for %lld stamps, and there is no column PSF_ID that says "
            "which is whose",
            (long long)info->n_psf, (long long)info->n_stamps);
    }
    info->geometry.psf_nx = (int)f->psf.axes[0];
    info->geometry.psf_ny = (int)f->psf.axes[1];
    return SHEAR_OK;
}

int sf_field_open_psf(shear_field *f, shear_error *err) {
    const sf_part *part = &f->parts.of[SHEAR_PART_PSF];
    TRY(sf_part_require(part, err));
    TRY(sf_image_init(&f->psf, part->file, part->hdu, part->label, err));
    TRY(check_sides(f, err));
    TRY(assign(f, err));
    return read_oversampling(f, err);
}
