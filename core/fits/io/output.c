/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fits/io/output.h"

#include "base/cleanup.h"
#include "base/io.h"
#include "base/text.h"
#include "fits/io/source.h"

#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

/* Fail unless CFITSIO's status is 0. */
static int check_status(const sf_output *out, int status, const char *doing, shear_error *err) {
    return sf_check_status(err, (sf_place){out->name, NULL}, status, doing);
}

static int exists(const sf_output *out, shear_error *err) {
    return sf_fail(err, SHEAR_E_EXISTS, (sf_place){out->name, NULL},
                   "choose another name, or allow it to be replaced", "exists already");
}

/* Split the path into out->base and its directory, which is opened. */
static int open_directory(sf_output *out, const char *path, shear_error *err) {
    const sf_place at = {out->name, NULL};
    const char *slash = strrchr(path, '/');
    const char *base = slash != NULL ? slash + 1 : path;
    if (base[0] == '\0' || strcmp(base, ".") == 0 || strcmp(base, "..") == 0) {
        return sf_fail(err, SHEAR_E_IO, at, "give a file's name", "is %s",
                       path[0] == '\0' ? "an empty name" : "a directory");
    }
    if (strlen(base) >= sizeof out->base)
        return sf_fail_errno(err, at, ENAMETOOLONG, "cannot be written");
    text_set(out->base, sizeof out->base, base);
    CLEANUP(release_free)
    char *directory = slash == NULL   ? strdup(".")
                      : slash == path ? strdup("/")
                                      : strndup(path, (size_t)(slash - path));
    if (directory == NULL)
        return sf_fail_memory(err, at);
    out->directory = open(directory, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    return out->directory >= 0 ? SHEAR_OK
                               : sf_fail_errno(err, at, errno, "its directory cannot be opened");
}

static int check_target(const sf_output *out, shear_error *err) {
    struct stat st;
    if (fstatat(out->directory, out->base, &st, 0) == 0 && !S_ISREG(st.st_mode)) {
        return sf_fail(err, SHEAR_E_IO, (sf_place){out->name, NULL}, "give another name",
                       "is %s, which cannot be replaced",
                       S_ISDIR(st.st_mode) ? "a directory" : "not a regular file");
    }
    if (!out->overwrite && fstatat(out->directory, out->base, &st, AT_SYMLINK_NOFOLLOW) == 0)
        return exists(out, err);
    return SHEAR_OK;
}

static int name_temporary(sf_output *out, shear_error *err) {
    const sf_place at = {out->name, NULL};
    uint64_t random = 0;
    if (getrandom(&random, sizeof random, 0) != (ssize_t)sizeof random)
        return sf_fail_errno(err, at, errno, "no random number for a temporary name");
    snprintf(out->temporary, sizeof out->temporary, ".sheard-%ld-%016llx.part", (long)getpid(),
             (unsigned long long)random);
    /* Try it first: CFITSIO's own message would not say why a file cannot be created. */
    const int fd =
        openat(out->directory, out->temporary, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (fd < 0)
        return sf_fail_errno(err, at, errno, "cannot be written in its directory");
    close(fd);
    unlinkat(out->directory, out->temporary, 0);
    return SHEAR_OK;
}

/* Write the only name that is passed to CFITSIO. */
static void name_for_cfitsio(const sf_output *out, char proc[320]) {
    snprintf(proc, 320, "/proc/self/fd/%d/%s", out->directory, out->temporary);
}

static int create_file(sf_output *out, shear_error *err) {
    assert(out->directory >= 0 && out->fits == NULL);
    char proc[320];
    int status = 0;
    name_for_cfitsio(out, proc);
    out->exists = true;
    fits_create_diskfile(&out->fits, proc, &status);
    return check_status(out, status, "cannot be created", err);
}

int sf_output_create(sf_output *out, const char *path, bool overwrite, shear_error *err) {
    *out = (sf_output){.directory = -1, .overwrite = overwrite};
    sf_printable_name(out->name, sizeof out->name, path);
    TRY(open_directory(out, path, err));
    TRY(check_target(out, err));
    TRY(name_temporary(out, err));
    return create_file(out, err);
}

static int close_fits(sf_output *out, shear_error *err) {
    int status = 0;
    fits_close_file(out->fits, &status);
    out->fits = NULL;
    return check_status(out, status, "cannot be completed", err);
}

/* Make the file at least `bytes` long, and sync it to disk. */
static int sync_file(const sf_output *out, int64_t bytes, shear_error *err) {
    const sf_place at = {out->name, NULL};
    struct stat st;
    CLEANUP(release_fd)
    const int fd = openat(out->directory, out->temporary, O_RDWR | O_CLOEXEC);
    if (fd < 0)
        return sf_fail_errno(err, at, errno, "its temporary file cannot be opened");
    const bool synced =
        fstat(fd, &st) == 0 && (st.st_size >= bytes || ftruncate(fd, bytes) == 0) && fsync(fd) == 0;
    return synced ? SHEAR_OK : sf_fail_errno(err, at, errno, "cannot be brought to disk");
}

static int put_in_place(sf_output *out, shear_error *err) {
    const sf_place at = {out->name, NULL};
    const int failed = io_rename(out->directory, out->temporary, out->base, out->overwrite);
    if (failed != 0) {
        return failed == EEXIST ? exists(out, err)
                                : sf_fail_errno(err, at, failed, "cannot be put in place");
    }
    out->exists = false;
    return fsync(out->directory) == 0 || errno == EINVAL
               ? SHEAR_OK
               : sf_fail_errno(err, at, errno, "its directory cannot be brought to disk");
}

int sf_output_commit(sf_output *out, shear_error *err) {
    TRY(close_fits(out, err));
    TRY(sync_file(out, 0, err));
    return put_in_place(out, err);
}

void sf_output_discard(sf_output *out) {
    if (out->fits != NULL)
        close_fits(out, NULL);
    if (out->exists) {
        unlinkat(out->directory, out->temporary, 0);
        out->exists = false;
    }
    release_fd(&out->directory);
    out->directory = -1;
}

/* ---- files that outlive their process ---- */

static int name_kept(sf_output *out, const char *path, shear_error *err) {
    *out = (sf_output){.directory = -1, .overwrite = true};
    sf_printable_name(out->name, sizeof out->name, path);
    TRY(open_directory(out, path, err));
    snprintf(out->temporary, sizeof out->temporary, ".%s.part", out->base);
    return SHEAR_OK;
}

/* Remove an older temporary file, if there is one; `doing` is for the message. */
static int remove_kept(const sf_output *out, const char *doing, shear_error *err) {
    return unlinkat(out->directory, out->temporary, 0) == 0 || errno == ENOENT
               ? SHEAR_OK
               : sf_fail_errno(err, (sf_place){out->name, NULL}, errno, doing);
}

int sf_output_create_kept(sf_output *out, const char *path, shear_error *err) {
    TRY(name_kept(out, path, err));
    TRY(check_target(out, err));
    TRY(remove_kept(out, "its temporary file cannot be replaced", err));
    return create_file(out, err);
}

int sf_output_reopen(sf_output *out, const char *path, sf_output_check *check, void *context,
                     shear_error *err) {
    char proc[320];
    int status = 0;
    TRY(name_kept(out, path, err));
    name_for_cfitsio(out, proc);
    TRY(check(proc, context, err));
    out->exists = true;
    fits_open_diskfile(&out->fits, proc, READWRITE, &status);
    return check_status(out, status, "cannot be gone on with", err);
}

int sf_output_sync(sf_output *out, shear_error *err) {
    LONGLONG end = 0;
    int status = 0;
    fits_flush_file(out->fits, &status);
    fits_get_hduaddrll(out->fits, NULL, NULL, &end, &status);
    TRY(check_status(out, status, "cannot be written", err));
    return sync_file(out, end, err);
}

void sf_output_suspend(sf_output *out) {
    out->exists = false;
    sf_output_discard(out);
}

int sf_output_discard_kept(const char *path, shear_error *err) {
    CLEANUP(sf_output_discard) sf_output out;
    TRY(name_kept(&out, path, err));
    return remove_kept(&out, "its temporary file cannot be removed", err);
}

/* ---- keywords ---- */

void sf_output_double(fitsfile *fits, const char *key, double value, const char *comment,
                      int *status) {
    if (!isfinite(value))
        return;
    const int digits = text_digits(value, 15);
    fits_write_key_dbl(fits, key, value, -digits, comment, status); /* negative: %G */
}
