/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "reader/child_stderr.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <unistd.h>

int child_stderr_pipe(int ends[2]) {
    ends[0] = ends[1] = -1;
    return pipe2(ends, O_CLOEXEC | O_NONBLOCK) == 0 ? 0 : errno;
}

/* Copy the bytes to the daemon's standard error in a build with sanitizers: tests look for the
 * whole reports in the log. */
static void pass_on(const char *bytes, size_t n) {
#ifdef SHEAR_SANITIZED
    fwrite(bytes, 1, n, stderr);
#else
    (void)bytes;
    (void)n;
#endif
}

static char printable(char c) {
    if (c == '\n')
        return ' ';
    return (char)(c >= ' ' && c <= '~' ? c : '?');
}

void child_stderr_read(int end, char *out, size_t size) {
    char bytes[512];
    size_t used = 0;
    ssize_t got = 0;
    while ((got = read(end, bytes, sizeof bytes)) > 0) {
        pass_on(bytes, (size_t)got);
        for (ssize_t i = 0; i < got && used + 1 < size; i++) {
            if (bytes[i] != '\n' || used > 0)
                out[used++] = printable(bytes[i]);
        }
    }
    while (used > 0 && out[used - 1] == ' ')
        used--;
    out[used] = '\0';
}
