/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "text.h"

#include "value.h"

#include <ctype.h>
#include <errno.h>
#include <float.h>
#include <string.h>

void text_wrap(FILE *out, const char *text, int column, const char *indent) {
    bool fresh = true; /* nothing on this line yet */
    while (*text != '\0') {
        int length = (int)strcspn(text, " ");
        if (!fresh && column + 1 + length > TEXT_LINE) {
            fprintf(out, "\n%s", indent);
            column = (int)strlen(indent);
            fresh = true;
        }
        column += fprintf(out, "%s%.*s", fresh ? "" : " ", length, text);
        fresh = false;
        text += length;
        text += strspn(text, " ");
    }
    fputc('\n', out);
}

static void list_choices(const char *const *choices, char *buf, size_t size) {
    size_t used = (size_t)snprintf(buf, size, "one of: ");
    for (size_t i = 0; choices[i] != NULL && used < size; i++) {
        used += (size_t)snprintf(buf + used, size - used, "%s%s", i > 0 ? ", " : "", choices[i]);
    }
}

static void expected_measure(const shear_setting_def *def, char *buf, size_t size) {
    const char *kind = def->type == SHEAR_T_INT ? "a whole number" : "a number";
    const char *space = def->unit[0] != '\0' ? " " : "";
    char automatic[24] = "";
    if (def->has_auto) {
        snprintf(automatic, sizeof automatic, ", or %s", shear_setting_auto(def));
    }
    if (def->type == SHEAR_T_CHOICE) {
        list_choices(def->choices, buf, size);
    } else if (def->type == SHEAR_T_BOOL) {
        snprintf(buf, size, "true or false");
    } else if (def->max >= DBL_MAX) {
        snprintf(buf, size, "%s from %g%s%s%s", kind, def->min, space, def->unit, automatic);
    } else {
        snprintf(buf, size, "%s from %g to %g%s%s%s", kind, def->min, def->max, space, def->unit,
                 automatic);
    }
}

static void expected(const sheard_setting *s, char *buf, size_t size) {
    switch (s->type) {
    case SHEARD_T_PATH:
        snprintf(buf, size, "an absolute path%s%s", s->word != NULL ? ", or " : "",
                 s->word != NULL ? s->word : "");
        break;
    case SHEARD_T_NAME:
        snprintf(buf, size, "a name, or empty");
        break;
    case SHEARD_T_PATHS:
        snprintf(buf, size, "absolute paths, separated by commas");
        break;
    case SHEARD_T_NAMES:
        snprintf(buf, size, "names, separated by commas");
        break;
    case SHEARD_T_CHOICE:
        list_choices(s->choices, buf, size);
        break;
    case SHEARD_T_BOOL:
        snprintf(buf, size, "true or false");
        break;
    case SHEARD_T_MEASURE:
        expected_measure(s->measure, buf, size);
        break;
    default:
        (void)number_expected(s, buf, size);
        break;
    }
}

char *text_expected(const sheard_setting *s, char *buf, size_t size) {
    expected(s, buf, size - 1);
    buf[0] = (char)toupper((unsigned char)buf[0]);
    size_t length = strlen(buf);
    buf[length] = '.';
    buf[length + 1] = '\0';
    return buf;
}

int text_flushed(FILE *out, shear_error *err) {
    if (fflush(out) != 0 || ferror(out) != 0) {
        return shear_fail(err, SHEAR_E_IO, NULL, "the output cannot be written: %s",
                          strerror(errno));
    }
    return SHEAR_OK;
}
