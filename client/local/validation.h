/* SPDX-License-Identifier: GPL-3.0-or-later */
/* validation.h: would a field file whose every stamp has been seen measure? */
#ifndef CLIENT_LOCAL_VALIDATION_H
#define CLIENT_LOCAL_VALIDATION_H

#include "sheard/validation_report.h"

/* Set v->good; the conclusion and what to do about it go to *words. */
void validation_conclude(sheard_validation_report *v, shear_error *words);

#endif
