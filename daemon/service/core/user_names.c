/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Names of users: asking the user database may take long, and jobs are told by the thousand. */
#include "service/inner.h"

#include <pwd.h>
#include <string.h>

enum { FRESH_MS = 60000 };

const char *user_name(service *s, uid_t uid) {
    known_user *u = &s->known_users[uid % KNOWN_USERS];
    const int64_t now = (int64_t)uv_now(&s->loop);
    if (u->until_ms <= now || u->uid != uid) {
        const struct passwd *entry = getpwuid(uid);
        const bool fits = entry != NULL && strlen(entry->pw_name) < sizeof u->name;
        *u = (known_user){.until_ms = now + FRESH_MS, .uid = uid};
        snprintf(u->name, sizeof u->name, "%s", fits ? entry->pw_name : "");
    }
    return u->name[0] != '\0' ? u->name : NULL;
}
