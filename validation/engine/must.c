/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/must.h"

#include <stdlib.h>

void *memory_new(size_t n, size_t size, const char *what, int *code, shear_error *err) {
    if (*code) {
        return NULL;
    }
    void *made = calloc(n > 0 ? n : 1, size);
    if (made == NULL) {
        *code = shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for %s", what);
    }
    return made;
}
