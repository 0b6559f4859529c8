/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/psf_direct.h"

#include "base/cleanup.h"
#include "shear/psf.h"

void psf_direct_place(psf_direct *d, const mode_plane *p, const psf_waves *w, arena *a) {
    psf_basis_place(&d->basis, p, 1, 2, a);
    d->rows = arena_doubles(a, 2 * FFT_LANES * (size_t)w->nx);
}

int psf_direct_power(psf_direct *d, const mode_plane *p, const psf_waves *w, const target_aim *aim,
                     const double *psf, double *power, shear_error *err) {
    static const double one = 1.0;
    TRY(shear_psf_usable(psf, w->nx, w->ny, err));
    psf_basis_fill(&d->basis, p, w, psf, d->rows);
    return psf_basis_power(&d->basis, p, aim, &one, power)
               ? SHEAR_OK
               : shear_fail(err, SHEAR_E_PSF, "scale its samples",
                            "the PSF's flux is beyond the range of numbers");
}
