/* SPDX-License-Identifier: GPL-3.0-or-later */
/* spool/folders.h: the spool's directory, its lock and its four folders, held open by descriptors,
 * so that renaming a folder does not redirect files. */
#pragma once

#include "shear/error.h"

#include <dirent.h>
#include <stdbool.h>
#include <sys/stat.h>

enum folder { INCOMING, ACTIVE, DONE, FAILED, N_FOLDERS };

typedef struct folders {
    char *path;
    int root, lock;
    int fd[N_FOLDERS];
} folders;

/* Make what is missing, take the lock, open the folders. Errors as for spool_open; *f is then
 * closed. */
int folders_open(folders *f, const char *path, shear_error *err);
void folders_close(folders *f); /* {0} is accepted */

/* Check that the folders are still those that the path names. A missing folder is made again, a
 * replaced one is used from now on; *incoming_changed is true if incoming/ was one of them.
 * SHEAR_E_IO if the directory itself is missing or was replaced. */
int folders_check(folders *f, bool *incoming_changed, shear_error *err);

const char *folder_name(enum folder folder);
/* The following return 0 or errno. folder_move never replaces a file (EEXIST). */
int folder_move(const folders *f, enum folder from, const char *name, enum folder to,
                const char *new_name);
int folder_sync(const folders *f, enum folder folder);
/* fsync the folder and active/. */
int folder_sync_move(const folders *f, enum folder folder);
/* Like lstat: a symbolic link is not followed. */
int folder_stat(const folders *f, enum folder folder, const char *name, struct stat *st);
/* Open the folder for readdir. Return NULL and set errno on error. */
DIR *folder_list(const folders *f, enum folder folder);
void folder_list_close(DIR **dir); /* for CLEANUP */

/* Parse "done/NAME" or "failed/NAME": set *folder and return NAME, or NULL if it is neither. */
const char *folder_of_place(const char *text, enum folder *folder);
