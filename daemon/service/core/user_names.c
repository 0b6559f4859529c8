/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/core/user_names.h"

#include "base/text.h"

#include <pwd.h>
#include <stdio.h>
#include <string.h>

enum { FRESH_MS = 60000 };

void user_names_write(uid_t uid, char *out, size_t size) {
    const struct passwd *entry = getpwuid(uid);
    if (entry != NULL) {
        snprintf(out, size, "%s", entry->pw_name);
    } else {
        snprintf(out, size, "%lu", (unsigned long)uid);
    }
}

const char *user_names_get(user_names *all, uid_t uid, int64_t now_ms) {
    known_user *u = &all->known[uid % KNOWN_USERS];
    if (u->until_ms <= now_ms || u->uid != uid) {
        const struct passwd *entry = getpwuid(uid);
        const bool fits = entry != NULL && strlen(entry->pw_name) < sizeof u->name;
        *u = (known_user){.until_ms = now_ms + FRESH_MS, .uid = uid};
        text_set(u->name, sizeof u->name, fits ? entry->pw_name : NULL);
    }
    return u->name[0] != '\0' ? u->name : NULL;
}
