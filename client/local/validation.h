/* SPDX-License-Identifier: GPL-3.0-or-later */
/* validation.h: the conclusion of `shearctl validate`, once every stamp has been scanned. */
#pragma once

#include "sheard/validation_report.h"

/* Set v->good, and write the conclusion and the advice into *words. */
void validation_conclude(sheard_validation_report *v, shear_error *words);
