/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/rpc/field_message.h: a field as the protocol tells it. `since`: see fields/estimates.h.
 */
#ifndef SHEARD_SERVICE_FIELD_MESSAGE_H
#define SHEARD_SERVICE_FIELD_MESSAGE_H

#include "service/fields/no_result.h"
#include "sheard/messages.h"
#include "store/store.h"

typedef struct service service;

/* A row of a field, with `counted`, the contributions that are to be listed. *why is begun, for the
 * row's reason and culprit, which are left out. Texts of f and `counted` are borrowed; deinit it.
 */
int field_to_message(service *s, const store_field *f, int64_t since,
                     const store_contribution_page *counted, sheard_msg_field_row *out,
                     no_result *why, shear_error *err);
void field_message_deinit(sheard_msg_field_row *out);
/* All texts are borrowed. */
void field_to_summary(service *s, const store_field *f, int64_t since, sheard_msg_summary *out);
/* For the change notifier: tell those who watch the field. */
void field_message_publish(service *s, const store_field *f, bool mixed, int64_t since);

#endif
