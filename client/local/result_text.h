/* SPDX-License-Identifier: GPL-3.0-or-later */
/* result_text.h: print a field's result as text. */
#pragma once

#include "local/measure_group.h"

#include <stdio.h>

/* Print the result of a measured group. `settings` are those of the measurement. */
void result_text_print(const measure_group *group, const shear_settings *settings, FILE *out);
