/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/jobs/rpc_errors.h"

#include "access/access.h"
#include "service/jobs/job_source.h"
#include "spool/spool.h"
#include "store/store.h"

/* A table ends with the code SHEAR_OK, which stands for all others. */
typedef struct code_pair {
    int code, rpc;
} code_pair;

static const code_pair store_codes[] = {{STORE_QUEUE_FULL, SHEARD_RPC_QUEUE_FULL},
                                        {STORE_KEY_REUSED, SHEARD_RPC_KEY_REUSED},
                                        {STORE_NOT_FOUND, SHEARD_RPC_NO_SUCH_JOB},
                                        {STORE_WRONG_STATE, SHEARD_RPC_WRONG_STATE},
                                        {STORE_BAD_TEXT, SHEARD_RPC_BAD_PARAMETER},
                                        {SHEAR_E_IO, SHEARD_RPC_STORE_FAILED},
                                        {SHEAR_E_FULL, SHEARD_RPC_DISK_FULL},
                                        {SHEAR_E_NOMEM, SHEARD_RPC_OUT_OF_MEMORY},
                                        {SHEAR_OK, SHEARD_RPC_INTERNAL}};
static const code_pair access_codes[] = {{ACCESS_E_PATH, SHEARD_RPC_BAD_PARAMETER},
                                         {ACCESS_E_OUTSIDE, SHEARD_RPC_OUTSIDE_ROOTS},
                                         {ACCESS_E_NOT_FOUND, SHEARD_RPC_NO_SUCH_FILE},
                                         {ACCESS_E_DENIED, SHEARD_RPC_NOT_READABLE},
                                         {ACCESS_E_SERVICE, SHEARD_RPC_NOT_READABLE},
                                         {ACCESS_E_ROOT, SHEARD_RPC_ROOT_MISSING},
                                         {ACCESS_E_NOT_REGULAR, SHEARD_RPC_NOT_REGULAR},
                                         {JOB_SOURCE_E_TOO_LARGE, SHEARD_RPC_FILE_TOO_LARGE},
                                         {SHEAR_OK, SHEARD_RPC_IO}};
static const code_pair spool_codes[] = {{SPOOL_GONE, SHEARD_RPC_NO_SUCH_FILE},
                                        {SPOOL_REPLACED, SHEARD_RPC_FILE_CHANGED},
                                        {SPOOL_DENIED, SHEARD_RPC_NOT_READABLE},
                                        {SPOOL_NOT_REGULAR, SHEARD_RPC_NOT_REGULAR},
                                        {JOB_SOURCE_E_TOO_LARGE, SHEARD_RPC_FILE_TOO_LARGE},
                                        {SHEAR_OK, SHEARD_RPC_IO}};

static int find(const code_pair *table, int code) {
    while (table->code != code && table->code != SHEAR_OK)
        table++;
    return table->rpc;
}

int rpc_error_from_store(sheard_rpc_error *error, int code, const shear_error *err) {
    return code == SHEAR_OK
               ? SHEARD_RPC_OK
               : sheard_rpc_fail(error, find(store_codes, code), NULL, "%s", err->message);
}

int rpc_error_from_field(sheard_rpc_error *error, int code, const shear_error *err) {
    return code == STORE_NOT_FOUND
               ? sheard_rpc_fail(error, SHEARD_RPC_NO_SUCH_FIELD, NULL, "%s", err->message)
               : rpc_error_from_store(error, code, err);
}

int rpc_error_from_access(sheard_rpc_error *error, int code, const shear_error *err) {
    return code == SHEAR_OK ? SHEARD_RPC_OK : rpc_error_as(error, find(access_codes, code), err);
}

int rpc_error_from_spool(sheard_rpc_error *error, int code, const shear_error *err) {
    return code == SHEAR_OK ? SHEARD_RPC_OK : rpc_error_as(error, find(spool_codes, code), err);
}

int rpc_error_as(sheard_rpc_error *error, int rpc, const shear_error *err) {
    return sheard_rpc_fail(error, rpc, err->advice[0] != '\0' ? err->advice : NULL, "%s",
                           err->message);
}
