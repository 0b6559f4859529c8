/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The one table of error codes. docs/protocol.md lists the same (a test compares them). */
#include "sheard/codes.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "base/text.h"

#define NONE      SHEARD_CLASS_NONE
#define TRANSIENT SHEARD_CLASS_TRANSIENT
#define DATA      SHEARD_CLASS_DATA
#define BUG       SHEARD_CLASS_BUG

/* name, JSON-RPC's number, may a client retry, class of a job that failed with it, advice */
static const sheard_rpc_code_info table[SHEARD_N_RPC_CODES] = {
    [SHEARD_RPC_OK] = {"ok", 0, false, NONE, ""},

    [SHEARD_RPC_PARSE_ERROR] = {"parse_error", -32700, false, NONE,
                                "send one JSON object in UTF-8 on each line"},
    [SHEARD_RPC_INVALID_REQUEST] = {"invalid_request", -32600, false, NONE,
                                    "send {\"jsonrpc\": \"2.0\", \"id\": ..., \"method\": ..., "
                                    "\"params\": {...}} and nothing else"},
    [SHEARD_RPC_UNKNOWN_METHOD] = {"unknown_method", -32601, false, NONE,
                                   "hello lists the methods; an older service may lack some"},
    [SHEARD_RPC_BATCH_UNSUPPORTED] = {"batch_unsupported", -32000, false, NONE,
                                      "send each request as a line of its own, without waiting for "
                                      "the reply to the one before"},
    [SHEARD_RPC_LINE_TOO_LONG] = {"line_too_long", -32001, false, NONE,
                                  "split the request; hello tells the limits"},
    [SHEARD_RPC_NUL_BYTE] = {"nul_byte", -32002, false, NONE, "send UTF-8 text without NUL bytes"},
    [SHEARD_RPC_TOO_COMPLEX] = {"too_complex", -32003, false, NONE,
                                "split the request; hello tells the limits"},
    [SHEARD_RPC_DUPLICATE_KEY] = {"duplicate_key", -32004, false, NONE, "give each member once"},
    [SHEARD_RPC_UNKNOWN_PARAMETER] = {"unknown_parameter", -32005, false, NONE,
                                      "check the spelling; docs/protocol.md lists the parameters"},
    [SHEARD_RPC_MISSING_PARAMETER] = {"missing_parameter", -32006, false, NONE,
                                      "add the parameter; docs/protocol.md lists them"},
    [SHEARD_RPC_BAD_PARAMETER] = {"bad_parameter", -32602, false, NONE,
                                  "correct the parameter; docs/protocol.md tells what it may be"},
    [SHEARD_RPC_BAD_SETTING] = {"bad_setting", -32007, false, DATA,
                                "shearctl help measure lists the settings and their values"},
    [SHEARD_RPC_BAD_CURSOR] =
        {"bad_cursor", -32008, false, NONE,
         "give the cursor of the page before, unchanged, with the same filter"},
    [SHEARD_RPC_UNSUPPORTED_VERSION] = {"unsupported_version", -32009, false, NONE,
                                        "use a client and a service of the same release"},

    [SHEARD_RPC_QUEUE_FULL] = {"queue_full", -32010, true, NONE,
                               "submit again when jobs have finished, or raise the queue's limit"},
    [SHEARD_RPC_DRAINING] = {"draining", -32011, true, NONE,
                             "submit again after the service has been restarted"},
    [SHEARD_RPC_STOPPING] = {"stopping", -32012, true, NONE,
                             "connect again after the service has been restarted"},
    [SHEARD_RPC_TOO_MANY_CONNECTIONS] = {"too_many_connections", -32013, true, NONE,
                                         "close connections that are not used, or try again later"},
    [SHEARD_RPC_TOO_MANY_REQUESTS] = {"too_many_requests", -32014, true, NONE,
                                      "read replies before sending more requests"},
    [SHEARD_RPC_TOO_MANY_SUBSCRIPTIONS] = {"too_many_subscriptions", -32015, false, NONE,
                                           "unsubscribe from something, or subscribe to all"},
    [SHEARD_RPC_IDLE_TIMEOUT] = {"idle_timeout", -32016, true, NONE,
                                 "connect again when there is something to ask"},
    [SHEARD_RPC_DISK_FULL] = {"disk_full", -32017, true, TRANSIENT,
                              "free space on the disk that the message names"},
    [SHEARD_RPC_STORE_FAILED] = {"store_failed", -32018, true, TRANSIENT,
                                 "look into the service's log and at the disk of its state"},
    [SHEARD_RPC_OUT_OF_MEMORY] = {"out_of_memory", -32019, true, TRANSIENT,
                                  "try again when the machine has more memory free"},

    [SHEARD_RPC_OUTSIDE_ROOTS] = {"outside_roots", -32020, false, DATA,
                                  "put the file beneath one of the data roots of sheard.conf"},
    [SHEARD_RPC_NOT_READABLE] = {"not_readable", -32021, false, DATA,
                                 "you and the service must both be allowed to read the file"},
    [SHEARD_RPC_NOT_OWNER] = {"not_owner", -32022, false, NONE,
                              "ask the job's owner or an administrator"},
    [SHEARD_RPC_NOT_ADMIN] = {"not_admin", -32023, false, NONE,
                              "ask an administrator of the service (admins in sheard.conf)"},
    [SHEARD_RPC_PRIORITY_NOT_ALLOWED] =
        {"priority_not_allowed", -32024, false, NONE,
         "leave the priority out, or ask an administrator for more"},
    [SHEARD_RPC_ROOT_MISSING] = {"root_missing", -32025, true, TRANSIENT,
                                 "mount the data root, or make it; accepted jobs wait for it"},

    [SHEARD_RPC_NO_SUCH_FILE] = {"no_such_file", -32030, false, DATA, "check the path"},
    [SHEARD_RPC_NOT_REGULAR] = {"not_regular", -32031, false, DATA,
                                "name a file, not a directory, pipe, device or symbolic link"},
    [SHEARD_RPC_NO_SUCH_JOB] = {"no_such_job", -32032, false, NONE,
                                "shearctl jobs lists the jobs; old ones are retired"},
    [SHEARD_RPC_NO_SUCH_FIELD] = {"no_such_field", -32033, false, NONE,
                                  "shearctl fields lists the fields"},
    [SHEARD_RPC_WRONG_STATE] = {"wrong_state", -32034, false, NONE,
                                "shearctl show tells the job's state"},
    [SHEARD_RPC_KEY_REUSED] = {"key_reused", -32035, false, NONE,
                               "use a new key for a new request"},
    [SHEARD_RPC_BAD_CONFIG] = {"bad_config", -32036, false, NONE,
                               "correct the file; the old configuration is still in force"},
    [SHEARD_RPC_FILE_TOO_LARGE] = {"file_too_large", -32037, false, DATA,
                                   "split the file, or have [reader] max_file_bytes raised"},

    [SHEARD_RPC_IO] = {"io", -32050, true, TRANSIENT, "look at the disk that the message names"},
    [SHEARD_RPC_BAD_FILE] = {"bad_file", -32051, false, DATA,
                             "shearctl validate tells what is wrong with the file"},
    [SHEARD_RPC_BETA_TOO_SMALL] = {"beta_too_small", -32052, false, DATA,
                                   "submit with a larger beta"},
    [SHEARD_RPC_BAD_PSF] = {"bad_psf", -32053, false, DATA, "correct the PSF image"},
    [SHEARD_RPC_NEGATIVE_PIXELS] = {"negative_pixels", -32054, false, DATA,
                                    "submit with a pedestal, or with another interpolation"},
    [SHEARD_RPC_EXISTS] = {"exists", -32055, false, DATA, "move the file that is in the way"},
    [SHEARD_RPC_CANCELLED] = {"cancelled", -32056, false, NONE,
                              "retry the job to run it after all"},
    [SHEARD_RPC_FILE_VANISHED] = {"file_vanished", -32058, false, TRANSIENT,
                                  "put the file back, and leave it until its job is done"},
    [SHEARD_RPC_FILE_CHANGED] = {"file_changed", -32059, false, TRANSIENT,
                                 "leave the file as it is until its job is done"},
    [SHEARD_RPC_READER_CRASHED] = {"reader_crashed", -32060, false, BUG,
                                   "keep the file and report it; shearctl validate may tell more"},
    [SHEARD_RPC_READER_TIMEOUT] =
        {"reader_timeout", -32061, false, BUG,
         "the file is damaged or its disk too slow; shearctl validate may "
         "tell more"},
    [SHEARD_RPC_MEMORY_BUDGET] = {"memory_budget", -32063, false, DATA,
                                  "cut smaller stamps, oversample less, or have [limits] memory "
                                  "raised"},
    [SHEARD_RPC_READER_MEMORY] = {"reader_memory", -32062, false, BUG,
                                  "the file is damaged, or raise the reader's limit of memory"},
    [SHEARD_RPC_INTERNAL] = {"internal", -32603, false, BUG, "please report this bug"},

    [SHEARD_RPC_BAD_REPLY] = {"bad_reply", -32098, false, NONE,
                              "use a client and a service of the same release"},
    [SHEARD_RPC_UNKNOWN] = {"unknown", -32099, false, NONE,
                            "use a client and a service of the same release"},
};

const sheard_rpc_code_info *sheard_rpc_code_get(int code) {
    return &table[code >= 0 && code < SHEARD_N_RPC_CODES ? code : SHEARD_RPC_UNKNOWN];
}

int sheard_rpc_code_find(const char *name) {
    for (int i = 0; i < SHEARD_N_RPC_CODES; i++) {
        if (strcmp(table[i].name, name) == 0) {
            return i;
        }
    }
    return SHEARD_RPC_UNKNOWN;
}

/* The names are the same by design. */
int sheard_rpc_code_from_core(int core_code) {
    const int code = sheard_rpc_code_find(shear_code_name(core_code));
    return code == SHEARD_RPC_UNKNOWN ? SHEARD_RPC_INTERNAL : code;
}

static void begin(sheard_rpc_error *error, int code, const char *advice) {
    const sheard_rpc_code_info *info = sheard_rpc_code_get(code);
    *error = (sheard_rpc_error){.code = code, .number = info->number, .retry = info->retry};
    text_set(error->name, sizeof error->name, info->name);
    text_set(error->advice, sizeof error->advice, advice != NULL ? advice : info->advice);
}

int sheard_rpc_fail(sheard_rpc_error *error, int code, const char *advice, const char *format,
                    ...) {
    begin(error, code, advice);
    va_list args;
    va_start(args, format);
    vsnprintf(error->message, sizeof error->message, format, args);
    va_end(args);
    return code;
}

int sheard_rpc_fail_parameter(sheard_rpc_error *error, int code, const char *parameter,
                              const char *advice, const char *format, ...) {
    begin(error, code, advice);
    text_set(error->parameter, sizeof error->parameter, parameter);
    const int used = snprintf(error->message, sizeof error->message, "'%.95s': ", parameter);
    va_list args;
    va_start(args, format);
    vsnprintf(error->message + used, sizeof error->message - (size_t)used, format, args);
    va_end(args);
    return code;
}

int sheard_rpc_fail_core(sheard_rpc_error *error, const shear_error *core) {
    return sheard_rpc_fail(error, sheard_rpc_code_from_core(core->code),
                           core->advice[0] != '\0' ? core->advice : NULL, "%s", core->message);
}
