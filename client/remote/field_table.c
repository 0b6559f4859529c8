/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "remote/field_table.h"

#include "terminal/human.h"
#include "terminal/style.h"

#include <inttypes.h>

text_table *field_table_new(void) {
    static const text_column columns[] = {{"FIELD", 'l'},   {"G1", 'l'},      {"G2", 'l'},
                                          {"USED", 'r'},    {"OF", 'r'},      {"JOBS", 'r'},
                                          {"TO COME", 'r'}, {"UPDATED", 'r'}, {"NOTE", 'l'}};
    return text_table_new(columns, sizeof columns / sizeof *columns);
}

void field_table_add(text_table *t, const sheard_msg_summary *f, int64_t now_ms) {
    char text[96];
    char age[HUMAN_SIZE];
    text_table_cell(t, NULL, "%s", f->field);
    text_table_cell(t, NULL, "%s", human_value(f->g1, f->g1_err, text, sizeof text));
    text_table_cell(t, NULL, "%s", human_value(f->g2, f->g2_err, text, sizeof text));
    text_table_cell(t, NULL, "%" PRId64, f->n_used);
    text_table_cell(t, NULL, "%" PRId64, f->n_stamps);
    text_table_cell(t, NULL, "%" PRId64, f->jobs);
    text_table_cell(t, f->unfinished != 0 ? STYLE_ACTIVE : NULL, "%" PRId64, f->unfinished);
    text_table_cell(t, NULL, "%s", human_age(f->updated_ms, now_ms, age));
    text_table_cell(t, STYLE_DOUBT, "%s%s%.12s%s%s", f->partial ? "partial " : "",
                    f->mixed ? "settings " : "", f->mixed ? f->digest : "", f->mixed ? " " : "",
                    f->reason != NULL ? f->reason : "");
}
