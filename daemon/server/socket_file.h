/* SPDX-License-Identifier: GPL-3.0-or-later */
/* server/socket_file.h: the socket file: made without ever being open to more than it should, and
 * removed only by whom it belongs to. */
#ifndef SHEARD_SERVER_SOCKET_FILE_H
#define SHEARD_SERVER_SOCKET_FILE_H

#include "shear/error.h"

#include <sys/types.h>

typedef struct socket_file {
    char *path, *lock_path; /* NULL: there is no file */
    int lock;               /* descriptor; -1: none */
    dev_t device;
    ino_t inode;
} socket_file;

/* *fd becomes a listening socket, close-on-exec. On failure there is nothing to remove. */
int socket_file_make(socket_file *file, int *fd, const char *path, unsigned mode, const char *group,
                     shear_error *err);
/* Remove the file, if it is still the one that was made, and the lock. It may be called again. */
void socket_file_remove(socket_file *file);

#endif
