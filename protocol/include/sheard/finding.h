/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sheard/finding.h: what a look at an installation found (shearctl doctor), as JSON. */
#ifndef SHEARD_FINDING_H
#define SHEARD_FINDING_H

#include "shear/error.h"

enum sheard_finding_level { SHEARD_FINDING_OK = 0, SHEARD_FINDING_WARN, SHEARD_FINDING_FAIL };
/* "ok", "warn", "fail" */
const char *sheard_finding_level_name(int level);

typedef struct sheard_finding {
    const char *subject; /* "socket" */
    int level;
    const char *message;
    const char *remedy; /* "" where there is nothing to do */
} sheard_finding;

/* {"subject", "level", "message", "remedy"} on one line; *text is malloc'd and the caller's to
 * free. SHEAR_E_NOMEM. */
int sheard_finding_json(char **text, const sheard_finding *finding, shear_error *err);

#endif
