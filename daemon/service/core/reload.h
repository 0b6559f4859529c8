/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/core/reload.h: read the configuration again while the service runs. */
#pragma once

#include "sheard/messages.h"
#include "sheard/rpc.h"

typedef struct service service;

/* Read the configuration and apply it, all or nothing. Return SHEARD_RPC_OK, or
 * SHEARD_RPC_BAD_CONFIG: then the old one stays. Deinit *reply in either case. */
int reload_config(service *s, sheard_msg_reloaded *reply, sheard_rpc_error *error);
void reload_reply_deinit(sheard_msg_reloaded *reply);
/* Log a warning for each configured name that no user or group has. */
void reload_warn_names(const service *s);
