/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/result.h: a field's result before anything is known. */
#ifndef SHEAR_MEASURE_RESULT_H
#define SHEAR_MEASURE_RESULT_H

#include "shear/sums.h"

/* NaN in every number that may be unknown, 0 in the sums and counts. */
shear_result result_unknown(void);

#endif
