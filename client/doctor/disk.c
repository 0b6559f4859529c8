/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks of the service's directories from this process: existence, write access, free space,
 * clocks. */
#include "base/cleanup.h"
#include "base/clock.h"
#include "base/io.h"
#include "doctor/internal.h"
#include "terminal/human.h"

#include <errno.h>
#include <grp.h>
#include <linux/magic.h>
#include <pwd.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/statfs.h>
#include <sys/statvfs.h>
#include <sys/wait.h>
#include <unistd.h>

static const char service_user[] = "sheard";
static const int64_t little_bytes = INT64_C(1) << 30;
static const int64_t too_little_bytes = INT64_C(100) << 20;
static const double clock_tolerance_s = 2.0; /* some file systems store whole seconds */
enum { CIFS_MAGIC = (int)0xFF534D42 };       /* missing in linux/magic.h of some versions */

void doctor_report_space(doctor *d, const char *subject, const char *path, int64_t left) {
    char bytes[HUMAN_SIZE];
    human_bytes(left, bytes);
    if (left < little_bytes) {
        doctor_report(d, subject, left < too_little_bytes ? SHEARD_CHECK_FAIL : SHEARD_CHECK_WARN,
                      "make room on that disk", "%s: only %s free", path, bytes);
    } else {
        doctor_ok(d, subject, "%s: %s free", path, bytes);
    }
}

static void check_room(doctor *d, const char *subject, const char *path) {
    struct statvfs fs;
    if (statvfs(path, &fs) != 0) {
        doctor_warn(d, subject, "run doctor as root or as the service's user",
                    "%s cannot be examined: %s", path, strerror(errno));
        return;
    }
    doctor_report_space(d, subject, path, (int64_t)fs.f_bavail * (int64_t)fs.f_frsize);
}

/* The database's write-ahead log needs shared memory, which network file systems do not support. */
void doctor_check_local(doctor *d, const char *path) {
    struct statfs fs;
    if (statfs(path, &fs) != 0) {
        return; /* check_room has reported it */
    }
    if (fs.f_type == NFS_SUPER_MAGIC || fs.f_type == SMB_SUPER_MAGIC ||
        (int)fs.f_type == CIFS_MAGIC) {
        doctor_fail(d, "state", "put state_dir on a local disk", "%s is on a network file system",
                    path);
    }
}

static bool check_directory(doctor *d, const char *subject, const char *path, struct stat *st) {
    if (stat(path, st) != 0) {
        const bool hidden = errno == EACCES;
        doctor_report(d, subject, hidden ? SHEARD_CHECK_WARN : SHEARD_CHECK_FAIL,
                      hidden
                          ? "run doctor as root or as the service's user"
                          : "start the service once as its own user, or: systemd-tmpfiles --create",
                      "%s: %s", path, strerror(errno));
        return false;
    }
    if (!S_ISDIR(st->st_mode)) {
        doctor_fail(d, subject, "move it out of the way", "%s is not a directory", path);
        return false;
    }
    return true;
}

/* ---- Write test, as the user of the service: existence and mode are not sufficient evidence ----
 */

/* Return the user for the test if this is root; NULL: the user of this process. */
static const struct passwd *other_user(void) {
    return geteuid() == 0 ? getpwnam(service_user) : NULL;
}

static bool become(const struct passwd *user) {
    return initgroups(user->pw_name, user->pw_gid) == 0 && setgid(user->pw_gid) == 0 &&
           setuid(user->pw_uid) == 0;
}

/* Try to write in a child process, which changes to the user. Returns 0 or errno. */
static int try_as(const struct passwd *user, const char *directory) {
    int status = 0;
    fflush(NULL); /* flush before fork: a sanitizer's _exit would write the child's copy of the
                     buffers */
    const pid_t pid = fork();
    if (pid == 0) {
        const bool good = user == NULL || become(user);
        _exit(good && io_open_nameless(directory) >= 0 ? 0 : errno & 0xff);
    }
    if (pid < 0 || waitpid(pid, &status, 0) != pid || !WIFEXITED(status))
        return ECHILD;
    return WEXITSTATUS(status);
}

/* Check that `directory` is writable for the service's user (if this is root) or for this process.
 * If it is not, report that and return false. */
static bool test_write(doctor *d, const char *subject, const char *directory) {
    struct stat st = {0};
    const struct passwd *user = other_user();
    const bool as_service = user != NULL; /* the next call may reuse what it points to */
    const int error = try_as(user, directory);
    if (error == 0)
        return true;
    const struct passwd *owner = stat(directory, &st) == 0 ? getpwuid(st.st_uid) : NULL;
    const bool ours = geteuid() == 0 || (owner != NULL && owner->pw_uid == geteuid());
    char remedy[300];
    snprintf(remedy, sizeof remedy,
             ours ? "give it to the service's user (chown -R %s: %s), or remove it and run "
                    "systemd-tmpfiles --create"
                  : "if the service is to run as somebody else, run doctor as that user or as root",
             service_user, directory);
    doctor_report(d, subject,
                  ours || error == EROFS || error == ENOSPC ? SHEARD_CHECK_FAIL : SHEARD_CHECK_WARN,
                  remedy, "%s: %s may not write there (%s); it belongs to %s", directory,
                  as_service ? service_user : "you", strerror(error),
                  owner != NULL ? owner->pw_name : "an unknown user");
    return false;
}

/* ---- The spool ---- */

static void check_folders(doctor *d) {
    static const char *const names[] = {"incoming", "active", "done", "failed"};
    struct stat spool;
    if (!check_directory(d, "spool", d->spool, &spool))
        return;
    check_room(d, "spool", d->spool);
    size_t good = 0;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        char path[4400];
        struct stat st;
        snprintf(path, sizeof path, "%s/%s", d->spool, names[i]);
        if (!check_directory(d, "spool", path, &st))
            continue;
        if (st.st_dev != spool.st_dev) {
            doctor_fail(d, "spool", "all four folders must be on the disk of the spool",
                        "%s is on another file system", path);
        } else if (test_write(d, "spool", path)) {
            good++;
        }
    }
    if (good == sizeof names / sizeof *names)
        doctor_ok(d, "spool", "incoming, active, done and failed are there, and can be written to");
}

/* Return whether the file is locked (flock). This reads the kernel's list of locks: a test lock
 * could make a daemon fail that is just starting. */
static bool is_locked(const struct stat *st) {
    char line[256];
    char inode[32];
    bool found = false;
    CLEANUP(release_file) FILE *locks = fopen("/proc/locks", "re");
    snprintf(inode, sizeof inode, ":%ju ", (uintmax_t)st->st_ino);
    while (locks != NULL && !found && fgets(line, sizeof line, locks) != NULL)
        found = strstr(line, "FLOCK") != NULL && strstr(line, inode) != NULL;
    return found;
}

/* Report whether a daemon holds the lock on its spool, as it does while it runs. */
static void check_lock(doctor *d) {
    char path[4400];
    struct stat st;
    snprintf(path, sizeof path, "%s/.lock", d->spool);
    const bool there = stat(path, &st) == 0;
    const bool locked = there && is_locked(&st);
    if (!there && errno != ENOENT) {
        doctor_warn(d, "lock", "run doctor as root or as the service's user",
                    "%s cannot be examined: %s", path, strerror(errno));
    } else if (!locked && d->reached) {
        doctor_warn(d, "lock", "does the service that answers use another configuration?",
                    "nobody holds the lock of the spool, though the service runs");
    } else if (locked && !d->reached) {
        doctor_warn(d, "lock",
                    "look for a service that is stuck or has another socket: systemctl status "
                    "sheard",
                    "the spool is locked, though no service answers");
    } else {
        doctor_ok(d, "lock", "the spool is %s", locked ? "locked by its service" : "not locked");
    }
}

/* The watch folder compares file times, set by the file server, with the local clock. */
void doctor_check_clock(doctor *d) {
    char path[4400];
    struct stat st;
    snprintf(path, sizeof path, "%s/incoming", d->spool);
    CLEANUP(release_fd) const int fd = io_open_nameless(path);
    if (fd < 0 || write(fd, "x", 1) != 1 || fstat(fd, &st) != 0) {
        doctor_warn(d, "clock", "run doctor as someone who may drop files",
                    "the clock of the spool's file system cannot be read: %s", strerror(errno));
        return;
    }
    const int64_t theirs_ms = (int64_t)st.st_mtim.tv_sec * 1000 + st.st_mtim.tv_nsec / 1000000;
    const double off = (double)(clock_ms(CLOCK_REALTIME) - theirs_ms) / 1000.0;
    const bool good = off < clock_tolerance_s && off > -clock_tolerance_s;
    doctor_report(d, "clock", good ? SHEARD_CHECK_OK : SHEARD_CHECK_WARN,
                  "synchronise the clocks (NTP), or make settle_time longer",
                  "the spool's file system is %.1f s %s this machine's clock", off < 0 ? -off : off,
                  off < 0 ? "before" : "behind");
}

/* ---- Data roots ---- */

static void check_root(doctor *d, const char *path) {
    struct stat st;
    const int error = stat(path, &st) != 0 ? errno : S_ISDIR(st.st_mode) ? 0 : ENOTDIR;
    if (error != 0) {
        doctor_warn(d, "data root", "mount or create it; jobs beneath it wait until it exists",
                    "%s: %s", path, strerror(error));
    } else if (access(path, R_OK | X_OK) != 0) {
        doctor_warn(d, "data root", "ask for read permission on it",
                    "%s: you may not read it, so no file in it will be measured for you", path);
    } else {
        doctor_ok(d, "data root", "%s is readable for you", path);
    }
}

void doctor_report_no_roots(doctor *d) {
    doctor_warn(d, "data root", "set [access] data_roots, if files are to be submitted by name",
                "none: files come only from the watch folder");
}

static void check_roots(doctor *d) {
    if (d->roots == NULL || *d->roots == '\0') {
        doctor_report_no_roots(d);
        return;
    }
    for (char *at = d->roots; at;) {
        char *comma = strstr(at, ", ");
        if (comma != NULL)
            *comma = '\0';
        check_root(d, at);
        at = comma != NULL ? comma + 2 : NULL;
    }
}

void doctor_check_disks(doctor *d) {
    struct stat st;
    if (d->state_dir != NULL && check_directory(d, "state", d->state_dir, &st)) {
        check_room(d, "state", d->state_dir);
        if (test_write(d, "state", d->state_dir))
            doctor_ok(d, "state", "%s can be written to", d->state_dir);
        doctor_check_local(d, d->state_dir);
    }
    if (d->spool != NULL && d->has_spool) {
        check_folders(d);
        check_lock(d);
        doctor_check_clock(d);
    }
    if (d->state_dir != NULL) { /* the configuration is known */
        check_roots(d);
    }
}
