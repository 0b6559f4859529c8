/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Open and close the spool, and do its work when the timer or inotify wakes it. */
#include "spool/spool.h"

#include "base/cleanup.h"
#include "base/clock.h"
#include "spool/acquire.h"
#include "spool/incoming.h"
#include "spool/internal.h"
#include "spool/report.h"
#include "spool/undo_log.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static int64_t wall_clock_ms(void *nothing) {
    (void)nothing;
    return clock_ms(CLOCK_REALTIME);
}

/* ---- reporting files to the owner ---- */

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

/* Report some of the files in active/ to the owner. Return true if there are more. */
static bool announce_files(spool *s) {
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

/* ---- work ---- */

static void on_timer(uv_timer_t *timer);

static void sleep_until_next(spool *s, bool more) {
    const int64_t acquire_ms = acquire_next_ms(s);
    const int64_t next_ms = acquire_ms < s->scan.next_ms ? acquire_ms : s->scan.next_ms;
    const int64_t left_ms = next_ms - clock_ms(CLOCK_MONOTONIC);
    /* The loop's time does not advance during an iteration; without this the timer would expire
     * early. A timeout of 0 would expire in this iteration again and again, and block everything
     * else. */
    uv_update_time(s->loop);
    uv_timer_start(&s->timer, on_timer, more || left_ms <= 0 ? 1 : (uint64_t)left_ms + 1, 0);
}

static void work(spool *s) {
    bool more = false;
    if (s->scan.dir == NULL && s->scan.next_ms <= clock_ms(CLOCK_MONOTONIC)) {
        unacknowledged_retry(&s->unacknowledged);
        if (incoming_begin_scan(s))
            retention_begin(&s->retention);
    }
    more |= incoming_scan(s);
    more |= acquire_settled(s);
    more |= announce_files(s);
    if (!s->closed)
        more |= acquire_ready(s);
    if (!s->closed)
        more |= announce_files(s);
    if (!s->closed) {
        more |= retention_step(s);
        sleep_until_next(s, more);
    }
}

static void on_timer(uv_timer_t *timer) {
    work(timer->data);
}

static void free_when_closed(spool *s) {
    if (s->handles == 0)
        free(s);
}

static void on_closed(uv_handle_t *handle) {
    spool *s = handle->data;
    s->handles--;
    free_when_closed(s);
}

/* Close the handle first: its descriptor's number may be reused afterwards. */
static void stop_watch(spool *s) {
    if (s->polling)
        uv_close((uv_handle_t *)&s->poll, on_closed);
    s->polling = false;
    watch_deinit(&s->watch);
    s->stats.watching = false;
}

static void on_readable(uv_poll_t *poll, int status, int events) {
    spool *s = poll->data;
    (void)events;
    const int error = status < 0 ? -status : watch_read(&s->watch, incoming_event, s);
    if (error != 0) {
        report_line(s, SPOOL_ERROR,
                    "%s/incoming: events cannot be read, scans alone find files: %s",
                    s->folders.path, strerror(error));
        stop_watch(s);
    }
    work(s);
}

void spool_wake(spool *s) {
    unacknowledged_retry(&s->unacknowledged);
    uv_timer_start(&s->timer, on_timer, 0, 0);
}

void spool_tune(spool *s, const spool_tuning *tuning) {
    s->tuning = *tuning;
    const int64_t latest_ms = clock_ms(CLOCK_MONOTONIC) + tuning->scan_ms;
    s->scan.next_ms = s->scan.next_ms < latest_ms ? s->scan.next_ms : latest_ms;
    uv_timer_start(&s->timer, on_timer, 0, 0);
}

/* ---- opening and closing ---- */

CLEANUP_DEFINE(spool, spool_close)

static int no_memory(shear_error *err) {
    return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for the spool");
}

static int list_one(spool *s, const char *active_name, shear_error *err) {
    if (active_name[0] == '.')
        return SHEAR_OK;
    if (name_of_active(active_name) == NULL) {
        char name[NAME_SIZE];
        name_printable(name, active_name);
        report_line(s, SPOOL_WARNING, "active/%s: ignored: it was not put there by this service",
                    name);
        return SHEAR_OK;
    }
    if (!unacknowledged_add(&s->unacknowledged, active_name, true, false))
        return no_memory(err);
    s->stats.active++;
    return SHEAR_OK;
}

/* List what the last owner had acquired. */
static int list_active(spool *s, shear_error *err) {
    CLEANUP(folder_list_close) DIR *dir = folder_list(&s->folders, ACTIVE);
    if (dir == NULL) {
        return shear_fail(err, SHEAR_E_IO, NULL, "%s/active: cannot be read: %s", s->folders.path,
                          strerror(errno));
    }
    for (const struct dirent *entry = readdir(dir); entry != NULL; entry = readdir(dir))
        TRY(list_one(s, entry->d_name, err));
    return SHEAR_OK;
}

/* Watch incoming/. Return 0 or errno. */
static int watch_incoming(spool *s) {
    TRY(watch_init(&s->watch));
    TRY(watch_start(&s->watch, s->folders.fd[INCOMING], s->folders.root));
    TRY(-uv_poll_init(s->loop, &s->poll, s->watch.fd));
    s->polling = true;
    s->poll.data = s;
    s->handles++;
    return -uv_poll_start(&s->poll, UV_READABLE, on_readable);
}

/* Watch incoming/ if possible: without it files are only found later. */
static void start_watch(spool *s) {
    const int error = watch_incoming(s);
    s->stats.watching = error == 0;
    if (error != 0) {
        report_line(s, SPOOL_WARNING,
                    "%s/incoming: cannot be watched, scans alone find files: %s%s", s->folders.path,
                    strerror(error),
                    error == EMFILE || error == ENOSPC
                        ? "; raise fs.inotify.max_user_instances and max_user_watches"
                        : "");
        stop_watch(s);
    }
}

void spool_close(spool *s) {
    if (s == NULL)
        return;
    s->closed = true;
    stop_watch(s);
    folder_list_close(&s->scan.dir);
    s->scan.dir = NULL;
    retention_deinit(&s->retention);
    unacknowledged_deinit(&s->unacknowledged);
    candidates_deinit(&s->candidates);
    folders_close(&s->folders);
    if (s->started)
        uv_close((uv_handle_t *)&s->timer, on_closed);
    free_when_closed(s);
}

static int start(spool *s, shear_error *err) {
    TRY(undo_log_recover(&s->folders, err));
    TRY(list_active(s, err));
    uv_timer_init(s->loop, &s->timer); /* never fails */
    s->timer.data = s;
    s->handles = 1;
    s->started = true;
    start_watch(s);
    s->scan.next_ms = clock_ms(CLOCK_MONOTONIC);
    uv_timer_start(&s->timer, on_timer, 0, 0);
    return SHEAR_OK;
}

int spool_open(spool **out, uv_loop_t *loop, const char *directory, const spool_tuning *tuning,
               const spool_callbacks *callbacks, shear_error *err) {
    *out = NULL;
    CLEANUP(spool_release) spool *s = calloc(1, sizeof *s);
    if (s == NULL)
        return no_memory(err);
    s->loop = loop;
    s->tuning = *tuning;
    s->call = *callbacks;
    s->call.now_ms = callbacks->now_ms != NULL ? callbacks->now_ms : wall_clock_ms;
    s->watch = (watch){-1, -1, -1};
    candidates_init(&s->candidates);
    unacknowledged_init(&s->unacknowledged);
    retention_init(&s->retention);
    TRY(folders_open(&s->folders, directory, err));
    TRY(start(s, err));
    *out = CLEANUP_TAKE(s);
    return SHEAR_OK;
}

/* ---- single files, statistics ---- */

int spool_refuse(spool *s, const char *active_name, shear_error *err) {
    if (!unacknowledged_add(&s->unacknowledged, active_name, true, true))
        return no_memory(err);
    return SHEAR_OK;
}

int spool_open_file(const spool *s, const char *active_name, int *out, shear_error *err) {
    const char *name = name_of_active(active_name);
    struct stat st;
    *out = -1;
    if (name == NULL)
        return name_fail_active(active_name, err);
    /* Do not wait for the other end if it is a pipe. */
    const int fd = openat(s->folders.fd[ACTIVE], active_name,
                          O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
    if (fd >= 0 && fstat(fd, &st) == 0 && S_ISREG(st.st_mode)) {
        *out = fd;
        return SHEAR_OK;
    }
    const int error = fd >= 0 || errno == ELOOP || errno == ENXIO ? EINVAL : errno;
    release_fd(&fd);
    const int code = error == EINVAL                     ? SPOOL_NOT_REGULAR
                     : error == ENOENT                   ? SPOOL_GONE
                     : error == EACCES || error == EPERM ? SPOOL_DENIED
                                                         : SHEAR_E_IO;
    return shear_fail(err, code,
                      code == SPOOL_DENIED ? "let the service's group read what is put into "
                                             "incoming/ (chmod g+r)"
                                           : NULL,
                      "the dropped file '%s' cannot be opened: %s", name,
                      code == SPOOL_NOT_REGULAR ? "it is no regular file" : strerror(error));
}

spool_stats spool_get_stats(const spool *s) {
    spool_stats stats = s->stats;
    const size_t *counts = s->candidates.counts;
    stats.waiting =
        (int64_t)(counts[CANDIDATE_SETTLING] + counts[CANDIDATE_BEGUN] + counts[CANDIDATE_READY]);
    stats.ignored = (int64_t)counts[CANDIDATE_IGNORED];
    /* The trouble is over if the files that could not be acquired have been removed. */
    if (s->away || stats.waiting > 0) {
        snprintf(stats.trouble, sizeof stats.trouble, "%s", s->trouble);
        stats.trouble_since_ms = s->trouble_since_ms;
    }
    return stats;
}
