/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/jobs/rpc_errors.h"

#include "access/access.h"
#include "service/jobs/job_source.h"
#include "store/store.h"

typedef struct code_pair {
    int code, rpc;
} code_pair;

static const code_pair store_codes[] = {
    {STORE_QUEUE_FULL, SHEARD_RPC_QUEUE_FULL},  {STORE_KEY_REUSED, SHEARD_RPC_KEY_REUSED},
    {STORE_NOT_FOUND, SHEARD_RPC_NO_SUCH_JOB},  {STORE_WRONG_STATE, SHEARD_RPC_WRONG_STATE},
    {STORE_BAD_TEXT, SHEARD_RPC_BAD_PARAMETER}, {SHEAR_E_IO, SHEARD_RPC_STORE_FAILED},
    {SHEAR_E_FULL, SHEARD_RPC_DISK_FULL},       {SHEAR_E_NOMEM, SHEARD_RPC_OUT_OF_MEMORY},
};
static const code_pair access_codes[] = {
    {ACCESS_E_PATH, SHEARD_RPC_BAD_PARAMETER},
    {ACCESS_E_OUTSIDE, SHEARD_RPC_OUTSIDE_ROOTS},
    {ACCESS_E_NOT_FOUND, SHEARD_RPC_NO_SUCH_FILE},
    {ACCESS_E_DENIED, SHEARD_RPC_NOT_READABLE},
    {ACCESS_E_SERVICE, SHEARD_RPC_NOT_READABLE},
    {ACCESS_E_ROOT, SHEARD_RPC_ROOT_MISSING},
    {ACCESS_E_NOT_REGULAR, SHEARD_RPC_NOT_REGULAR},
    {JOB_SOURCE_E_TOO_LARGE, SHEARD_RPC_FILE_TOO_LARGE},
};

static int find(const code_pair *table, size_t n, int code, int otherwise) {
    for (size_t i = 0; i < n; i++) {
        if (table[i].code == code)
            return table[i].rpc;
    }
    return otherwise;
}

int rpc_error_from_store(sheard_rpc_error *error, int code, const shear_error *err) {
    const size_t n = sizeof store_codes / sizeof *store_codes;
    return sheard_rpc_fail(error, find(store_codes, n, code, SHEARD_RPC_INTERNAL), NULL, "%s",
                           err->message);
}

int rpc_error_from_access(sheard_rpc_error *error, int code, const shear_error *err) {
    const size_t n = sizeof access_codes / sizeof *access_codes;
    return rpc_error_as(error, find(access_codes, n, code, SHEARD_RPC_IO), err);
}

int rpc_error_as(sheard_rpc_error *error, int rpc, const shear_error *err) {
    return sheard_rpc_fail(error, rpc, err->advice[0] != '\0' ? err->advice : NULL, "%s",
                           err->message);
}
