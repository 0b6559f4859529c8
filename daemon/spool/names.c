/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "spool/names.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <sys/random.h>
#include <time.h>

static bool ends_with(const char *name, const char *suffix) {
    const size_t n = strlen(name);
    const size_t m = strlen(suffix);
    return n > m && strcasecmp(name + n - m, suffix) == 0;
}

/* The extension, in upper or lower case, or NULL where the name has none that is taken. */
static const char *extension_of(const char *name) {
    static const char *const taken[] = {".fits",    ".fit",    ".fits.gz", ".fit.gz",
                                        ".fits.fz", ".fit.fz", ".fz",      ".json"};
    for (size_t i = 0; i < sizeof taken / sizeof taken[0]; i++) {
        if (ends_with(name, taken[i])) {
            return name + strlen(name) - strlen(taken[i]);
        }
    }
    return NULL;
}

/* The code point at *p, which moves on; -1 where it is not well formed (Unicode, table 3-7). */
static int32_t next_code_point(const unsigned char **p) {
    static const int32_t least[] = {0, 0x80, 0x800, 0x10000};
    const unsigned char first = *(*p)++;
    const int more = first < 0x80 ? 0 : first < 0xc2 ? -1 : first < 0xe0 ? 1 : first < 0xf0 ? 2 : 3;
    if (more < 0 || first > 0xf4) {
        return -1;
    }
    int32_t point = more == 0 ? first : first & (0x3f >> more);
    for (int i = 0; i < more; i++) {
        if ((**p & 0xc0) != 0x80) {
            return -1;
        }
        point = (point << 6) | (*(*p)++ & 0x3f);
    }
    const bool surrogate = point >= 0xd800 && point <= 0xdfff;
    return point < least[more] || surrogate || point > 0x10ffff ? -1 : point;
}

static int judge_characters(const char *name) {
    const unsigned char *p = (const unsigned char *)name;
    while (*p != '\0') {
        const int32_t point = next_code_point(&p);
        if (point < 0) {
            return NAME_NOT_UTF8;
        }
        if (point < 0x20 || (point >= 0x7f && point < 0xa0)) {
            return NAME_CONTROL;
        }
    }
    return NAME_GOOD;
}

int name_judge(const char *name) {
    if (name[0] == '.' || ends_with(name, ".tmp") || ends_with(name, ".part")) {
        return NAME_QUIET;
    }
    const int verdict = judge_characters(name);
    if (verdict != NAME_GOOD) {
        return verdict;
    }
    if (strchr(name, '/') != NULL || extension_of(name) == NULL) {
        return NAME_SUFFIX;
    }
    return strlen(name) > NAME_GOOD_MAX ? NAME_LONG : NAME_GOOD;
}

const char *name_complaint(int verdict) {
    static const char *const texts[NAME_N_VERDICTS] = {
        [NAME_SUFFIX] = "ends neither in .fits, .fit, .fits.gz, .fit.gz, .fz nor .json",
        [NAME_CONTROL] = "has control characters",
        [NAME_NOT_UTF8] = "is not UTF-8",
        [NAME_LONG] = "is too long",
    };
    return verdict >= 0 && verdict < NAME_N_VERDICTS && texts[verdict] != NULL ? texts[verdict]
                                                                               : "";
}

void name_printable(char out[NAME_SIZE], const char *name) {
    size_t i = 0;
    for (; name[i] != '\0' && i < NAME_SIZE - 1; i++) {
        out[i] = '?';
        if (name[i] >= 0x20 && name[i] < 0x7f) {
            out[i] = name[i];
        }
    }
    out[i] = '\0';
}

int name_make_active(char out[NAME_SIZE], const char *name, uint64_t counter) {
    uint64_t chance = 0;
    struct timespec now;
    if (strlen(name) > NAME_GOOD_MAX) {
        return ENAMETOOLONG;
    }
    if (getrandom(&chance, sizeof chance, 0) != (ssize_t)sizeof chance ||
        clock_gettime(CLOCK_REALTIME, &now) != 0) {
        return errno;
    }
    const uint64_t us = (uint64_t)now.tv_sec * 1000000 + (uint64_t)now.tv_nsec / 1000;
    snprintf(out, NAME_SIZE, "%014" PRIx64 "%04x%016" PRIx64 "-%s", us & 0xffffffffffffff,
             (unsigned)(counter & 0xffff), chance, name);
    return 0;
}

const char *name_of_active(const char *active_name) {
    const size_t n = strspn(active_name, "0123456789abcdef");
    if (n != SPOOL_KEY_SIZE - 1 || active_name[n] != '-') {
        return NULL;
    }
    return name_judge(active_name + n + 1) == NAME_GOOD ? active_name + n + 1 : NULL;
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
