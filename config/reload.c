/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Compare two configurations, and reload a running one. */
#include "origin.h"
#include "sheard/config.h"
#include "table.h"
#include "value.h"

#include <string.h>

bool sheard_config_same(const sheard_config *a, const sheard_config *b, size_t index) {
    sheard_setting s = sheard_setting_at(index);
    if (s.type != SHEARD_T_MEASURE)
        return value_equal(&s, config_const_member(a, &s), config_const_member(b, &s));
    char text_a[VALUE_TEXT_MAX]; /* "auto" is NaN, never equal to itself: compare texts */
    char text_b[VALUE_TEXT_MAX];
    return strcmp(shear_settings_format(&a->measure, s.measure, text_a, sizeof text_a),
                  shear_settings_format(&b->measure, s.measure, text_b, sizeof text_b)) == 0;
}

size_t sheard_config_changes(const sheard_config *a, const sheard_config *b, bool at_start,
                             size_t *changed, size_t capacity) {
    size_t n = 0;
    for (size_t i = 0; i < sheard_settings_count(); i++) {
        if ((!at_start || sheard_setting_at(i).at_start) && !sheard_config_same(a, b, i)) {
            if (n < capacity)
                changed[n] = i;
            n++;
        }
    }
    return n;
}

static void swap_bytes(void *a, void *b, size_t n) {
    for (char *x = a, *y = b; n > 0; n--, x++, y++) {
        const char kept = *x;
        *x = *y;
        *y = kept;
    }
}

/* Exchange the values that may change while running, and the origins of all. A second call undoes
 * the first. */
static void exchange(sheard_config *a, sheard_config *b) {
    for (size_t i = 0; i < config_n_rows; i++) {
        const sheard_setting *s = &config_rows[i];
        if (!s->at_start)
            swap_bytes(config_member(a, s), config_member(b, s), value_size(s));
    }
    swap_bytes(&a->measure, &b->measure, sizeof a->measure);
    swap_bytes(&a->path, &b->path, sizeof a->path);
    swap_bytes(&a->lines, &b->lines, sizeof a->lines);
}

/* Warn of the settings that keep their value although the file's line has another, and mark them.
 */
static void note_kept(sheard_config *running, const sheard_config *fresh,
                      sheard_problems *problems) {
    for (size_t i = 0; i < sheard_settings_count(); i++) {
        const sheard_setting s = sheard_setting_at(i);
        if (s.at_start && !sheard_config_same(running, fresh, i)) {
            problems_warn(problems, running, i, "restart the daemon to apply it",
                          "[%s] %s: the change takes effect at the next start", s.section, s.key);
            running->lines[i] = ORIGIN_EARLIER;
        }
    }
}

int sheard_config_reload(sheard_config *running, sheard_config *fresh, sheard_problems *problems) {
    exchange(running, fresh);
    const int code = sheard_config_check(running, problems);
    if (code == SHEAR_OK) {
        note_kept(running, fresh, problems);
    } else {
        exchange(running, fresh);
    }
    return code;
}
