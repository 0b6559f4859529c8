/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pictures as files: whole or not there, and never in place of another unasked. */
#include "figure_fixture.h"
#include "test.h"

#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

static uint32_t big_endian(const unsigned char *p) {
    return (uint32_t)p[0] << 24 | (uint32_t)p[1] << 16 | (uint32_t)p[2] << 8 | p[3];
}

static void test_png_has_the_size_and_an_end(void **state) {
    (void)state;
    shear_figure *f = NULL;
    assert_int_equal(shear_figure_new(&f, 123, 45, NULL), SHEAR_OK);
    assert_int_equal(shear_figure_pixel(f, 122, 44), 0xffffff);
    assert_int_equal(shear_figure_pixel(f, 123, -1), 0xffffff);
    assert_int_equal(shear_figure_save(f, in_directory("a.png"), false, NULL), SHEAR_OK);
    shear_figure_free(f);
    unsigned char bytes[4096];
    FILE *file = fopen(in_directory("a.png"), "rb");
    assert_non_null(file);
    const size_t n = fread(bytes, 1, sizeof bytes, file);
    fclose(file);
    assert_in_range(n, 45, sizeof bytes - 1);
    assert_memory_equal(bytes, "\x89PNG\r\n\x1a\n", 8);
    assert_memory_equal(bytes + 12, "IHDR", 4);
    assert_int_equal(big_endian(bytes + 16), 123);
    assert_int_equal(big_endian(bytes + 20), 45);
    assert_memory_equal(bytes + n - 8, "IEND", 4);
    assert_int_equal(entries(), 1); /* no temporary file is left */
    assert_int_equal(unlink(in_directory("a.png")), 0);
}

static void test_sizes_that_cannot_be(void **state) {
    (void)state;
    static const int bad[][2] = {{0, 10}, {10, 0}, {-5, 5}, {20001, 10}, {10, 2147483647}};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        shear_error err = {0};
        shear_figure *f = (shear_figure *)&err;
        assert_int_equal(shear_figure_new(&f, bad[i][0], bad[i][1], &err), SHEAR_E_SETTING);
        assert_null(f);
        assert_true(err.advice[0] != '\0');
    }
    shear_figure_free(NULL);
}

static off_t size_of(const char *path) {
    struct stat st;
    return stat(path, &st) == 0 ? st.st_size : -1;
}

static void test_an_existing_file_is_replaced_only_if_asked(void **state) {
    (void)state;
    shear_figure *f = new_figure();
    shear_error err = {0};
    FILE *file = fopen(in_directory("b.png"), "wb");
    assert_non_null(file);
    fputs("mine", file);
    fclose(file);
    assert_int_equal(shear_figure_save(f, in_directory("b.png"), false, &err), SHEAR_E_EXISTS);
    assert_int_equal(size_of(in_directory("b.png")), 4);
    assert_int_equal(shear_figure_save(f, in_directory("b.png"), true, &err), SHEAR_OK);
    assert_true(size_of(in_directory("b.png")) > 40);
    assert_int_equal(entries(), 1);
    assert_int_equal(unlink(in_directory("b.png")), 0);
    shear_figure_free(f);
}

static void test_places_that_cannot_be_written(void **state) {
    (void)state;
    shear_figure *f = new_figure();
    const char *const bad[] = {"/nonexistent/x.png", "/dev/null", "/dev/null/x.png", directory, ""};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        shear_error err = {0};
        assert_int_equal(shear_figure_save(f, bad[i], true, &err), SHEAR_E_IO);
        assert_non_null(strstr(err.message, bad[i]));
        assert_true(err.advice[0] != '\0');
    }
    assert_int_equal(entries(), 0);
    shear_figure_free(f);
}

static void test_a_full_disk_leaves_nothing(void **state) {
    (void)state;
    struct rlimit before;
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
    const struct rlimit small = {.rlim_cur = 64, .rlim_max = before.rlim_max};
    void (*handler)(int) = signal(SIGXFSZ, SIG_IGN);
    shear_figure *f = new_figure();
    shear_error err = {0};
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &small), 0);
    const int code = shear_figure_save(f, in_directory("c.png"), false, &err);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &before), 0);
    signal(SIGXFSZ, handler);
    assert_int_equal(code, SHEAR_E_IO);
    assert_int_equal(entries(), 0);
    shear_figure_free(f);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_png_has_the_size_and_an_end),
        cmocka_unit_test(test_sizes_that_cannot_be),
        cmocka_unit_test(test_an_existing_file_is_replaced_only_if_asked),
        cmocka_unit_test(test_places_that_cannot_be_written),
        cmocka_unit_test(test_a_full_disk_leaves_nothing),
    };
    return cmocka_run_group_tests(tests, make_directory, remove_directory);
}
