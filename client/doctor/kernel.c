/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks of the kernel's features for the readers' sandbox. */
#include "base/cleanup.h"
#include "doctor/internal.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/landlock.h>
#include <string.h>
#include <sys/syscall.h>
#include <unistd.h>

static void check_seccomp(doctor *d) {
    char actions[256] = "";
    CLEANUP(release_fd)
    const int fd = open("/proc/sys/kernel/seccomp/actions_avail", O_RDONLY | O_CLOEXEC);
    const ssize_t n = fd < 0 ? -1 : read(fd, actions, sizeof actions - 1);
    const bool good = n > 0 && strstr(actions, "kill_process") != NULL;
    doctor_report(d, "seccomp", good ? SHEARD_CHECK_OK : SHEARD_CHECK_FAIL,
                  "use a kernel with CONFIG_SECCOMP_FILTER",
                  good ? "system calls of readers can be filtered"
                       : "system calls of readers cannot be filtered: files will not be read");
}

static void check_landlock(doctor *d) {
    const long version =
        syscall(SYS_landlock_create_ruleset, NULL, 0, LANDLOCK_CREATE_RULESET_VERSION);
    if (version > 0) {
        doctor_ok(d, "landlock", "readers can be kept from the file system (version %ld)", version);
    } else {
        doctor_warn(d, "landlock",
                    "boot with landlock among the security modules (lsm=landlock,...)",
                    "no Landlock (%s): only seccomp guards the readers", strerror(errno));
    }
}

void doctor_check_kernel(doctor *d) {
    check_seccomp(d);
    check_landlock(d);
}
