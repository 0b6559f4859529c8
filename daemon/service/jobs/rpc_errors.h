/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/jobs/rpc_errors.h: convert errors of the store and of opening files into errors of the
 * protocol. */
#pragma once

#include "shear/error.h"
#include "sheard/rpc.h"

/* Fill *error from an error of the store. Like the others, return the protocol's code. */
int rpc_error_from_store(sheard_rpc_error *error, int code, const shear_error *err);
/* Fill *error from an error of access/access.h or jobs/job_source.h. */
int rpc_error_from_access(sheard_rpc_error *error, int code, const shear_error *err);
/* Fill *error with the protocol's code `rpc` and the message and advice of *err. */
int rpc_error_as(sheard_rpc_error *error, int rpc, const shear_error *err);
