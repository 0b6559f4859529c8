/* SPDX-License-Identifier: GPL-3.0-or-later */
/* log/log.h: the daemon's log, one line per message on standard error.
 *
 * If standard error is the journal (JOURNAL_STREAM), a line begins with its priority, "<6>", which
 * the journal removes; otherwise with an RFC 3339 time in UTC and the level's name. Control
 * characters and bytes that are not UTF-8 are written as \n, \t or \xNN, so a message is one line,
 * whatever the name of a client's file. A message that is repeated is written a few times and then
 * counted; the count is written later.
 *
 * Any thread may log, and none blocks on a slow reader of the log (log/outlet.h): up to 256 KiB
 * that a pipe, a terminal or the journal's socket does not accept are kept. Further lines are lost
 * and counted, and a line reports their number once the log is read again. Write errors are not
 * reported: there is nowhere to report them. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

/* The values are those of enum sheard_log_level. */
enum log_level {
    LOG_LEVEL_ERROR,
    LOG_LEVEL_WARNING,
    LOG_LEVEL_NOTICE,
    LOG_LEVEL_INFO,
    LOG_LEVEL_DEBUG
};

enum log_style { LOG_AUTO, LOG_JOURNAL, LOG_TIMED };

typedef struct log_options {
    enum log_level level; /* the least important level that is written */
    int fd;               /* stays the caller's */
    enum log_style style;
    int burst; /* most equal messages in interval_ms; 0: no limit */
    int64_t interval_ms;
    int64_t (*now_ms)(void); /* milliseconds since 1970; NULL: the system's clock */
} log_options;
/* Set the defaults: info, standard error, auto, 5 in 30 s. */
void log_options_init(log_options *options);

/* Configure the log; before, it has the options of log_options_init. Not while other threads log.
 */
void log_open(const log_options *options);
void log_set_level(enum log_level level);
/* Return whether messages of this level are written. */
bool log_is_on(enum log_level level);
/* Write the counts of repeated messages that were left out. Call it from time to time, and at the
 * end. */
void log_flush(void);
/* Wait until everything is written. Return false if that takes longer; if the process then ends,
 * the rest is lost. */
bool log_drain(int timeout_ms);

typedef struct log_losses {
    int64_t lines;         /* lost since log_open */
    int64_t untold;        /* ... of them, not reported by a line yet */
    int64_t since_ms;      /* time when the first of these was lost, ms since 1970; 0: none */
    int64_t waiting_bytes; /* bytes that are not written yet */
} log_losses;
log_losses log_get_losses(void);

void log_error(const char *format, ...) __attribute__((format(printf, 1, 2)));
void log_warning(const char *format, ...) __attribute__((format(printf, 1, 2)));
void log_notice(const char *format, ...) __attribute__((format(printf, 1, 2)));
void log_info(const char *format, ...) __attribute__((format(printf, 1, 2)));
void log_debug(const char *format, ...) __attribute__((format(printf, 1, 2)));
