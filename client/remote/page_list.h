/* SPDX-License-Identifier: GPL-3.0-or-later */
/* page_list.h: a list that the service gives page by page: jobs, fields. */
#ifndef CLIENT_REMOTE_PAGE_LIST_H
#define CLIENT_REMOTE_PAGE_LIST_H

#include "remote/service.h"
#include "terminal/text_table.h"

typedef struct page_list page_list;
struct page_list {
    const char *what, *hint; /* "jobs", and what the note on further pages says besides */
    int method;
    service service; /* connected */
    sheard_params params;
    int64_t *page_limit; /* in params, as `cursor` is */
    const char **cursor;
    int64_t page_max; /* rows of a page */
    int64_t limit;    /* rows that are still to be listed */
    bool brief;       /* names alone, and no table */
    text_table *table;
    /* Show a page: print with `brief`, else add to the table, and neither with service.json.
     * Returns its rows; *next becomes the cursor of the next page, or NULL. */
    size_t (*show)(const page_list *list, const sheard_reply *page, const char **next);
};

/* All pages, up to the limit, and a note if there are more. Returns an exit code, with an error
 * printed. */
enum exit_code page_list_print(page_list *list);
/* Closes the service and frees the table. */
void page_list_deinit(page_list *list);

#endif
