/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "store/sql.h"

#define SQL_TEXT(name, text) [name] = (text),
const char *const sql_texts[SQL_N] = {SQL_STATEMENTS(SQL_TEXT)};
