/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Namespaces for the reader alone. A process namespace holds the children of the process that asks
 * for it, so there are two processes then: the one that the service started, and knows, only waits.
 */
#include "reader/sandbox.h"

#include <errno.h>
#include <sched.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

/* End as the child does, without a core: by the same signal, or with its code. */
static _Noreturn void end_as(pid_t child) {
    int status = 0;
    close_range(0, ~0U, 0); /* the socket's end is the child's alone */
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
