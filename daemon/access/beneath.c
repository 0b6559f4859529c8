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

/* LINKS_MAX is the kernel's; the others keep a path from taking the daemon's descriptors and time.
 */
enum { LINKS_MAX = 40, DEPTH_MAX = 100, STEPS_MAX = 4096 };

typedef struct way {
    const access_peer *peer;
    int at[DEPTH_MAX + 1]; /* the directories from the root (not ours) to where we are: ".." goes
                              back to the one that we came from, even if that was moved meanwhile */
    int depth;
    int links, steps;
    char text[2 * PATH_MAX];
    const char *rest; /* in text: what is left to go, of links' texts and then of the path */
    size_t own;       /* bytes at its end that are of the path itself */
    char link;
} way;

/* The next name into `name`, and whether anything follows it, which makes it a directory's. False:
 * there is none. */
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

/* Put the link's text before what is left. 0 or -errno. */
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

/* A link comes as itself. What must be a directory is opened as one, for that mounts it where it is
 * to be mounted when it is first used. */
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

/* A descriptor that is no link and the last name is what was looked for; any other must be a
 * directory, which is gone down into. 0 or -errno; then the descriptor is not in use. */
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

/* Where the name leads: down, or along a link's text; *found is the last name's descriptor. 0 or
 * -errno. */
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
        fd = -1; /* it is the way's, or the caller's */
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
    if (error == 0 && found < 0) { /* a directory that we are in */
        found = fcntl(w.at[w.depth], F_DUPFD_CLOEXEC, 0);
        error = found < 0 ? -errno : 0;
    }
    while (w.depth > 0)
        close(w.at[w.depth--]);
    *link = w.link;
    return error == 0 ? found : error;
}
