/* SPDX-License-Identifier: GPL-3.0-or-later */
/* log/log.h: the daemon's log, a line a message on standard error.
 *
 * Under systemd (JOURNAL_STREAM names the descriptor) a line begins with its priority, "<6>", which
 * the journal takes off; elsewhere with an RFC 3339 time in UTC and the level's name. Control
 * characters and bytes that are not UTF-8 are written as \n, \t or \xNN: a message is one line,
 * whatever a client named its file. A message that comes again and again is written a few times and
 * then counted; the count follows at last.
 *
 * Any thread may log, and none waits for who reads the log (log/outlet.h): what a pipe, a terminal
 * or the journal's socket does not take is kept, 256 KiB of it; lines beyond are lost and counted,
 * and a line says how many there were once it is read again. Errors of writing are not reported:
 * there is nowhere to.
 */
#ifndef SHEARD_LOG_H
#define SHEARD_LOG_H

#include <stdbool.h>
#include <stdint.h>

/* The numbers are those of enum sheard_log_level. */
enum log_level {
    LOG_LEVEL_ERROR,
    LOG_LEVEL_WARNING,
    LOG_LEVEL_NOTICE,
    LOG_LEVEL_INFO,
    LOG_LEVEL_DEBUG
};

enum log_style { LOG_AUTO, LOG_JOURNAL, LOG_TIMED };

typedef struct log_options {
    enum log_level level; /* the least important that is written */
    int fd;               /* stays the caller's */
    enum log_style style;
    int burst; /* so many equal messages in interval_ms; 0: no limit */
    int64_t interval_ms;
    int64_t (*now_ms)(void); /* milliseconds since 1970; NULL: the clock */
} log_options;
/* info, standard error, auto, 5 in 30 s */
void log_options_init(log_options *options);

/* Without it the log is as of log_options_init. Not while other threads log. */
void log_open(const log_options *options);
void log_set_level(enum log_level level);
bool log_is_on(enum log_level level);
/* Write the counts of messages that were left out. Now and then, and at the end. */
void log_flush(void);
/* Wait until everything is written. False: it was not in this time; at the end of the process it is
 * lost. */
bool log_drain(int timeout_ms);

typedef struct log_losses {
    int64_t lines;         /* that were lost since log_open */
    int64_t untold;        /* ... of them, those that no line tells of yet */
    int64_t since_ms;      /* the first of those, milliseconds since 1970; 0: none */
    int64_t waiting_bytes; /* that the log's reader has not taken yet */
} log_losses;
log_losses log_get_losses(void);

void log_error(const char *format, ...) __attribute__((format(printf, 1, 2)));
void log_warning(const char *format, ...) __attribute__((format(printf, 1, 2)));
void log_notice(const char *format, ...) __attribute__((format(printf, 1, 2)));
void log_info(const char *format, ...) __attribute__((format(printf, 1, 2)));
void log_debug(const char *format, ...) __attribute__((format(printf, 1, 2)));

#endif
