/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "terminal/bar.h"

#include <inttypes.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

static const double longest_s = 359999.0; /* 99:59:59 */

double bar_part(double done, double total) {
    if (total < 0.0)
        return 0.0;
    return total > done && done >= 0.0 ? done / total : 1.0;
}

char *bar_text(double part, int width, char *buf, size_t size) {
    const int inner = width - 2;
    if (inner < 1 || (size_t)width >= size) {
        buf[0] = '\0';
        return buf;
    }
    const int full = part > 1.0 ? inner : part > 0.0 ? (int)(part * inner) : 0;
    buf[0] = '[';
    memset(buf + 1, '#', (size_t)full);
    memset(buf + 1 + full, '.', (size_t)(inner - full));
    memcpy(buf + 1 + inner, "]", 2);
    return buf;
}

char *bar_figures(double part, double rate, double left_s, char *buf, size_t size) {
    const int64_t s = left_s >= 0.0 && left_s < longest_s ? (int64_t)left_s : (int64_t)longest_s;
    int used = snprintf(buf, size, " %3d%%", (int)(100.0 * part));
    if (!(rate > 0.0) || used < 0 || (size_t)used >= size)
        return buf;
    buf += used;
    size -= (size_t)used;
    if (s < 3600) {
        snprintf(buf, size, " %.0f stamps/s %" PRId64 ":%02" PRId64 " left", rate, s / 60, s % 60);
    } else {
        snprintf(buf, size, " %.0f stamps/s %" PRId64 ":%02" PRId64 ":%02" PRId64 " left", rate,
                 s / 3600, s / 60 % 60, s % 60);
    }
    return buf - used;
}
