/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "spool/folders.h"

#include "base/cleanup.h"
#include "base/fingerprint.h"
#include "spool/spool.h"

#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <unistd.h>

static const struct {
    const char *name;
    mode_t mode;
} layout[N_FOLDERS] = {
    /* Writable for the group, sticky, and new files get the directory's group, so that the service
       can read what users drop with their own umask. */
    [INCOMING] = {"incoming", 03770},
    [ACTIVE] = {"active", 02750},
    [DONE] = {"done", 02750},
    [FAILED] = {"failed", 02750},
};

const char *folder_name(enum folder folder) {
    return layout[folder].name;
}

static int complain(shear_error *err, const char *path, const char *what, const char *name) {
    return shear_fail(err, errno == ENOMEM ? SHEAR_E_NOMEM : SHEAR_E_IO,
                      "the service's user must own the spool, and its disk must be writable",
                      "%s/%s: cannot %s: %s", path, name, what, strerror(errno));
}

/* Set the mode. Restricted services (RestrictSUIDSGID) may not set the set-group-ID bit; then the
 * group comes from the parent directory, or from whoever installed the folders. */
static int set_mode(int fd, mode_t mode) {
    if (fchmod(fd, mode) == 0)
        return 0;
    return errno == EPERM ? fchmod(fd, mode & ~(mode_t)S_ISGID) : -1;
}

/* Open a folder, made if it is missing. An existing one keeps the mode that the administrator gave
 * it. *fd is the caller's to close, also after an error. */
static int open_folder(const folders *f, enum folder folder, int *fd, shear_error *err) {
    const char *name = layout[folder].name;
    const bool made = mkdirat(f->root, name, 0700) == 0;
    if (!made && errno != EEXIST)
        return complain(err, f->path, "make it", name);
    *fd = openat(f->root, name, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    if (*fd < 0)
        return complain(err, f->path, "open it", name);
    return made && set_mode(*fd, layout[folder].mode) != 0
               ? complain(err, f->path, "set its mode", name)
               : SHEAR_OK;
}

static int open_root(folders *f, shear_error *err) {
    if (mkdir(f->path, 0750) != 0 && errno != EEXIST)
        return complain(err, f->path, "make it", "");
    f->root = open(f->path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    return f->root < 0 ? complain(err, f->path, "open it", "") : SHEAR_OK;
}

/* Lock the spool. The file contains the holder's process number, for the message; the lock itself
 * is the kernel's and ends with its holder. */
static int acquire_lock(folders *f, shear_error *err) {
    char holder[24] = "";
    f->lock = openat(f->root, ".lock", O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0640);
    if (f->lock < 0)
        return complain(err, f->path, "open it", ".lock");
    if (flock(f->lock, LOCK_EX | LOCK_NB) == 0) {
        const int n = snprintf(holder, sizeof holder, "%ld\n", (long)getpid());
        /* Only for the message: a full disk must not prevent a start. */
        if (ftruncate(f->lock, 0) != 0 || pwrite(f->lock, holder, (size_t)n, 0) != n)
            errno = 0;
        return SHEAR_OK;
    }
    if (errno != EWOULDBLOCK)
        return complain(err, f->path, "lock it", ".lock");
    const ssize_t n = pread(f->lock, holder, sizeof holder - 1, 0);
    holder[n > 0 ? strspn(holder, "0123456789") : 0] = '\0';
    return shear_fail(err, SPOOL_LOCKED, "stop the other one, or configure another spool directory",
                      "%s: another sheard%s%s%s uses this spool", f->path,
                      holder[0] != '\0' ? " (process " : "", holder, holder[0] != '\0' ? ")" : "");
}

/* Check that all folders are on one mount: a rename does not cross mounts, even of one file
 * system. */
static int check_one_mount(const folders *f, shear_error *err) {
    struct statx first;
    for (int i = 0; i < N_FOLDERS; i++) {
        struct statx one;
        if (statx(f->fd[i], "", AT_EMPTY_PATH, STATX_INO | STATX_MNT_ID, &one) != 0)
            return complain(err, f->path, "examine it", layout[i].name);
        first = i == 0 ? one : first;
        if (one.stx_dev_major != first.stx_dev_major || one.stx_dev_minor != first.stx_dev_minor ||
            ((one.stx_mask & STATX_MNT_ID) != 0 && one.stx_mnt_id != first.stx_mnt_id)) {
            return shear_fail(err, SHEAR_E_IO,
                              "put the whole spool on one file system, mounted once",
                              "%s: %s/ and %s/ are on different mounts, files cannot be renamed "
                              "from one to the other",
                              f->path, layout[0].name, layout[i].name);
        }
    }
    return SHEAR_OK;
}

static int open_all(folders *f, shear_error *err) {
    TRY(open_root(f, err));
    TRY(acquire_lock(f, err));
    for (int i = 0; i < N_FOLDERS; i++)
        TRY(open_folder(f, (enum folder)i, &f->fd[i], err));
    return check_one_mount(f, err);
}

int folders_open(folders *f, const char *path, shear_error *err) {
    *f = (folders){strdup(path), -1, -1, {-1, -1, -1, -1}};
    if (f->path == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for the spool");
    const int code = open_all(f, err);
    if (code != SHEAR_OK)
        folders_close(f);
    return code;
}

void folders_close(folders *f) {
    if (f->path == NULL)
        return;
    for (int i = 0; i < N_FOLDERS; i++)
        release_fd(&f->fd[i]);
    release_fd(&f->lock);
    release_fd(&f->root);
    free(f->path);
    f->path = NULL;
}

static int check_root(const folders *f, shear_error *err) {
    struct stat held;
    struct stat named;
    if (fstat(f->root, &held) != 0 || stat(f->path, &named) != 0)
        return complain(err, f->path, "examine it", "");
    if (!fingerprint_same_file(&held, &named)) {
        return shear_fail(err, SHEAR_E_IO, "restart the service to use the new one",
                          "%s: is another directory than at the start", f->path);
    }
    return SHEAR_OK;
}

static bool is_current(const folders *f, enum folder folder) {
    struct stat held;
    struct stat named;
    return fstat(f->fd[folder], &held) == 0 &&
           fstatat(f->root, layout[folder].name, &named, AT_SYMLINK_NOFOLLOW) == 0 &&
           fingerprint_same_file(&held, &named);
}

int folders_check(folders *f, bool *incoming_changed, shear_error *err) {
    *incoming_changed = false;
    TRY(check_root(f, err));
    for (enum folder i = INCOMING; i < N_FOLDERS; i++) {
        CLEANUP(release_fd) int fd = -1; /* the new one, then the old one */
        if (is_current(f, i))
            continue;
        TRY(open_folder(f, i, &fd, err));
        const int old = f->fd[i];
        f->fd[i] = fd;
        fd = old;
        *incoming_changed |= i == INCOMING;
    }
    return SHEAR_OK;
}

int folder_move(const folders *f, enum folder from, const char *name, enum folder to,
                const char *new_name) {
    struct stat st;
    assert(from < N_FOLDERS && to < N_FOLDERS && f->fd[from] >= 0 && f->fd[to] >= 0);
    if (renameat2(f->fd[from], name, f->fd[to], new_name, RENAME_NOREPLACE) == 0)
        return 0;
    if (errno != EINVAL && errno != ENOSYS)
        return errno;
    /* Network file systems have no such rename. Only this service puts files into these folders. */
    const int absent = folder_stat(f, to, new_name, &st);
    if (absent != ENOENT)
        return absent == 0 ? EEXIST : absent;
    return renameat(f->fd[from], name, f->fd[to], new_name) == 0 ? 0 : errno;
}

int folder_sync(const folders *f, enum folder folder) {
    return fsync(f->fd[folder]) == 0 ? 0 : errno;
}

int folder_sync_move(const folders *f, enum folder folder) {
    TRY(folder_sync(f, folder));
    return folder_sync(f, ACTIVE);
}

int folder_stat(const folders *f, enum folder folder, const char *name, struct stat *st) {
    return fstatat(f->fd[folder], name, st, AT_SYMLINK_NOFOLLOW) == 0 ? 0 : errno;
}

DIR *folder_list(const folders *f, enum folder folder) {
    const int fd = openat(f->fd[folder], ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    DIR *dir = fd >= 0 ? fdopendir(fd) : NULL;
    if (dir == NULL && fd >= 0) {
        const int saved = errno;
        close(fd);
        errno = saved;
    }
    return dir;
}

void folder_list_close(DIR **dir) {
    if (*dir != NULL)
        closedir(*dir);
}

const char *folder_of_place(const char *text, enum folder *folder) {
    for (*folder = DONE; *folder <= FAILED; (*folder)++) {
        const char *prefix = folder_name(*folder);
        const size_t n = strlen(prefix);
        if (strncmp(text, prefix, n) == 0 && text[n] == '/')
            return text + n + 1;
    }
    return NULL;
}
