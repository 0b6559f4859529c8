/* SPDX-License-Identifier: GPL-3.0-or-later */
/* message/table.h: every message is a table of its members; one reader, one writer and one deinit
 * walk it. A table and its struct cannot drift apart: the macros below do not compile where the
 * member has another type. */
#ifndef PROTOCOL_MSG_TABLE_H
#define PROTOCOL_MSG_TABLE_H

#include "sheard/rpc.h"

#include <jansson.h>
#include <stddef.h>

enum msg_type {
    MSG_BOOL,     /* bool */
    MSG_INT,      /* int64_t; null for the fallback where MSG_NULLABLE */
    MSG_REAL,     /* double; null for NaN */
    MSG_TEXT,     /* const char *; null for NULL */
    MSG_NAME,     /* int, an index into `names`; null for the one that is "" */
    MSG_TIME,     /* int64_t ms; null for 0 */
    MSG_RAW,      /* const char *, a JSON object as text; null for NULL */
    MSG_SETTINGS, /* const char *, canonical settings <-> an object; null for NULL */
    MSG_STATES,   /* unsigned, a set of `names` <-> an array of names */
    MSG_INTS,     /* const int64_t *, size_t */
    MSG_TEXTS,    /* const char *const *, size_t */
    MSG_OBJECT,   /* a struct within the struct */
    MSG_OBJECTS,  /* const struct *, size_t */
    MSG_MERGED /* const char *, a JSON object whose members stand beside ours; at most one, first */
};

enum msg_flag {
    MSG_REQUIRED = 1, /* must be there and not null */
    MSG_NULLABLE = 2, /* MSG_INT: the fallback is written as null.
                         MSG_OBJECT: null where its first member is at its fallback */
    MSG_PLAIN = 4,    /* MSG_TEXT, MSG_TEXTS: not empty, no control characters */
    MSG_ABSOLUTE = 8  /* MSG_TEXT: a path that begins with a slash */
};

struct msg_table;

typedef struct msg_member {
    const char *name;
    int type;
    unsigned flags;
    size_t offset;       /* in the struct */
    size_t count_offset; /* of a list's length */
    int64_t min, max;    /* of numbers (MSG_REAL: seconds and the like, whole bounds); bytes of a
                            text; most elements of a list. max 0: no bounds */
    int64_t item_max;    /* MSG_TEXTS: bytes of an element */
    int64_t fallback;    /* where absent: MSG_INT, MSG_NAME, MSG_BOOL */
    const char *const *names;      /* ended by NULL */
    const struct msg_table *table; /* of MSG_OBJECT and MSG_OBJECTS */
} msg_member;

typedef struct msg_table {
    size_t size; /* of the struct */
    const msg_member *members;
    size_t n;
    /* What one member alone does not show; NULL: nothing. Called only on what a client sent or is
     * about to send. */
    int (*check)(const void *message, sheard_rpc_error *error);
} msg_table;

/* The offset of a member that must be of this type. (sizeof a type's name cannot be put in
 * parentheses.) */
/* clang-format off */
#define MSG_AT(T, member, type)                                                                    \
    (offsetof(T, member) +                                                                         \
     0 * sizeof(char[_Generic(((T *)0)->member, type: 1, default: -1)])) /* NOLINT(bugprone-macro-parentheses) */
/* clang-format on */
#define MSG_LIST_AT(T, list, count)                                                                \
    .offset = offsetof(T, list), .count_offset = MSG_AT(T, count, size_t)

#define MSG_BOOL_(T, member, flag)                                                                 \
    { .name = #member, .type = MSG_BOOL, .flags = (flag), .offset = MSG_AT(T, member, bool) }
#define MSG_INT_(T, member, key, low, high, otherwise, flag)                                       \
    {                                                                                              \
        .name = (key), .type = MSG_INT, .flags = (flag), .offset = MSG_AT(T, member, int64_t),     \
        .min = (low), .max = (high), .fallback = (otherwise)                                       \
    }
/* A count, an id: 0 or more, 0 where absent. */
#define MSG_COUNT_(T, member, flag) MSG_INT_(T, member, #member, 0, INT64_MAX, 0, flag)
#define MSG_REAL_(T, member, low, high)                                                            \
    {                                                                                              \
        .name = #member, .type = MSG_REAL, .offset = MSG_AT(T, member, double), .min = (low),      \
        .max = (high)                                                                              \
    }
#define MSG_TEXT_(T, member, key, longest, flag)                                                   \
    {                                                                                              \
        .name = (key), .type = MSG_TEXT, .flags = (flag),                                          \
        .offset = MSG_AT(T, member, const char *), .max = (longest)                                \
    }
#define MSG_SAID_(T, member, flag) MSG_TEXT_(T, member, #member, 0, flag)
#define MSG_NAME_(T, member, key, list, flag)                                                      \
    {                                                                                              \
        .name = (key), .type = MSG_NAME, .flags = (flag), .offset = MSG_AT(T, member, int),        \
        .names = (list)                                                                            \
    }
#define MSG_TIME_(T, member, key)                                                                  \
    { .name = (key), .type = MSG_TIME, .offset = MSG_AT(T, member, int64_t) }
#define MSG_RAW_(T, member)                                                                        \
    { .name = #member, .type = MSG_RAW, .offset = MSG_AT(T, member, const char *) }
#define MSG_SETTINGS_(T, member)                                                                   \
    { .name = #member, .type = MSG_SETTINGS, .offset = MSG_AT(T, member, const char *) }
#define MSG_STATES_(T, member, list)                                                               \
    { .name = #member, .type = MSG_STATES, .offset = MSG_AT(T, member, unsigned), .names = (list) }
#define MSG_INTS_(T, member, longest, flag)                                                        \
    {                                                                                              \
        .name = #member, .type = MSG_INTS,                                                         \
        .flags = (flag) + 0 * MSG_AT(T, member, const int64_t *),                                  \
        MSG_LIST_AT(T, member, n_##member), .max = (longest)                                       \
    }
#define MSG_TEXTS_(T, member, longest, item, flag)                                                 \
    {                                                                                              \
        .name = #member, .type = MSG_TEXTS,                                                        \
        .flags = (flag) + 0 * MSG_AT(T, member, const char *const *),                              \
        MSG_LIST_AT(T, member, n_##member), .max = (longest), .item_max = (item)                   \
    }
#define MSG_OBJECT_(T, member, key, S, its, flag)                                                  \
    {                                                                                              \
        .name = (key), .type = MSG_OBJECT, .flags = (flag), .offset = MSG_AT(T, member, S),        \
        .table = (its)                                                                             \
    }
#define MSG_OBJECTS_(T, member, S, its)                                                            \
    {                                                                                              \
        .name = #member, .type = MSG_OBJECTS, .flags = 0 * MSG_AT(T, member, const S *),           \
        MSG_LIST_AT(T, member, n_##member), .table = (its)                                         \
    }
#define MSG_MERGED_(T, member)                                                                     \
    { .name = "", .type = MSG_MERGED, .offset = MSG_AT(T, member, const char *) }

#define MSG_TABLE_(T, list) .size = sizeof(T), .members = (list), .n = sizeof(list) / sizeof *(list)

/* The tables, and the lists of names. */
extern const char *const msg_phases[];
extern const char *const msg_states[], *const msg_classes[], *const msg_outcomes[],
                                                                 *const msg_origins[],
                                                                     *const msg_attempt_outcomes[],
                                                                         *const msg_server_states[],
                                                                             *const msg_modes[];
/* names[index]; "unknown" outside. */
const char *msg_name(const char *const *names, int index);

extern const msg_table msg_nothing;
extern const msg_table msg_source, msg_hello, msg_submit, msg_id, msg_jobs, msg_wait, msg_field,
    msg_fields, msg_forget, msg_subscribe, msg_unsubscribe, msg_shutdown;
extern const msg_table msg_job, msg_shown, msg_submitted, msg_job_page, msg_waited, msg_progress;
extern const msg_table msg_field_result, msg_field_page, msg_summary, msg_forgotten;
extern const msg_table msg_limits, msg_welcome, msg_subscribed, msg_status, msg_metrics, msg_probed,
    msg_reloaded, msg_stopping;
extern const msg_table msg_job_changed, msg_job_progress, msg_field_changed, msg_lost, msg_side;

/* ---- Values in memory (msg_value.c) ---- */

void *msg_pointer(const void *message, size_t offset); /* the pointer that is kept there */
void msg_put_pointer(void *message, size_t offset, const void *pointer);
void msg_init(void *message, const msg_table *table);
void msg_deinit(void *message, const msg_table *table);
/* Of a MSG_NULLABLE object: is it there? */
bool msg_is_there(const void *message, const msg_table *table);

/* ---- Reading (msg_read.c) ---- */

enum msg_mode {
    MSG_STRICT = 1, /* from a client: unknown members are errors, all bounds hold */
    MSG_SPARSE = 2  /* writing: members at their fallback are left out */
};

/* Where in a message we are, for errors. */
typedef struct msg_reader {
    unsigned mode;
    sheard_rpc_error *error;
    char path[SHEARD_RPC_PARAMETER_SIZE];
} msg_reader;

/* Fill `message` from `object` (NULL: an empty one). On an error it is empty. The path of what is
 * wrong goes to error->parameter. */
int msg_read(void *message, const msg_table *table, const json_t *object, unsigned mode,
             sheard_rpc_error *error);
/* "PATH: MESSAGE", with error->parameter. */
int msg_fail(msg_reader *r, int code, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
int msg_no_memory(msg_reader *r);
/* Enter member or element, and leave to what *mark was. */
size_t msg_enter(msg_reader *r, const char *member);
size_t msg_enter_item(msg_reader *r, size_t index);
void msg_leave(msg_reader *r, size_t mark);
/* "a whole number, not \"x\"": what a value is, for messages. */
const char *msg_kind(const json_t *value);

int msg_read_number(msg_reader *r, void *at, const msg_member *m, const json_t *value);
int msg_read_text(msg_reader *r, const char **at, const msg_member *m, const json_t *value);
int msg_read_list(msg_reader *r, void *message, const msg_member *m, const json_t *value);
int msg_read_object(msg_reader *r, void *message, const msg_table *table, const json_t *object);
int msg_read_settings(msg_reader *r, const char **at, const json_t *value);
/* A copy of n bytes with a NUL; NULL: no memory. */
char *msg_copy(const char *bytes, size_t n);

/* ---- Writing (msg_write.c) ---- */

/* A new object, or NULL with *error set. */
json_t *msg_write(const void *message, const msg_table *table, unsigned mode,
                  sheard_rpc_error *error);
/* Canonical settings as an object. NULL: *bad says whether the text is none, or memory is out. */
json_t *msg_write_settings(const char *text, bool *bad);

#endif
