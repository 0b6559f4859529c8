/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/core/reload.h: the configuration is read again while the service runs. */
#ifndef SHEARD_SERVICE_RELOAD_H
#define SHEARD_SERVICE_RELOAD_H

#include "sheard/messages.h"
#include "sheard/rpc.h"

typedef struct service service;

/* All or nothing. SHEARD_RPC_OK, or SHEARD_RPC_BAD_CONFIG: then the old one stays. */
int reload_config(service *s, sheard_msg_reloaded *reply, sheard_rpc_error *error);
void reload_reply_deinit(sheard_msg_reloaded *reply);
/* Log the configured names that are no user or group. */
void reload_warn_names(const service *s);

#endif
