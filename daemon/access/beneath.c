/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "access/beneath.h"

#include "access/permission.h"
#include "base/cleanup.h"

#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* LINKS_MAX is the kernel's. The other limits keep a path from using up the daemon's descriptors
 * and time. */
enum { LINKS_MAX = 40, DEPTH_MAX = 100, STEPS_MAX = 4096 };

typedef struct way {
    const access_peer *peer;
    /* Descriptors from the root (the caller's) to the current directory. ".." returns to the one
     * before, even if the directory has been moved meanwhile. */
    int at[DEPTH_MAX + 1];
    int depth;
    int links, steps;
    char text[2 * PATH_MAX];
    const char *rest; /* within text: the rest to resolve, of links' texts and then the path */
    size_t own;       /* bytes at the end of the rest that belong to the path itself */
    char link;
} way;

/* Copy the next component into `name`. *followed: something follows it, so it must be a directory.
 * Return false if there is none. */
static bool next_name(way *w, char *name, size_t size, bool *followed) {
    w->rest += strspn(w->rest, "/");
    if (w->rest[0] != '\0' && strlen(w->rest) <= w->own)
        w->link = '\0';
    const size_t n = strcspn(w->rest, "/");
    snprintf(name, size, "%.*s", (int)n, w->rest);
    w->rest += n;
    *followed = w->rest[0] != '\0';
    return n > 0;
}

/* Put the link's text before the rest. Return 0 or -errno. */
static int follow(way *w, int link) {
    char text[PATH_MAX];
    const size_t left = strlen(w->rest);
    const ssize_t got = readlinkat(link, "", text, sizeof text);
    if (got <= 0)
        return got < 0 ? -errno : -ENOENT;
    const size_t n = (size_t)got;
    if (w->link == '\0') {
        w->link = text[0];
        w->own = left;
    }
    if (text[0] == '/')
        return -EXDEV;
    if (++w->links > LINKS_MAX)
        return -ELOOP;
    if (n == sizeof text || n + left >= sizeof w->text)
        return -ENAMETOOLONG;
    memmove(w->text + n, w->rest, left + 1);
    memcpy(w->text, text, n);
    w->rest = w->text;
    return 0;
}

/* Open a component; a link is opened itself. A component that must be a directory is opened as one,
 * because that triggers an automount. */
static int open_name(const way *w, const char *name, bool directory) {
    enum { FLAGS = O_PATH | O_NOFOLLOW | O_CLOEXEC };
    struct stat st;
    const int error = permission_check(w->at[w->depth], w->peer, PERMIT_SEARCH, &st);
    if (error != 0)
        return -error;
    int fd = directory ? openat(w->at[w->depth], name, FLAGS | O_DIRECTORY) : -1;
    if (!directory || (fd < 0 && errno == ENOTDIR))
        fd = openat(w->at[w->depth], name, FLAGS);
    return fd >= 0 ? fd : errno == EACCES ? -EPERM : -errno;
}

/* Use a descriptor that is not a link: it is the result if its component is the last; otherwise it
 * must be a directory, and becomes the current one. Return 0, or -errno: the descriptor is not used
 * then. */
static int go_down(way *w, int fd, const struct stat *st, bool followed, int *found) {
    if (!followed) {
        *found = fd;
        return 0;
    }
    if (!S_ISDIR(st->st_mode))
        return -ENOTDIR;
    if (w->depth == DEPTH_MAX)
        return -ENAMETOOLONG;
    w->at[++w->depth] = fd;
    return 0;
}

/* Resolve a component: enter the directory or follow the link; *found becomes the descriptor of the
 * last one. Return 0 or -errno. */
static int enter(way *w, const char *name, bool followed, int *found) {
    struct stat st;
    CLEANUP(release_fd) int fd = open_name(w, name, followed);
    if (fd < 0)
        return fd;
    if (fstat(fd, &st) != 0)
        return -errno;
    if (S_ISLNK(st.st_mode))
        return follow(w, fd);
    const int error = go_down(w, fd, &st, followed, found);
    if (error == 0) {
        fd = -1; /* it belongs to the way or to the caller now */
    }
    return error;
}

static int step(way *w, const char *name, bool followed, int *found) {
    if (++w->steps > STEPS_MAX)
        return -ELOOP;
    if (strcmp(name, ".") == 0)
        return 0;
    if (strcmp(name, "..") != 0)
        return enter(w, name, followed, found);
    if (w->depth == 0)
        return -EXDEV;
    assert(w->depth > 0 && w->depth <= DEPTH_MAX);
    close(w->at[w->depth--]);
    return 0;
}

int beneath_open(int root, const char *path, const access_peer *peer, char *link) {
    char name[PATH_MAX];
    bool followed = false;
    int found = -1;
    int error = 0;
    way w = {.peer = peer, .at = {root}, .own = strlen(path)};
    w.rest = w.text;
    *link = '\0';
    if (w.own >= PATH_MAX)
        return -ENAMETOOLONG;
    memcpy(w.text, path, w.own + 1);
    while (error == 0 && found < 0 && next_name(&w, name, sizeof name, &followed))
        error = step(&w, name, followed, &found);
    if (error == 0 && found < 0) { /* the path ends at a directory that is already open */
        found = fcntl(w.at[w.depth], F_DUPFD_CLOEXEC, 0);
        error = found < 0 ? -errno : 0;
    }
    while (w.depth > 0)
        close(w.at[w.depth--]);
    *link = w.link;
    return error == 0 ? found : error;
}
