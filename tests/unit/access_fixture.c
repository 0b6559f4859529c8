/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "access_fixture.h"
#include "remove_tree.h"
#include "test.h"

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

const char *at(const char *directory, const char *name) {
    static char paths[4][512];
    static unsigned turn;
    char *path = paths[turn++ % 4];
    assert_true(snprintf(path, sizeof paths[0], "%s/%s", directory, name) < (int)sizeof paths[0]);
    return path;
}

void write_file(const char *path, const char *content, mode_t mode) {
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    assert_true(fputs(content, file) >= 0);
    assert_int_equal(fclose(file), 0);
    assert_int_equal(chmod(path, mode), 0);
}

void make_directory(const char *path, mode_t mode) {
    assert_int_equal(mkdir(path, 0700), 0);
    assert_int_equal(chmod(path, mode), 0);
}

int access_setup(void **state) {
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

int access_teardown(void **state) {
    fixture *f = *state;
    access_roots_free(f->roots);
    remove_tree(f->top);
    free(f);
    return 0;
}

const access_peer alice = {ALICE, STAFF, NULL, 0};
const access_peer root_peer = {0, 0, NULL, 0};

int try_open(const fixture *f, const access_peer *peer, const char *path, const char *content) {
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
