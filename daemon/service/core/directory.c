/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/core/directory.h"

#include "service/core/user_names.h"

#include <errno.h>
#include <pwd.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static int refuse(const char *state_dir, const char *user, shear_error *err) {
    char advice[240];
    snprintf(advice, sizeof advice,
             "systemctl start sheard; without systemd: systemd-tmpfiles --create, then runuser -u "
             "%.32s -- sheard; or give root a state_dir of its own",
             user);
    return shear_fail(err, SHEAR_E_SETTING, advice,
                      "this is root, and the state directory '%.200s' is for the user '%.32s', "
                      "whose service what root leaves there would stop",
                      state_dir, user);
}

int directory_check_owner(const char *state_dir, const char *installed, const char *user,
                          shear_error *err) {
    struct stat st;
    char owner[64];
    if (geteuid() != 0)
        return SHEAR_OK;
    if (stat(state_dir, &st) != 0) {
        return strcmp(state_dir, installed) == 0 && getpwnam(user) != NULL
                   ? refuse(state_dir, user, err)
                   : SHEAR_OK;
    }
    if (st.st_uid == 0)
        return SHEAR_OK;
    user_names_write(st.st_uid, owner, sizeof owner);
    return refuse(state_dir, owner, err);
}

int directory_make(const char *path, mode_t mode, shear_error *err) {
    if (mkdir(path, mode) == 0 || errno == EEXIST)
        return SHEAR_OK;
    return shear_fail(err, SHEAR_E_IO, "create it, or set another directory",
                      "cannot make the directory '%s': %s", path, strerror(errno));
}
