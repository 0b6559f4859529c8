/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "remote/page_list.h"

#include "base/cleanup.h"
#include "terminal/message.h"

#include <stdlib.h>
#include <string.h>

/* Request and show one page; *cursor, owned by the caller, becomes that of the next page, or NULL.
 */
static enum exit_code list_page(page_list *l, size_t *n, char **cursor) {
    sheard_reply reply = {0};
    const char *next = NULL;
    *l->page_limit = l->limit < l->page_max ? l->limit : l->page_max;
    *l->cursor = *cursor != NULL ? *cursor : *l->cursor;
    TRY(service_answer(&l->service, l->method, &l->params, &reply));
    *n = l->show(l, &reply, &next);
    free(*cursor);
    *cursor = next != NULL ? strdup(next) : NULL;
    l->limit -= (int64_t)*n;
    sheard_reply_deinit(&reply, l->method);
    return EXIT_CODE_DONE;
}

enum exit_code page_list_print(page_list *l) {
    CLEANUP(release_free) char *cursor = NULL;
    size_t n = 0; /* an empty page ends the list, or the loop would not end */
    do {
        TRY(list_page(l, &n, &cursor));
    } while (cursor != NULL && n > 0 && l->limit > 0);
    if (l->service.json)
        return EXIT_CODE_DONE;
    const enum exit_code code = l->brief ? EXIT_CODE_DONE : text_table_print(l->table, stdout);
    fflush(stdout);
    if (code == EXIT_CODE_DONE && cursor != NULL) {
        message_note("there are more %s: --cursor %s goes on with them%s", l->what, cursor,
                     l->hint);
    }
    return code;
}

void page_list_deinit(page_list *l) {
    text_table_free(l->table);
    service_close(&l->service);
}
