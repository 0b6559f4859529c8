/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "reader/launch.h"

#include "base/cleanup.h"
#include "reader/wire.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <unistd.h>

enum { N_FDS = READER_FD_END - READER_FD_SOCKET, NUMBER = 24 };

/* The child's arguments, with buffers for the numbers. */
typedef struct arguments {
    char numbers[READER_ARG_FIRST_NAME - 1][NUMBER];
    char hdus[SHEAR_N_PARTS][NUMBER];
    char options[SHEAR_N_EXPOSURE_OPTIONS][NUMBER];
    char *argv[READER_ARGS_PARTS + 1];
} arguments;

static void fill_arguments(arguments *a, const shear_input *input, int n_scratch,
                           const reader_limits *limits) {
    int n = 0;
    snprintf(a->numbers[0], NUMBER, "%" PRId64, limits->memory_bytes);
    snprintf(a->numbers[1], NUMBER, "%" PRId64, limits->cpu_seconds);
    snprintf(a->numbers[2], NUMBER, "%" PRId64, limits->unpacked_bytes);
    snprintf(a->numbers[3], NUMBER, "%d", n_scratch);
    snprintf(a->numbers[4], NUMBER, "%d", input->mosaic.stamp_nx);
    snprintf(a->numbers[5], NUMBER, "%d", input->mosaic.stamp_ny);
    snprintf(a->numbers[6], NUMBER, "%" PRId64, input->mosaic.stamps);
    a->argv[n++] = (char *)"sheard-reader";
    for (int i = 0; i < READER_ARG_FIRST_NAME - 1; i++)
        a->argv[n++] = a->numbers[i];
    if (input->path != NULL)
        a->argv[n++] = (char *)input->path;
    for (int i = 0; i < SHEAR_N_PARTS && input->path == NULL; i++) {
        const shear_input_part *part = &input->parts[i];
        snprintf(a->hdus[i], NUMBER, "%" PRId64, part->hdu);
        a->argv[n++] = (char *)(part->path != NULL ? part->path : "");
        a->argv[n++] = a->hdus[i];
        a->argv[n++] = (char *)(part->extname != NULL ? part->extname : "");
    }
    for (int i = 0; i < SHEAR_N_EXPOSURE_OPTIONS && input->path == NULL; i++) {
        const char *text =
            shear_exposure_get(&input->exposure, shear_exposure_option(i), a->options[i]);
        a->argv[n++] = (char *)(text != NULL ? text : "");
    }
    a->argv[n] = NULL;
}

/* Set up the child's descriptors. They are first duplicated above the fixed numbers, so that no
 * dup2 in the child overwrites one that is still needed. All other descriptors of the daemon are
 * close-on-exec. Return 0 or errno. */
static int add_descriptors(posix_spawn_file_actions_t *actions, int child_stderr,
                           const int given[N_FDS], int from[N_FDS]) {
    int rc = posix_spawn_file_actions_adddup2(actions, child_stderr, STDERR_FILENO);
    for (int i = 0; i < N_FDS && rc == 0; i++) {
        if (given[i] < 0)
            continue;
        from[i] = fcntl(given[i], F_DUPFD_CLOEXEC, 16);
        rc = from[i] < 0 ? errno
                         : posix_spawn_file_actions_adddup2(actions, from[i], READER_FD_SOCKET + i);
    }
    return rc;
}

static void fill_attributes(posix_spawnattr_t *attributes) {
    sigset_t none;
    sigset_t defaults;
    sigemptyset(&none);
    sigemptyset(&defaults);
    sigaddset(&defaults, SIGPIPE);
    sigaddset(&defaults, SIGTERM);
    sigaddset(&defaults, SIGINT);
    posix_spawnattr_setsigmask(attributes, &none);
    posix_spawnattr_setsigdefault(attributes, &defaults);
    posix_spawnattr_setpgroup(attributes, 0); /* ^C of a terminal is handled by the daemon alone */
    posix_spawnattr_setflags(attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF |
                                             POSIX_SPAWN_SETPGROUP);
}

int launch_reader(pid_t *pid, const shear_input *input, const int *fds, launch_ends ends,
                  const reader_limits *limits) {
    char *const environment[] = {NULL};
    int given[N_FDS];
    int from[N_FDS];
    int n_scratch = 0;
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attributes;
    arguments a;
    for (int i = 0; i < N_FDS; i++)
        given[i] = from[i] = -1;
    given[0] = ends.socket;
    given[1] = ends.memory;
    for (int i = 0; i < (input->path != NULL ? 1 : SHEAR_N_PARTS); i++)
        given[READER_FD_FILE - READER_FD_SOCKET + i] = fds[i];
    while (n_scratch < SHEAR_N_PARTS && ends.scratch[n_scratch] >= 0) {
        given[READER_FD_SCRATCH - READER_FD_SOCKET + n_scratch] = ends.scratch[n_scratch];
        n_scratch++;
    }
    fill_arguments(&a, input, n_scratch, limits);
    posix_spawn_file_actions_init(&actions);
    posix_spawnattr_init(&attributes);
    fill_attributes(&attributes);
    int rc = add_descriptors(&actions, ends.child_stderr, given, from);
    if (rc == 0)
        rc = posix_spawn(pid, limits->program, &actions, &attributes, a.argv, environment);
    for (int i = 0; i < N_FDS; i++)
        release_fd(&from[i]);
    posix_spawn_file_actions_destroy(&actions);
    posix_spawnattr_destroy(&attributes);
    return rc;
}
