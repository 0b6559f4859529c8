/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Read pages of jobs. Each filter has an index that begins with its columns, continues with the
 * state and ends in the id. So a page is the merged head of one range per state, and no more ids
 * are read than one page per state, however many jobs there are. */
#include "store/page.h"

#include "base/cleanup.h"
#include "store/row.h"

#include <stdlib.h>

enum { IDS_MAX = STORE_N_STATES * (STORE_PAGE_MAX + 1) };

typedef struct id_list {
    int64_t ids[IDS_MAX];
    size_t n;
} id_list;

void store_job_page_deinit(store_job_page *page) {
    for (size_t i = 0; i < page->n; i++)
        store_job_deinit(&page->jobs[i]);
    free(page->jobs);
    *page = (store_job_page){0};
}

int store_last_job(store *s, int64_t *id, shear_error *err) {
    return query_number(query_on(s, SQL_LAST_JOB), 0, id, err);
}

static enum sql statement_for(const store_job_filter *f) {
    if (f->field != NULL)
        return f->by_owner ? SQL_JOBS_BY_BOTH : SQL_JOBS_BY_FIELD;
    return f->by_owner ? SQL_JOBS_BY_OWNER : SQL_JOBS_BY_STATE;
}

/* Add the `limit` newest ids of one state. */
static int add_ids(store *s, const store_job_filter *f, enum store_state state, size_t limit,
                   id_list *list, shear_error *err) {
    static const row_member id = {MEMBER_INT64, 0};
    static const row_type id_type = {sizeof(int64_t), &id, 1};
    const parameter field = query_text(f->field);
    const parameter parameters[] = {
        query_int(state), query_int(f->before > 0 ? f->before : INT64_MAX),
        query_int((int64_t)limit), f->by_owner ? query_int(f->owner) : field, field};
    const size_t n_parameters = 3 + (size_t)f->by_owner + (f->field != NULL);
    size_t n = 0;
    bool more = false;
    TRY(row_list(query_with(s, statement_for(f), parameters, n_parameters), &id_type, limit,
                 list->ids + list->n, &n, &more, err));
    list->n += n;
    return SHEAR_OK;
}

static int descending(const void *a, const void *b) {
    const int64_t x = *(const int64_t *)a;
    const int64_t y = *(const int64_t *)b;
    return (x < y) - (x > y);
}

static int find_ids(store *s, const store_job_filter *f, size_t limit, id_list *list,
                    shear_error *err) {
    list->n = 0;
    for (enum store_state state = STORE_QUEUED; state < STORE_N_STATES; state++) {
        if (f->states == 0 || (f->states & 1u << state) != 0)
            TRY(add_ids(s, f, state, limit, list, err));
    }
    qsort(list->ids, list->n, sizeof list->ids[0], descending);
    return SHEAR_OK;
}

static int fill(store *s, const id_list *list, size_t limit, store_job_page *page,
                shear_error *err) {
    const size_t n = list->n < limit ? list->n : limit;
    page->more = list->n > limit;
    page->jobs = calloc(n + 1, sizeof *page->jobs);
    if (page->jobs == NULL)
        return page_no_memory(err);
    for (; page->n < n; page->n++)
        TRY(store_job_get(s, list->ids[page->n], &page->jobs[page->n], err));
    return SHEAR_OK;
}

int store_jobs(store *s, const store_job_filter *filter, size_t limit, store_job_page *page,
               shear_error *err) {
    *page = (store_job_page){0};
    limit = page_limit(limit);
    CLEANUP(release_free) id_list *list = malloc(sizeof *list);
    if (list == NULL)
        return page_no_memory(err);
    TRY(find_ids(s, filter, limit + 1, list, err));
    int code = fill(s, list, limit, page, err);
    if (code != SHEAR_OK)
        store_job_page_deinit(page);
    return code;
}
