/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The data roots: behind links, several, bad, missing for a time; paths beneath them. */
#include "access/roots.h"
#include "access_fixture.h"
#include "test.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

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

int main(void) {
    const struct CMUnitTest tests[] = {
        ACCESS_TEST(root_behind_a_link),
        ACCESS_TEST(several_roots),
        ACCESS_TEST(bad_roots),
        ACCESS_TEST(a_root_comes_and_goes),
        ACCESS_TEST(a_root_in_a_root_is_missing),
        cmocka_unit_test(paths_by_component),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
