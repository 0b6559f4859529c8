/* SPDX-License-Identifier: GPL-3.0-or-later */
/* status_text.h: the state of the service for people, in lines (status, watch). */
#ifndef CLIENT_REMOTE_STATUS_TEXT_H
#define CLIENT_REMOTE_STATUS_TEXT_H

#include "sheard/messages.h"

#include <stdbool.h>
#include <stdio.h>

/* Version, state, queue, workers and rates: a few lines; then what an operator should look at. */
void status_text_brief(const sheard_msg_status *s, bool colours, FILE *out);
/* One of s->problems, with when it is tried again. */
char *status_text_problem(const sheard_msg_status *s, size_t i, char *buf, size_t size);
/* What drain and shutdown are answered. */
void status_text_stopping(const sheard_msg_stopping *s, FILE *out);
/* Disks, connections and totals. */
void status_text_rest(const sheard_msg_status *s, bool utc, FILE *out);

#endif
