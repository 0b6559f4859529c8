/* SPDX-License-Identifier: GPL-3.0-or-later */
/* server/socket_file.h: create the socket file with its final permissions only, and remove it only
 * by the server that made it. */
#pragma once

#include "shear/error.h"

#include <sys/types.h>

typedef struct socket_file {
    char *path, *lock_path; /* NULL: there is no file */
    int lock;               /* descriptor; -1: none */
    dev_t device;
    ino_t inode;
} socket_file;

/* Create the socket file and set *fd to its listening socket (close-on-exec). On failure nothing is
 * left to remove. */
int socket_file_make(socket_file *file, int *fd, const char *path, unsigned mode, const char *group,
                     shear_error *err);
/* Remove the file, if it is still the one that was made, and the lock. Further calls do nothing. */
void socket_file_remove(socket_file *file);
