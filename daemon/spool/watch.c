/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "watch.h"

#include <errno.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <sys/inotify.h>
#include <unistd.h>

static const uint32_t wanted = IN_CLOSE_WRITE | IN_MOVED_TO | IN_CREATE | IN_DELETE |
                               IN_MOVED_FROM | IN_DELETE_SELF | IN_MOVE_SELF | IN_ONLYDIR;

int watch_init(watch *w) {
    *w = (watch){inotify_init1(IN_NONBLOCK | IN_CLOEXEC), -1};
    return w->fd >= 0 ? 0 : errno;
}

void watch_deinit(watch *w) {
    if (w->fd >= 0) {
        close(w->fd);
    }
    *w = (watch){-1, -1};
}

static void forget(watch *w) {
    if (w->id >= 0) {
        inotify_rm_watch(w->fd, w->id);
    }
    w->id = -1;
}

int watch_start(watch *w, int directory) {
    char path[32];
    if (w->fd < 0) {
        return EBADF;
    }
    forget(w);
    /* By descriptor: the name may already stand for another directory. */
    snprintf(path, sizeof path, "/proc/self/fd/%d", directory);
    w->id = inotify_add_watch(w->fd, path, wanted);
    return w->id >= 0 ? 0 : errno;
}

static int meaning(uint32_t mask) {
    if ((mask & IN_Q_OVERFLOW) != 0) {
        return WATCH_OVERFLOW;
    }
    if ((mask & (IN_DELETE_SELF | IN_MOVE_SELF | IN_UNMOUNT | IN_IGNORED)) != 0) {
        return WATCH_LOST;
    }
    if ((mask & (IN_CLOSE_WRITE | IN_MOVED_TO)) != 0) {
        return WATCH_COMPLETE;
    }
    return (mask & IN_CREATE) != 0 ? WATCH_BEGUN : WATCH_GONE;
}

static void dispatch(watch *w, const struct inotify_event *event,
                     void (*handle)(void *, int, const char *), void *context) {
    const int kind = meaning(event->mask);
    if (kind == WATCH_OVERFLOW) {
        handle(context, kind, NULL);
    } else if (event->wd != w->id) {
        return; /* of a directory that is no longer watched */
    } else if (kind == WATCH_LOST) {
        forget(w);
        handle(context, kind, NULL);
    } else if (event->len > 0) {
        handle(context, kind, event->name);
    }
}

int watch_read(watch *w, void (*handle)(void *, int, const char *), void *context) {
    _Alignas(struct inotify_event) char buffer[16384];
    for (;;) {
        const ssize_t n = read(w->fd, buffer, sizeof buffer);
        if (n < 0 && errno == EINTR) {
            continue;
        }
        if (n <= 0) {
            return n == 0 || errno == EAGAIN ? 0 : errno;
        }
        for (ssize_t at = 0; at < n;) {
            const struct inotify_event *event = (const void *)(buffer + at);
            dispatch(w, event, handle, context);
            at += (ssize_t)(sizeof *event + event->len);
        }
    }
}
