/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fits/field/name.h"

#include "base/text.h"

#include <string.h>

int sf_field_name_copy(char out[SHEAR_FIELD_NAME_SIZE], const char *name, int code, sf_place at,
                       const char *whence, shear_error *err) {
    const size_t length = strlen(name);
    for (size_t i = 0; i < length; i++) {
        if (name[i] < ' ' || name[i] > '~') {
            return sf_fail(err, code, at, "give the keyword FIELD in the primary header",
                           "the field's name (%s) has a control or non-ASCII character at "
                           "position %zu",
                           whence, i + 1);
        }
    }
    if (length < 1 || length >= SHEAR_FIELD_NAME_SIZE) {
        return sf_fail(err, code, at, "give a shorter keyword FIELD in the primary header",
                       "the field's name (%s) has %zu characters, but must have 1 to %d", whence,
                       length, SHEAR_FIELD_NAME_SIZE - 1);
    }
    if (name[0] == ' ' || name[length - 1] == ' ') {
        return sf_fail(err, code, at, "give the keyword FIELD in the primary header",
                       "the field's name (%s) begins or ends with a blank", whence);
    }
    memcpy(out, name, length + 1);
    return SHEAR_OK;
}

static void strip(char *name, const char *ending) {
    if (text_ends_with(name, ending) && strlen(name) > strlen(ending))
        name[strlen(name) - strlen(ending)] = '\0';
}

int sf_field_name_of_file(char out[SHEAR_FIELD_NAME_SIZE], const char *path, sf_place at,
                          shear_error *err) {
    const char *slash = strrchr(path, '/');
    char base[256];
    text_set(base, sizeof base, slash != NULL ? slash + 1 : path);
    strip(base, ".gz");
    strip(base, ".fz");
    strip(base, ".fits");
    strip(base, ".fit");
    return sf_field_name_copy(out, base, SHEAR_E_FORMAT, at, "from the file's name", err);
}
