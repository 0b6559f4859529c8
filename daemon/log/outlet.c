/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "log/outlet.h"

#include "base/io.h"
#include "base/thread.h"

#include <assert.h>
#include <pthread.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum { CHUNK = 4096 };

/* The lock guards everything here. The writing thread holds it only while it copies. */
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static pthread_cond_t filled = PTHREAD_COND_INITIALIZER, emptied = PTHREAD_COND_INITIALIZER;
static char ring[OUTLET_BYTES];
static size_t first, count; /* unwritten bytes: ring[(first + i) % OUTLET_BYTES], i < count */
static int target = STDERR_FILENO;
static bool through_thread, has_thread;

static void *serve(void *nothing) {
    char chunk[CHUNK];
    pthread_mutex_lock(&lock);
    for (;;) {
        while (count == 0)
            pthread_cond_wait(&filled, &lock);
        const size_t to_end = OUTLET_BYTES - first;
        const size_t at_most = count < to_end ? count : to_end;
        const size_t n = at_most < CHUNK ? at_most : CHUNK;
        const int fd = target;
        memcpy(chunk, ring + first, n);
        pthread_mutex_unlock(&lock);
        io_write(fd, chunk, n); /* write errors are ignored: there is nowhere to report them */
        pthread_mutex_lock(&lock);
        first = (first + n) % OUTLET_BYTES;
        count -= n;
        pthread_cond_broadcast(&emptied);
    }
    return nothing;
}

/* Start the writing thread. */
static bool start_thread(void) {
    pthread_t thread;
    const bool started = thread_start(&thread, serve, NULL) == 0;
    if (started)
        pthread_detach(thread);
    return started;
}

void outlet_open(int fd) {
    struct stat st;
    LOCKED(&lock);
    target = fd;
    through_thread = fstat(fd, &st) != 0 || !S_ISREG(st.st_mode);
    if (through_thread && !has_thread)
        has_thread = through_thread = start_thread();
}

static void append(const char *bytes, size_t n) {
    assert(n <= OUTLET_BYTES - count);
    const size_t at = (first + count) % OUTLET_BYTES;
    const size_t to_end = OUTLET_BYTES - at;
    const size_t head = n < to_end ? n : to_end;
    memcpy(ring + at, bytes, head);
    memcpy(ring, bytes + head, n - head);
    count += n;
}

bool outlet_put(const char *bytes, size_t n) {
    LOCKED(&lock);
    if (!through_thread) {
        io_write(target, bytes, n);
        return true;
    }
    if (n > OUTLET_BYTES - count)
        return false;
    append(bytes, n);
    pthread_cond_signal(&filled);
    return true;
}

bool outlet_drain(int timeout_ms) {
    struct timespec end;
    int rc = 0;
    LOCKED(&lock);
    clock_gettime(CLOCK_MONOTONIC, &end);
    end.tv_sec += timeout_ms / 1000;
    end.tv_nsec += (timeout_ms % 1000) * 1000000L;
    end.tv_sec += end.tv_nsec / 1000000000L;
    end.tv_nsec %= 1000000000L;
    while (count > 0 && rc == 0)
        rc = pthread_cond_clockwait(&emptied, &lock, CLOCK_MONOTONIC, &end);
    return count == 0;
}

size_t outlet_waiting(void) {
    LOCKED(&lock);
    return count;
}
