/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A library to preload into sheard for tests/system/test_daemon_faults.py: counts the calls that
 * write, sync or rename files below some directories, and lets chosen ones fail.
 *
 *   FAULT_BELOW   directories, with ':' between them; nothing else is counted
 *   FAULT_CALLS   which calls: letters of w (write), s (sync), r (rename); default all
 *   FAULT_AT      the first call to fail, from 1; 0: none
 *   FAULT_LENGTH  how many fail in a row (default 1)
 *   FAULT_HOW     EIO or ENOSPC; or KILL: the process dies there, a write half done
 *   FAULT_COUNT   file that holds the number of calls so far, 8 bytes, native order
 *   FAULT_CLOCK   file with milliseconds, 8 bytes, native order, that the wall clock is ahead; may
 * be written to at any time
 *
 * It works in the program FAULT_PROGRAM only, and takes itself out of the environment, so that the
 * sandboxed reader is started without it. */
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/uio.h>
#include <time.h>
#include <unistd.h>

static struct {
    const char *below, *calls;
    int64_t at, length;
    int error; /* 0: kill */
    _Atomic int64_t *count, *clock_ms;
    bool on;
} shim;

static int64_t number(const char *name, int64_t otherwise) {
    const char *text = getenv(name);
    return text != NULL ? strtoll(text, NULL, 10) : otherwise;
}

static const char *text(const char *name, const char *otherwise) {
    const char *value = getenv(name);
    return value != NULL ? value : otherwise;
}

/* 8 bytes that are shared with the test, or NULL. */
static _Atomic int64_t *shared(const char *path) {
    void *map = MAP_FAILED;
    const int fd = path != NULL ? open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0600) : -1;
    if (fd >= 0 && ftruncate(fd, sizeof(_Atomic int64_t)) == 0)
        map = mmap(NULL, sizeof(_Atomic int64_t), PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
    if (fd >= 0)
        close(fd);
    return map != MAP_FAILED ? map : NULL;
}

__attribute__((constructor)) static void begin(void) {
    static _Atomic int64_t own;
    const char *how = text("FAULT_HOW", "EIO");
    if (strcmp(program_invocation_short_name, text("FAULT_PROGRAM", "sheard")) != 0)
        return;
    shim.below = text("FAULT_BELOW", "");
    shim.calls = text("FAULT_CALLS", "wsr");
    shim.at = number("FAULT_AT", 0);
    shim.length = number("FAULT_LENGTH", 1);
    shim.error = strcmp(how, "KILL") == 0 ? 0 : strcmp(how, "ENOSPC") == 0 ? ENOSPC : EIO;
    shim.count = shared(getenv("FAULT_COUNT"));
    shim.count = shim.count != NULL ? shim.count : &own;
    atomic_store(shim.count, 0);
    shim.clock_ms = shared(getenv("FAULT_CLOCK"));
    unsetenv("LD_PRELOAD");
    shim.on = true;
}

static bool is_below(const char *path) {
    for (const char *at = shim.below; *at != '\0';) {
        const size_t n = strcspn(at, ":");
        if (n > 0 && strncmp(path, at, n) == 0 && (path[n] == '/' || path[n] == '\0'))
            return true;
        at += n + (at[n] == ':');
    }
    return false;
}

static bool fd_is_below(int fd) {
    char link[64];
    char path[PATH_MAX];
    snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
    const ssize_t n = readlink(link, path, sizeof path - 1);
    path[n > 0 ? n : 0] = '\0';
    return is_below(path);
}

enum fate { GO_ON, FAIL, DIE };

/* Counts a call; errno is kept, unless it is to fail. */
static enum fate fate(char call, bool counted) {
    const int64_t n =
        counted && strchr(shim.calls, call) != NULL ? atomic_fetch_add(shim.count, 1) + 1 : 0;
    if (n == 0 || shim.at == 0 || n < shim.at || n >= shim.at + shim.length)
        return GO_ON;
    errno = shim.error;
    return shim.error != 0 ? FAIL : DIE;
}

static enum fate fd_fate(char call, int fd) {
    const int kept = errno;
    const bool counted = shim.on && fd_is_below(fd);
    errno = kept;
    return fate(call, counted);
}

static enum fate rename_fate(int from_fd, const char *from, int to_fd, const char *to) {
    const int kept = errno;
    const bool counted = shim.on && ((from[0] == '/' ? is_below(from) : fd_is_below(from_fd)) ||
                                     (to[0] == '/' ? is_below(to) : fd_is_below(to_fd)));
    errno = kept;
    return fate('r', counted);
}

/* `done` is what was written before, and matters to nobody. */
_Noreturn static void die(ssize_t done) {
    (void)done;
    raise(SIGKILL);
    _exit(99);
}

/* The function behind ours. */
#define REAL(name) __extension__(__typeof__(&name)) dlsym(RTLD_NEXT, #name)

/* Half of it is written where the process is to die. */
#define WRITES(name, parameters, all, half)                                                        \
    ssize_t name parameters {                                                                      \
        const __typeof__(&name) real = REAL(name);                                                 \
        const enum fate f = fd_fate('w', fd);                                                      \
        if (f == DIE) {                                                                            \
            die(real half);                                                                        \
        }                                                                                          \
        return f == FAIL ? -1 : real all;                                                          \
    }

#define SYNCS(name)                                                                                \
    int name(int fd) {                                                                             \
        const __typeof__(&name) real = REAL(name);                                                 \
        const enum fate f = fd_fate('s', fd);                                                      \
        if (f == DIE) {                                                                            \
            die(0);                                                                                \
        }                                                                                          \
        return f == FAIL ? -1 : real(fd);                                                          \
    }

#define RENAMES(name, parameters, from_fd, to_fd, all)                                             \
    int name parameters {                                                                          \
        const __typeof__(&name) real = REAL(name);                                                 \
        const enum fate f = rename_fate(from_fd, from, to_fd, to);                                 \
        if (f == DIE) {                                                                            \
            die(0);                                                                                \
        }                                                                                          \
        return f == FAIL ? -1 : real all;                                                          \
    }

WRITES(write, (int fd, const void *data, size_t n), (fd, data, n), (fd, data, n / 2))
WRITES(pwrite, (int fd, const void *data, size_t n, off_t at), (fd, data, n, at),
       (fd, data, n / 2, at))
WRITES(pwrite64, (int fd, const void *data, size_t n, off64_t at), (fd, data, n, at),
       (fd, data, n / 2, at))
WRITES(writev, (int fd, const struct iovec *parts, int n), (fd, parts, n), (fd, parts, n / 2))
SYNCS(fsync)
SYNCS(fdatasync)
SYNCS(syncfs)
RENAMES(rename, (const char *from, const char *to), AT_FDCWD, AT_FDCWD, (from, to))
RENAMES(renameat, (int from_fd, const char *from, int to_fd, const char *to), from_fd, to_fd,
        (from_fd, from, to_fd, to))
RENAMES(renameat2, (int from_fd, const char *from, int to_fd, const char *to, unsigned int flags),
        from_fd, to_fd, (from_fd, from, to_fd, to, flags))

int clock_gettime(clockid_t id, struct timespec *t) {
    const __typeof__(&clock_gettime) real = REAL(clock_gettime);
    const int rc = real(id, t);
    if (rc == 0 && id == CLOCK_REALTIME && shim.clock_ms != NULL) {
        const int64_t ms = atomic_load(shim.clock_ms) + t->tv_nsec / 1000000;
        const int64_t seconds = ms / 1000 - (ms % 1000 < 0);
        t->tv_nsec = (long)(ms - 1000 * seconds) * 1000000 + t->tv_nsec % 1000000;
        t->tv_sec += (time_t)seconds;
    }
    return rc;
}
