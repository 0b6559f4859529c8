/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/jobs/rpc_errors.h: convert errors of the store and of opening files into errors of the
 * protocol. `code` is the failed call's, which *err describes. All return the protocol's code, or
 * SHEARD_RPC_OK, with *error unchanged, if `code` is SHEAR_OK. */
#pragma once

#include "shear/error.h"
#include "sheard/rpc.h"

int rpc_error_from_store(sheard_rpc_error *error, int code, const shear_error *err);
/* The same of a call whose STORE_NOT_FOUND means a field. */
int rpc_error_from_field(sheard_rpc_error *error, int code, const shear_error *err);
/* From an error of access/access.h or jobs/job_source.h. */
int rpc_error_from_access(sheard_rpc_error *error, int code, const shear_error *err);
/* From an error of spool/spool.h or jobs/job_source.h. */
int rpc_error_from_spool(sheard_rpc_error *error, int code, const shear_error *err);
/* Fill *error with the protocol's code `rpc` and the message and advice of *err. */
int rpc_error_as(sheard_rpc_error *error, int rpc, const shear_error *err);
