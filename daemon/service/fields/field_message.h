/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/fields/field_message.h: a field as a message of the protocol. `since`: see
 * fields/estimates.h. */
#pragma once

#include "service/fields/no_result.h"
#include "sheard/messages.h"
#include "store/store.h"

typedef struct service service;

/* Fill *out from a field, with `counted` as its list of contributions. The reason and the culprit
 * are left out; *why is initialized to find them. Texts of f and `counted` are borrowed. Deinit
 * *out. */
int field_to_message(service *s, const store_field *f, int64_t since,
                     const store_contribution_page *counted, sheard_msg_field_row *out,
                     no_result *why, shear_error *err);
void field_message_deinit(sheard_msg_field_row *out);
/* Fill *out; all texts are borrowed. */
void field_to_summary(service *s, const store_field *f, int64_t since, sheard_msg_summary *out);
/* Publish the field to subscribers. `mixed`: it also has results by other settings. A field without
 * contributions is gone. */
void field_message_publish(service *s, const store_field *f, bool mixed, int64_t since);
