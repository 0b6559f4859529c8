/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which files a peer may have read: paths, links, modes and access control lists. */
#include "access_fixture.h"
#include "test.h"

#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/xattr.h>
#include <unistd.h>

static void beneath_the_root(void **state) {
    const fixture *f = *state;
    make_directory(at(f->data, "sub"), 0755);
    write_file(at(f->data, "sub/b.fits"), "more", 0644);
    OPENS(&alice, at(f->data, "a.fits"), "pixels");
    OPENS(&alice, at(f->data, "sub/b.fits"), "more");
    OPENS(&alice, at(f->data, "/.//sub/./b.fits"), "more");
    REFUSES(&alice, at(f->data, "c.fits"), ACCESS_E_NOT_FOUND);
    REFUSES(&alice, at(f->data, "a.fits/"), ACCESS_E_NOT_FOUND);
    REFUSES(&alice, at(f->data, "a.fits/b"), ACCESS_E_NOT_FOUND);
    REFUSES(&alice, at(f->data, "sub/c/d.fits"), ACCESS_E_NOT_FOUND);
}

static void outside_the_root(void **state) {
    const fixture *f = *state;
    shear_error err = {0};
    int fd = -1;
    char *canonical = NULL;
    REFUSES(&root_peer, at(f->outside, "secret.fits"), ACCESS_E_OUTSIDE);
    REFUSES(&root_peer, "/etc/passwd", ACCESS_E_OUTSIDE);
    REFUSES(&root_peer, f->data, ACCESS_E_OUTSIDE);
    REFUSES(&root_peer, at(f->data, "../outside/secret.fits"), ACCESS_E_PATH);
    REFUSES(&root_peer, at(f->data, ".."), ACCESS_E_PATH);
    REFUSES(&root_peer, "a.fits", ACCESS_E_PATH);
    REFUSES(&root_peer, "", ACCESS_E_PATH);
    assert_int_equal(access_open(f->roots, &alice, "/data.fits", &fd, &canonical, &err),
                     ACCESS_E_OUTSIDE);
    assert_non_null(strstr(err.advice, f->data));
    char sibling[512];
    snprintf(sibling, sizeof sibling, "%s2/a.fits", f->data); /* a prefix of text, not of names */
    REFUSES(&root_peer, sibling, ACCESS_E_OUTSIDE);
    char long_path[5000];
    memset(long_path, '/', sizeof long_path - 1);
    long_path[sizeof long_path - 1] = '\0';
    REFUSES(&root_peer, long_path, ACCESS_E_PATH);
    char long_name[300] = "/";
    memset(long_name + 1, 'x', sizeof long_name - 2);
    long_name[sizeof long_name - 1] = '\0';
    REFUSES(&root_peer, at(f->data, long_name), ACCESS_E_PATH);
}

static void links(void **state) {
    const fixture *f = *state;
    make_directory(at(f->data, "sub"), 0755);
    assert_int_equal(symlink("a.fits", at(f->data, "inside")), 0);
    assert_int_equal(symlink("../a.fits", at(f->data, "sub/up")), 0);
    assert_int_equal(symlink("sub", at(f->data, "dirlink")), 0);
    assert_int_equal(symlink("../../outside/secret.fits", at(f->data, "sub/out")), 0);
    assert_int_equal(symlink(at(f->outside, "secret.fits"), at(f->data, "absolute")), 0);
    assert_int_equal(symlink(f->outside, at(f->data, "dirout")), 0);
    assert_int_equal(symlink("nothing", at(f->data, "dangling")), 0);
    assert_int_equal(symlink("circle", at(f->data, "circle")), 0);
    OPENS(&alice, at(f->data, "inside"), "pixels");
    OPENS(&alice, at(f->data, "sub/up"), "pixels");
    OPENS(&alice, at(f->data, "dirlink/up"), "pixels");
    REFUSES(&root_peer, at(f->data, "sub/out"), ACCESS_E_OUTSIDE);
    REFUSES(&root_peer, at(f->data, "absolute"), ACCESS_E_OUTSIDE);
    REFUSES(&root_peer, at(f->data, "dirout/secret.fits"), ACCESS_E_OUTSIDE);
    REFUSES(&root_peer, at(f->data, "dangling"), ACCESS_E_NOT_FOUND);
    REFUSES(&root_peer, at(f->data, "circle"), ACCESS_E_OUTSIDE);
    REFUSES(&alice, at(f->data, "absolute"), ACCESS_E_OUTSIDE);
    REFUSES(&alice, at(f->data, "sub/out"), ACCESS_E_DENIED);
    REFUSES(&alice, at(f->data, "dangling"), ACCESS_E_DENIED);
}

static void magic_links(void **state) {
    const fixture *f = *state;
    char *proc[] = {"/proc"};
    char path[512];
    fixture with_proc = *f;
    const int fd = open(at(f->outside, "secret.fits"), O_RDONLY);
    assert_true(fd >= 0);
    snprintf(path, sizeof path, "/proc/self/fd/%d", fd);
    assert_int_equal(symlink(path, at(f->data, "magic")), 0);
    REFUSES(&root_peer, at(f->data, "magic"), ACCESS_E_OUTSIDE);
    assert_int_equal(access_roots_new(&with_proc.roots, proc, 1, NULL), SHEAR_OK);
    assert_int_equal(try_open(&with_proc, &root_peer, path, ""), ACCESS_E_OUTSIDE);
    snprintf(path, sizeof path, "/proc/%ld/fd/%d", (long)getpid(), fd);
    assert_int_equal(try_open(&with_proc, &root_peer, path, ""), ACCESS_E_OUTSIDE);
    snprintf(path, sizeof path, "/proc/%ld/root%s", (long)getpid(), at(f->outside, "secret.fits"));
    assert_int_equal(try_open(&with_proc, &root_peer, path, ""), ACCESS_E_OUTSIDE);
    access_roots_free(with_proc.roots);
    close(fd);
}

static void only_regular_files(void **state) {
    const fixture *f = *state;
    char *dev[] = {"/dev"};
    fixture with_dev = *f;
    make_directory(at(f->data, "dir.fits"), 0755);
    assert_int_equal(mkfifo(at(f->data, "pipe.fits"), 0644), 0);
    assert_int_equal(chmod(at(f->data, "pipe.fits"), 0644), 0);
    REFUSES(&alice, at(f->data, "dir.fits"), ACCESS_E_NOT_REGULAR);
    REFUSES(&alice, at(f->data, "dir.fits/"), ACCESS_E_NOT_REGULAR);
    REFUSES(&alice, at(f->data, "pipe.fits"), ACCESS_E_NOT_REGULAR);
    assert_int_equal(access_roots_new(&with_dev.roots, dev, 1, NULL), SHEAR_OK);
    assert_int_equal(try_open(&with_dev, &alice, "/dev/zero", ""), ACCESS_E_NOT_REGULAR);
    access_roots_free(with_dev.roots);
}

/* The owner of the files here is whoever runs the test. */
static access_peer owner(void) {
    return (access_peer){geteuid(), getegid(), NULL, 0};
}

static void file_modes(void **state) {
    const fixture *f = *state;
    const char *path = at(f->data, "a.fits");
    char name[512];
    snprintf(name, sizeof name, "%s", path);
    gid_t groups[] = {TEAM, getegid()};
    const access_peer member = {ALICE, STAFF, groups, 2};
    const access_peer primary = {ALICE, getegid(), NULL, 0};
    const access_peer stranger = {ALICE, STAFF, groups, 1};
    assert_int_equal(chmod(name, 0640), 0);
    REFUSES(&alice, name, ACCESS_E_DENIED);
    REFUSES(&stranger, name, ACCESS_E_DENIED);
    OPENS(&member, name, "pixels");
    OPENS(&primary, name, "pixels");
    OPENS(&root_peer, name, "pixels");
    /* The first class that fits decides, even where a later one would give more. */
    assert_int_equal(chmod(name, 0604), 0);
    REFUSES(&member, name, ACCESS_E_DENIED);
    OPENS(&alice, name, "pixels");
    if (geteuid() != 0) {
        const access_peer me = owner();
        assert_int_equal(chmod(name, 0044), 0);
        REFUSES(&me, name, ACCESS_E_DENIED);
        REFUSES(&alice, name, ACCESS_E_SERVICE);
    }
}

static void directory_modes(void **state) {
    const fixture *f = *state;
    char path[512];
    gid_t groups[] = {getegid()};
    const access_peer member = {ALICE, STAFF, groups, 1};
    make_directory(at(f->data, "sub"), 0750);
    make_directory(at(f->data, "sub/deep"), 0755);
    snprintf(path, sizeof path, "%s/sub/deep/b.fits", f->data);
    write_file(path, "deep", 0644);
    REFUSES(&alice, path, ACCESS_E_DENIED);
    OPENS(&member, path, "deep");
    OPENS(&root_peer, path, "deep");
    /* What is not there is denied all the same: its absence is none of her business. */
    REFUSES(&alice, at(f->data, "sub/deep/nothing"), ACCESS_E_DENIED);
    REFUSES(&alice, at(f->data, "sub/nothing"), ACCESS_E_DENIED);
    /* Search is enough, reading the directory is not needed; reading alone is not enough. */
    assert_int_equal(chmod(at(f->data, "sub"), 0751), 0);
    OPENS(&alice, path, "deep");
    assert_int_equal(chmod(at(f->data, "sub"), 0754), 0);
    REFUSES(&alice, path, ACCESS_E_DENIED);
    /* Also above the root. */
    assert_int_equal(chmod(at(f->data, "sub"), 0755), 0);
    assert_int_equal(chmod(f->top, 0700), 0);
    REFUSES(&alice, path, ACCESS_E_DENIED);
    OPENS(&root_peer, path, "deep");
}

/* She may make links to where she may not look, but learns nothing by them. */
static void links_are_no_way_around(void **state) {
    const fixture *f = *state;
    make_directory(at(f->data, "private"), 0700);
    write_file(at(f->data, "private/x.fits"), "x", 0644);
    assert_int_equal(mkfifo(at(f->data, "private/pipe"), 0666), 0);
    assert_int_equal(symlink("private/x.fits", at(f->data, "to_file")), 0);
    assert_int_equal(symlink("private/none", at(f->data, "to_nothing")), 0);
    assert_int_equal(symlink("private/pipe", at(f->data, "to_pipe")), 0);
    assert_int_equal(symlink("private", at(f->data, "to_dir")), 0);
    REFUSES(&alice, at(f->data, "to_file"), ACCESS_E_DENIED);
    REFUSES(&alice, at(f->data, "to_nothing"), ACCESS_E_DENIED);
    REFUSES(&alice, at(f->data, "to_pipe"), ACCESS_E_DENIED);
    REFUSES(&alice, at(f->data, "to_dir/x.fits"), ACCESS_E_DENIED);
    REFUSES(&alice, at(f->data, "to_dir/none"), ACCESS_E_DENIED);
    OPENS(&root_peer, at(f->data, "to_file"), "x");
}

/* ---- access control lists, in the kernel's form ---- */

typedef struct acl_line {
    uint16_t tag, bits;
    uint32_t id;
} acl_line;

enum { NOBODY = -1 };

/* False where the file system has none. */
static bool set_acl(const char *path, const acl_line *lines, size_t n) {
    char text[4 + 8 * 8] = {2, 0, 0, 0};
    memcpy(text + 4, lines, n * sizeof *lines); /* little-endian machines only */
    const int version = 2;
    return *(const char *)&version == 2 &&
           setxattr(path, "system.posix_acl_access", text, 4 + n * sizeof *lines, 0) == 0;
}

static void access_control_lists(void **state) {
    const fixture *f = *state;
    char path[512];
    gid_t team[] = {TEAM};
    const access_peer bob = {BOB, STAFF, NULL, 0};
    const access_peer carol = {BOB + 1, BOB + 1, team, 1};
    const access_peer dave = {BOB + 2, BOB + 2, NULL, 0};
    const acl_line lines[] = {
        {0x01, 6, (uint32_t)NOBODY}, /* owner rw */
        {0x02, 4, ALICE},            /* Alice r */
        {0x02, 0, BOB},              /* Bob nothing */
        {0x04, 0, (uint32_t)NOBODY}, /* group nothing */
        {0x08, 4, TEAM},             /* the team r */
        {0x10, 4, (uint32_t)NOBODY}, /* mask r */
        {0x20, 0, (uint32_t)NOBODY}, /* others nothing */
    };
    snprintf(path, sizeof path, "%s", at(f->data, "a.fits"));
    if (!set_acl(path, lines, 7))
        skip();
    OPENS(&alice, path, "pixels");
    REFUSES(&bob, path, ACCESS_E_DENIED);
    OPENS(&carol, path, "pixels");
    REFUSES(&dave, path, ACCESS_E_DENIED);
    acl_line masked[7];
    memcpy(masked, lines, sizeof masked);
    masked[5].bits = 2; /* the mask takes reading away from all but owner and others */
    masked[6].bits = 4;
    assert_true(set_acl(path, masked, 7));
    REFUSES(&alice, path, ACCESS_E_DENIED);
    REFUSES(&carol, path, ACCESS_E_DENIED);
    OPENS(&dave, path, "pixels");
    /* The mode says that the group may: that is the mask, and means nobody in particular. */
    assert_true(set_acl(path, lines, 7));
    struct stat st;
    assert_int_equal(stat(path, &st), 0);
    assert_int_equal(st.st_mode & 0777, 0640);
    const access_peer primary = {BOB + 3, getegid(), NULL, 0};
    REFUSES(&primary, path, ACCESS_E_DENIED);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        ACCESS_TEST(beneath_the_root),
        ACCESS_TEST(outside_the_root),
        ACCESS_TEST(links),
        ACCESS_TEST(magic_links),
        ACCESS_TEST(only_regular_files),
        ACCESS_TEST(file_modes),
        ACCESS_TEST(directory_modes),
        ACCESS_TEST(links_are_no_way_around),
        ACCESS_TEST(access_control_lists),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
