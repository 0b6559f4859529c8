/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "sums_text.h"

#include "store.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The packed form begins with this; a run of n zeros is "zN.". A text that has those letters itself
 * is kept as it is. */
static const char mark[] = "z:";
enum { SHORTEST_RUN = 6 }; /* shorter ones are not worth it */

static int no_memory(shear_error *err) {
    return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a field's sums");
}

int sums_pack(const char *text, char **packed, shear_error *err) {
    if (strpbrk(text, "z.") != NULL) {
        *packed = strdup(text);
        return *packed != NULL ? SHEAR_OK : no_memory(err);
    }
    /* A run and its count take no more room than the zeros did. */
    const size_t size = strlen(text) + sizeof mark;
    char *out = malloc(size);
    *packed = out;
    if (out == NULL) {
        return no_memory(err);
    }
    out += snprintf(out, size, "%s", mark);
    while (*text != '\0') {
        const size_t zeros = strspn(text, "0");
        if (zeros >= SHORTEST_RUN) {
            out += snprintf(out, size - (size_t)(out - *packed), "z%zu.", zeros);
            text += zeros;
        } else {
            *out++ = *text++;
        }
    }
    *out = '\0';
    return SHEAR_OK;
}

/* "zN." at *at, which moves behind it; 0 where it is none. */
static size_t read_run(const char **at) {
    char *end = NULL;
    const unsigned long zeros = strtoul(*at + 1, &end, 10);
    if (*end != '.' || zeros > STORE_SUMS_MAX) {
        return 0;
    }
    *at = end + 1;
    return zeros;
}

static bool unpack(const char *packed, char *out, size_t room) {
    while (*packed != '\0') {
        const bool run = *packed == 'z';
        const size_t n = run ? read_run(&packed) : 1;
        if (n == 0 || n > room) {
            return false;
        }
        memset(out, run ? '0' : *packed, n);
        packed += run ? 0 : 1;
        out += n;
        room -= n;
    }
    *out = '\0';
    return true;
}

int sums_unpack(const char *packed, char **text, shear_error *err) {
    const size_t head = sizeof mark - 1;
    if (strncmp(packed, mark, head) != 0) {
        *text = strdup(packed);
        return *text != NULL ? SHEAR_OK : no_memory(err);
    }
    char *out = malloc(STORE_SUMS_MAX + 1);
    *text = NULL;
    if (out == NULL) {
        return no_memory(err);
    }
    if (!unpack(packed + head, out, STORE_SUMS_MAX)) {
        free(out);
        return shear_fail(err, SHEAR_E_FORMAT, "restore the database from a copy",
                          "the database holds sums that cannot be read");
    }
    char *shrunk = realloc(out, strlen(out) + 1);
    *text = shrunk != NULL ? shrunk : out;
    return SHEAR_OK;
}
