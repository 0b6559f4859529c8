/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "access/permission.h"

#include <endian.h>
#include <errno.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/xattr.h>

/* The kernel's format of a POSIX access control list (linux/posix_acl_xattr.h), little-endian. */
enum {
    ACL_VERSION = 2,
    ACL_USER_OBJ = 0x01,
    ACL_USER = 0x02,
    ACL_GROUP_OBJ = 0x04,
    ACL_GROUP = 0x08,
    ACL_MASK = 0x10,
    ACL_OTHER = 0x20
};
typedef struct acl_entry {
    uint16_t tag, bits;
    uint32_t id;
} acl_entry;

/* The permission bits that the list gives, by class. -1: no such entry. */
typedef struct acl_view {
    int owner, user, mask, other;
    bool in_group;    /* there is an entry for a group of the peer's */
    bool group_gives; /* one of these gives all that is wanted, before the mask */
} acl_view;

bool peer_has_group(const access_peer *peer, gid_t gid) {
    bool has = peer->gid == gid;
    for (size_t i = 0; i < peer->n_groups && !has; i++)
        has = peer->groups[i] == gid;
    return has;
}

static bool gives(unsigned bits, unsigned wanted) {
    return (bits & wanted) == wanted;
}

static bool mode_gives(const struct stat *st, const access_peer *peer, unsigned wanted) {
    if (st->st_uid == peer->uid)
        return gives(st->st_mode >> 6, wanted);
    return gives(peer_has_group(peer, st->st_gid) ? st->st_mode >> 3 : st->st_mode, wanted);
}

static void look_at(const acl_entry *entry, const struct stat *st, const access_peer *peer,
                    unsigned wanted, acl_view *view) {
    const unsigned bits = le16toh(entry->bits);
    const uint32_t id = le32toh(entry->id);
    const int tag = le16toh(entry->tag);
    if (tag == ACL_USER_OBJ) {
        view->owner = (int)bits;
    } else if (tag == ACL_USER && id == peer->uid) {
        view->user = (int)bits;
    } else if (tag == ACL_MASK) {
        view->mask = (int)bits;
    } else if (tag == ACL_OTHER) {
        view->other = (int)bits;
    } else if ((tag == ACL_GROUP_OBJ && peer_has_group(peer, st->st_gid)) ||
               (tag == ACL_GROUP && peer_has_group(peer, id))) {
        view->in_group = true;
        view->group_gives |= gives(bits, wanted);
    }
}

/* The access check algorithm of acl(5). */
static bool acl_gives(const acl_view *view, const struct stat *st, const access_peer *peer,
                      unsigned wanted) {
    const unsigned mask = view->mask >= 0 ? (unsigned)view->mask : 7;
    if (st->st_uid == peer->uid)
        return view->owner >= 0 && gives((unsigned)view->owner, wanted);
    if (view->user >= 0)
        return gives((unsigned)view->user & mask, wanted);
    if (view->in_group)
        return view->group_gives && gives(mask, wanted);
    return view->other >= 0 && gives((unsigned)view->other, wanted);
}

static int check_list(const char *list, size_t size, const struct stat *st, const access_peer *peer,
                      unsigned wanted) {
    acl_view view = {-1, -1, -1, -1, false, false};
    uint32_t version = 0;
    if (size < sizeof version || (size - sizeof version) % sizeof(acl_entry) != 0)
        return EACCES;
    memcpy(&version, list, sizeof version);
    if (le32toh(version) != ACL_VERSION) {
        return EACCES; /* an unknown version gives nothing */
    }
    for (size_t at = sizeof version; at < size; at += sizeof(acl_entry)) {
        acl_entry entry;
        memcpy(&entry, list + at, sizeof entry);
        look_at(&entry, st, peer, wanted, &view);
    }
    return acl_gives(&view, st, peer, wanted) ? 0 : EACCES;
}

int permission_check(int fd, const access_peer *peer, unsigned wanted, struct stat *st) {
    char path[32];
    char list[8192]; /* room for a thousand entries; a longer list is ERANGE */
    if (fstat(fd, st) != 0)
        return errno;
    if (peer->uid == 0)
        return 0;
    /* getxattr fails on an O_PATH descriptor, but not on its name in /proc. */
    snprintf(path, sizeof path, "/proc/self/fd/%d", fd);
    const ssize_t size = getxattr(path, "system.posix_acl_access", list, sizeof list);
    if (size >= 0)
        return check_list(list, (size_t)size, st, peer, wanted);
    if (errno != ENODATA && errno != ENOTSUP)
        return errno;
    return mode_gives(st, peer, wanted) ? 0 : EACCES;
}
