/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fstat by its own system call, for the whole program sheard-reader: libc's is a call that takes a
 * path, which the sandbox does not allow. */
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

int fstat(int fd, struct stat *st) {
    return (int)syscall(SYS_fstat, fd, st);
}
