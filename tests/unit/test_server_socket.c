/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The socket file: its owner, who may connect and when, and what prevents its creation. */
#include "server_fixture.h"

#include "test.h"

#include <errno.h>
#include <fcntl.h>
#include <grp.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

static int open_server(fixture *f, shear_error *err) {
    const int code = server_open(&f->s, &f->loop, &f->options, err);
    assert_true((code == SHEAR_OK) == (f->s != NULL));
    return code;
}

/* A socket bound to the fixture's path; it listens if `alive`. */
static int bind_socket(const fixture *f, bool alive) {
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    const int fd = socket(AF_UNIX, SOCK_STREAM, 0);
    snprintf(address.sun_path, sizeof address.sun_path, "%s", f->path);
    assert_int_equal(bind(fd, (const struct sockaddr *)&address, sizeof address), 0);
    if (alive)
        assert_int_equal(listen(fd, 1), 0);
    return fd;
}

static struct stat look(const char *path) {
    struct stat st = {0};
    assert_int_equal(lstat(path, &st), 0);
    return st;
}

/* ---- mode and group ---- */

typedef struct watcher {
    const char *path;
    gid_t gid;
    atomic_bool stop;
    atomic_uint seen;    /* looks that found a file */
    atomic_uint modes;   /* all bits that it ever had */
    atomic_bool foreign; /* group bits while it had another group */
} watcher;

static void *watch(void *argument) {
    watcher *w = argument;
    struct stat st;
    while (!atomic_load(&w->stop)) {
        if (lstat(w->path, &st) == 0) {
            atomic_fetch_add(&w->seen, 1);
            atomic_fetch_or(&w->modes, st.st_mode & 07777);
            if ((st.st_mode & 070) != 0 && st.st_gid != w->gid)
                atomic_store(&w->foreign, true);
        }
    }
    return NULL;
}

/* A group that is not the process's own, where it may give files away. */
static gid_t other_group(fixture *f, char *name, size_t size) {
    gid_t gid = getegid();
    const struct group *g;
    setgrent();
    while (geteuid() == 0 && gid == getegid() && (g = getgrent())) {
        if (g->gr_gid != gid) {
            gid = g->gr_gid;
            snprintf(name, size, "%s", g->gr_name);
            f->options.group = name;
        }
    }
    endgrent();
    return gid;
}

static void test_mode_is_never_wider(void **state) {
    fixture *f = *state;
    char group[64];
    pthread_t thread;
    watcher w = {.path = f->path, .gid = other_group(f, group, sizeof group)};
    const mode_t umask_before = umask(0);
    assert_int_equal(pthread_create(&thread, NULL, watch, &w), 0);
    for (int i = 0; i < 200 || atomic_load(&w.seen) < 1000; i++) {
        f->options.mode = 0620;
        fx_open(f);
        assert_int_equal(look(f->path).st_mode & 07777, 0620);
        assert_int_equal(look(f->path).st_gid, w.gid);
        fx_close(f, 0);
    }
    atomic_store(&w.stop, true);
    pthread_join(thread, NULL);
    umask(umask_before);
    assert_int_equal(atomic_load(&w.modes) & ~0620u, 0);
    assert_false(atomic_load(&w.foreign));
}

static void test_umask_does_not_matter(void **state) {
    fixture *f = *state;
    const mode_t umask_before = umask(0777);
    f->options.mode = 0666;
    fx_open(f);
    umask(umask_before);
    assert_int_equal(look(f->path).st_mode & 07777, 0666);
}

/* ---- what is in the way ---- */

static void test_stale_socket_is_replaced(void **state) {
    fixture *f = *state;
    close(bind_socket(f, true));
    fx_open(f);
    client c;
    cl_connect(f, &c);
    cl_say(f, &c, request_text(1, "metrics", NULL));
    assert_int_equal(cl_reply(f, &c), 1);
    cl_close(&c);
}

static void expect_refused(fixture *f, int code, const char *word) {
    shear_error err = {0};
    assert_int_equal(open_server(f, &err), code);
    assert_non_null(strstr(err.message, word));
    assert_non_null(strstr(err.message, f->path));
    assert_string_not_equal(err.advice, "");
}

static void test_live_socket_is_left_alone(void **state) {
    fixture *f = *state;
    const int fd = bind_socket(f, true);
    const ino_t inode = look(f->path).st_ino;
    expect_refused(f, SHEAR_E_EXISTS, "another service");
    assert_int_equal(look(f->path).st_ino, inode);
    close(fd);
}

/* Its backlog is full: connect says EAGAIN. */
static void test_busy_socket_is_alive(void **state) {
    fixture *f = *state;
    const int fd = bind_socket(f, true);
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    snprintf(address.sun_path, sizeof address.sun_path, "%s", f->path);
    int fds[16];
    size_t n = 0;
    int rc = 0;
    while (n < 16 && rc == 0) {
        fds[n] = socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0);
        rc = connect(fds[n++], (const struct sockaddr *)&address, sizeof address);
    }
    assert_int_equal(rc, -1);
    assert_int_equal(errno, EAGAIN);
    expect_refused(f, SHEAR_E_EXISTS, "another service");
    while (n > 0)
        close(fds[--n]);
    close(fd);
}

static void test_second_server_is_refused(void **state) {
    fixture *f = *state;
    fx_open(f);
    server *first = f->s;
    expect_refused(f, SHEAR_E_EXISTS, "another service");
    f->s = first;
    client c;
    cl_connect(f, &c); /* the first one lives on, under its name */
    cl_say(f, &c, request_text(1, "metrics", NULL));
    assert_int_equal(cl_reply(f, &c), 1);
    cl_close(&c);
}

/* Bound and not yet listening looks dead; the lock says that it is being born. */
static void test_lock_keeps_others_out(void **state) {
    fixture *f = *state;
    char lock[128];
    const int fd = bind_socket(f, false);
    snprintf(lock, sizeof lock, "%s.lock", f->path);
    const int held = open(lock, O_RDWR | O_CREAT | O_CLOEXEC, 0600);
    assert_int_equal(flock(held, LOCK_EX), 0);
    expect_refused(f, SHEAR_E_EXISTS, "another service");
    assert_int_equal(look(lock).st_mode & 0777, 0600); /* and it is not removed */
    close(held);
    fx_open(f); /* nobody holds it: what lies around is stale */
    close(fd);
}

static void test_other_files_are_left_alone(void **state) {
    fixture *f = *state;
    const int fd = open(f->path, O_CREAT | O_WRONLY, 0600);
    assert_int_equal(write(fd, "mine", 4), 4);
    close(fd);
    expect_refused(f, SHEAR_E_EXISTS, "not a socket");
    assert_int_equal(look(f->path).st_size, 4);
    unlink(f->path);
    assert_int_equal(symlink("/nowhere", f->path), 0);
    expect_refused(f, SHEAR_E_EXISTS, "not a socket");
    assert_true(S_ISLNK(look(f->path).st_mode));
}

static void test_socket_of_another_user(void **state) {
    fixture *f = *state;
    if (geteuid() != 0)
        skip();
    close(bind_socket(f, true));
    assert_int_equal(chown(f->path, 12345, (gid_t)-1), 0);
    expect_refused(f, SHEAR_E_EXISTS, "this user");
    assert_int_equal(look(f->path).st_uid, 12345);
}

/* As a user that is not in the group: told so, with what to do, and no socket stays. */
static void test_group_of_others(void **state) {
    fixture *f = *state;
    char name[64] = "";
    const struct group *g;
    setgrent();
    while (name[0] == '\0' && (g = getgrent())) {
        if (g->gr_gid != 0 && g->gr_gid != 65534 && group_member(g->gr_gid) == 0)
            snprintf(name, sizeof name, "%s", g->gr_name);
    }
    endgrent();
    assert_true(name[0] != '\0');
    assert_int_equal(chmod(f->dir, 0777), 0);
    const pid_t pid = fork();
    assert_true(pid >= 0);
    if (pid == 0) {
        shear_error err = {0};
        const bool me =
            geteuid() != 0 || (setgroups(0, NULL) == 0 && setgid(65534) == 0 && setuid(65534) == 0);
        f->options.group = name;
        const int code = open_server(f, &err);
        _exit(me && code == SHEAR_E_SETTING && strstr(err.message, name) != NULL &&
                      strstr(err.message, "socket_group") != NULL &&
                      strstr(err.advice, "usermod") != NULL
                  ? 0
                  : 1);
    }
    int status = 0;
    assert_int_equal(waitpid(pid, &status, 0), pid);
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), 0);
    struct stat st;
    assert_int_equal(lstat(f->path, &st), -1);
}

static void test_bad_places(void **state) {
    fixture *f = *state;
    char path[160];
    shear_error err = {0};
    f->options.group = "no-such-group-here";
    expect_refused(f, SHEAR_E_SETTING, "no group");
    f->options.group = "";
    snprintf(path, sizeof path, "%s/missing/socket", f->dir);
    f->options.path = path;
    assert_int_equal(open_server(f, &err), SHEAR_E_IO);
    memset(path, 'x', 108);
    path[0] = '/';
    path[108] = '\0';
    assert_int_equal(open_server(f, &err), SHEAR_E_SETTING);
    assert_non_null(strstr(err.message, "1 to 107"));
    f->options.path = "";
    assert_int_equal(open_server(f, &err), SHEAR_E_SETTING);
}

static void test_only_the_own_file_is_removed(void **state) {
    fixture *f = *state;
    fx_open(f);
    assert_int_equal(unlink(f->path), 0);
    const int fd = bind_socket(f, true); /* somebody else's */
    fx_close(f, 0);
    assert_true(S_ISSOCK(look(f->path).st_mode));
    close(fd);
    fx_open(f);
    server_stop_accepting(f->s);
    struct stat st;
    assert_int_equal(lstat(f->path, &st), -1);
}

/* ---- activation ---- */

static void set_activation(pid_t pid, const char *count) {
    char text[32];
    snprintf(text, sizeof text, "%d", (int)pid);
    setenv("LISTEN_PID", text, 1);
    setenv("LISTEN_FDS", count, 1);
    setenv("LISTEN_FDNAMES", "x", 1);
}

/* In a child, where descriptor 3 may be anything: its exit code tells. */
static int activate(int fd, pid_t pid, const char *count, int wanted, size_t n_wanted) {
    const pid_t child = fork();
    if (child == 0) {
        shear_error err = {0};
        int fds[2] = {-1, -1};
        size_t n = 99;
        if (fd >= 0 && fd != 3) {
            dup2(fd, 3);
        } else if (fd < 0) {
            close(3);
        }
        set_activation(pid != 0 ? pid : getpid(), count);
        const int code = server_activation(fds, 2, &n, &err);
        const bool gone = getenv("LISTEN_PID") == NULL && getenv("LISTEN_FDS") == NULL &&
                          getenv("LISTEN_FDNAMES") == NULL;
        const bool good = n == 0 || (fds[0] == 3 && (fcntl(3, F_GETFD) & FD_CLOEXEC));
        _exit(code != wanted ? 1 : n != n_wanted ? 2 : !gone ? 3 : good ? 0 : 4);
    }
    int status = -1;
    waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

static void test_activation(void **state) {
    fixture *f = *state;
    const int listening = bind_socket(f, true);
    const int bare = socket(AF_UNIX, SOCK_STREAM, 0);
    const int inet = socket(AF_INET, SOCK_STREAM, 0);
    assert_int_equal(activate(listening, 0, "1", SHEAR_OK, 1), 0);
    assert_int_equal(activate(listening, 0, "0", SHEAR_OK, 0), 0);
    assert_int_equal(activate(listening, 1, "1", SHEAR_OK, 0), 0); /* for somebody else */
    assert_int_equal(activate(listening, 0, "3", SHEAR_E_SETTING, 0), 0);
    assert_int_equal(activate(listening, 0, "1x", SHEAR_E_SETTING, 0), 0);
    assert_int_equal(activate(listening, 0, "-1", SHEAR_E_SETTING, 0), 0);
    assert_int_equal(activate(bare, 0, "1", SHEAR_E_SETTING, 0), 0);
    assert_int_equal(activate(inet, 0, "1", SHEAR_E_SETTING, 0), 0);
    assert_int_equal(activate(-1, 0, "1", SHEAR_E_SETTING, 0), 0);
    close(listening);
    close(bare);
    close(inet);
}

static void test_given_socket(void **state) {
    fixture *f = *state;
    const int fds[] = {bind_socket(f, true)};
    f->options.fds = fds;
    f->options.n_fds = 1;
    f->options.path = "/not/this/one";
    fx_open(f);
    client c;
    char sockets[200];
    server_sockets(f->s, sockets, sizeof sockets);
    assert_string_equal(sockets, f->path); /* which the options do not know */
    cl_connect(f, &c);
    cl_say(f, &c, request_text(5, "metrics", NULL));
    assert_int_equal(cl_reply(f, &c), 5);
    cl_close(&c);
    fx_close(f, 0);
    assert_true(S_ISSOCK(look(f->path).st_mode)); /* systemd's, not ours */
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_mode_is_never_wider, fx_setup, fx_teardown),
        cmocka_unit_test_setup_teardown(test_umask_does_not_matter, fx_setup, fx_teardown),
        cmocka_unit_test_setup_teardown(test_stale_socket_is_replaced, fx_setup, fx_teardown),
        cmocka_unit_test_setup_teardown(test_live_socket_is_left_alone, fx_setup, fx_teardown),
        cmocka_unit_test_setup_teardown(test_busy_socket_is_alive, fx_setup, fx_teardown),
        cmocka_unit_test_setup_teardown(test_second_server_is_refused, fx_setup, fx_teardown),
        cmocka_unit_test_setup_teardown(test_lock_keeps_others_out, fx_setup, fx_teardown),
        cmocka_unit_test_setup_teardown(test_other_files_are_left_alone, fx_setup, fx_teardown),
        cmocka_unit_test_setup_teardown(test_socket_of_another_user, fx_setup, fx_teardown),
        cmocka_unit_test_setup_teardown(test_group_of_others, fx_setup, fx_teardown),
        cmocka_unit_test_setup_teardown(test_bad_places, fx_setup, fx_teardown),
        cmocka_unit_test_setup_teardown(test_only_the_own_file_is_removed, fx_setup, fx_teardown),
        cmocka_unit_test_setup_teardown(test_activation, fx_setup, fx_teardown),
        cmocka_unit_test_setup_teardown(test_given_socket, fx_setup, fx_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
