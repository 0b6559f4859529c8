/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "store/sums_text.h"

#include "base/cleanup.h"
#include "store/query.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int sums_parse_given(shear_field_sums **sums, const char *text, shear_error *err) {
    const text_rule rule = {"sums", text, STORE_SUMS_MAX, false};
    *sums = NULL;
    TRY(query_check_texts(&rule, 1, err));
    int code = shear_field_sums_parse(sums, text, err);
    return code == SHEAR_E_FORMAT
               ? shear_fail(err, SHEAR_E_INTERNAL, "this is a bug: please report it",
                            "sums were given that cannot be read: '%.40s'", text)
               : code;
}

/* Marks at the beginning of a packed text: unchanged, or with each long run of n zeros as "zN.". */
static const char plain[] = "t:";
static const char counted[] = "z:";
enum { MARK = 2 };
enum { SHORTEST_RUN = 6 }; /* shorter ones would save nothing */

static int no_memory(shear_error *err) {
    return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a field's sums");
}

/* A run's count needs no more bytes than the zeros did. */
static void count_zeros(const char *text, char *out, size_t size) {
    while (*text != '\0') {
        const size_t zeros = strspn(text, "0");
        if (zeros >= SHORTEST_RUN) {
            const size_t n = (size_t)snprintf(out, size, "z%zu.", zeros);
            text += zeros;
            out += n;
            size -= n;
        } else {
            *out++ = *text++;
            size--;
        }
    }
    *out = '\0';
}

int sums_pack(const char *text, char **packed, shear_error *err) {
    const size_t size = strlen(text) + 1;
    const bool has_marks = strchr(text, 'z') != NULL;
    *packed = malloc(MARK + size);
    if (*packed == NULL)
        return no_memory(err);
    memcpy(*packed, has_marks ? plain : counted, MARK);
    if (has_marks) {
        memcpy(*packed + MARK, text, size);
    } else {
        count_zeros(text, *packed + MARK, size);
    }
    return SHEAR_OK;
}

/* Read "zN." at *at and advance *at behind it. Return N, or 0 if it is not a run. */
static size_t read_run(const char **at) {
    char *end = NULL;
    const unsigned long zeros = strtoul(*at + 1, &end, 10);
    if (*end != '.' || zeros > STORE_SUMS_MAX)
        return 0;
    *at = end + 1;
    return zeros;
}

static bool unpack(const char *packed, char *out, size_t capacity) {
    while (*packed != '\0') {
        const bool run = *packed == 'z';
        const size_t n = run ? read_run(&packed) : 1;
        if (n == 0 || n > capacity)
            return false;
        memset(out, run ? '0' : *packed, n);
        packed += run ? 0 : 1;
        out += n;
        capacity -= n;
    }
    *out = '\0';
    return true;
}

int sums_unpack(const char *packed, char **text, shear_error *err) {
    const bool is_plain = strncmp(packed, plain, MARK) == 0;
    const bool is_counted = strncmp(packed, counted, MARK) == 0;
    char *out = is_plain ? strdup(packed + MARK) : malloc(STORE_SUMS_MAX + 1);
    *text = NULL;
    if (out == NULL)
        return no_memory(err);
    if (!is_plain && (!is_counted || !unpack(packed + MARK, out, STORE_SUMS_MAX))) {
        free(out);
        return shear_fail(err, SHEAR_E_FORMAT, "restore the database from a copy",
                          "the database holds sums that cannot be read");
    }
    char *fitted = realloc(out, strlen(out) + 1);
    *text = fitted != NULL ? fitted : out;
    return SHEAR_OK;
}

int sums_parse_packed(shear_field_sums **sums, const char *packed, shear_error *err) {
    CLEANUP(release_free) char *text = NULL;
    *sums = NULL;
    TRY(sums_unpack(packed, &text, err));
    return shear_field_sums_parse(sums, text, err);
}

int sums_format_packed(const shear_field_sums *sums, char **packed, shear_error *err) {
    CLEANUP(release_free) char *text = NULL;
    *packed = NULL;
    TRY(shear_field_sums_format(sums, &text, err));
    return sums_pack(text, packed, err);
}
