/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sheard/rpc.h: JSON-RPC 2.0 lines to the structs of sheard/messages.h and back, for the daemon and
 * its clients alike. docs/protocol.md is normative.
 *
 * Functions return 0 or an enum sheard_rpc_code, which is then also in *error (never NULL). Lines
 * that are made end with \n and a NUL, are malloc'd and the caller's to free. Thread-safe: there is
 * no state. Input of any kind, and want of memory at any point, is an error and never worse.
 */
#ifndef SHEARD_RPC_H
#define SHEARD_RPC_H

#include "sheard/codes.h"
#include "sheard/messages.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* ---- Methods and notifications ---- */

/* Every method: its number SHEARD_METHOD_X; its name, also that of its members in the unions below;
 * the messages that are its parameters and its reply (structs sheard_msg_Y, tables in message/); is
 * it for administrators only? */
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

/* Every notification: its number SHEARD_NOTICE_X, its name, the message that is its parameters. */
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

/* The name; NULL if there is none of this number. */
const char *sheard_method_name(int method);
const char *sheard_notice_name(int notice);
/* By name; SHEARD_METHOD_NONE, SHEARD_NOTICE_NONE. */
enum sheard_method sheard_method_find(const char *name);
enum sheard_notice sheard_notice_find(const char *name);
bool sheard_method_needs_admin(int method);
/* All names, in order; *n becomes their number. Static. */
const char *const *sheard_method_names(size_t *n);

typedef union sheard_params {
#define METHOD(NAME, name, params, reply, admin) sheard_msg_##params name;
    SHEARD_METHODS(METHOD)
#undef METHOD
    sheard_msg_id id; /* of job, cancel, retry and retract alike */
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

/* What a line may hold at most, whatever its method. */
typedef struct sheard_rpc_limits {
    size_t line;   /* bytes */
    int depth;     /* of arrays and objects in each other; the outermost object is 1 */
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

/* One line without its \n, `n` bytes. `defaults`: the settings that a submit's own are set upon, to
 * check them together (NULL: shear_settings_init). On an error the request is empty, with its id
 * where that could be known: reply with it. */
int sheard_request_parse(sheard_request *request, const char *line, size_t n,
                         const shear_settings *defaults, sheard_rpc_error *error);
void sheard_request_deinit(sheard_request *request); /* zeroed or deinited: fine */

/* `reply` is the member of `method`. What is not UTF-8 becomes U+FFFD. SHEARD_RPC_OUT_OF_MEMORY; or
 * SHEARD_RPC_INTERNAL: a raw JSON text in it is no object. */
int sheard_reply_line(char **line, size_t *n, const sheard_rpc_id *id, int method,
                      const sheard_reply *reply, sheard_rpc_error *error);
/* The same, made item by item: the text of an item of the one list in replies of `method` (jobs of
 * `jobs` and `wait`, fields of `fields`, rows of `field`), without a newline; and the reply `rest`,
 * whose list is empty, with items[n_items] in it: such texts, with commas between them. The bytes
 * are those of sheard_reply_line. */
int sheard_reply_item(char **text, size_t *n, int method, const void *item,
                      sheard_rpc_error *error);
int sheard_reply_list_line(char **line, size_t *n, const sheard_rpc_id *id, int method,
                           const sheard_reply *rest, const char *items, size_t n_items,
                           sheard_rpc_error *error);
/* SHEARD_RPC_OUT_OF_MEMORY: *line is NULL; then sheard_rpc_no_memory_line may be sent. */
int sheard_error_line(char **line, size_t *n, const sheard_rpc_id *id,
                      const sheard_rpc_error *what);
extern const char sheard_rpc_no_memory_line[]; /* id null */
int sheard_notice_line(char **line, size_t *n, int notice, const sheard_notice_params *params,
                       sheard_rpc_error *error);

/* ---- The client's side ---- */

/* `params` may be NULL for a method without. It is checked as the daemon checks it, but for
 * settings together; what is at its default is left out. SHEARD_RPC_BAD_PARAMETER and its kin, as
 * from the daemon. */
int sheard_request_line(char **line, size_t *n, const sheard_rpc_id *id, int method,
                        const sheard_params *params, sheard_rpc_error *error);
/* The params with every member at its default. */
void sheard_params_init(sheard_params *params, int method);

enum sheard_message_kind { SHEARD_MESSAGE_REPLY, SHEARD_MESSAGE_ERROR, SHEARD_MESSAGE_NOTICE };
typedef struct sheard_message {
    enum sheard_message_kind kind;
    sheard_rpc_id id;          /* of a reply or an error */
    sheard_rpc_error error;    /* of an error */
    enum sheard_notice notice; /* of a notification; SHEARD_NOTICE_NONE: unknown to this version */
    sheard_notice_params params; /* of a notification */
    void *body;                  /* of a reply; see below */
} sheard_message;

/* One line from the daemon. SHEARD_RPC_BAD_REPLY if it is none of the three. Members that this
 * version does not know are passed over. */
int sheard_message_parse(sheard_message *message, const char *line, size_t n,
                         sheard_rpc_error *error);
void sheard_message_deinit(sheard_message *message);
/* A reply as the result of `method`; *reply outlives the message. SHEARD_RPC_BAD_REPLY. */
int sheard_message_reply(const sheard_message *message, int method, sheard_reply *reply,
                         sheard_rpc_error *error);
void sheard_reply_deinit(sheard_reply *reply, int method); /* zeroed: fine */
/* A reply as it came, one line of JSON without \n, for --json. */
int sheard_message_text(const sheard_message *message, char **text, sheard_rpc_error *error);

/* ---- Files and texts ---- */

/* A job file: the object that is `submit`'s params, in any layout, `n` bytes. */
int sheard_job_file_parse(sheard_msg_submit *submit, const char *text, size_t n,
                          const shear_settings *defaults, sheard_rpc_error *error);
void sheard_submit_deinit(sheard_msg_submit *submit);

/* A source as one line of JSON (the store keeps it), and back. */
int sheard_source_text(char **text, const sheard_msg_source *source, sheard_rpc_error *error);
int sheard_source_parse(sheard_msg_source *source, const char *text, sheard_rpc_error *error);
void sheard_source_deinit(sheard_msg_source *source);

/* The file beside an input, for people and programs: indented, with \n at its end. */
int sheard_side_text(char **text, const sheard_msg_side *side, sheard_rpc_error *error);
int sheard_side_parse(sheard_msg_side *side, const char *text, size_t n, sheard_rpc_error *error);
void sheard_side_deinit(sheard_msg_side *side);

#endif
