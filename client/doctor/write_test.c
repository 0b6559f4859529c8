/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Write test in a directory, as the user of the service: existence and mode are not sufficient
 * evidence. */
#include "doctor/internal.h"

#include "base/io.h"

#include <errno.h>
#include <grp.h>
#include <pwd.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

static const char service_user[] = "sheard";

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

bool doctor_test_write(doctor *d, const char *subject, const char *directory) {
    struct stat st = {0};
    const struct passwd *user = other_user();
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
             user != NULL ? user->pw_name : service_user, directory);
    doctor_report(d, subject,
                  ours || error == EROFS || error == ENOSPC ? SHEARD_CHECK_FAIL : SHEARD_CHECK_WARN,
                  remedy, "%s: %s may not write there (%s); it belongs to %s", directory,
                  user != NULL ? user->pw_name : "you", strerror(error),
                  owner != NULL ? owner->pw_name : "an unknown user");
    return false;
}
