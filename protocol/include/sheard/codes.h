/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sheard/codes.h: the error codes of the service, in one table. Names, numbers and meanings never
 * change; docs/protocol.md lists them. */
#ifndef SHEARD_CODES_H
#define SHEARD_CODES_H

#include "shear/error.h"
#include "sheard/messages.h"

#include <stdbool.h>

/* All codes: the name of SHEARD_RPC_X, the code's name, JSON-RPC's number, whether a client may try
 * again, the class (enum sheard_job_class) of a job that fails with it, and advice. */
#define SHEARD_RPC_CODES(CODE)                                                                     \
    CODE(OK, ok, 0, false, NONE, "")                                                               \
    /* the line or the request is wrong */                                                         \
    CODE(PARSE_ERROR, parse_error, -32700, false, NONE,                                            \
         "send one JSON object in UTF-8 on each line")                                             \
    CODE(INVALID_REQUEST, invalid_request, -32600, false, NONE,                                    \
         "send {\"jsonrpc\": \"2.0\", \"id\": ..., \"method\": ..., \"params\": {...}} and "       \
         "nothing else")                                                                           \
    CODE(UNKNOWN_METHOD, unknown_method, -32601, false, NONE,                                      \
         "hello lists the methods; an older service may lack some")                                \
    CODE(BATCH_UNSUPPORTED, batch_unsupported, -32000, false, NONE,                                \
         "send each request as a line of its own, without waiting for the reply to the one "       \
         "before")                                                                                 \
    CODE(LINE_TOO_LONG, line_too_long, -32001, false, NONE,                                        \
         "split the request; hello reports the limits")                                            \
    CODE(NUL_BYTE, nul_byte, -32002, false, NONE, "send UTF-8 text without NUL bytes")             \
    CODE(TOO_COMPLEX, too_complex, -32003, false, NONE,                                            \
         "split the request; hello reports the limits")                                            \
    CODE(DUPLICATE_KEY, duplicate_key, -32004, false, NONE, "give each member once")               \
    CODE(UNKNOWN_PARAMETER, unknown_parameter, -32005, false, NONE,                                \
         "check the spelling; docs/protocol.md lists the parameters")                              \
    CODE(MISSING_PARAMETER, missing_parameter, -32006, false, NONE,                                \
         "add the parameter; docs/protocol.md lists them")                                         \
    CODE(BAD_PARAMETER, bad_parameter, -32602, false, NONE,                                        \
         "correct the parameter; docs/protocol.md says what it may be")                            \
    CODE(BAD_SETTING, bad_setting, -32007, false, DATA,                                            \
         "shearctl help measure lists the settings and their values")                              \
    CODE(BAD_CURSOR, bad_cursor, -32008, false, NONE,                                              \
         "give the cursor of the page before, unchanged, with the same filter")                    \
    CODE(UNSUPPORTED_VERSION, unsupported_version, -32009, false, NONE,                            \
         "use a client and a service of the same release")                                         \
    /* the service cannot accept it now */                                                         \
    CODE(QUEUE_FULL, queue_full, -32010, true, NONE,                                               \
         "submit again when jobs have finished, or raise the queue's limit")                       \
    CODE(DRAINING, draining, -32011, true, NONE,                                                   \
         "submit again after the service has been restarted")                                      \
    CODE(STOPPING, stopping, -32012, true, NONE,                                                   \
         "connect again after the service has been restarted")                                     \
    CODE(TOO_MANY_CONNECTIONS, too_many_connections, -32013, true, NONE,                           \
         "close connections that are not used, or try again later")                                \
    CODE(TOO_MANY_REQUESTS, too_many_requests, -32014, true, NONE,                                 \
         "read replies before sending more requests")                                              \
    CODE(TOO_MANY_SUBSCRIPTIONS, too_many_subscriptions, -32015, false, NONE,                      \
         "unsubscribe from something, or subscribe to all")                                        \
    CODE(IDLE_TIMEOUT, idle_timeout, -32016, true, NONE,                                           \
         "connect again when there is something to ask")                                           \
    CODE(DISK_FULL, disk_full, -32017, true, TRANSIENT,                                            \
         "free space on the disk that the message names")                                          \
    CODE(STORE_FAILED, store_failed, -32018, true, TRANSIENT,                                      \
         "look into the service's log and at the disk of its state")                               \
    CODE(OUT_OF_MEMORY, out_of_memory, -32019, true, TRANSIENT,                                    \
         "try again when the machine has more memory free")                                        \
    /* not allowed */                                                                              \
    CODE(OUTSIDE_ROOTS, outside_roots, -32020, false, DATA,                                        \
         "put the file beneath one of the data roots of sheard.conf")                              \
    CODE(NOT_READABLE, not_readable, -32021, false, DATA,                                          \
         "you and the service must both be allowed to read the file")                              \
    CODE(NOT_OWNER, not_owner, -32022, false, NONE, "ask the job's owner or an administrator")     \
    CODE(NOT_ADMIN, not_admin, -32023, false, NONE,                                                \
         "ask an administrator of the service (admins in sheard.conf)")                            \
    CODE(PRIORITY_NOT_ALLOWED, priority_not_allowed, -32024, false, NONE,                          \
         "leave the priority out, or ask an administrator for more")                               \
    CODE(ROOT_MISSING, root_missing, -32025, true, TRANSIENT,                                      \
         "mount or create the data root; accepted jobs wait for it")                               \
    /* it does not exist, or is not in that state */                                               \
    CODE(NO_SUCH_FILE, no_such_file, -32030, false, DATA, "check the path")                        \
    CODE(NOT_REGULAR, not_regular, -32031, false, DATA,                                            \
         "name a file, not a directory, pipe, device or symbolic link")                            \
    CODE(NO_SUCH_JOB, no_such_job, -32032, false, NONE,                                            \
         "shearctl jobs lists the jobs; old ones are retired")                                     \
    CODE(NO_SUCH_FIELD, no_such_field, -32033, false, NONE, "shearctl fields lists the fields")    \
    CODE(WRONG_STATE, wrong_state, -32034, false, NONE, "shearctl show reports the job's state")   \
    CODE(KEY_REUSED, key_reused, -32035, false, NONE, "use a new key for a new request")           \
    CODE(BAD_CONFIG, bad_config, -32036, false, NONE,                                              \
         "correct the file; the old configuration is still in force")                              \
    CODE(FILE_TOO_LARGE, file_too_large, -32037, false, DATA,                                      \
         "split the file, or have [reader] max_file_bytes raised")                                 \
    /* reasons why a job failed, with libshear's own names (shear_code_name) */                    \
    CODE(IO, io, -32050, true, TRANSIENT, "look at the disk that the message names")               \
    CODE(BAD_FILE, bad_file, -32051, false, DATA,                                                  \
         "shearctl validate shows what is wrong with the file")                                    \
    CODE(BETA_TOO_SMALL, beta_too_small, -32052, false, DATA, "submit with a larger beta")         \
    CODE(BAD_PSF, bad_psf, -32053, false, DATA, "correct the PSF image")                           \
    CODE(NEGATIVE_PIXELS, negative_pixels, -32054, false, DATA,                                    \
         "submit with a pedestal, or with another interpolation")                                  \
    CODE(EXISTS, exists, -32055, false, DATA, "move the file that is in the way")                  \
    CODE(CANCELLED, cancelled, -32056, false, NONE, "retry the job to run it after all")           \
    CODE(FILE_VANISHED, file_vanished, -32058, false, TRANSIENT,                                   \
         "put the file back, and leave it until its job is done")                                  \
    CODE(FILE_CHANGED, file_changed, -32059, false, TRANSIENT,                                     \
         "leave the file as it is until its job is done")                                          \
    CODE(READER_CRASHED, reader_crashed, -32060, false, BUG,                                       \
         "keep the file and report it; shearctl validate may show more")                           \
    CODE(READER_TIMEOUT, reader_timeout, -32061, false, BUG,                                       \
         "the file is damaged or its disk too slow; shearctl validate may show more")              \
    CODE(READER_MEMORY, reader_memory, -32062, false, BUG,                                         \
         "the file is damaged, or raise the reader's limit of memory")                             \
    CODE(MEMORY_BUDGET, memory_budget, -32063, false, DATA,                                        \
         "cut smaller stamps, oversample less, or have [limits] memory raised")                    \
    CODE(INTERNAL, internal, -32603, false, BUG, "please report this bug")                         \
    /* set by clients only */                                                                      \
    CODE(BAD_REPLY, bad_reply, -32098, false, NONE,                                                \
         "use a client and a service of the same release")                                         \
    CODE(UNKNOWN, unknown, -32099, false, NONE, "use a client and a service of the same release")

enum sheard_rpc_code {
#define CODE(NAME, name, number, retry, CLASS, advice) SHEARD_RPC_##NAME,
    SHEARD_RPC_CODES(CODE)
#undef CODE
        SHEARD_N_RPC_CODES
};

typedef struct sheard_rpc_code_info {
    const char *name;                /* "queue_full": error.data.code, and code of a failed job */
    int number;                      /* JSON-RPC's error.code */
    bool retry;                      /* the same request may succeed later */
    enum sheard_job_class job_class; /* of a job that fails with it */
    const char *advice;
} sheard_rpc_code_info;

/* Return the entry of a code, or that of SHEARD_RPC_UNKNOWN for any other number. Never NULL. */
const sheard_rpc_code_info *sheard_rpc_code_get(int code);
/* Return the code of that name, or SHEARD_RPC_UNKNOWN if there is none. */
int sheard_rpc_code_find(const char *name);
/* Return the code for an enum shear_code of libshear. SHEAR_OK gives SHEARD_RPC_OK. */
int sheard_rpc_code_from_core(int core_code);

enum { SHEARD_RPC_NAME_SIZE = 48, SHEARD_RPC_PARAMETER_SIZE = 96 };

typedef struct sheard_rpc_error {
    int code;                                  /* enum sheard_rpc_code */
    int number;                                /* JSON-RPC's */
    bool retry;                                /* the same request may succeed later */
    char name[SHEARD_RPC_NAME_SIZE];           /* the code's name */
    char parameter[SHEARD_RPC_PARAMETER_SIZE]; /* "galaxy.hdu", "ids[3]", "settings.beta"; or "" */
    char message[480];
    char advice[240];
} sheard_rpc_error;

/* Fill *error from the table and return `code`. If `advice` is NULL, the table's is used. */
int sheard_rpc_fail(sheard_rpc_error *error, int code, const char *advice, const char *format, ...)
    __attribute__((format(printf, 4, 5)));
/* The same, with the name of the wrong parameter. The message is "'PARAMETER': MESSAGE". */
int sheard_rpc_fail_parameter(sheard_rpc_error *error, int code, const char *parameter,
                              const char *advice, const char *format, ...)
    __attribute__((format(printf, 5, 6)));
/* The same, from an error of libshear. */
int sheard_rpc_fail_core(sheard_rpc_error *error, const shear_error *core);

#endif
