/* SPDX-License-Identifier: GPL-3.0-or-later */
/* field_table.h: print a table of fields, one row each. */
#pragma once

#include "sheard/messages.h"
#include "terminal/text_table.h"

/* Return a new table of fields, and add rows to it. `now_ms` is the wall clock time, for ages. */
text_table *field_table_new(void);
void field_table_add(text_table *table, const sheard_msg_summary *field, int64_t now_ms);
