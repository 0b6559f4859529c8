/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sheard/rpc.h: convert between JSON-RPC 2.0 lines and the structs of sheard/messages.h, for the
 * daemon and its clients. docs/protocol.md is normative.
 *
 * Functions return 0 or an enum sheard_rpc_code, which is then also in *error (never NULL). Lines
 * end with \n and a NUL, and are from malloc; the caller frees them. Thread-safe: there is no
 * state. Any malformed input, and lack of memory at any point, is an error, never undefined
 * behaviour. */
#ifndef SHEARD_RPC_H
#define SHEARD_RPC_H

#include "sheard/codes.h"
#include "sheard/messages.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* ---- Methods and notifications ---- */

/* All methods: the name of SHEARD_METHOD_X; the method's name, also that of its members in the
 * unions below; the messages of its parameters and its reply (structs sheard_msg_Y, tables in
 * message/); whether it is for administrators only. */
#define SHEARD_METHODS(METHOD)                                                                     \
    METHOD(HELLO, hello, hello, welcome, false)                                                    \
    METHOD(SUBMIT, submit, submit, submitted, false)                                               \
    METHOD(JOB, job, id, shown, false)                                                             \
    METHOD(JOBS, jobs, jobs, job_page, false)                                                      \
    METHOD(WAIT, wait, wait, waited, false)                                                        \
    METHOD(CANCEL, cancel, id, job, false)                                                         \
    METHOD(RETRY, retry, id, job, false)                                                           \
    METHOD(RETRACT, retract, id, job, false)                                                       \
    METHOD(FIELD, field, field, field_result, false)                                               \
    METHOD(FIELDS, fields, fields, field_page, false)                                              \
    METHOD(FORGET, forget, forget, forgotten, true)                                                \
    METHOD(SUBSCRIBE, subscribe, subscribe, subscribed, false)                                     \
    METHOD(UNSUBSCRIBE, unsubscribe, unsubscribe, subscribed, false)                               \
    METHOD(STATUS, status, nothing, status, false)                                                 \
    METHOD(METRICS, metrics, nothing, metrics, false)                                              \
    METHOD(PROBE, probe, nothing, probed, false)                                                   \
    METHOD(RELOAD, reload, nothing, reloaded, true)                                                \
    METHOD(DRAIN, drain, nothing, stopping, true)                                                  \
    METHOD(SHUTDOWN, shutdown, shutdown, stopping, true)

/* All notifications: the name of SHEARD_NOTICE_X, the notification's name, the message of its
 * parameters. */
#define SHEARD_NOTICES(NOTICE)                                                                     \
    NOTICE(JOB_CHANGED, job_changed, job_changed)                                                  \
    NOTICE(JOB_PROGRESS, job_progress, job_progress)                                               \
    NOTICE(FIELD_CHANGED, field_changed, field_changed)                                            \
    NOTICE(SERVER_STATE, server_state, stopping)                                                   \
    NOTICE(LOST, lost, lost)

enum sheard_method {
    SHEARD_METHOD_NONE = -1,
#define METHOD(NAME, name, params, reply, admin) SHEARD_METHOD_##NAME,
    SHEARD_METHODS(METHOD)
#undef METHOD
        SHEARD_N_METHODS
};

enum sheard_notice {
    SHEARD_NOTICE_NONE = -1,
#define NOTICE(NAME, name, params) SHEARD_NOTICE_##NAME,
    SHEARD_NOTICES(NOTICE)
#undef NOTICE
        SHEARD_N_NOTICES
};

/* Return the name, or NULL if there is none of this number. */
const char *sheard_method_name(int method);
const char *sheard_notice_name(int notice);
/* Return the number of a name, or SHEARD_METHOD_NONE or SHEARD_NOTICE_NONE. */
enum sheard_method sheard_method_find(const char *name);
enum sheard_notice sheard_notice_find(const char *name);
/* Return whether the method is for administrators only. */
bool sheard_method_needs_admin(int method);
/* Return all names, in order, as a static array; *n becomes their number. */
const char *const *sheard_method_names(size_t *n);

typedef union sheard_params {
#define METHOD(NAME, name, params, reply, admin) sheard_msg_##params name;
    SHEARD_METHODS(METHOD)
#undef METHOD
    sheard_msg_id id; /* the parameters of job, cancel, retry and retract */
} sheard_params;

typedef union sheard_reply {
#define METHOD(NAME, name, params, reply, admin) sheard_msg_##reply name;
    SHEARD_METHODS(METHOD)
#undef METHOD
} sheard_reply;

typedef union sheard_notice_params {
#define NOTICE(NAME, name, params) sheard_msg_##params name;
    SHEARD_NOTICES(NOTICE)
#undef NOTICE
} sheard_notice_params;

/* ---- Identity of a request ---- */

enum { SHEARD_RPC_ID_MAX = 128 }; /* bytes of a text */
enum sheard_rpc_id_type { SHEARD_ID_NULL = 0, SHEARD_ID_INTEGER, SHEARD_ID_TEXT };
typedef struct sheard_rpc_id {
    enum sheard_rpc_id_type type;
    int64_t integer;
    char text[SHEARD_RPC_ID_MAX + 1];
} sheard_rpc_id;
bool sheard_rpc_id_equal(const sheard_rpc_id *a, const sheard_rpc_id *b);

/* ---- The daemon's side ---- */

/* Limits of a line, whatever its method. */
typedef struct sheard_rpc_limits {
    size_t line;   /* bytes */
    int depth;     /* nesting of arrays and objects; the outermost object is 1 */
    size_t values; /* members, elements and names */
    size_t text;   /* bytes of a string as written, between its quotes */
} sheard_rpc_limits;
extern const sheard_rpc_limits sheard_rpc_request_limits; /* 64 KiB, 8, 4096, 32 KiB */
extern const sheard_rpc_limits sheard_rpc_reply_limits;   /* 32 MiB, 16, 4 million, 32 MiB */

typedef struct sheard_request {
    sheard_rpc_id id;
    enum sheard_method method; /* SHEARD_METHOD_NONE after an error */
    sheard_params params;
} sheard_request;

/* Parse one line of `n` bytes, without its \n. The settings of a submit are checked together with
 * `defaults` (NULL: shear_settings_init). On an error the request is empty, but has its id, if that
 * could be read, for the error reply. */
int sheard_request_parse(sheard_request *request, const char *line, size_t n,
                         const shear_settings *defaults, sheard_rpc_error *error);
void sheard_request_deinit(sheard_request *request); /* a zeroed or deinited request is accepted */

/* Write a reply; `reply` is the member of `method`. Bytes that are not UTF-8 become U+FFFD. Errors:
 * SHEARD_RPC_OUT_OF_MEMORY, or SHEARD_RPC_INTERNAL if a raw JSON text in it is not an object. */
int sheard_reply_line(char **line, size_t *n, const sheard_rpc_id *id, int method,
                      const sheard_reply *reply, sheard_rpc_error *error);
/* Write the same bytes item by item. sheard_reply_item writes one item of the list in replies of
 * `method` (jobs of `jobs` and `wait`, fields of `fields`, rows of `field`), without a newline.
 * sheard_reply_list_line writes the reply `rest`, whose list is empty, with items[n_items] in it:
 * such texts, separated by commas. */
int sheard_reply_item(char **text, size_t *n, int method, const void *item,
                      sheard_rpc_error *error);
int sheard_reply_list_line(char **line, size_t *n, const sheard_rpc_id *id, int method,
                           const sheard_reply *rest, const char *items, size_t n_items,
                           sheard_rpc_error *error);
/* Write an error reply. On SHEARD_RPC_OUT_OF_MEMORY *line is NULL, and sheard_rpc_no_memory_line
 * may be sent instead. */
int sheard_error_line(char **line, size_t *n, const sheard_rpc_id *id,
                      const sheard_rpc_error *what);
extern const char sheard_rpc_no_memory_line[]; /* with id null */
int sheard_notice_line(char **line, size_t *n, int notice, const sheard_notice_params *params,
                       sheard_rpc_error *error);

/* ---- The client's side ---- */

/* Write a request. `params` may be NULL for a method without parameters. They are checked as the
 * daemon does, except for settings together, and errors are the same (SHEARD_RPC_BAD_PARAMETER and
 * others). Members at their default are left out. */
int sheard_request_line(char **line, size_t *n, const sheard_rpc_id *id, int method,
                        const sheard_params *params, sheard_rpc_error *error);
/* Set every member of the parameters to its default. */
void sheard_params_init(sheard_params *params, int method);

enum sheard_message_kind { SHEARD_MESSAGE_REPLY, SHEARD_MESSAGE_ERROR, SHEARD_MESSAGE_NOTICE };
typedef struct sheard_message {
    enum sheard_message_kind kind;
    sheard_rpc_id id;          /* of a reply or an error */
    sheard_rpc_error error;    /* of an error */
    enum sheard_notice notice; /* of a notification; SHEARD_NOTICE_NONE: unknown to this version */
    sheard_notice_params params; /* of a notification */
    void *body;                  /* of a reply: see sheard_message_reply */
} sheard_message;

/* Parse one line from the daemon. SHEARD_RPC_BAD_REPLY if it is neither a reply, an error nor a
 * notification. Members unknown to this version are ignored. */
int sheard_message_parse(sheard_message *message, const char *line, size_t n,
                         sheard_rpc_error *error);
void sheard_message_deinit(sheard_message *message);
/* Read a reply as the result of `method`. *reply outlives the message. SHEARD_RPC_BAD_REPLY if it
 * is not one. */
int sheard_message_reply(const sheard_message *message, int method, sheard_reply *reply,
                         sheard_rpc_error *error);
void sheard_reply_deinit(sheard_reply *reply, int method); /* a zeroed reply is accepted */
/* Return a reply as it came, one line of JSON without \n, for --json. */
int sheard_message_text(const sheard_message *message, char **text, sheard_rpc_error *error);

/* ---- Files and texts ---- */

/* Parse a job file of `n` bytes: the object that is `submit`'s parameters, in any layout. */
int sheard_job_file_parse(sheard_msg_submit *submit, const char *text, size_t n,
                          const shear_settings *defaults, sheard_rpc_error *error);
void sheard_submit_deinit(sheard_msg_submit *submit);

/* Write a source as one line of JSON, which the store keeps, or parse it. */
int sheard_source_text(char **text, const sheard_msg_source *source, sheard_rpc_error *error);
int sheard_source_parse(sheard_msg_source *source, const char *text, sheard_rpc_error *error);
void sheard_source_deinit(sheard_msg_source *source);

/* Write or parse the report file beside an input, for people and programs: indented, with \n at its
 * end. */
int sheard_side_text(char **text, const sheard_msg_side *side, sheard_rpc_error *error);
int sheard_side_parse(sheard_msg_side *side, const char *text, size_t n, sheard_rpc_error *error);
void sheard_side_deinit(sheard_msg_side *side);

#endif
