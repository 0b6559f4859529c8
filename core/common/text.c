/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "shear/text.h"

#include "base/utf8.h"

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

/* Characters that are not shown: controls, and those that Unicode calls format characters or
 * defines without a glyph. Sorted. */
static const struct {
    uint32_t first, last;
} hidden[] = {
    {0x00, 0x1f},       {0x7f, 0x9f},       {0xad, 0xad},       {0x34f, 0x34f},
    {0x600, 0x605},     {0x61c, 0x61c},     {0x6dd, 0x6dd},     {0x70f, 0x70f},
    {0x890, 0x891},     {0x8e2, 0x8e2},     {0x115f, 0x1160},   {0x17b4, 0x17b5},
    {0x180b, 0x180f},   {0x200b, 0x200f},   {0x2028, 0x202e},   {0x2060, 0x206f},
    {0x3164, 0x3164},   {0xd800, 0xdfff},   {0xfeff, 0xfeff},   {0xffa0, 0xffa0},
    {0xfff0, 0xfffb},   {0xfffe, 0xffff},   {0x110bd, 0x110bd}, {0x110cd, 0x110cd},
    {0x13430, 0x1343f}, {0x1bca0, 0x1bca3}, {0x1d173, 0x1d17a}, {0xe0000, 0xe0fff},
};

static bool is_hidden(uint32_t value) {
    for (size_t i = 0; i < sizeof hidden / sizeof hidden[0] && hidden[i].first <= value; i++) {
        if (value <= hidden[i].last)
            return true;
    }
    return false;
}

size_t shear_text_shown(const char *text) {
    uint32_t value = 0;
    const size_t n = utf8_decode(text, &value);
    return n > 0 && !is_hidden(value) ? n : 0;
}

char *shear_text_clean(const char *text, char *buf, size_t size) {
    size_t used = 0;
    while (*text != '\0') {
        uint32_t value = 0;
        const size_t n = utf8_decode(text, &value);
        const bool shown = n > 0 && !is_hidden(value);
        const size_t taken = shown ? n : 1;
        if (used + taken >= size)
            break;
        memcpy(buf + used, shown ? text : "?", taken);
        used += taken;
        text += n > 0 ? n : 1;
    }
    buf[used] = '\0';
    return buf;
}
