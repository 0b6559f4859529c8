/* SPDX-License-Identifier: GPL-3.0-or-later */
/* status_text.h: print the state of the service as text (status, watch). */
#pragma once

#include "sheard/messages.h"

#include <stdbool.h>
#include <stdio.h>

/* Print version, state, queue, workers and rates in a few lines, then problems that need attention.
 */
void status_text_brief(const sheard_msg_status *s, bool colours, FILE *out);
/* Write one of s->problems, with the time of the next attempt, into buf. Returns buf. */
char *status_text_problem(const sheard_msg_status *s, size_t i, char *buf, size_t size);
/* Print disks, connections and totals. */
void status_text_rest(const sheard_msg_status *s, bool utc, FILE *out);
