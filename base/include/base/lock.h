/* SPDX-License-Identifier: GPL-3.0-or-later */
/* base/lock.h: hold a mutex until the block ends, however it is left.
 *
 *     LOCK_HOLD(&work->results);
 *     return work->code; */
#pragma once

#include "base/cleanup.h"

#include <pthread.h>

#define LOCK_HOLD(mutex)                                                                           \
    CLEANUP(lock_release) __attribute__((unused)) pthread_mutex_t *lock_held_ = lock_take(mutex)

static inline pthread_mutex_t *lock_take(pthread_mutex_t *mutex) {
    pthread_mutex_lock(mutex);
    return mutex;
}

static inline void lock_release(pthread_mutex_t **held) {
    pthread_mutex_unlock(*held);
}
