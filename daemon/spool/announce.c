/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "spool/announce.h"

#include "base/cleanup.h"
#include "spool/internal.h"
#include "spool/report.h"

#include <errno.h>
#include <string.h>

static void announce(spool *s, const char *active_name, bool again) {
    char key[SPOOL_KEY_SIZE];
    struct stat st;
    const int error = folder_stat(&s->folders, ACTIVE, active_name, &st);
    if (error == ENOENT) {
        report_line(s, SPOOL_WARNING, "active/%s: vanished before it was looked at", active_name);
        s->stats.active--;
        return;
    }
    name_key(key, active_name);
    s->call.found(s->call.context, &(spool_file){active_name, key, name_of_active(active_name),
                                                 error == 0 ? st.st_uid : (uid_t)-1, again});
}

/* Bring what is reported to disk, in this order: the new name, then the removal of the old one. */
static bool sync_moves(spool *s) {
    int error = folder_sync(&s->folders, ACTIVE);
    error = error != 0 ? error : folder_sync(&s->folders, INCOMING);
    if (error != 0) {
        report_line(s, SPOOL_ERROR, "%s: cannot be brought to disk, tried again later: %s",
                    s->folders.path, strerror(error));
    }
    s->unacknowledged.unsynced = error != 0;
    return error == 0;
}

bool announce_files(spool *s) {
    unacknowledged *list = &s->unacknowledged;
    if (!unacknowledged_pending(list) || (list->unsynced && !sync_moves(s)))
        return false;
    for (int i = 0; i < SPOOL_STEP_FILES && !s->closed && unacknowledged_pending(list); i++) {
        /* Remove it from the list first: the owner may refuse or dispose of it at once. */
        CLEANUP(release_free) unacknowledged_file *one = unacknowledged_next(list);
        announce(s, one->active_name, one->again);
    }
    return !s->closed && unacknowledged_pending(list);
}
