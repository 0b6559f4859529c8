/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "text.h"

#include "base/text.h"
#include "value.h"

#include <ctype.h>
#include <errno.h>
#include <float.h>
#include <string.h>

static void expect_measure(const shear_setting_def *def, char *buf, size_t size) {
    const char *kind = def->type == SHEAR_T_INT ? "a whole number" : "a number";
    if (def->type == SHEAR_T_CHOICE) {
        text_set(buf, size, "one of: ");
        text_list(buf + strlen(buf), size - strlen(buf), def->choices);
        return;
    }
    if (def->type == SHEAR_T_BOOL) {
        text_set(buf, size, "true or false");
        return;
    }
    snprintf(buf, size, "%s from %g", kind, def->min);
    if (def->max < DBL_MAX)
        text_append(buf, size, " to %g", def->max);
    text_append(buf, size, "%s%s", def->unit[0] != '\0' ? " " : "", def->unit);
    if (def->has_auto)
        text_append(buf, size, ", or %s", shear_setting_auto(def));
}

char *text_expected(const sheard_setting *s, char *buf, size_t size) {
    if (s->type == SHEARD_T_MEASURE) {
        expect_measure(s->measure, buf, size - 1);
    } else {
        value_expected(s, buf, size - 1);
    }
    buf[0] = (char)toupper((unsigned char)buf[0]);
    text_append(buf, size, ".");
    return buf;
}

int text_flushed(FILE *out, shear_error *err) {
    if (fflush(out) != 0 || ferror(out) != 0) {
        return shear_fail(err, SHEAR_E_IO, NULL, "the output cannot be written: %s",
                          strerror(errno));
    }
    return SHEAR_OK;
}
