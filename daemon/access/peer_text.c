/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Convert a peer's groups to text and back. */
#include "access/access.h"
#include "base/buffer.h"

#include <errno.h>
#include <inttypes.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int access_peer_groups_text(const access_peer *peer, char **text, shear_error *err) {
    buffer list = {0};
    for (size_t i = 0; i < peer->n_groups; i++) {
        char one[16];
        snprintf(one, sizeof one, "%s%" PRIu32, i > 0 ? " " : "", (uint32_t)peer->groups[i]);
        buffer_add_text(&list, one);
    }
    *text = buffer_take(&list, NULL);
    return *text != NULL
               ? SHEAR_OK
               : shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a list of groups");
}

static int bad_text(access_peer *peer, const char *groups, shear_error *err) {
    access_peer_deinit(peer);
    return shear_fail(err, SHEAR_E_INTERNAL, "this is a bug: please report it",
                      "\"%.80s\" is no list of groups", groups);
}

/* Read one number at *at, and advance *at beyond it and one blank. */
static bool read_group(const char **at, gid_t *group) {
    char *end = NULL;
    errno = 0;
    const unsigned long long value = strtoull(*at, &end, 10);
    const bool good = **at >= '0' && **at <= '9' && errno == 0 && value <= UINT32_MAX &&
                      (*end == '\0' || (*end == ' ' && end[1] != '\0'));
    *group = (gid_t)value;
    *at = good && *end == ' ' ? end + 1 : end;
    return good;
}

int access_peer_from_text(uid_t uid, gid_t gid, const char *groups, access_peer *peer,
                          shear_error *err) {
    *peer = (access_peer){uid, gid, NULL, 0};
    peer->groups = calloc(strlen(groups) / 2 + 1, sizeof *peer->groups);
    if (peer->groups == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a list of groups");
    for (const char *at = groups; *at != '\0';) {
        if (!read_group(&at, &peer->groups[peer->n_groups]))
            return bad_text(peer, groups, err);
        peer->n_groups++;
    }
    return SHEAR_OK;
}
