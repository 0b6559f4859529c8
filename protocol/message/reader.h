/* SPDX-License-Identifier: GPL-3.0-or-later */
/* message/reader.h: functions shared by the readers of objects, values and settings: track the
 * position in a message, and report errors there. */
#pragma once

#include "message/table.h"

typedef struct msg_reader {
    unsigned mode; /* set of enum msg_mode */
    sheard_rpc_error *error;
    char path[SHEARD_RPC_PARAMETER_SIZE]; /* "galaxy.hdu", "ids[3]" */
} msg_reader;

/* Return whether the message comes from a client (MSG_STRICT). */
bool reader_is_strict(const msg_reader *r);

/* Enter a member or an element. Return the mark with which reader_leave returns. */
size_t reader_enter(msg_reader *r, const char *member);
size_t reader_enter_item(msg_reader *r, size_t index);
void reader_leave(msg_reader *r, size_t mark);

/* Fill in the error "'PATH': MESSAGE", with error->parameter. Return `code`, or
 * SHEARD_RPC_BAD_REPLY unless the reader is strict. */
int reader_fail(const msg_reader *r, int code, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/* Report "expected EXPECTED, not a string". */
int reader_wrong_type(const msg_reader *r, const char *expected, const json_t *value);
int reader_no_memory(const msg_reader *r);

/* Copy n bytes without a NUL, terminated, to *at. */
int reader_copy(const msg_reader *r, const char **at, const char *bytes, size_t n);

/* ---- Values without a table of their own ---- */

/* Read a MSG_BOOL, MSG_INT, MSG_REAL, MSG_NAME or MSG_TIME (message/read_scalar.c). */
int reader_scalar(const msg_reader *r, void *at, const msg_member *m, const json_t *value);
/* Read a string of at most `longest` bytes (0: any length); `flags` are enum msg_flag. */
int reader_string(const msg_reader *r, const char **at, unsigned flags, int64_t longest,
                  const json_t *value);
/* Return the index of a name, or -1; report what a name should have been. */
int reader_name_index(const char *const *names, const json_t *value);
int reader_wrong_name(const msg_reader *r, const char *const *names, const json_t *value);

/* Read an object of settings as canonical text; NULL if it has none (message/settings.c). */
int reader_settings(msg_reader *r, const char **at, const json_t *value);
/* Write canonical settings as an object. If NULL is returned, *bad is true if the text is invalid,
 * false if memory is out. */
json_t *msg_write_settings(const char *text, bool *bad);
