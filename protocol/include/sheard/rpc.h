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

#include "sheard/messages.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* ---- Errors ---- */

/* The one table of codes is in rpc_codes.c; names, numbers and meanings never change. */
enum sheard_rpc_code {
    SHEARD_RPC_OK = 0,
    /* the line or the request is wrong */
    SHEARD_RPC_PARSE_ERROR,
    SHEARD_RPC_INVALID_REQUEST,
    SHEARD_RPC_UNKNOWN_METHOD,
    SHEARD_RPC_BATCH_UNSUPPORTED,
    SHEARD_RPC_LINE_TOO_LONG,
    SHEARD_RPC_NUL_BYTE,
    SHEARD_RPC_TOO_COMPLEX,
    SHEARD_RPC_DUPLICATE_KEY,
    SHEARD_RPC_UNKNOWN_PARAMETER,
    SHEARD_RPC_MISSING_PARAMETER,
    SHEARD_RPC_BAD_PARAMETER,
    SHEARD_RPC_BAD_SETTING,
    SHEARD_RPC_BAD_CURSOR,
    SHEARD_RPC_UNSUPPORTED_VERSION,
    /* the service cannot take it now */
    SHEARD_RPC_QUEUE_FULL,
    SHEARD_RPC_DRAINING,
    SHEARD_RPC_STOPPING,
    SHEARD_RPC_TOO_MANY_CONNECTIONS,
    SHEARD_RPC_TOO_MANY_REQUESTS,
    SHEARD_RPC_TOO_MANY_SUBSCRIPTIONS,
    SHEARD_RPC_IDLE_TIMEOUT,
    SHEARD_RPC_DISK_FULL,
    SHEARD_RPC_STORE_FAILED,
    SHEARD_RPC_OUT_OF_MEMORY,
    /* not allowed */
    SHEARD_RPC_OUTSIDE_ROOTS,
    SHEARD_RPC_NOT_READABLE,
    SHEARD_RPC_NOT_OWNER,
    SHEARD_RPC_NOT_ADMIN,
    SHEARD_RPC_PRIORITY_NOT_ALLOWED,
    SHEARD_RPC_ROOT_MISSING,
    /* not there, or not in that state */
    SHEARD_RPC_NO_SUCH_FILE,
    SHEARD_RPC_NOT_REGULAR,
    SHEARD_RPC_NO_SUCH_JOB,
    SHEARD_RPC_NO_SUCH_FIELD,
    SHEARD_RPC_WRONG_STATE,
    SHEARD_RPC_KEY_REUSED,
    SHEARD_RPC_BAD_CONFIG,
    SHEARD_RPC_FILE_TOO_LARGE,
    /* why a job failed: also libshear's own names (shear_code_name) */
    SHEARD_RPC_IO,
    SHEARD_RPC_BAD_FILE,
    SHEARD_RPC_BETA_TOO_SMALL,
    SHEARD_RPC_BAD_PSF,
    SHEARD_RPC_NEGATIVE_PIXELS,
    SHEARD_RPC_EXISTS,
    SHEARD_RPC_CANCELLED,
    SHEARD_RPC_FILE_VANISHED,
    SHEARD_RPC_FILE_CHANGED,
    SHEARD_RPC_READER_CRASHED,
    SHEARD_RPC_READER_TIMEOUT,
    SHEARD_RPC_READER_MEMORY,
    SHEARD_RPC_MEMORY_BUDGET,
    SHEARD_RPC_INTERNAL,
    /* seen by clients only */
    SHEARD_RPC_BAD_REPLY,
    SHEARD_RPC_UNKNOWN, /* a code that this version does not know: see its name */
    SHEARD_N_RPC_CODES
};

typedef struct sheard_rpc_code_info {
    const char *name; /* "queue_full": error.data.code, and code of a failed job */
    int number;       /* JSON-RPC's error.code */
    bool retry;       /* the same request may succeed later */
    int job_class;    /* enum sheard_job_class of a job that fails with it */
    const char *advice;
} sheard_rpc_code_info;

/* The entry of the table; that of SHEARD_RPC_UNKNOWN for what is no code. Never NULL. */
const sheard_rpc_code_info *sheard_rpc_code_get(int code);
/* By name; SHEARD_RPC_UNKNOWN where there is none. */
int sheard_rpc_code_find(const char *name);
/* For an enum shear_code of libshear, except SHEAR_OK, which is SHEARD_RPC_OK. */
int sheard_rpc_code_from_core(int core_code);

enum { SHEARD_RPC_NAME_SIZE = 48, SHEARD_RPC_PARAMETER_SIZE = 96 };

typedef struct sheard_rpc_error {
    int code;                                  /* enum sheard_rpc_code */
    int number;                                /* JSON-RPC's */
    bool retry;                                /* may succeed later */
    char name[SHEARD_RPC_NAME_SIZE];           /* the stable code as text */
    char parameter[SHEARD_RPC_PARAMETER_SIZE]; /* "galaxy.hdu", "ids[3]", "settings.beta"; or "" */
    char message[480];
    char advice[240];
} sheard_rpc_error;

/* Fill *error from the table and return `code`. `advice` NULL: the table's. */
int sheard_rpc_fail(sheard_rpc_error *error, int code, const char *advice, const char *format, ...)
    __attribute__((format(printf, 4, 5)));
/* The same from an error of libshear. */
int sheard_rpc_fail_core(sheard_rpc_error *error, const shear_error *core);

/* ---- Methods and notifications ---- */

enum sheard_method {
    SHEARD_METHOD_HELLO,
    SHEARD_METHOD_SUBMIT,
    SHEARD_METHOD_JOB,
    SHEARD_METHOD_JOBS,
    SHEARD_METHOD_WAIT,
    SHEARD_METHOD_CANCEL,
    SHEARD_METHOD_RETRY,
    SHEARD_METHOD_RETRACT,
    SHEARD_METHOD_FIELD,
    SHEARD_METHOD_FIELDS,
    SHEARD_METHOD_FORGET,
    SHEARD_METHOD_SUBSCRIBE,
    SHEARD_METHOD_UNSUBSCRIBE,
    SHEARD_METHOD_STATUS,
    SHEARD_METHOD_METRICS,
    SHEARD_METHOD_PROBE,
    SHEARD_METHOD_RELOAD,
    SHEARD_METHOD_DRAIN,
    SHEARD_METHOD_SHUTDOWN,
    SHEARD_N_METHODS
};
enum sheard_notice {
    SHEARD_NOTICE_JOB_CHANGED,
    SHEARD_NOTICE_JOB_PROGRESS,
    SHEARD_NOTICE_FIELD_CHANGED,
    SHEARD_NOTICE_SERVER_STATE,
    SHEARD_NOTICE_LOST,
    SHEARD_N_NOTICES
};
/* The name; NULL for what is none. */
const char *sheard_method_name(int method);
const char *sheard_notice_name(int notice);
int sheard_method_find(const char *name); /* -1: none */
bool sheard_method_needs_admin(int method);
/* All names, in order; *n becomes their number. Static. */
const char *const *sheard_method_names(size_t *n);

typedef union sheard_params {
    sheard_msg_hello hello;
    sheard_msg_submit submit;
    sheard_msg_id id; /* job, cancel, retry, retract */
    sheard_msg_jobs jobs;
    sheard_msg_wait wait;
    sheard_msg_field field;
    sheard_msg_fields fields;
    sheard_msg_forget forget;
    sheard_msg_subscribe subscribe; /* and unsubscribe */
    sheard_msg_shutdown shutdown;
} sheard_params;

typedef union sheard_reply {
    sheard_msg_welcome hello;
    sheard_msg_submitted submit;
    sheard_msg_shown job;
    sheard_msg_job_page jobs;
    sheard_msg_waited wait;
    sheard_msg_job cancel, retry, retract;
    sheard_msg_field_result field;
    sheard_msg_field_page fields;
    sheard_msg_forgotten forget;
    sheard_msg_subscribed subscribe, unsubscribe;
    sheard_msg_status status;
    sheard_msg_metrics metrics;
    sheard_msg_probed probe;
    sheard_msg_reloaded reload;
    sheard_msg_stopping drain, shutdown;
} sheard_reply;

typedef union sheard_notice_params {
    sheard_msg_job_changed job_changed;
    sheard_msg_job_progress job_progress;
    sheard_msg_field_changed field_changed;
    sheard_msg_stopping server_state;
    sheard_msg_lost lost;
} sheard_notice_params;

/* ---- Identity of a request ---- */

enum { SHEARD_RPC_ID_MAX = 128 }; /* bytes of a text */
enum sheard_rpc_id_type { SHEARD_ID_NULL = 0, SHEARD_ID_INTEGER, SHEARD_ID_TEXT };
typedef struct sheard_rpc_id {
    int type;
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
    int method;
    sheard_params params;
} sheard_request;

/* One line without its \n, `n` bytes. `defaults`: the settings that a submit's own are set upon, to
 * check them together (NULL: shear_settings_init). On an error the request is empty, with its id
 * where that could be known: reply with it. */
int sheard_request_parse(sheard_request *request, const char *line, size_t n,
                         const shear_settings *defaults, sheard_rpc_error *error);
void sheard_request_deinit(sheard_request *request); /* zeroed or deinited: fine */

/* `reply` is the member of `method`. What is not UTF-8 becomes U+FFFD. SHEARD_RPC_OUT_OF_MEMORY; or
 * SHEARD_RPC_INTERNAL: a raw JSON text in it is none. */
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
    int kind;
    sheard_rpc_id id;            /* of a reply or an error */
    sheard_rpc_error error;      /* of an error */
    int notice;                  /* of a notification; -1: one that this version does not know */
    sheard_notice_params params; /* of a notification */
    void *body;                  /* of a reply; see below */
} sheard_message;

/* One line from the daemon. SHEARD_RPC_BAD_REPLY where it is none of the three. Members that this
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
