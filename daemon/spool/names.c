/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "spool/names.h"

#include "base/clock.h"
#include "base/text.h"
#include "base/utf8.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <sys/random.h>

/* Return the extension, in upper or lower case, or NULL if it is not one that the spool accepts. */
static const char *extension_of(const char *name) {
    static const char *const taken[] = {".fits",    ".fit",    ".fits.gz", ".fit.gz",
                                        ".fits.fz", ".fit.fz", ".fz",      ".json"};
    for (size_t i = 0; i < sizeof taken / sizeof taken[0]; i++) {
        if (text_ends_with(name, taken[i]))
            return name + strlen(name) - strlen(taken[i]);
    }
    return NULL;
}

static enum name_status validate_characters(const char *name) {
    while (*name != '\0') {
        uint32_t point = 0;
        const size_t bytes = utf8_decode(name, &point);
        if (bytes == 0)
            return NAME_NOT_UTF8;
        if (point < 0x20 || (point >= 0x7f && point < 0xa0))
            return NAME_CONTROL;
        name += bytes;
    }
    return NAME_GOOD;
}

enum name_status name_validate(const char *name) {
    if (name[0] == '.' || text_ends_with(name, ".tmp") || text_ends_with(name, ".part"))
        return NAME_QUIET;
    const enum name_status status = validate_characters(name);
    if (status != NAME_GOOD)
        return status;
    if (strchr(name, '/') != NULL || extension_of(name) == NULL)
        return NAME_SUFFIX;
    return strlen(name) > NAME_GOOD_MAX ? NAME_LONG : NAME_GOOD;
}

void name_printable(char out[NAME_SIZE], const char *name) {
    size_t i = 0;
    for (; name[i] != '\0' && i < NAME_SIZE - 1; i++) {
        out[i] = '?';
        if (name[i] >= 0x20 && name[i] < 0x7f)
            out[i] = name[i];
    }
    out[i] = '\0';
}

int name_make_active(char out[NAME_SIZE], const char *name, uint64_t counter) {
    uint64_t chance = 0;
    if (strlen(name) > NAME_GOOD_MAX)
        return ENAMETOOLONG;
    if (getrandom(&chance, sizeof chance, 0) != (ssize_t)sizeof chance)
        return errno;
    const uint64_t us = (uint64_t)clock_us(CLOCK_REALTIME);
    snprintf(out, NAME_SIZE, "%014" PRIx64 "%04x%016" PRIx64 "-%s", us & 0xffffffffffffff,
             (unsigned)(counter & 0xffff), chance, name);
    return 0;
}

const char *name_of_active(const char *active_name) {
    const size_t n = strspn(active_name, "0123456789abcdef");
    if (n != SPOOL_KEY_SIZE - 1 || active_name[n] != '-')
        return NULL;
    return name_validate(active_name + n + 1) == NAME_GOOD ? active_name + n + 1 : NULL;
}

int name_fail_active(const char *active_name, shear_error *err) {
    return shear_fail(err, SHEAR_E_INTERNAL, NULL, "'%.255s' is no name of the spool's",
                      active_name);
}

void name_key(char key[SPOOL_KEY_SIZE], const char *active_name) {
    memcpy(key, active_name, SPOOL_KEY_SIZE - 1);
    key[SPOOL_KEY_SIZE - 1] = '\0';
}

void name_number(char out[NAME_SIZE], const char *name, int64_t n) {
    const char *extension = extension_of(name);
    if (n == 0 || extension == NULL) {
        snprintf(out, NAME_SIZE, "%s", name);
    } else {
        snprintf(out, NAME_SIZE, "%.*s.%" PRId64 "%s", (int)(extension - name), name, n, extension);
    }
}

void name_report(char out[NAME_REPORT_SIZE], const char *name) {
    snprintf(out, NAME_REPORT_SIZE, "%s.json", name);
}
