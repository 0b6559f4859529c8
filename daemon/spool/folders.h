/* SPDX-License-Identifier: GPL-3.0-or-later */
/* spool/folders.h: the spool's directory, its lock and its four folders, held by descriptors: when
 * a folder is renamed under the running service, files do not go elsewhere. */
#ifndef SHEARD_SPOOL_FOLDERS_H
#define SHEARD_SPOOL_FOLDERS_H

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

/* Make what is missing, lock, open. Errors as of spool_open; *f is then closed. */
int folders_open(folders *f, const char *path, shear_error *err);
void folders_close(folders *f); /* also of {0} with path NULL */

/* Are the folders still those that the path names? A folder that is gone is made again, one that
 * was replaced is used from now on; *incoming_changed tells whether it was incoming/. SHEAR_E_IO
 * where the directory itself is gone or replaced. */
int folders_check(folders *f, bool *incoming_changed, shear_error *err);

const char *folder_name(enum folder folder);
/* These return 0 or errno. A move never replaces (EEXIST). */
int folder_move(const folders *f, enum folder from, const char *name, enum folder to,
                const char *new_name);
int folder_sync(const folders *f, enum folder folder);
/* The folder and active/. */
int folder_sync_move(const folders *f, enum folder folder);
int folder_stat(const folders *f, enum folder folder, const char *name,
                struct stat *st); /* of a link: its own */
/* For readdir; NULL and errno. */
DIR *folder_list(const folders *f, enum folder folder);
void folder_list_close(DIR **dir); /* for CLEANUP */

/* "done/NAME" or "failed/NAME": NAME, and the folder; NULL where the text is neither. */
const char *folder_of_place(const char *text, enum folder *folder);

#endif
