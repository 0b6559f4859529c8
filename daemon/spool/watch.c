/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "spool/watch.h"

#include "base/cleanup.h"
#include "spool/folders.h"

#include <errno.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/inotify.h>
#include <unistd.h>

static const uint32_t of_directory =
    IN_CLOSE_WRITE | IN_MOVED_TO | IN_CREATE | IN_DELETE | IN_MOVED_FROM | IN_ONLYDIR;

/* While a removed directory is held open, only its parent reports the removal. */
static const uint32_t of_parent = IN_DELETE | IN_MOVED_FROM | IN_ONLYDIR;

int watch_init(watch *w) {
    *w = (watch){inotify_init1(IN_NONBLOCK | IN_CLOEXEC), -1, -1};
    return w->fd >= 0 ? 0 : errno;
}

void watch_deinit(watch *w) {
    release_fd(&w->fd);
    *w = (watch){-1, -1, -1};
}

static void forget(watch *w, int *id) {
    if (*id >= 0)
        inotify_rm_watch(w->fd, *id);
    *id = -1;
}

static int add(watch *w, int directory, uint32_t wanted, int *id) {
    char path[32];
    /* By descriptor: its name may already belong to another directory. */
    snprintf(path, sizeof path, "/proc/self/fd/%d", directory);
    *id = inotify_add_watch(w->fd, path, wanted);
    return *id >= 0 ? 0 : errno;
}

int watch_start(watch *w, int directory, int parent) {
    if (w->fd < 0)
        return EBADF;
    forget(w, &w->id);
    const int error = add(w, parent, of_parent, &w->parent); /* the same number each time */
    return error == 0 ? add(w, directory, of_directory, &w->id) : error;
}

static enum watch_event meaning(uint32_t mask) {
    if ((mask & IN_Q_OVERFLOW) != 0)
        return WATCH_OVERFLOW;
    if ((mask & (IN_UNMOUNT | IN_IGNORED)) != 0)
        return WATCH_LOST;
    if ((mask & (IN_CLOSE_WRITE | IN_MOVED_TO)) != 0)
        return WATCH_COMPLETE;
    return (mask & IN_CREATE) != 0 ? WATCH_BEGUN : WATCH_GONE;
}

static void dispatch(watch *w, const struct inotify_event *event,
                     void (*handle)(void *, enum watch_event, const char *), void *context) {
    const bool named = event->len > 0;
    enum watch_event kind = meaning(event->mask);
    if (event->wd == w->parent && kind == WATCH_GONE && named &&
        strcmp(event->name, folder_name(INCOMING)) == 0) {
        kind = WATCH_LOST;
    } else if (kind != WATCH_OVERFLOW && event->wd != w->id) {
        return; /* another name in the parent, or a directory that is no longer watched */
    }
    if (kind == WATCH_LOST)
        forget(w, &w->id);
    if (kind == WATCH_OVERFLOW || kind == WATCH_LOST) {
        handle(context, kind, NULL);
    } else if (named) {
        handle(context, kind, event->name);
    }
}

int watch_read(watch *w, void (*handle)(void *, enum watch_event, const char *), void *context) {
    _Alignas(struct inotify_event) char buffer[16384];
    for (;;) {
        const ssize_t n = read(w->fd, buffer, sizeof buffer);
        if (n < 0 && errno == EINTR)
            continue;
        if (n <= 0)
            return n == 0 || errno == EAGAIN ? 0 : errno;
        for (ssize_t at = 0; at < n;) {
            const struct inotify_event *event = (const void *)(buffer + at);
            dispatch(w, event, handle, context);
            at += (ssize_t)(sizeof *event + event->len);
        }
    }
}
