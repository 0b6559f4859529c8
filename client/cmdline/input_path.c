/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "cmdline/input_path.h"

#include "base/cleanup.h"
#include "sheard/messages.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static int no_memory(shear_error *err) {
    return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory");
}

/* Set *path to "DIRECTORY/LAST", without a second slash after the root directory. */
static int join(const char *directory, const char *last, char **path, shear_error *err) {
    const char *slash = strcmp(directory, "/") == 0 ? "" : "/";
    return asprintf(path, "%s%s%s", directory, slash, last) < 0 ? no_memory(err) : SHEAR_OK;
}

int input_path_absolute(const char *name, char **path, shear_error *err) {
    *path = NULL;
    if (name[0] == '/') {
        *path = strdup(name);
        return *path != NULL ? SHEAR_OK : no_memory(err);
    }
    const char *slash = strrchr(name, '/');
    const char *last = slash != NULL ? slash + 1 : name;
    if (*last == '\0' || strcmp(last, ".") == 0 || strcmp(last, "..") == 0)
        return shear_fail(err, SHEAR_E_IO, NULL, "%s is not the name of a file", name);
    CLEANUP(release_free)
    char *parent = slash != NULL ? strndup(name, (size_t)(slash - name)) : strdup(".");
    if (parent == NULL)
        return no_memory(err);
    CLEANUP(release_free) char *real = realpath(parent, NULL);
    return real != NULL
               ? join(real, last, path, err)
               : shear_fail(err, SHEAR_E_IO, "check the path",
                            "%s: its directory cannot be found: %s", name, strerror(errno));
}

/* Parse the HDU: digits only are a number, anything else is a name. */
static int read_hdu(const char *name, const char *text, shear_input_part *part, shear_error *err) {
    const size_t n = strlen(text);
    if (strspn(text, "0123456789") != n) {
        part->extname = text;
        return n <= SHEARD_MSG_EXTNAME_MAX
                   ? SHEAR_OK
                   : shear_fail(err, SHEAR_E_SETTING, NULL,
                                "%s: the name of an HDU has at most %d characters", name,
                                SHEARD_MSG_EXTNAME_MAX);
    }
    const long value = n < 6 ? strtol(text, NULL, 10) : SHEARD_MSG_HDU_MAX + 1L;
    if (value > SHEARD_MSG_HDU_MAX) {
        return shear_fail(err, SHEAR_E_SETTING, NULL, "%s: an HDU is a number from 0 to %d", name,
                          SHEARD_MSG_HDU_MAX);
    }
    part->hdu = value;
    return SHEAR_OK;
}

int input_path_hdu(const char *name, shear_input_part *part, size_t *length, shear_error *err) {
    *part = (shear_input_part){.hdu = -1};
    *length = strlen(name);
    const char *colon = strrchr(name, ':');
    if (colon == NULL || colon == name || !colon[1] || strchr(colon, '/') != NULL ||
        access(name, F_OK) == 0) {
        return SHEAR_OK;
    }
    *length = (size_t)(colon - name);
    return read_hdu(name, colon + 1, part, err);
}
