/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "reader/child_process.h"

#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>

static void describe_end(bool known, int status, char *out, size_t size) {
    if (!known) {
        snprintf(out, size, "how it ended is unknown");
    } else if (WIFSIGNALED(status)) {
        snprintf(out, size, "it was killed by signal %d, %s", WTERMSIG(status),
                 strsignal(WTERMSIG(status)));
    } else {
        snprintf(out, size, "it ended with code %d", WEXITSTATUS(status));
    }
}

/* Wait at most a second for the process to end. Return as waitpid does; 0 means that it has not
 * ended. */
static pid_t wait_for_end(pid_t pid, int *status) {
    enum { TRIES = 200 };
    const struct timespec pause = {.tv_nsec = 5000000};
    pid_t got = 0;
    for (int i = 0; i < TRIES && got == 0; i++) {
        got = waitpid(pid, status, WNOHANG);
        if (got == 0)
            nanosleep(&pause, NULL);
    }
    return got;
}

int child_process_reap(pid_t *pid, bool kill_now, char *end, size_t size) {
    int status = 0;
    if (*pid <= 0)
        return -1;
    pid_t got = kill_now ? 0 : wait_for_end(*pid, &status);
    if (got == 0) {
        kill(*pid, SIGKILL);
        /* The wait is bounded: a process blocked in a dead file server cannot be killed, and must
         * not delay the caller. Then it is left to the system. */
        got = wait_for_end(*pid, &status);
    }
    *pid = 0;
    if (end != NULL)
        describe_end(got > 0, status, end, size);
    return got > 0 && WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}
