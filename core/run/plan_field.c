/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The plan for a field file: its PSF decides the automatic settings. */
#include "shear/run.h"

#include <math.h>
#include <stdlib.h>

enum { MAX_PSFS_FOR_RADIUS = 256 };

static int compare_doubles(const void *a, const void *b) {
    const double x = *(const double *)a;
    const double y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The median scale radius of evenly spaced PSFs; unusable ones do not count. */
static int median_radius(shear_psf_source psfs, const shear_field_info *info, double *psf,
                         double *r_psf, shear_error *err) {
    double radius[MAX_PSFS_FOR_RADIUS];
    int n = 0;
    const int64_t tries = info->n_psf < MAX_PSFS_FOR_RADIUS ? info->n_psf : MAX_PSFS_FOR_RADIUS;
    shear_error why = {0};
    for (int64_t i = 0; i < tries; i++) {
        const int code = psfs.read(psfs.self, i * info->n_psf / tries, psf, err);
        if (code != SHEAR_OK) {
            return code;
        }
        const shear_geometry *g = &info->geometry;
        n += shear_psf_radius(psf, g->psf_nx, g->psf_ny, g->psf_oversample, &radius[n], &why) ==
             SHEAR_OK;
    }
    if (n == 0) {
        return shear_fail(err, SHEAR_E_PSF, why.advice, "none of %lld PSFs is usable: %s",
                          (long long)tries, why.message);
    }
    qsort(radius, (size_t)n, sizeof *radius, compare_doubles);
    *r_psf = radius[n / 2];
    return SHEAR_OK;
}

int shear_plan_basis_read(shear_plan_basis *basis, const shear_field_info *info,
                          shear_psf_source psfs, shear_error *err) {
    const bool one = info->psf_layout == SHEAR_PSF_ONE;
    const shear_geometry *g = &info->geometry;
    *basis =
        (shear_plan_basis){.r_psf_px = NAN, .has_r_gal = (info->columns & SHEAR_COL_R_GAL) != 0};
    double *psf = malloc((size_t)g->psf_nx * (size_t)g->psf_ny * sizeof *psf);
    if (psf == NULL) {
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a PSF of %d x %d samples",
                          g->psf_nx, g->psf_ny);
    }
    const int code = one ? psfs.read(psfs.self, 0, psf, err)
                         : median_radius(psfs, info, psf, &basis->r_psf_px, err);
    if (one && code == SHEAR_OK) {
        basis->psf = psf;
    } else {
        free(psf);
    }
    return code;
}

void shear_plan_basis_deinit(shear_plan_basis *basis) {
    free(basis->psf);
    *basis = (shear_plan_basis){0};
}

int shear_plan_for_psfs(shear_plan **plan, const shear_settings *settings,
                        const shear_field_info *info, shear_psf_source psfs, shear_error *err) {
    shear_plan_basis basis;
    *plan = NULL;
    int code = shear_plan_basis_read(&basis, info, psfs, err);
    if (code == SHEAR_OK) {
        code = shear_plan_new(plan, settings, &info->geometry, basis.psf, basis.r_psf_px,
                              basis.has_r_gal, err);
    }
    shear_plan_basis_deinit(&basis);
    return code;
}

static int read_from_file(void *self, int64_t index, double *out, shear_error *err) {
    return shear_field_read_psf(self, index, out, err);
}

int shear_plan_for_field(shear_plan **plan, const shear_settings *settings, shear_field *field,
                         shear_error *err) {
    const shear_psf_source psfs = {.self = field, .read = read_from_file};
    return shear_plan_for_psfs(plan, settings, shear_field_get_info(field), psfs, err);
}
