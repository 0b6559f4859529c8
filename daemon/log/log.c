/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "log/log.h"

#include "base/clock.h"
#include "base/thread.h"
#include "log/outlet.h"
#include "log/repeats.h"
#include "shear/text.h"

#include <errno.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum { MESSAGE_SIZE = 2048, LINE_SIZE = 4 * MESSAGE_SIZE + 64 };

/* The lock is held while `messages` is used and a line is passed on, so that a count follows the
 * lines that it counts. `options` and `journal` change only in log_open. */
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static repeats messages;
static log_options options = {.fd = STDERR_FILENO, .burst = 5, .interval_ms = 30000};
static bool journal;
static log_losses losses;
static atomic_int level_on = LOG_LEVEL_INFO;

void log_options_init(log_options *o) {
    *o = (log_options){
        .level = LOG_LEVEL_INFO, .fd = STDERR_FILENO, .burst = 5, .interval_ms = 30000};
}

/* Return whether fd is the journal's stream. JOURNAL_STREAM ("device:inode") is inherited, so it
 * applies only if the descriptor is still that file. */
static bool is_journal(int fd) {
    const char *text = getenv("JOURNAL_STREAM");
    unsigned long long device = 0;
    unsigned long long inode = 0;
    char rest = '\0';
    struct stat st;
    // NOLINTNEXTLINE(cert-err34-c): a text that does not match is not our stream
    return text != NULL && sscanf(text, "%llu:%llu%c", &device, &inode, &rest) == 2 &&
           fstat(fd, &st) == 0 && st.st_dev == device && st.st_ino == inode;
}

void log_open(const log_options *o) {
    log_set_level(o->level);
    LOCKED(&lock);
    options = *o;
    journal = o->style == LOG_JOURNAL || (o->style == LOG_AUTO && is_journal(o->fd));
    messages = (repeats){0};
    losses = (log_losses){0};
    outlet_open(o->fd);
}

void log_set_level(enum log_level level) {
    atomic_store(&level_on, (int)level);
}

bool log_is_on(enum log_level level) {
    return (int)level <= atomic_load(&level_on);
}

static int64_t now_ms(void) {
    return options.now_ms != NULL ? options.now_ms() : clock_ms(CLOCK_REALTIME);
}

/* ---- lines ---- */

static size_t escape(char *out, const char *text) {
    char *o = out;
    for (const unsigned char *p = (const unsigned char *)text; *p != '\0';) {
        const size_t n = shear_text_shown((const char *)p);
        if (n > 0) {
            memcpy(o, p, n);
            o += n;
            p += n;
        } else {
            o += *p == '\n'   ? sprintf(o, "\\n")
                 : *p == '\t' ? sprintf(o, "\\t")
                              : sprintf(o, "\\x%02x", *p);
            p++;
        }
    }
    return (size_t)(o - out);
}

static size_t begin_line(char *line, size_t size, enum log_level level, int64_t ms) {
    static const int priorities[] = {3, 4, 5, 6, 7};
    static const char *const names[] = {"error", "warning", "notice", "info", "debug"};
    if (journal)
        return (size_t)snprintf(line, size, "<%d>", priorities[level]);
    const time_t seconds = (time_t)(ms / 1000);
    struct tm tm = {0};
    char date[32];
    gmtime_r(&seconds, &tm);
    strftime(date, sizeof date, "%Y-%m-%dT%H:%M:%S", &tm);
    return (size_t)snprintf(line, size, "%s.%03dZ %s: ", date, (int)(ms % 1000), names[level]);
}

static bool hand_over(enum log_level level, const char *text, int64_t ms) {
    char line[LINE_SIZE];
    size_t n = begin_line(line, 64, level, ms);
    n += escape(line + n, text);
    line[n++] = '\n';
    return outlet_put(line, n);
}

/* Write how many lines were lost at this place. This waits until half of the buffer is free, so
 * that such lines stay rare. */
static void tell_losses(int64_t ms) {
    char text[128];
    if (losses.untold == 0 || outlet_waiting() > OUTLET_BYTES / 2)
        return;
    snprintf(text, sizeof text, "%lld lines of the log were lost here: nobody read it",
             (long long)losses.untold);
    if (hand_over(LOG_LEVEL_WARNING, text, ms))
        losses.untold = losses.since_ms = 0;
}

static void write_message(enum log_level level, const char *text, int64_t ms) {
    tell_losses(ms);
    if (losses.untold > 0 || !hand_over(level, text, ms)) {
        losses.since_ms = losses.untold == 0 ? ms : losses.since_ms;
        losses.lines++;
        losses.untold++;
    }
}

static void write_counts(int64_t interval_ms, int64_t ms) {
    repeated m;
    while (repeats_next_ended(&messages, interval_ms, ms, &m)) {
        char text[REPEATS_TEXT + 64];
        snprintf(text, sizeof text, "%u times more: %s", m.left_out, m.text);
        write_message(m.level, text, ms);
    }
}

static void log_text(enum log_level level, const char *text) {
    LOCKED(&lock);
    const int64_t ms = now_ms();
    write_counts(options.interval_ms, ms);
    if (options.burst <= 0 ||
        repeats_admit(&messages, level, text, (unsigned)options.burst, options.interval_ms, ms)) {
        write_message(level, text, ms);
    }
}

void log_flush(void) {
    LOCKED(&lock);
    write_counts(0, now_ms());
    tell_losses(now_ms());
}

bool log_drain(int timeout_ms) {
    return outlet_drain(timeout_ms);
}

log_losses log_get_losses(void) {
    LOCKED(&lock);
    log_losses got = losses;
    got.waiting_bytes = (int64_t)outlet_waiting();
    return got;
}

/* errno is preserved: the caller may use it after logging. */
#define LOG_AT(name, level)                                                                        \
    void name(const char *format, ...) {                                                           \
        const int saved = errno;                                                                   \
        if (log_is_on(level)) {                                                                    \
            char text[MESSAGE_SIZE];                                                               \
            va_list args;                                                                          \
            va_start(args, format);                                                                \
            vsnprintf(text, sizeof text, format, args);                                            \
            va_end(args);                                                                          \
            log_text((level), text);                                                               \
        }                                                                                          \
        errno = saved;                                                                             \
    }

LOG_AT(log_error, LOG_LEVEL_ERROR)
LOG_AT(log_warning, LOG_LEVEL_WARNING)
LOG_AT(log_notice, LOG_LEVEL_NOTICE)
LOG_AT(log_info, LOG_LEVEL_INFO)
LOG_AT(log_debug, LOG_LEVEL_DEBUG)
