/* SPDX-License-Identifier: GPL-3.0-or-later */
/* chips_text.h: print the chips of an exposure in the report of `shearctl validate`. */
#pragma once

#include "sheard/validation_report.h"

#include <stdio.h>

/* Print frame, distortion, and two or three lines for each chip. */
void chips_text_print(const sheard_validation_report *v, FILE *out);
