/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "run/file_source.h"

#include "base/cleanup.h"

int file_source_init(file_source *s, shear_field *field, int slots, int capacity,
                     shear_error *err) {
    *s = (file_source){.field = field, .slots = slots};
    s->blocks = calloc((size_t)slots, sizeof(shear_block *));
    if (s->blocks == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for %d threads", slots);
    for (int i = 0; i < slots; i++)
        TRY(shear_block_new(&s->blocks[i], shear_field_get_info(field), capacity, err));
    return SHEAR_OK;
}

void file_source_deinit(file_source *s) {
    for (int i = 0; s->blocks != NULL && i < s->slots; i++)
        shear_block_free(s->blocks[i]);
    free(s->blocks);
    *s = (file_source){0};
}

static int read_block(void *self, int slot, int64_t first, int count, const shear_block **block,
                      shear_error *err) {
    const file_source *s = self;
    *block = s->blocks[slot];
    return shear_field_read(s->field, first, count, s->blocks[slot], err);
}

shear_source file_source_as_source(file_source *s) {
    return (shear_source){.self = s, .read = read_block};
}
