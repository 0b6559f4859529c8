/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sheard/codes.h: the errors of the service. Their one table is in message/codes.c; names, numbers
 * and meanings never change, and docs/protocol.md lists them. */
#ifndef SHEARD_CODES_H
#define SHEARD_CODES_H

#include <stdbool.h>

#include "shear/error.h"
#include "sheard/messages.h"

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
    const char *name;                /* "queue_full": error.data.code, and code of a failed job */
    int number;                      /* JSON-RPC's error.code */
    bool retry;                      /* the same request may succeed later */
    enum sheard_job_class job_class; /* of a job that fails with it */
    const char *advice;
} sheard_rpc_code_info;

/* The entry of the table; that of SHEARD_RPC_UNKNOWN for any other number. Never NULL. */
const sheard_rpc_code_info *sheard_rpc_code_get(int code);
/* By name; SHEARD_RPC_UNKNOWN if there is none. */
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
/* The same with the parameter that is wrong: "'PARAMETER': MESSAGE". */
int sheard_rpc_fail_parameter(sheard_rpc_error *error, int code, const char *parameter,
                              const char *advice, const char *format, ...)
    __attribute__((format(printf, 5, 6)));
/* The same from an error of libshear. */
int sheard_rpc_fail_core(sheard_rpc_error *error, const shear_error *core);

#endif
