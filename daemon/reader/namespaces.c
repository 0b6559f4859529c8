/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Enter new user and process namespaces. A process namespace applies to the children of the process
 * that creates it, so there are two processes: the one that the daemon started only waits for the
 * other. */
#include "reader/sandbox.h"

#include <errno.h>
#include <sched.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

/* Wait for the child and end as it does: by the same signal (without a core), or with its code. */
static _Noreturn void end_as(pid_t child) {
    int status = 0;
    close_range(0, ~0U, 0); /* only the child keeps the socket */
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    if (WIFSIGNALED(status)) {
        prctl(PR_SET_DUMPABLE, 0, 0, 0, 0);
        signal(WTERMSIG(status), SIG_DFL);
        raise(WTERMSIG(status));
    }
    _exit(WIFEXITED(status) ? WEXITSTATUS(status) : 1);
}

void sandbox_unshare(unsigned *guards) {
    prctl(PR_SET_PDEATHSIG, SIGKILL, 0, 0, 0);
    if (unshare(CLONE_NEWUSER | CLONE_NEWPID) != 0)
        return;
    const pid_t child = fork();
    if (child > 0)
        end_as(child);
    if (child == 0) {
        prctl(PR_SET_PDEATHSIG, SIGKILL, 0, 0, 0);
        *guards |= SANDBOX_NAMESPACES;
    }
}
