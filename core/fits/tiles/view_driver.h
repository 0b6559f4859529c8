/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/tiles/view_driver.h: open views in CFITSIO, through an I/O driver. */
#pragma once

#include "fits/tiles/view.h"

/* Have CFITSIO open `v`, whose header is complete. *status is CFITSIO's. SHEAR_E_INTERNAL: CFITSIO
 * accepts no driver, or is not reentrant; SHEAR_E_IO: too many views are open. */
int sf_view_driver_open(sf_view *v, fitsfile **fits, int *status, shear_error *err);
/* Release the view's slot, after CFITSIO has closed it or could not open it. */
void sf_view_driver_release(sf_view *v);
