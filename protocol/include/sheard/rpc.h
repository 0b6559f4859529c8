/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sheard/rpc.h: JSON-RPC 2.0 lines to the structs of sheard/messages.h and back, for the daemon and
 * its clients alike. docs/protocol.md is normative.
 *
 * Functions return 0 or an enum shear_rpc_code, which is then also in *error (never NULL). Lines
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
enum shear_rpc_code {
    SHEAR_RPC_OK = 0,
    /* the line or the request is wrong */
    SHEAR_RPC_PARSE_ERROR,
    SHEAR_RPC_INVALID_REQUEST,
    SHEAR_RPC_UNKNOWN_METHOD,
    SHEAR_RPC_BATCH_UNSUPPORTED,
    SHEAR_RPC_LINE_TOO_LONG,
    SHEAR_RPC_NUL_BYTE,
    SHEAR_RPC_TOO_COMPLEX,
    SHEAR_RPC_DUPLICATE_KEY,
    SHEAR_RPC_UNKNOWN_PARAMETER,
    SHEAR_RPC_MISSING_PARAMETER,
    SHEAR_RPC_BAD_PARAMETER,
    SHEAR_RPC_BAD_SETTING,
    SHEAR_RPC_BAD_CURSOR,
    SHEAR_RPC_UNSUPPORTED_VERSION,
    /* the service cannot take it now */
    SHEAR_RPC_QUEUE_FULL,
    SHEAR_RPC_DRAINING,
    SHEAR_RPC_STOPPING,
    SHEAR_RPC_TOO_MANY_CONNECTIONS,
    SHEAR_RPC_TOO_MANY_REQUESTS,
    SHEAR_RPC_TOO_MANY_SUBSCRIPTIONS,
    SHEAR_RPC_IDLE_TIMEOUT,
    SHEAR_RPC_DISK_FULL,
    SHEAR_RPC_STORE_FAILED,
    SHEAR_RPC_OUT_OF_MEMORY,
    /* not allowed */
    SHEAR_RPC_OUTSIDE_ROOTS,
    SHEAR_RPC_NOT_READABLE,
    SHEAR_RPC_NOT_OWNER,
    SHEAR_RPC_NOT_ADMIN,
    SHEAR_RPC_PRIORITY_NOT_ALLOWED,
    SHEAR_RPC_ROOT_MISSING,
    /* not there, or not in that state */
    SHEAR_RPC_NO_SUCH_FILE,
    SHEAR_RPC_NOT_REGULAR,
    SHEAR_RPC_NO_SUCH_JOB,
    SHEAR_RPC_NO_SUCH_FIELD,
    SHEAR_RPC_WRONG_STATE,
    SHEAR_RPC_KEY_REUSED,
    SHEAR_RPC_BAD_CONFIG,
    SHEAR_RPC_FILE_TOO_LARGE,
    /* why a job failed: also libshear's own names (shear_code_name) */
    SHEAR_RPC_IO,
    SHEAR_RPC_BAD_FILE,
    SHEAR_RPC_BETA_TOO_SMALL,
    SHEAR_RPC_BAD_PSF,
    SHEAR_RPC_NEGATIVE_PIXELS,
    SHEAR_RPC_EXISTS,
    SHEAR_RPC_CANCELLED,
    SHEAR_RPC_FILE_VANISHED,
    SHEAR_RPC_FILE_CHANGED,
    SHEAR_RPC_READER_CRASHED,
    SHEAR_RPC_READER_TIMEOUT,
    SHEAR_RPC_READER_MEMORY,
    SHEAR_RPC_MEMORY_BUDGET,
    SHEAR_RPC_INTERNAL,
    /* seen by clients only */
    SHEAR_RPC_BAD_REPLY,
    SHEAR_RPC_UNKNOWN, /* a code that this version does not know: see its name */
    SHEAR_N_RPC_CODES
};

typedef struct shear_rpc_code_info {
    const char *name; /* "queue_full": error.data.code, and code of a failed job */
    int number;       /* JSON-RPC's error.code */
    bool retry;       /* the same request may succeed later */
    int job_class;    /* enum shear_job_class of a job that fails with it */
    const char *advice;
} shear_rpc_code_info;

/* The entry of the table; that of SHEAR_RPC_UNKNOWN for what is no code. Never NULL. */
const shear_rpc_code_info *shear_rpc_code_get(int code);
/* By name; SHEAR_RPC_UNKNOWN where there is none. */
int shear_rpc_code_find(const char *name);
/* For an enum shear_code of libshear, except SHEAR_OK, which is SHEAR_RPC_OK. */
int shear_rpc_code_from_core(int core_code);

enum { SHEAR_RPC_NAME_SIZE = 48, SHEAR_RPC_PARAMETER_SIZE = 96 };

typedef struct shear_rpc_error {
    int code;                                 /* enum shear_rpc_code */
    int number;                               /* JSON-RPC's */
    bool retry;                               /* may succeed later */
    char name[SHEAR_RPC_NAME_SIZE];           /* the stable code as text */
    char parameter[SHEAR_RPC_PARAMETER_SIZE]; /* "galaxy.hdu", "ids[3]", "settings.beta"; or "" */
    char message[480];
    char advice[240];
} shear_rpc_error;

/* Fill *error from the table and return `code`. `advice` NULL: the table's. */
int shear_rpc_fail(shear_rpc_error *error, int code, const char *advice, const char *format, ...)
    __attribute__((format(printf, 4, 5)));
/* The same from an error of libshear. */
int shear_rpc_fail_core(shear_rpc_error *error, const shear_error *core);

/* ---- Methods and notifications ---- */

enum shear_method {
    SHEAR_METHOD_HELLO,
    SHEAR_METHOD_SUBMIT,
    SHEAR_METHOD_JOB,
    SHEAR_METHOD_JOBS,
    SHEAR_METHOD_WAIT,
    SHEAR_METHOD_CANCEL,
    SHEAR_METHOD_RETRY,
    SHEAR_METHOD_RETRACT,
    SHEAR_METHOD_FIELD,
    SHEAR_METHOD_FIELDS,
    SHEAR_METHOD_FORGET,
    SHEAR_METHOD_SUBSCRIBE,
    SHEAR_METHOD_UNSUBSCRIBE,
    SHEAR_METHOD_STATUS,
    SHEAR_METHOD_METRICS,
    SHEAR_METHOD_PROBE,
    SHEAR_METHOD_RELOAD,
    SHEAR_METHOD_DRAIN,
    SHEAR_METHOD_SHUTDOWN,
    SHEAR_N_METHODS
};
enum shear_notice {
    SHEAR_NOTICE_JOB_CHANGED,
    SHEAR_NOTICE_JOB_PROGRESS,
    SHEAR_NOTICE_FIELD_CHANGED,
    SHEAR_NOTICE_SERVER_STATE,
    SHEAR_NOTICE_LOST,
    SHEAR_N_NOTICES
};
/* The name; NULL for what is none. */
const char *shear_method_name(int method);
const char *shear_notice_name(int notice);
int shear_method_find(const char *name); /* -1: none */
bool shear_method_needs_admin(int method);
/* All names, in order; *n becomes their number. Static. */
const char *const *shear_method_names(size_t *n);

typedef union shear_params {
    shear_msg_hello hello;
    shear_msg_submit submit;
    shear_msg_id id; /* job, cancel, retry, retract */
    shear_msg_jobs jobs;
    shear_msg_wait wait;
    shear_msg_field field;
    shear_msg_fields fields;
    shear_msg_forget forget;
    shear_msg_subscribe subscribe; /* and unsubscribe */
    shear_msg_shutdown shutdown;
} shear_params;

typedef union shear_reply {
    shear_msg_welcome hello;
    shear_msg_submitted submit;
    shear_msg_shown job;
    shear_msg_job_page jobs;
    shear_msg_waited wait;
    shear_msg_job cancel, retry, retract;
    shear_msg_field_result field;
    shear_msg_field_page fields;
    shear_msg_forgotten forget;
    shear_msg_subscribed subscribe, unsubscribe;
    shear_msg_status status;
    shear_msg_metrics metrics;
    shear_msg_probed probe;
    shear_msg_reloaded reload;
    shear_msg_stopping drain, shutdown;
} shear_reply;

typedef union shear_notice_params {
    shear_msg_job_changed job_changed;
    shear_msg_job_progress job_progress;
    shear_msg_field_changed field_changed;
    shear_msg_stopping server_state;
    shear_msg_lost lost;
} shear_notice_params;

/* ---- Identity of a request ---- */

enum { SHEAR_RPC_ID_MAX = 128 }; /* bytes of a text */
enum shear_rpc_id_type { SHEAR_ID_NULL = 0, SHEAR_ID_INTEGER, SHEAR_ID_TEXT };
typedef struct shear_rpc_id {
    int type;
    int64_t integer;
    char text[SHEAR_RPC_ID_MAX + 1];
} shear_rpc_id;
bool shear_rpc_id_equal(const shear_rpc_id *a, const shear_rpc_id *b);

/* ---- The daemon's side ---- */

/* What a line may hold at most, whatever its method. */
typedef struct shear_rpc_limits {
    size_t line;   /* bytes */
    int depth;     /* of arrays and objects in each other; the outermost object is 1 */
    size_t values; /* members, elements and names */
    size_t text;   /* bytes of a string as written, between its quotes */
} shear_rpc_limits;
extern const shear_rpc_limits shear_rpc_request_limits; /* 64 KiB, 8, 4096, 32 KiB */
extern const shear_rpc_limits shear_rpc_reply_limits;   /* 32 MiB, 16, 4 million, 32 MiB */

typedef struct shear_request {
    shear_rpc_id id;
    int method;
    shear_params params;
} shear_request;

/* One line without its \n, `n` bytes. `defaults`: the settings that a submit's own are set upon, to
 * check them together (NULL: shear_settings_init). On an error the request is empty, with its id
 * where that could be known: reply with it. */
int shear_request_parse(shear_request *request, const char *line, size_t n,
                        const shear_settings *defaults, shear_rpc_error *error);
void shear_request_deinit(shear_request *request); /* zeroed or deinited: fine */

/* `reply` is the member of `method`. What is not UTF-8 becomes U+FFFD. SHEAR_RPC_OUT_OF_MEMORY; or
 * SHEAR_RPC_INTERNAL: a raw JSON text in it is none. */
int shear_reply_line(char **line, size_t *n, const shear_rpc_id *id, int method,
                     const shear_reply *reply, shear_rpc_error *error);
/* The same, made item by item: the text of an item of the one list in replies of `method` (jobs of
 * `jobs` and `wait`, fields of `fields`, rows of `field`), without a newline; and the reply `rest`,
 * whose list is empty, with items[n_items] in it: such texts, with commas between them. The bytes
 * are those of shear_reply_line. */
int shear_reply_item(char **text, size_t *n, int method, const void *item, shear_rpc_error *error);
int shear_reply_list_line(char **line, size_t *n, const shear_rpc_id *id, int method,
                          const shear_reply *rest, const char *items, size_t n_items,
                          shear_rpc_error *error);
/* SHEAR_RPC_OUT_OF_MEMORY: *line is NULL; then shear_rpc_no_memory_line may be sent. */
int shear_error_line(char **line, size_t *n, const shear_rpc_id *id, const shear_rpc_error *what);
extern const char shear_rpc_no_memory_line[]; /* id null */
int shear_notice_line(char **line, size_t *n, int notice, const shear_notice_params *params,
                      shear_rpc_error *error);

/* ---- The client's side ---- */

/* `params` may be NULL for a method without. It is checked as the daemon checks it, but for
 * settings together; what is at its default is left out. SHEAR_RPC_BAD_PARAMETER and its kin, as
 * from the daemon. */
int shear_request_line(char **line, size_t *n, const shear_rpc_id *id, int method,
                       const shear_params *params, shear_rpc_error *error);
/* The params with every member at its default. */
void shear_params_init(shear_params *params, int method);

enum shear_message_kind { SHEAR_MESSAGE_REPLY, SHEAR_MESSAGE_ERROR, SHEAR_MESSAGE_NOTICE };
typedef struct shear_message {
    int kind;
    shear_rpc_id id;            /* of a reply or an error */
    shear_rpc_error error;      /* of an error */
    int notice;                 /* of a notification; -1: one that this version does not know */
    shear_notice_params params; /* of a notification */
    void *body;                 /* of a reply; see below */
} shear_message;

/* One line from the daemon. SHEAR_RPC_BAD_REPLY where it is none of the three. Members that this
 * version does not know are passed over. */
int shear_message_parse(shear_message *message, const char *line, size_t n, shear_rpc_error *error);
void shear_message_deinit(shear_message *message);
/* A reply as the result of `method`; *reply outlives the message. SHEAR_RPC_BAD_REPLY. */
int shear_message_reply(const shear_message *message, int method, shear_reply *reply,
                        shear_rpc_error *error);
void shear_reply_deinit(shear_reply *reply, int method); /* zeroed: fine */
/* A reply as it came, one line of JSON without \n, for --json. */
int shear_message_text(const shear_message *message, char **text, shear_rpc_error *error);

/* ---- Files and texts ---- */

/* A job file: the object that is `submit`'s params, in any layout, `n` bytes. */
int shear_job_file_parse(shear_msg_submit *submit, const char *text, size_t n,
                         const shear_settings *defaults, shear_rpc_error *error);
void shear_submit_deinit(shear_msg_submit *submit);

/* A source as one line of JSON (the store keeps it), and back. */
int shear_source_text(char **text, const shear_msg_source *source, shear_rpc_error *error);
int shear_source_parse(shear_msg_source *source, const char *text, shear_rpc_error *error);
void shear_source_deinit(shear_msg_source *source);

/* The file beside an input, for people and programs: indented, with \n at its end. */
int shear_side_text(char **text, const shear_msg_side *side, shear_rpc_error *error);
int shear_side_parse(shear_msg_side *side, const char *text, size_t n, shear_rpc_error *error);
void shear_side_deinit(shear_msg_side *side);

#endif
