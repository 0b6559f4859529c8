/* SPDX-License-Identifier: GPL-3.0-or-later */
/* message/reader.h: what the readers of objects, values and settings share: where in a message they
 * are, and how they say what is wrong there. */
#ifndef PROTOCOL_MESSAGE_READER_H
#define PROTOCOL_MESSAGE_READER_H

#include "message/table.h"

typedef struct msg_reader {
    unsigned mode; /* enum msg_mode, or'ed */
    sheard_rpc_error *error;
    char path[SHEARD_RPC_PARAMETER_SIZE]; /* "galaxy.hdu", "ids[3]" */
} msg_reader;

bool reader_is_strict(const msg_reader *r);

/* Enter a member or an element; returns the mark to leave to. */
size_t reader_enter(msg_reader *r, const char *member);
size_t reader_enter_item(msg_reader *r, size_t index);
void reader_leave(msg_reader *r, size_t mark);

/* "'PATH': MESSAGE", with error->parameter. Returns the code, which is SHEARD_RPC_BAD_REPLY unless
 * the reader is strict. */
int reader_fail(const msg_reader *r, int code, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/* "expected EXPECTED, not a string" */
int reader_wrong_type(const msg_reader *r, const char *expected, const json_t *value);
int reader_no_memory(const msg_reader *r);

/* A copy of n bytes, ended by a NUL, in *at. */
int reader_copy(const msg_reader *r, const char **at, const char *bytes, size_t n);

/* ---- Values without a table of their own ---- */

/* MSG_BOOL, MSG_INT, MSG_REAL, MSG_NAME, MSG_TIME (message/read_scalar.c) */
int reader_scalar(const msg_reader *r, void *at, const msg_member *m, const json_t *value);
/* A string of at most `longest` bytes (0: any); enum msg_flag */
int reader_string(const msg_reader *r, const char **at, unsigned flags, int64_t longest,
                  const json_t *value);
/* The index of a name, or -1; what a name should have been. */
int reader_name_index(const char *const *names, const json_t *value);
int reader_wrong_name(const msg_reader *r, const char *const *names, const json_t *value);

/* An object of settings as canonical text; NULL if it gives none (message/settings.c). */
int reader_settings(msg_reader *r, const char **at, const json_t *value);
/* The other way: canonical settings as an object. NULL: *bad says whether the text is bad; if not,
 * memory is out. */
json_t *msg_write_settings(const char *text, bool *bad);

#endif
