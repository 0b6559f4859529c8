/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/rpc/problem_list.h: problems that an operator should know of: recent failures that will
 * be tried again, ignored files, disks, the log. Shown by status, doctor, metrics and the live
 * view. */
#pragma once

#include "sheard/messages.h"
#include "store/store.h"

typedef struct service service;

enum { DISKS = 4 };
enum { PROBLEM_TEXT = 512, PROBLEM_REASONS = 16, PROBLEMS_TOLD = 48 };

/* The present problems, with their texts. One more than PROBLEMS_TOLD can be written, and is not
 * told. */
typedef struct problem_list {
    sheard_msg_problem items[PROBLEMS_TOLD + 1];
    const char *lines[PROBLEMS_TOLD + 1]; /* messages of items */
    size_t n;
    char texts[PROBLEMS_TOLD + 1][PROBLEM_TEXT];
    sheard_msg_disk disks[DISKS]; /* the directories that the service writes to: whether they exist
                                     and are writable, and how much space is free */
    size_t n_disks;
    store_waiting waiting[PROBLEM_REASONS];
    size_t n_waiting;
} problem_list;

/* Fill a zeroed list. */
void problem_list_fill(problem_list *list, const service *s);
