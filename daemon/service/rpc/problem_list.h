/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/rpc/problem_list.h: what an operator should look at: what failed lately and will be tried
 * again, what lies where it should not, disks, the log. Told by status, doctor, metrics and the
 * live view. */
#ifndef SHEARD_SERVICE_PROBLEM_LIST_H
#define SHEARD_SERVICE_PROBLEM_LIST_H

#include "service/rpc/disks.h"
#include "store/store.h"

enum { PROBLEM_TEXT = 512, PROBLEM_REASONS = 16, PROBLEMS_TOLD = 48 };

/* What there is to tell now, with the texts. */
typedef struct problem_list {
    sheard_msg_problem items[PROBLEMS_TOLD];
    const char *lines[PROBLEMS_TOLD]; /* the messages of items */
    size_t n;
    char texts[PROBLEMS_TOLD][PROBLEM_TEXT];
    sheard_msg_disk disks[DISKS];
    size_t n_disks;
    store_waiting waiting[PROBLEM_REASONS];
    size_t n_waiting;
} problem_list;

/* All that there is; free(). NULL: out of memory. */
problem_list *problem_list_new(const service *s);

#endif
