/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/result.h: a field's result with nothing known yet. */
#ifndef SHEAR_MEASURE_RESULT_H
#define SHEAR_MEASURE_RESULT_H

#include "shear/sums.h"

/* Return a result with NaN in every number that may be unknown, and 0 in the sums and counts. */
shear_result result_unknown(void);

#endif
