/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sf_table_advise: which columns there are. */
#include "fits/header/table.h"

#include "base/spelling.h"
#include "base/text.h"

void sf_table_advise(const sf_table *t, const char *name, char *out, size_t size) {
    spelling s = {.given = name};
    for (int i = 0; i < t->n && name[0] != '\0'; i++)
        spelling_consider(&s, t->columns[i].name);
    text_set(out, size, "");
    if (s.best != NULL)
        text_append(out, size, "did you mean %s? ", s.best);
    text_append(out, size, "columns:");
    const char *before = "";
    for (int i = 0; i < t->n; i++) {
        if (t->columns[i].name[0] != '\0') {
            text_append(out, size, "%s %s", before, t->columns[i].name);
            before = ",";
        }
    }
    sf_make_printable(out);
}
