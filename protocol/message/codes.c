/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Look up error codes and fill in errors. The table itself is SHEARD_RPC_CODES; a test compares it
 * with docs/protocol.md. */
#include "sheard/codes.h"

#include "base/text.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static const sheard_rpc_code_info table[SHEARD_N_RPC_CODES] = {
#define CODE(NAME, name, number, retry, CLASS, advice)                                             \
    {#name, number, retry, SHEARD_CLASS_##CLASS, advice},
    SHEARD_RPC_CODES(CODE)
#undef CODE
};

const sheard_rpc_code_info *sheard_rpc_code_get(int code) {
    return &table[code >= 0 && code < SHEARD_N_RPC_CODES ? code : SHEARD_RPC_UNKNOWN];
}

int sheard_rpc_code_find(const char *name) {
    for (int i = 0; i < SHEARD_N_RPC_CODES; i++) {
        if (strcmp(table[i].name, name) == 0)
            return i;
    }
    return SHEARD_RPC_UNKNOWN;
}

/* libshear's codes have the same names by design. */
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
