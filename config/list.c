/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Manage lists of strings. */
#include "sheard/config.h"

#include "base/buffer.h"

#include <stdlib.h>
#include <string.h>

int sheard_list_append(sheard_list *list, const char *text, shear_error *err) {
    char *copy = strdup(text);
    char **items =
        copy != NULL ? reallocarray(list->items, list->n + 1, sizeof *list->items) : NULL;
    if (items == NULL) {
        free(copy);
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a list");
    }
    items[list->n] = copy;
    list->items = items;
    list->n++;
    return SHEAR_OK;
}

char *sheard_list_join(const sheard_list *list) {
    buffer text = {0};
    for (size_t i = 0; i < list->n; i++) {
        buffer_add_text(&text, i > 0 ? ", " : "");
        buffer_add_text(&text, list->items[i]);
    }
    return buffer_take(&text, NULL);
}

void sheard_list_deinit(sheard_list *list) {
    for (size_t i = 0; i < list->n; i++)
        free(list->items[i]);
    free(list->items);
    *list = (sheard_list){0};
}
