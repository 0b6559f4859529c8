/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Resolving beneath a directory: as the kernel does it by openat2, for any tree of links; within
 * its bounds; and while names move. */
#include "remove_tree.h"
#include "test.h"

#include "access/beneath.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <linux/openat2.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

typedef struct fixture {
    char top[128];
    int out, root; /* top/out, which nothing may reach, and top/root */
} fixture;

static const access_peer root_peer = {0, 0, NULL, 0};
static const access_peer alice = {54321, 54321, NULL, 0};

static int setup(void **state) {
    fixture *f = calloc(1, sizeof *f);
    assert_non_null(f);
    const char *base = getenv("TMPDIR");
    snprintf(f->top, sizeof f->top, "%.80s/sheard-beneath-XXXXXX", base != NULL ? base : "/tmp");
    assert_non_null(mkdtemp(f->top));
    const int top = open(f->top, O_PATH | O_DIRECTORY | O_CLOEXEC);
    assert_int_equal(mkdirat(top, "out", 0755), 0);
    assert_int_equal(mkdirat(top, "root", 0755), 0);
    f->out = openat(top, "out", O_PATH | O_DIRECTORY | O_CLOEXEC);
    f->root = openat(top, "root", O_PATH | O_DIRECTORY | O_CLOEXEC);
    assert_true(f->out >= 0 && f->root >= 0);
    close(top);
    *state = f;
    return 0;
}

static int teardown(void **state) {
    fixture *f = *state;
    close(f->out);
    close(f->root);
    remove_tree(f->top);
    free(f);
    return 0;
}

static void make_file(int at, const char *name) {
    const int fd = openat(at, name, O_WRONLY | O_CREAT | O_CLOEXEC, 0644);
    assert_true(fd >= 0);
    close(fd);
}

/* 0, and what it is; or -errno. */
static int resolve(int root, const char *path, const access_peer *peer, struct stat *st) {
    char link = 'x';
    const int fd = beneath_open(root, path, peer, &link);
    if (fd < 0)
        return fd;
    assert_true((fcntl(fd, F_GETFD) & FD_CLOEXEC) != 0);
    assert_true((fcntl(fd, F_GETFL) & O_PATH) != 0);
    assert_int_equal(fstat(fd, st), 0);
    close(fd);
    return 0;
}

static int resolve_by_kernel(int root, const char *path, struct stat *st) {
    struct open_how how = {.flags = O_PATH | O_CLOEXEC,
                           .resolve = RESOLVE_BENEATH | RESOLVE_NO_MAGICLINKS};
    long fd = -1;
    do { /* the kernel gives up with EAGAIN if anything on the machine is renamed meanwhile */
        fd = syscall(SYS_openat2, root, path, &how, sizeof how);
    } while (fd < 0 && errno == EAGAIN);
    if (fd < 0)
        return -errno;
    assert_int_equal(fstat((int)fd, st), 0);
    close((int)fd);
    return 0;
}

/* ---- the law ---- */

static unsigned draw(unsigned *seed, unsigned n) {
    *seed = *seed * 1664525U + 1013904223U;
    return (*seed >> 8) % n;
}

static const char *const names[] = {"a", "b", "c", "d", "e"};
enum { N_NAMES = sizeof names / sizeof names[0] };

/* A path by chance: names, and "..", ".", slashes where they are wanted. */
static void draw_path(unsigned *seed, bool wild, char *path, size_t size) {
    const unsigned n = 1 + draw(seed, 5);
    size_t at = wild && draw(seed, 12) == 0 ? (size_t)snprintf(path, size, "/") : 0;
    for (unsigned i = 0; i < n; i++) {
        const unsigned kind = wild ? draw(seed, 10) : 0;
        const char *name = kind < 6 ? names[draw(seed, N_NAMES)] : kind < 9 ? ".." : ".";
        const char *slash = i + 1 < n            ? (draw(seed, 8) == 0 ? "//" : "/")
                            : draw(seed, 6) == 0 ? "/"
                                                 : "";
        at += (size_t)snprintf(path + at, size - at, "%s%s", name, slash);
    }
}

/* Directories, files and links by chance, `depth` levels of them. */
static void grow(unsigned *seed, int at, int depth) {
    char text[64];
    for (int i = 0; i < N_NAMES; i++) {
        const unsigned kind = draw(seed, 8);
        if (kind < 3 && depth > 0) {
            assert_int_equal(mkdirat(at, names[i], 0755), 0);
            const int sub = openat(at, names[i], O_PATH | O_DIRECTORY | O_CLOEXEC);
            grow(seed, sub, depth - 1);
            close(sub);
        } else if (kind < 4) {
            make_file(at, names[i]);
        } else if (kind < 7) {
            draw_path(seed, true, text, sizeof text);
            assert_int_equal(symlinkat(text, at, names[i]), 0);
        }
    }
}

static void as_the_kernel_does(void **state) {
    const fixture *f = *state;
    enum { TREES = 40, PATHS = 250 };
    struct stat st;
    unsigned seed = 20261130;
    int good = 0;
    if (resolve_by_kernel(f->root, ".", &st) == -ENOSYS ||
        resolve_by_kernel(f->root, ".", &st) == -EPERM) {
        skip(); /* no openat2 here: that is what beneath_open is for */
    }
    for (int tree = 0; tree < TREES; tree++) {
        char name[16];
        snprintf(name, sizeof name, "%d", tree);
        assert_int_equal(mkdirat(f->root, name, 0755), 0);
        const int root = openat(f->root, name, O_PATH | O_DIRECTORY | O_CLOEXEC);
        grow(&seed, root, 3);
        for (int i = 0; i < PATHS; i++) {
            char path[64];
            struct stat mine = {0};
            struct stat theirs = {0};
            draw_path(&seed, false, path, sizeof path);
            const int wanted = resolve_by_kernel(root, path, &theirs);
            const int got = resolve(root, path, &root_peer, &mine);
            if (got != wanted || mine.st_ino != theirs.st_ino || mine.st_dev != theirs.st_dev) {
                fail_msg("tree %d, '%s': %d (inode %ju), the kernel says %d (inode %ju)", tree,
                         path, got, (uintmax_t)mine.st_ino, wanted, (uintmax_t)theirs.st_ino);
            }
            good += got == 0;
        }
        close(root);
    }
    assert_in_range(good, TREES * PATHS / 20, TREES * PATHS); /* not by failing both */
}

/* ---- bounds ---- */

static void many_links(void **state) {
    const fixture *f = *state;
    struct stat st;
    char name[16];
    char text[16];
    make_file(f->root, "0");
    for (int i = 1; i <= 41; i++) {
        snprintf(name, sizeof name, "%d", i);
        snprintf(text, sizeof text, "%d", i - 1);
        assert_int_equal(symlinkat(text, f->root, name), 0);
    }
    assert_int_equal(resolve(f->root, "40", &root_peer, &st), 0);
    assert_int_equal(resolve(f->root, "41", &root_peer, &st), -ELOOP);
    assert_int_equal(symlinkat("circle/x", f->root, "circle"), 0);
    assert_int_equal(resolve(f->root, "circle", &root_peer, &st), -ELOOP);
}

static void deep_and_long(void **state) {
    const fixture *f = *state;
    struct stat st;
    char path[512] = "";
    for (int i = 0; i < 101; i++) {
        strcat(path, i == 0 ? "d" : "/d");
        assert_int_equal(mkdirat(f->root, path, 0755), 0);
    }
    strcat(path, "/x");
    make_file(f->root, path);
    assert_int_equal(resolve(f->root, path, &root_peer, &st), -ENAMETOOLONG);
    assert_int_equal(resolve(f->root, path + 2, &root_peer, &st), -ENOENT); /* 100 are allowed */
    char text[PATH_MAX];
    size_t at = 0;
    while (at < sizeof text - 8) { /* about 1,360 steps */
        at += (size_t)snprintf(text + at, sizeof text - at, "d/../");
    }
    assert_int_equal(symlinkat(text, f->root, "there_and_back"), 0);
    assert_int_equal(resolve(f->root, "there_and_back", &root_peer, &st), 0);
    assert_int_equal(
        resolve(f->root, "there_and_back/there_and_back/there_and_back", &root_peer, &st), -ELOOP);
}

/* ---- the peer ---- */

/* A link through what she may not search tells nothing, not even by coming back out of it. */
static void no_way_through_private_directories(void **state) {
    const fixture *f = *state;
    struct stat st;
    char link = 'x';
    assert_int_equal(mkdirat(f->root, "private", 0700), 0);
    assert_int_equal(mkdirat(f->root, "private/sub", 0755), 0);
    make_file(f->root, "a");
    assert_int_equal(symlinkat("private/sub/../../a", f->root, "there"), 0);
    assert_int_equal(symlinkat("private/none/../../a", f->root, "not_there"), 0);
    assert_int_equal(resolve(f->root, "there", &root_peer, &st), 0);
    assert_int_equal(resolve(f->root, "not_there", &root_peer, &st), -ENOENT);
    assert_int_equal(resolve(f->root, "there", &alice, &st), -EACCES);
    assert_int_equal(resolve(f->root, "not_there", &alice, &st), -EACCES);
    assert_int_equal(beneath_open(f->root, "there", &alice, &link), -EACCES);
    assert_int_equal(link, 'p');
    assert_int_equal(beneath_open(f->root, "private/sub", &alice, &link), -EACCES);
    assert_int_equal(link, '\0');
    assert_int_equal(beneath_open(f->root, "a/b", &alice, &link), -ENOTDIR);
    assert_int_equal(link, '\0');
}

/* ---- while names move ---- */

typedef struct mover {
    const fixture *f;
    atomic_bool stop;
} mover;

static void *move_about(void *argument) {
    mover *m = argument;
    while (!atomic_load(&m->stop)) {
        renameat(m->f->root, "sub/dir", m->f->out, "dir");
        renameat(m->f->out, "dir", m->f->root, "sub/dir");
    }
    return NULL;
}

/* A directory that is carried out of the root while we are in it does not take us along. */
static void carried_out(void **state) {
    const fixture *f = *state;
    enum { TRIES = 800, MOST = 1000 * TRIES };
    mover m = {.f = f};
    pthread_t thread;
    struct stat secret;
    struct stat st;
    assert_int_equal(mkdirat(f->root, "sub", 0755), 0);
    assert_int_equal(mkdirat(f->root, "sub/dir", 0755), 0);
    make_file(f->root, "sub/x");
    make_file(f->out, "x");
    assert_int_equal(fstatat(f->out, "x", &secret, 0), 0);
    assert_int_equal(symlinkat("sub/dir/../x", f->root, "link"), 0);
    assert_int_equal(pthread_create(&thread, NULL, move_about, &m), 0);
    int found = 0;
    for (int i = 0; i < TRIES || (found == 0 && i < MOST); i++) {
        const int error = resolve(f->root, "link", &root_peer, &st);
        assert_true(error == 0 || error == -ENOENT);
        assert_true(error != 0 || st.st_ino != secret.st_ino);
        found += error == 0;
    }
    atomic_store(&m.stop, true);
    pthread_join(thread, NULL);
    assert_true(found > 0);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, setup, teardown)

int main(void) {
    const struct CMUnitTest tests[] = {
        TEST(as_the_kernel_does), TEST(many_links),
        TEST(deep_and_long),      TEST(no_way_through_private_directories),
        TEST(carried_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
