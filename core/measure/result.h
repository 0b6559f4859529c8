/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/result.h: a field's result with nothing known yet. */
#pragma once

#include "shear/sums.h"

/* Return a result with NaN in every number that may be unknown, and 0 in the sums and counts. */
shear_result result_unknown(void);
