/* SPDX-License-Identifier: GPL-3.0-or-later */
/* message/table.h: tables that describe messages. Each message is a table of its members, and one
 * reader, one writer and one deinit use all tables. A macro does not compile if the member has
 * another type, so a table always matches its struct. A message needs only its struct
 * (sheard/messages.h) and its table. */
#pragma once

#include "base/member.h"
#include "sheard/codes.h"
#include "sheard/messages.h"
#include "sheard/rpc.h"

#include <jansson.h>
#include <stddef.h>

enum msg_type {
    MSG_BOOL,     /* bool */
    MSG_INT,      /* int64_t; null for the fallback if MSG_NULLABLE */
    MSG_REAL,     /* double; null for NaN */
    MSG_TEXT,     /* const char *; null for NULL */
    MSG_NAME,     /* int or an enum, an index into `names`; null for the name "" */
    MSG_TIME,     /* int64_t ms; null for 0 */
    MSG_RAW,      /* const char *, a JSON object as text; null for NULL */
    MSG_SETTINGS, /* const char *, canonical settings <-> an object; null for NULL */
    MSG_STATES,   /* unsigned, a set of `names` <-> an array of names */
    MSG_INTS,     /* const int64_t *, size_t */
    MSG_TEXTS,    /* const char *const *, size_t */
    MSG_OBJECT,   /* a struct within the struct */
    MSG_OBJECTS,  /* const struct *, size_t */
    MSG_MERGED /* const char *, a JSON object whose members are merged into the message; at most one
                  per table, and first */
};

enum msg_flag {
    MSG_REQUIRED = 1, /* must be present and not null */
    MSG_NULLABLE = 2, /* MSG_INT: the fallback is written as null.
                         MSG_OBJECT: null if its first member is at its fallback */
    MSG_PLAIN = 4,    /* MSG_TEXT, MSG_TEXTS: not empty, no control characters */
    MSG_ABSOLUTE = 8  /* MSG_TEXT: a path that begins with a slash */
};

typedef struct msg_table msg_table;

typedef struct msg_member {
    const char *name;
    enum msg_type type;
    unsigned flags;      /* set of enum msg_flag */
    size_t offset;       /* of the member in the struct */
    size_t count_offset; /* of the list's length in the struct */
    int64_t min, max; /* range of numbers (whole numbers also for MSG_REAL); bytes of a text; most
                         elements of a list. max 0: no limits */
    int64_t item_max; /* MSG_TEXTS: most bytes of an element */
    int64_t fallback; /* value if absent: MSG_INT, MSG_NAME, MSG_BOOL */
    const char *const *names; /* terminated by NULL */
    const msg_table *table;   /* of MSG_OBJECT and MSG_OBJECTS */
} msg_member;

struct msg_table {
    const char *name; /* its struct is sheard_msg_NAME */
    size_t size;      /* of the struct */
    const msg_member *members;
    size_t n;
    /* Check conditions between members, in messages that a client sent or is about to send; NULL:
     * none. */
    int (*check)(const void *message, sheard_rpc_error *error);
};

/* ---- Members of struct sheard_msg_T. The key in JSON is the member's name ---- */

#define MSG_MEMBER(T, member, key, kind, c_type, ...)                                              \
    {                                                                                              \
        .name = (key), .type = (kind), .offset = MEMBER_AT(sheard_msg_##T, member, c_type),        \
        __VA_ARGS__                                                                                \
    }

/* A member whose type is enough: bool, double, const char *, and int64_t for a count or an id (0 or
 * more, 0 if absent). */
#define MSG(T, member)        MSG_FLAGGED(T, member, 0)
#define MSG_NEEDED(T, member) MSG_FLAGGED(T, member, MSG_REQUIRED)
#define MSG_FLAGGED(T, member, flag)                                                                 \
    {                                                                                                \
        .name = #member, .flags = (flag), .offset = offsetof(sheard_msg_##T, member),              \
        .type = _Generic(((sheard_msg_##T *)0)->member, bool: MSG_BOOL, int64_t: MSG_INT,          \
                         double: MSG_REAL, const char *: MSG_TEXT),                                \
        .max = _Generic(((sheard_msg_##T *)0)->member, int64_t: INT64_MAX, default: 0) \
    }

#define MSG_NUMBER(T, member, low, high, otherwise, flag)                                          \
    MSG_MEMBER(T, member, #member, MSG_INT, int64_t, .flags = (flag), .min = (low), .max = (high), \
               .fallback = (otherwise))
/* A double from 0 to `high`. */
#define MSG_UP_TO(T, member, high)           MSG_MEMBER(T, member, #member, MSG_REAL, double, .max = (high))
#define MSG_STRING(T, member, longest, flag) MSG_STRING_AS(T, member, #member, longest, flag)
#define MSG_STRING_AS(T, member, key, longest, flag)                                               \
    MSG_MEMBER(T, member, key, MSG_TEXT, const char *, .flags = (flag), .max = (longest))
#define MSG_NAMED(T, member, key, list, flag)                                                      \
    MSG_MEMBER(T, member, key, MSG_NAME, int, .flags = (flag), .names = (list))
/* The member is KEY_ms. */
#define MSG_WHEN(T, key) MSG_MEMBER(T, key##_ms, #key, MSG_TIME, int64_t, .flags = 0)
/* MSG_RAW, MSG_SETTINGS or MSG_MERGED */
#define MSG_JSON(T, member, kind) MSG_MEMBER(T, member, #member, kind, const char *, .flags = 0)
#define MSG_SET(T, member, list)                                                                   \
    MSG_MEMBER(T, member, #member, MSG_STATES, unsigned, .names = (list))
/* Lists of n_MEMBER elements */
#define MSG_LIST(T, member, kind, c_type, ...)                                                     \
    MSG_MEMBER(T, member, #member, kind, c_type,                                                   \
               .count_offset = MEMBER_AT(sheard_msg_##T, n_##member, size_t), __VA_ARGS__)
#define MSG_IDS(T, member, longest, flag)                                                          \
    MSG_LIST(T, member, MSG_INTS, const int64_t *, .max = (longest), .flags = (flag))
#define MSG_STRINGS(T, member, longest, item, flag)                                                \
    MSG_LIST(T, member, MSG_TEXTS, const char *const *, .max = (longest), .item_max = (item),      \
             .flags = (flag))
/* Lists of structs sheard_msg_S, by their table msg_S */
#define MSG_LISTED(T, member, S)                                                                   \
    MSG_LIST(T, member, MSG_OBJECTS, const sheard_msg_##S *, .table = &msg_##S)
#define MSG_STRUCT(T, member, S, flag) MSG_STRUCT_AS(T, member, #member, S, flag)
#define MSG_STRUCT_AS(T, member, key, S, flag)                                                     \
    MSG_MEMBER(T, member, key, MSG_OBJECT, sheard_msg_##S, .flags = (flag), .table = &msg_##S)

/* Define the table msg_T of T_members[], with its check or NULL. `static` may precede it. */
#define MSG_TABLE(T, its_check)                                                                    \
    const msg_table msg_##T = {.name = #T,                                                         \
                               .size = sizeof(sheard_msg_##T),                                     \
                               .members = T##_members,                                             \
                               .n = sizeof T##_members / sizeof T##_members[0],                    \
                               .check = (its_check)}
/* Define a static table of a few members, without a check, for a part of other messages. */
#define MSG_WHOLE(T, ...)                                                                          \
    static const msg_member T##_members[] = {__VA_ARGS__};                                         \
    MSG_TABLE(T, NULL)
#define MSG_PART(T, ...)                                                                           \
    static const msg_member T##_members[] = {__VA_ARGS__};                                         \
    static MSG_TABLE(T, NULL)

/* Tables of all parameters, replies and notifications, and of the structs that several of them
 * contain. */
#define METHOD(NAME, name, params, reply, admin) extern const msg_table msg_##params, msg_##reply;
SHEARD_METHODS(METHOD)
#undef METHOD
#define NOTICE(NAME, name, params) extern const msg_table msg_##params;
SHEARD_NOTICES(NOTICE)
#undef NOTICE
extern const msg_table msg_source, msg_limits, msg_progress, msg_summary, msg_side;

/* ---- Names (message/names.c): in the order of their enums, ended by NULL; "" is null in JSON ----
 */

extern const char *const msg_job_states[];
extern const char *const msg_job_classes[];
extern const char *const msg_job_phases[];
extern const char *const msg_job_outcomes[];
extern const char *const msg_job_origins[];
extern const char *const msg_attempt_outcomes[];
extern const char *const msg_server_states[];
extern const char *const msg_shutdown_modes[];
/* Return names[index], or "unknown" if there is none. */
const char *msg_name(const char *const *names, int index);

/* ---- Values in memory (message/value.c) ---- */

/* Set all members to their fallback; free what the members own. */
void msg_init(void *message, const msg_table *table);
void msg_deinit(void *message, const msg_table *table);
/* Return whether a MSG_NULLABLE object is present. */
bool msg_is_there(const void *message, const msg_table *table);
/* Return whether the member has the value of an absent one. */
bool msg_is_absent(const void *message, const msg_member *m);

void *msg_pointer(const void *message, size_t offset); /* the pointer stored at the offset */
void msg_put_pointer(void *message, size_t offset, const void *pointer);
/* Return a list's length; set it; return the bytes of an element. */
size_t msg_count(const void *message, const msg_member *m);
void msg_put_count(void *message, const msg_member *m, size_t n);
size_t msg_item_size(const msg_member *m);

/* ---- Reading and writing (message/read.c, message/write.c) ---- */

enum msg_mode {
    MSG_STRICT = 1, /* from a client: unknown members are errors, all limits apply */
    MSG_SPARSE = 2  /* writing: members at their fallback are left out */
};

/* Fill `message` from `object` (NULL: an empty one). On an error the message is empty, and
 * error->parameter is the path of what is wrong. */
int msg_read(void *message, const msg_table *table, const json_t *object, unsigned mode,
             sheard_rpc_error *error);

/* Return the message as a new object, or NULL with *error set. */
json_t *msg_write(const void *message, const msg_table *table, unsigned mode,
                  sheard_rpc_error *error);
