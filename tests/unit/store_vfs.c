/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "store_vfs.h"

#include <sqlite3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

const char store_vfs_name[] = "sheard-test";

/* The real file follows in memory. */
typedef struct file {
    sqlite3_file base;
    char path[512]; /* empty: a temporary file */
} file;

static sqlite3_vfs *real_vfs;
static struct {
    enum store_vfs_fault fault;
    int64_t at, calls, syncs;
    bool fired, remember;
} plan;

static sqlite3_file *real(sqlite3_file *f) {
    return (sqlite3_file *)(void *)((file *)(void *)f + 1);
}

/* Does this call fail? Counted in any case. */
static bool fails(bool is_write) {
    if (plan.fault == VFS_READ_ERROR)
        return false;
    plan.calls++;
    if (plan.fault == VFS_SOUND || plan.calls < plan.at)
        return false;
    const bool hit = plan.fault == VFS_IO_ERROR ? plan.calls == plan.at
                     : plan.fault == VFS_FULL   ? is_write
                                                : true;
    plan.fired = plan.fired || hit;
    return hit;
}

static bool is_dead(void) {
    return plan.fired && plan.fault == VFS_POWER_CUT;
}

static void name_synced(char *out, size_t size, const char *path) {
    snprintf(out, size, "%s.synced", path);
}

static bool copy_file(const char *from, const char *to) {
    char buffer[65536];
    size_t n = 0;
    unlink(to); /* some file systems write a file out that replaces another by truncating it */
    FILE *in = fopen(from, "rb");
    FILE *out = in != NULL ? fopen(to, "wb") : NULL;
    bool good = out != NULL;
    while (good && (n = fread(buffer, 1, sizeof buffer, in)) > 0)
        good = fwrite(buffer, 1, n, out) == n;
    if (out != NULL)
        good = fclose(out) == 0 && good;
    if (in != NULL)
        fclose(in);
    return good;
}

static int f_close(sqlite3_file *f) {
    return real(f)->pMethods->xClose(real(f));
}

static int f_read(sqlite3_file *f, void *to, int n, sqlite3_int64 at) {
    if (plan.fault == VFS_READ_ERROR && ++plan.calls == plan.at) {
        plan.fired = true;
        return SQLITE_IOERR_READ;
    }
    return is_dead() ? SQLITE_IOERR_READ : real(f)->pMethods->xRead(real(f), to, n, at);
}

static int f_write(sqlite3_file *f, const void *from, int n, sqlite3_int64 at) {
    if (fails(true)) {
        if (!is_dead() && n > 1)
            real(f)->pMethods->xWrite(real(f), from, n / 2, at);
        return plan.fault == VFS_FULL ? SQLITE_FULL : SQLITE_IOERR_WRITE;
    }
    return real(f)->pMethods->xWrite(real(f), from, n, at);
}

static int f_truncate(sqlite3_file *f, sqlite3_int64 size) {
    return fails(false) ? SQLITE_IOERR_TRUNCATE : real(f)->pMethods->xTruncate(real(f), size);
}

static int f_sync(sqlite3_file *f, int flags) {
    char synced[600];
    const char *path = ((file *)(void *)f)->path;
    (void)flags;
    plan.syncs++;
    if (fails(false))
        return SQLITE_IOERR_FSYNC;
    name_synced(synced, sizeof synced, path);
    return !plan.remember || path[0] == '\0' || copy_file(path, synced) ? SQLITE_OK
                                                                        : SQLITE_IOERR_FSYNC;
}

static int f_size(sqlite3_file *f, sqlite3_int64 *size) {
    return is_dead() ? SQLITE_IOERR_FSTAT : real(f)->pMethods->xFileSize(real(f), size);
}

static int f_lock(sqlite3_file *f, int level) {
    return real(f)->pMethods->xLock(real(f), level);
}

static int f_unlock(sqlite3_file *f, int level) {
    return real(f)->pMethods->xUnlock(real(f), level);
}

static int f_check_lock(sqlite3_file *f, int *locked) {
    return real(f)->pMethods->xCheckReservedLock(real(f), locked);
}

static int f_control(sqlite3_file *f, int op, void *arg) {
    return real(f)->pMethods->xFileControl(real(f), op, arg);
}

static int f_sector(sqlite3_file *f) {
    return real(f)->pMethods->xSectorSize(real(f));
}

/* No promise of the real file system is passed on (such as safe appends): the worst disk is
 * simulated. */
static int f_traits(sqlite3_file *f) {
    (void)f;
    return 0;
}

/* Version 1: without shared memory, which an exclusive owner does not need. */
static const sqlite3_io_methods methods = {.iVersion = 1,
                                           .xClose = f_close,
                                           .xRead = f_read,
                                           .xWrite = f_write,
                                           .xTruncate = f_truncate,
                                           .xSync = f_sync,
                                           .xFileSize = f_size,
                                           .xLock = f_lock,
                                           .xUnlock = f_unlock,
                                           .xCheckReservedLock = f_check_lock,
                                           .xFileControl = f_control,
                                           .xSectorSize = f_sector,
                                           .xDeviceCharacteristics = f_traits};

static int v_open(sqlite3_vfs *vfs, sqlite3_filename name, sqlite3_file *f, int flags, int *out) {
    file *me = (file *)(void *)f;
    (void)vfs;
    me->base.pMethods = NULL;
    snprintf(me->path, sizeof me->path, "%s", name != NULL ? name : "");
    if (is_dead())
        return SQLITE_CANTOPEN;
    const int rc = real_vfs->xOpen(real_vfs, name, real(f), flags, out);
    me->base.pMethods = real(f)->pMethods != NULL ? &methods : NULL;
    return rc;
}

static int v_delete(sqlite3_vfs *vfs, const char *name, int sync_directory) {
    char synced[600];
    (void)vfs;
    if (fails(false))
        return SQLITE_IOERR_DELETE;
    /* A deletion that is not synced is undone when the power is cut. */
    if (plan.remember && sync_directory != 0) {
        name_synced(synced, sizeof synced, name);
        unlink(synced);
    }
    return real_vfs->xDelete(real_vfs, name, 0);
}

static int v_access(sqlite3_vfs *vfs, const char *name, int flags, int *out) {
    (void)vfs;
    return real_vfs->xAccess(real_vfs, name, flags, out);
}

static int v_full_path(sqlite3_vfs *vfs, const char *name, int size, char *out) {
    (void)vfs;
    return real_vfs->xFullPathname(real_vfs, name, size, out);
}

static int v_random(sqlite3_vfs *vfs, int n, char *out) {
    (void)vfs;
    return real_vfs->xRandomness(real_vfs, n, out);
}

static int v_sleep(sqlite3_vfs *vfs, int us) {
    (void)vfs;
    return real_vfs->xSleep(real_vfs, us);
}

static int v_time(sqlite3_vfs *vfs, double *day) {
    (void)vfs;
    return real_vfs->xCurrentTime(real_vfs, day);
}

static int v_last_error(sqlite3_vfs *vfs, int n, char *out) {
    (void)vfs;
    return real_vfs->xGetLastError(real_vfs, n, out);
}

void store_vfs_register(void) {
    static sqlite3_vfs vfs = {.iVersion = 1,
                              .mxPathname = 500,
                              .zName = store_vfs_name,
                              .xOpen = v_open,
                              .xDelete = v_delete,
                              .xAccess = v_access,
                              .xFullPathname = v_full_path,
                              .xRandomness = v_random,
                              .xSleep = v_sleep,
                              .xCurrentTime = v_time,
                              .xGetLastError = v_last_error};
    if (real_vfs == NULL) {
        real_vfs = sqlite3_vfs_find(NULL);
        vfs.szOsFile = (int)sizeof(file) + real_vfs->szOsFile;
        sqlite3_vfs_register(&vfs, 0);
    }
    store_vfs_remember(false);
    store_vfs_arm(VFS_SOUND, 0);
}

void store_vfs_arm(enum store_vfs_fault fault, int64_t at) {
    plan.fault = fault;
    plan.at = at;
    plan.calls = 0;
    plan.syncs = 0;
    plan.fired = false;
}

bool store_vfs_fired(void) {
    return plan.fired;
}

int64_t store_vfs_calls(void) {
    return plan.calls;
}

int64_t store_vfs_syncs(void) {
    return plan.syncs;
}

void store_vfs_remember(bool on) {
    plan.remember = on;
}

void store_vfs_restart(const char *path) {
    static const char *const endings[] = {"", "-wal", "-journal"};
    for (size_t i = 0; i < sizeof endings / sizeof endings[0]; i++) {
        char name[512];
        char synced[600];
        snprintf(name, sizeof name, "%s%s", path, endings[i]);
        name_synced(synced, sizeof synced, name);
        unlink(name);
        if (access(synced, F_OK) == 0 && !copy_file(synced, name)) {
            fprintf(stderr, "store_vfs: cannot restore %s\n", name);
            abort();
        }
    }
    store_vfs_arm(VFS_SOUND, 0);
}
