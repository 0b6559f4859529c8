/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sheard/check_result.h: the result of one check of an installation (shearctl doctor), as JSON. */
#ifndef SHEARD_CHECK_RESULT_H
#define SHEARD_CHECK_RESULT_H

#include "shear/error.h"

enum sheard_check_level { SHEARD_CHECK_OK = 0, SHEARD_CHECK_WARN, SHEARD_CHECK_FAIL };
/* Return "ok", "warn" or "fail". */
const char *sheard_check_level_name(enum sheard_check_level level);

typedef struct sheard_check_result {
    const char *subject; /* "socket" */
    enum sheard_check_level level;
    const char *message;
    const char *remedy; /* "" if there is none */
} sheard_check_result;

/* Write {"subject", "level", "message", "remedy"} on one line. *text is from malloc; the caller
 * frees it. Return SHEAR_OK or SHEAR_E_NOMEM. */
int sheard_check_result_json(char **text, const sheard_check_result *result, shear_error *err);

#endif
