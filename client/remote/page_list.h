/* SPDX-License-Identifier: GPL-3.0-or-later */
/* page_list.h: a list that the service returns in pages: jobs, fields. */
#pragma once

#include "remote/service.h"
#include "terminal/text_table.h"

typedef struct page_list page_list;
struct page_list {
    const char *what, *hint; /* "jobs"; and the rest of the note that there are more */
    int method;
    service service; /* connected */
    sheard_params params;
    int64_t *page_limit; /* points into params, as does `cursor` */
    const char **cursor;
    int64_t page_max; /* rows per page */
    int64_t limit;    /* remaining rows to list */
    bool brief;       /* only names, without a table */
    text_table *table;
    /* Show a page: print it with `brief`, otherwise add it to the table; do neither with
     * service.json. Returns its number of rows; *next becomes the cursor of the next page, or NULL.
     */
    size_t (*show)(const page_list *list, const sheard_reply *page, const char **next);
};

/* Print all pages, up to the limit, and a note if there are more. Returns an exit code; on failure
 * an error has been printed. */
enum exit_code page_list_print(page_list *list);
/* Close the connection and free the table. */
void page_list_deinit(page_list *list);
