/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "doctor/run_program.h"

#include "base/cleanup.h"
#include "base/clock.h"
#include "base/io.h"
#include "base/text.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

enum { OUTPUT_MAX = 1 << 20, PATIENCE_S = 10 };

extern char **environ;

/* Read all output; what does not fit into buf is dropped. Returns false on timeout. */
static bool collect(int fd, char *buf, size_t size) {
    const double deadline = clock_s(CLOCK_MONOTONIC) + PATIENCE_S;
    char rest[4096];
    size_t used = 0;
    for (;;) {
        struct pollfd p = {.fd = fd, .events = POLLIN};
        const double left_ms = 1000.0 * (deadline - clock_s(CLOCK_MONOTONIC));
        const int ready = left_ms > 0.0 ? poll(&p, 1, (int)left_ms + 1) : 0;
        if (ready == 0)
            return false;
        const bool fits = used + 1 < size;
        const ssize_t n =
            ready > 0 ? read(fd, fits ? buf + used : rest, fits ? size - 1 - used : sizeof rest)
                      : -1;
        if (n == 0 || (n < 0 && errno != EINTR))
            return n == 0;
        used += n > 0 && fits ? (size_t)n : 0;
        buf[used] = '\0';
    }
}

static int start(const char *const argv[], int output, pid_t *pid) {
    posix_spawn_file_actions_t actions;
    if (posix_spawn_file_actions_init(&actions) != 0)
        return -1;
    int failed = posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    failed =
        failed != 0 ? failed : posix_spawn_file_actions_adddup2(&actions, output, STDOUT_FILENO);
    failed =
        failed != 0 ? failed : posix_spawn_file_actions_adddup2(&actions, output, STDERR_FILENO);
    failed = failed != 0 ? failed
                         : posix_spawn(pid, argv[0], &actions, NULL, (char *const *)argv, environ);
    posix_spawn_file_actions_destroy(&actions);
    return failed != 0 ? -1 : 0;
}

int run_program(const char *const argv[], char **text) {
    int ends[2];
    int state = 0;
    pid_t pid = 0;
    *text = calloc(1, OUTPUT_MAX);
    if (*text == NULL || pipe2(ends, O_CLOEXEC) != 0)
        return -1;
    CLEANUP(release_fd) const int output = ends[0];
    const int failed = start(argv, ends[1], &pid);
    close(ends[1]);
    if (failed != 0)
        return -1;
    const bool good = collect(output, *text, OUTPUT_MAX);
    if (!good)
        kill(pid, SIGKILL);
    while (waitpid(pid, &state, 0) < 0 && errno == EINTR) {
    }
    return good && WIFEXITED(state) ? WEXITSTATUS(state) : -1;
}

/* Return "DIRECTORY/name" if that is a program, or NULL; `length` bytes of directory. */
static char *find_in(const char *directory, size_t length, const char *name) {
    char *path = NULL;
    if (asprintf(&path, "%.*s/%s", (int)length, directory, name) < 0)
        return NULL;
    if (access(path, X_OK) == 0)
        return path;
    free(path);
    return NULL;
}

static char *search(const char *directories, const char *name) {
    char *found = NULL;
    while (directories != NULL && *directories != '\0' && found == NULL) {
        const size_t n = strcspn(directories, ":");
        found = n > 0 && *directories == '/' ? find_in(directories, n, name) : NULL;
        directories += n + (directories[n] == ':');
    }
    return found;
}

/* Look beside this program, and in ../sbin. */
static char *find_beside(const char *name) {
    char own[4096];
    if (io_own_directory(own, sizeof own) != 0)
        return NULL;
    char *found = find_in(own, strlen(own), name);
    return found != NULL || !text_append(own, sizeof own, "/../sbin")
               ? found
               : find_in(own, strlen(own), name);
}

char *run_program_find(const char *name) {
    char *found = find_beside(name);
    found = found != NULL ? found : search(getenv("PATH"), name);
    return found != NULL ? found : search("/usr/local/sbin:/usr/sbin:/usr/bin", name);
}
