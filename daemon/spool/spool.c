/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Opening, closing, and the turn: what the spool does when the timer or inotify wakes it. */
#include "spool/internal.h"

#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

int64_t spool_clock_ms(void) {
    return (int64_t)(uv_hrtime() / 1000000);
}

void spool_log(const spool *s, int level, const char *format, ...) {
    char text[1024];
    va_list list;
    va_start(list, format);
    vsnprintf(text, sizeof text, format, list);
    va_end(list);
    s->call.log(s->call.context, level, text);
}

static int64_t wall_clock_ms(void *nothing) {
    struct timespec now;
    (void)nothing;
    clock_gettime(CLOCK_REALTIME, &now);
    return (int64_t)now.tv_sec * 1000 + now.tv_nsec / 1000000;
}

/* ---- the turn ---- */

static void on_timer(uv_timer_t *timer);

static void sleep_until_next(spool *s, bool more) {
    int64_t next_ms = s->scan.next_ms;
    if (incoming_next_ms(s) < next_ms) {
        next_ms = incoming_next_ms(s);
    }
    const int64_t left_ms = next_ms - spool_clock_ms();
    /* The loop's clock stands still during a turn: without this the timer would come early. A time
     * of 0 would come in this very turn of the loop, again and again, and nobody else would. */
    uv_update_time(s->loop);
    uv_timer_start(&s->timer, on_timer, more || left_ms <= 0 ? 1 : (uint64_t)left_ms + 1, 0);
}

static void take_turn(spool *s) {
    bool more = false;
    if (s->scan.dir == NULL && s->scan.next_ms <= spool_clock_ms()) {
        offers_revive(&s->offers);
        if (incoming_begin_scan(s)) {
            sweep_begin(&s->sweep);
        }
    }
    more |= incoming_scan(s);
    more |= incoming_settle(s);
    more |= offers_tell(s);
    if (!s->closed) {
        more |= incoming_take(s);
    }
    if (!s->closed) {
        more |= offers_tell(s);
    }
    if (!s->closed) {
        more |= sweep_step(s);
        sleep_until_next(s, more);
    }
}

static void on_timer(uv_timer_t *timer) {
    take_turn(timer->data);
}

static void free_when_closed(spool *s) {
    if (s->handles == 0) {
        free(s);
    }
}

static void on_closed(uv_handle_t *handle) {
    spool *s = handle->data;
    s->handles--;
    free_when_closed(s);
}

/* The handle first: later its descriptor's number may be somebody else's. */
static void stop_watch(spool *s) {
    if (s->polling) {
        uv_close((uv_handle_t *)&s->poll, on_closed);
    }
    s->polling = false;
    watch_deinit(&s->watch);
    s->stats.watching = false;
}

static void handle_event(void *context, int event, const char *name) {
    incoming_event(context, event, name);
}

static void on_readable(uv_poll_t *poll, int status, int events) {
    spool *s = poll->data;
    (void)events;
    const int error = status < 0 ? -status : watch_read(&s->watch, handle_event, s);
    if (error != 0) {
        spool_log(s, SPOOL_ERROR, "%s/incoming: events cannot be read, scans alone find files: %s",
                  s->folders.path, strerror(error));
        stop_watch(s);
    }
    take_turn(s);
}

void spool_wake(spool *s) {
    offers_revive(&s->offers);
    uv_timer_start(&s->timer, on_timer, 0, 0);
}

void spool_tune(spool *s, const spool_tuning *tuning) {
    s->tuning = *tuning;
    const int64_t latest_ms = spool_clock_ms() + tuning->scan_ms;
    s->scan.next_ms = s->scan.next_ms < latest_ms ? s->scan.next_ms : latest_ms;
    uv_timer_start(&s->timer, on_timer, 0, 0);
}

/* ---- opening and closing ---- */

/* What the last owner had taken. */
static int list_active(spool *s, shear_error *err) {
    int code = SHEAR_OK;
    DIR *dir = folder_list(&s->folders, ACTIVE);
    if (dir == NULL) {
        return shear_fail(err, SHEAR_E_IO, NULL, "%s/active: cannot be read: %s", s->folders.path,
                          strerror(errno));
    }
    for (const struct dirent *entry = readdir(dir); entry != NULL && code == SHEAR_OK;
         entry = readdir(dir)) {
        char name[NAME_SIZE];
        name_printable(name, entry->d_name);
        if (entry->d_name[0] == '.') {
            continue;
        }
        if (name_of_active(entry->d_name) == NULL) {
            spool_log(s, SPOOL_WARNING, "active/%s: ignored: it was not put there by this service",
                      name);
        } else if (!offers_add(&s->offers, entry->d_name, true, false)) {
            code = shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for the spool");
        } else {
            s->stats.active++;
        }
    }
    closedir(dir);
    return code;
}

/* Failures here cost speed only. */
static void start_watch(spool *s) {
    int error = watch_init(&s->watch);
    if (error == 0) {
        error = watch_start(&s->watch, s->folders.fd[INCOMING], s->folders.root);
    }
    if (error == 0) {
        error = -uv_poll_init(s->loop, &s->poll, s->watch.fd);
        s->polling = error == 0;
        s->poll.data = s;
        s->handles += s->polling;
    }
    if (error == 0) {

        error = -uv_poll_start(&s->poll, UV_READABLE, on_readable);
    }
    s->stats.watching = error == 0;
    if (error != 0) {
        spool_log(s, SPOOL_WARNING, "%s/incoming: cannot be watched, scans alone find files: %s%s",
                  s->folders.path, strerror(error),
                  error == EMFILE || error == ENOSPC
                      ? "; raise fs.inotify.max_user_instances and max_user_watches"
                      : "");
        stop_watch(s);
    }
}

void spool_close(spool *s) {
    if (s == NULL) {
        return;
    }
    s->closed = true;
    stop_watch(s);
    if (s->scan.dir != NULL) {
        closedir(s->scan.dir);
    }
    s->scan.dir = NULL;
    sweep_deinit(&s->sweep);
    offers_deinit(&s->offers);
    waiting_deinit(&s->waiting);
    folders_close(&s->folders);
    if (s->started) {
        uv_close((uv_handle_t *)&s->timer, on_closed);
    }
    free_when_closed(s);
}

static int start(spool *s, shear_error *err) {
    int code = ending_recover(&s->folders, err);
    if (code == SHEAR_OK) {
        code = list_active(s, err);
    }
    if (code != SHEAR_OK) {
        return code;
    }
    uv_timer_init(s->loop, &s->timer); /* never fails */
    s->timer.data = s;
    s->handles = 1;
    s->started = true;
    start_watch(s);
    s->scan.next_ms = spool_clock_ms();
    uv_timer_start(&s->timer, on_timer, 0, 0);
    return SHEAR_OK;
}

int spool_open(spool **out, uv_loop_t *loop, const char *directory, const spool_tuning *tuning,
               const spool_callbacks *callbacks, shear_error *err) {
    *out = NULL;
    spool *s = calloc(1, sizeof *s);
    if (s == NULL) {
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for the spool");
    }
    s->loop = loop;
    s->tuning = *tuning;
    s->call = *callbacks;
    s->call.now_ms = callbacks->now_ms != NULL ? callbacks->now_ms : wall_clock_ms;
    s->watch = (watch){-1, -1, -1};
    waiting_init(&s->waiting);
    offers_init(&s->offers);
    sweep_init(&s->sweep);
    int code = folders_open(&s->folders, directory, err);
    if (code == SHEAR_OK) {
        code = start(s, err);
    }
    if (code != SHEAR_OK) {
        spool_close(s);
        return code;
    }
    *out = s;
    return SHEAR_OK;
}

/* ---- the rest ---- */

int spool_refuse(spool *s, const char *active_name, shear_error *err) {
    if (!offers_add(&s->offers, active_name, true, true)) {
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for the spool");
    }
    return SHEAR_OK;
}

int spool_open_file(const spool *s, const char *active_name, int *out, shear_error *err) {
    const char *name = name_of_active(active_name);
    struct stat st;
    *out = -1;
    if (name == NULL) {
        return shear_fail(err, SHEAR_E_INTERNAL, NULL, "'%.255s' is no name of the spool's",
                          active_name);
    }
    /* Not to wait for the other end, should it be a pipe. */
    const int fd = openat(s->folders.fd[ACTIVE], active_name,
                          O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
    if (fd >= 0 && fstat(fd, &st) == 0 && S_ISREG(st.st_mode)) {
        *out = fd;
        return SHEAR_OK;
    }
    const int error = fd >= 0 || errno == ELOOP || errno == ENXIO ? EINVAL : errno;
    if (fd >= 0) {
        close(fd);
    }
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
    const size_t *counts = s->waiting.counts;
    stats.waiting =
        (int64_t)(counts[WAITING_SETTLING] + counts[WAITING_BEGUN] + counts[WAITING_READY]);
    stats.ignored = (int64_t)s->waiting.counts[WAITING_IGNORED];
    if (s->away || stats.waiting > 0) { /* who cannot be taken may have been taken away */
        snprintf(stats.trouble, sizeof stats.trouble, "%s", s->trouble);
        stats.trouble_since_ms = s->trouble_since_ms;
    }
    return stats;
}
