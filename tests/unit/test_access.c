/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Who may have which file read. Peers are made up: no other user is needed. */
#include "test.h"

#include "access/access.h"
#include "access/roots.h"

#include <fcntl.h>
#include <ftw.h>
#include <grp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/xattr.h>
#include <unistd.h>

enum { ALICE = 54321, STAFF = 54322, TEAM = 54323, BOB = 54324 }; /* nobody's numbers */

typedef struct fixture {
    char top[128]; /* all may search it */
    char data[160], outside[160];
    access_roots *roots;
} fixture;

static const char *at(const char *directory, const char *name) {
    static char paths[4][512];
    static unsigned turn;
    char *path = paths[turn++ % 4];
    assert_true(snprintf(path, sizeof paths[0], "%s/%s", directory, name) < (int)sizeof paths[0]);
    return path;
}

static void write_file(const char *path, const char *content, mode_t mode) {
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    assert_true(fputs(content, file) >= 0);
    assert_int_equal(fclose(file), 0);
    assert_int_equal(chmod(path, mode), 0);
}

static void make_directory(const char *path, mode_t mode) {
    assert_int_equal(mkdir(path, 0700), 0);
    assert_int_equal(chmod(path, mode), 0);
}

static int setup(void **state) {
    fixture *f = calloc(1, sizeof *f);
    assert_non_null(f);
    const char *base = getenv("TMPDIR");
    char top[128];
    snprintf(top, sizeof top, "%.80s/sheard-access-XXXXXX", base != NULL ? base : "/tmp");
    assert_non_null(mkdtemp(top));
    assert_int_equal(chmod(top, 0711), 0);
    char *real = realpath(top, NULL);
    assert_non_null(real);
    snprintf(f->top, sizeof f->top, "%s", real);
    free(real);
    snprintf(f->data, sizeof f->data, "%s/data", f->top);
    snprintf(f->outside, sizeof f->outside, "%s/outside", f->top);
    make_directory(f->data, 0755);
    make_directory(f->outside, 0755);
    write_file(at(f->data, "a.fits"), "pixels", 0644);
    write_file(at(f->outside, "secret.fits"), "secret", 0644);
    char *paths[] = {f->data};
    assert_int_equal(access_roots_new(&f->roots, paths, 1, NULL), SHEAR_OK);
    *state = f;
    return 0;
}

static int remove_one(const char *path, const struct stat *st, int kind, struct FTW *where) {
    (void)st;
    (void)kind;
    (void)where;
    return remove(path);
}

static int teardown(void **state) {
    fixture *f = *state;
    access_roots_free(f->roots);
    nftw(f->top, remove_one, 16, FTW_DEPTH | FTW_PHYS);
    free(f);
    return 0;
}

static const access_peer alice = {ALICE, STAFF, NULL, 0};
static const access_peer root_peer = {0, 0, NULL, 0};

/* What comes of it; where it opens, the content must be `content`. */
static int try_open(const fixture *f, const access_peer *peer, const char *path,
                    const char *content) {
    shear_error err = {0};
    char text[16] = "";
    char *canonical = NULL;
    int fd = -2;
    const int code = access_open(f->roots, peer, path, &fd, &canonical, &err);
    if (code != SHEAR_OK) {
        assert_int_equal(fd, -1);
        assert_null(canonical);
        assert_int_equal(err.code, code);
        assert_true(strlen(err.message) > 0);
        return code;
    }
    assert_int_equal(fcntl(fd, F_GETFL) & O_ACCMODE, O_RDONLY);
    assert_true((fcntl(fd, F_GETFD) & FD_CLOEXEC) != 0);
    assert_true(read(fd, text, sizeof text - 1) >= 0);
    assert_string_equal(text, content);
    assert_int_equal(canonical[0], '/');
    close(fd);
    free(canonical);
    return SHEAR_OK;
}

#define OPENS(peer, path, content) assert_int_equal(try_open(f, peer, path, content), SHEAR_OK)
#define REFUSES(peer, path, code)  assert_int_equal(try_open(f, peer, path, ""), code)

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

/* ---- roots ---- */

static void root_behind_a_link(void **state) {
    const fixture *f = *state;
    char link_name[512];
    fixture linked = *f;
    snprintf(link_name, sizeof link_name, "%s", at(f->top, "link"));
    assert_int_equal(symlink("data", link_name), 0);
    char *paths[] = {link_name};
    assert_int_equal(access_roots_new(&linked.roots, paths, 1, NULL), SHEAR_OK);
    assert_int_equal(try_open(&linked, &alice, at(link_name, "a.fits"), "pixels"), SHEAR_OK);
    assert_int_equal(try_open(&linked, &alice, at(f->data, "a.fits"), "pixels"), SHEAR_OK);
    int fd = -1;
    char *canonical = NULL;
    assert_int_equal(
        access_open(linked.roots, &alice, at(link_name, "a.fits"), &fd, &canonical, NULL),
        SHEAR_OK);
    assert_string_equal(canonical, at(f->data, "a.fits"));
    free(canonical);
    close(fd);
    access_roots_free(linked.roots);
}

static void several_roots(void **state) {
    const fixture *f = *state;
    fixture both = *f;
    char inner[512];
    snprintf(inner, sizeof inner, "%s/inner", f->data);
    make_directory(inner, 0755);
    assert_int_equal(symlink("../a.fits", at(inner, "up")), 0);
    char *paths[] = {inner, both.data, both.outside};
    assert_int_equal(access_roots_new(&both.roots, paths, 3, NULL), SHEAR_OK);
    assert_int_equal(try_open(&both, &root_peer, at(inner, "up"), "pixels"), SHEAR_OK);
    assert_int_equal(try_open(&both, &alice, at(f->outside, "secret.fits"), "secret"), SHEAR_OK);
    access_roots_free(both.roots);
}

static void bad_roots(void **state) {
    fixture *f = *state;
    access_roots *roots = NULL;
    shear_error err = {0};
    char relative[] = "data";
    char climbing[] = "/tmp/../etc";
    char *lists[][1] = {{relative}, {climbing}};
    for (int i = 0; i < 2; i++) {
        assert_int_equal(access_roots_new(&roots, lists[i], 1, &err), SHEAR_E_SETTING);
        assert_null(roots);
        assert_non_null(strstr(err.message, lists[i][0]));
    }
    fixture none = *f;
    assert_int_equal(access_roots_new(&none.roots, NULL, 0, NULL), SHEAR_OK);
    assert_int_equal(access_roots_check(none.roots, NULL), SHEAR_OK);
    assert_int_equal(try_open(&none, &root_peer, at(f->data, "a.fits"), ""), ACCESS_E_OUTSIDE);
    access_roots_free(none.roots);
}

/* A disk that is not there yet, comes, goes, and comes again under another inode. */
static void a_root_comes_and_goes(void **state) {
    const fixture *f = *state;
    fixture later = *f;
    char root[512];
    char away[512];
    char file[512];
    shear_error err = {0};
    snprintf(root, sizeof root, "%s/later", f->top);
    snprintf(away, sizeof away, "%s/away", f->top);
    snprintf(file, sizeof file, "%s/b.fits", root);
    char *paths[] = {root, later.data};
    assert_int_equal(access_roots_new(&later.roots, paths, 2, NULL), SHEAR_OK);
    assert_int_equal(try_open(&later, &alice, file, ""), ACCESS_E_ROOT);
    assert_int_equal(try_open(&later, &alice, at(f->outside, "x"), ""), ACCESS_E_OUTSIDE);
    assert_int_equal(try_open(&later, &alice, at(f->data, "a.fits"), "pixels"), SHEAR_OK);
    assert_int_equal(access_roots_check(later.roots, &err), ACCESS_E_ROOT);
    assert_non_null(strstr(err.message, root));
    make_directory(root, 0755);
    assert_int_equal(access_roots_check(later.roots, NULL), SHEAR_OK);
    assert_int_equal(try_open(&later, &alice, file, ""), ACCESS_E_NOT_FOUND);
    write_file(file, "first", 0644);
    assert_int_equal(try_open(&later, &alice, file, "first"), SHEAR_OK);
    assert_int_equal(rename(root, away), 0);
    assert_int_equal(try_open(&later, &alice, file, ""), ACCESS_E_ROOT);
    make_directory(root, 0755);
    write_file(file, "second", 0644);
    assert_int_equal(try_open(&later, &alice, file, "second"), SHEAR_OK);
    access_roots_free(later.roots);
}

/* What is missing beneath a missing root is missing for that, also where it lies in another one. */
static void a_root_in_a_root_is_missing(void **state) {
    const fixture *f = *state;
    fixture both = *f;
    char inner[512];
    snprintf(inner, sizeof inner, "%s/inner", f->data);
    char *paths[] = {both.data, inner};
    for (int i = 0; i < 2; i++) {
        assert_int_equal(access_roots_new(&both.roots, paths, 2, NULL), SHEAR_OK);
        assert_int_equal(try_open(&both, &alice, at(inner, "x.fits"), ""), ACCESS_E_ROOT);
        assert_int_equal(try_open(&both, &alice, at(f->data, "a.fits"), "pixels"), SHEAR_OK);
        access_roots_free(both.roots);
        paths[0] = inner;
        paths[1] = both.data;
    }
}

static void paths_by_component(void **state) {
    (void)state;
    assert_string_equal(path_beneath("/a/b/c", "/a/b"), "c");
    assert_string_equal(path_beneath("/a/b/c", "/a//b/./"), "c");
    assert_string_equal(path_beneath("//a/./b//c/d", "/a/b"), "c/d");
    assert_string_equal(path_beneath("/a", "/"), "a");
    assert_string_equal(path_beneath("/a/.hidden", "/a"), ".hidden");
    assert_null(path_beneath("/a/bc", "/a/b"));
    assert_null(path_beneath("/a/b", "/a/b"));
    assert_null(path_beneath("/a/b/.", "/a/b"));
    assert_null(path_beneath("/a", "/a/b"));
    assert_true(path_climbs("/a/../b"));
    assert_true(path_climbs("/a/.."));
    assert_false(path_climbs("/a/...b/..c/d.."));
}

/* ---- peers and lists ---- */

static void peer_of_a_socket(void **state) {
    (void)state;
    int pair[2];
    access_peer peer;
    shear_error err = {0};
    assert_int_equal(socketpair(AF_UNIX, SOCK_STREAM, 0, pair), 0);
    assert_int_equal(access_peer_from_socket(pair[0], &peer, NULL), SHEAR_OK);
    assert_int_equal(peer.uid, geteuid());
    assert_int_equal(peer.gid, getegid());
    assert_int_equal(peer.n_groups, getgroups(0, NULL));
    access_peer_deinit(&peer);
    close(pair[1]);
    close(pair[0]);
    const int lone = socket(AF_UNIX, SOCK_STREAM, 0);
    assert_int_equal(access_peer_from_socket(lone, &peer, &err), SHEAR_E_IO);
    close(lone);
    assert_int_equal(access_peer_from_socket(-1, &peer, &err), SHEAR_E_IO);
}

static void peer_of_a_user(void **state) {
    (void)state;
    access_peer peer;
    assert_int_equal(access_peer_from_user(0, 5, &peer, NULL), SHEAR_OK);
    assert_int_equal(peer.uid, 0);
    assert_int_equal(peer.gid, 0);
    assert_true(peer.n_groups >= 1);
    access_peer_deinit(&peer);
    assert_int_equal(access_peer_from_user(ALICE, STAFF, &peer, NULL), SHEAR_OK);
    assert_int_equal(peer.uid, ALICE);
    assert_int_equal(peer.gid, STAFF);
    assert_int_equal(peer.n_groups, 0);
    access_peer_deinit(&peer);
}

static void groups_as_text(void **state) {
    (void)state;
    gid_t some[] = {4, 27, 4294967294u};
    const access_peer peers[] = {
        {ALICE, STAFF, some, 3}, {ALICE, STAFF, some, 1}, {ALICE, STAFF, NULL, 0}};
    const char *const texts[] = {"4 27 4294967294", "4", ""};
    access_peer back;
    shear_error err = {0};
    for (int i = 0; i < 3; i++) {
        char *text = NULL;
        assert_int_equal(access_peer_groups_text(&peers[i], &text, &err), SHEAR_OK);
        assert_string_equal(text, texts[i]);
        assert_int_equal(access_peer_from_text(ALICE, STAFF, text, &back, &err), SHEAR_OK);
        assert_int_equal(back.uid, ALICE);
        assert_int_equal(back.gid, STAFF);
        assert_int_equal(back.n_groups, peers[i].n_groups);
        assert_memory_equal(back.groups, some, back.n_groups * sizeof *some);
        access_peer_deinit(&back);
        free(text);
    }
    const char *const bad[] = {"x", " 4", "4 ", "4  5", "4,5", "-4", "4294967296", "0x4", "4\n"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        assert_int_equal(access_peer_from_text(ALICE, STAFF, bad[i], &back, &err),
                         SHEAR_E_INTERNAL);
        assert_int_equal(back.n_groups, 0); /* no rights where they cannot be read */
    }
}

static void lists_of_users_and_groups(void **state) {
    (void)state;
    char root_name[] = "root";
    char number[] = "54324"; /* Bob */
    char team[] = "54323";
    char *users[] = {root_name, number};
    char *groups[] = {team};
    gid_t in_team[] = {7, TEAM};
    const access_peer bob = {BOB, STAFF, NULL, 0};
    const access_peer member = {ALICE, STAFF, in_team, 2};
    const access_peer primary = {ALICE, TEAM, NULL, 0};
    access_list *list = NULL;
    shear_error err = {0};
    assert_int_equal(access_list_new(&list, users, 2, groups, 1, &err), SHEAR_OK);
    assert_true(access_list_has(list, &root_peer));
    assert_true(access_list_has(list, &bob));
    assert_true(access_list_has(list, &member));
    assert_true(access_list_has(list, &primary));
    assert_false(access_list_has(list, &alice));
    access_list_free(list);
    assert_int_equal(access_list_new(&list, NULL, 0, NULL, 0, &err), SHEAR_OK);
    assert_false(access_list_has(list, &root_peer));
    access_list_free(list);
    char unknown[] = "no-such-name-here";
    char too_large[] = "4294967295";
    char *bad[][1] = {{unknown}, {too_large}};
    for (int i = 0; i < 2; i++) {
        assert_int_equal(access_list_new(&list, bad[i], 1, bad[i], 1, &err), SHEAR_OK);
        assert_false(access_list_has(list, &alice) || access_list_has(list, &root_peer));
        assert_non_null(strstr(access_list_unknown(list, 0), "no user"));
        assert_non_null(strstr(access_list_unknown(list, 0), bad[i][0]));
        assert_non_null(strstr(access_list_unknown(list, 1), "no group"));
        assert_null(access_list_unknown(list, 2));
        access_list_free(list);
    }
}

static void codes_have_names(void **state) {
    (void)state;
    assert_string_equal(access_code_name(ACCESS_E_PATH), "bad_path");
    assert_string_equal(access_code_name(ACCESS_E_NOT_REGULAR), "not_regular");
    assert_string_equal(access_code_name(ACCESS_E_ROOT), "root_missing");
    assert_string_equal(access_code_name(SHEAR_E_IO), shear_code_name(SHEAR_E_IO));
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, setup, teardown)

int main(void) {
    const struct CMUnitTest tests[] = {
        TEST(beneath_the_root),
        TEST(outside_the_root),
        TEST(links),
        TEST(magic_links),
        TEST(only_regular_files),
        TEST(file_modes),
        TEST(directory_modes),
        TEST(links_are_no_way_around),
        TEST(access_control_lists),
        TEST(root_behind_a_link),
        TEST(several_roots),
        TEST(bad_roots),
        TEST(a_root_comes_and_goes),
        TEST(a_root_in_a_root_is_missing),
        cmocka_unit_test(paths_by_component),
        cmocka_unit_test(peer_of_a_socket),
        cmocka_unit_test(peer_of_a_user),
        cmocka_unit_test(groups_as_text),
        cmocka_unit_test(lists_of_users_and_groups),
        cmocka_unit_test(codes_have_names),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
