/* SPDX-License-Identifier: GPL-3.0-or-later */
/* base/thread.h: start threads, and hold locks until a block ends. */
#pragma once

#include "base/cleanup.h"

#include <pthread.h>

/* Start a thread with all signals blocked, so that another one handles them. Return 0 or errno. */
int thread_start(pthread_t *thread, void *(*start)(void *), void *argument);

/* Lock a mutex until the block ends, however it is left:
 *
 *     LOCKED(&queue->lock);
 *     return queue->n; */
#define LOCKED(mutex)                                                                              \
    CLEANUP(thread_unlock) pthread_mutex_t *const thread_locked_ = thread_lock(mutex)

/* The functions behind the macro. */
static inline pthread_mutex_t *thread_lock(pthread_mutex_t *mutex) {
    pthread_mutex_lock(mutex);
    return mutex;
}

static inline void thread_unlock(pthread_mutex_t *const *mutex) {
    pthread_mutex_unlock(*mutex);
}
