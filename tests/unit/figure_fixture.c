/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "figure_fixture.h"
#include "test.h"

#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

char directory[64];

int make_directory(void **state) {
    (void)state;
    snprintf(directory, sizeof directory, "%s", "/tmp/test_figure_XXXXXX");
    return mkdtemp(directory) != NULL ? 0 : -1;
}

int remove_directory(void **state) {
    (void)state;
    return rmdir(directory);
}

const char *in_directory(const char *name) {
    static char path[128];
    snprintf(path, sizeof path, "%s/%s", directory, name);
    return path;
}

int entries(void) {
    int n = 0;
    DIR *d = opendir(directory);
    while (d != NULL && readdir(d) != NULL)
        n++;
    closedir(d);
    return n - 2; /* . and .. */
}

shear_figure *new_figure(void) {
    shear_figure *f = NULL;
    assert_int_equal(shear_figure_new(&f, SIDE, SIDE, NULL), SHEAR_OK);
    return f;
}

uint32_t packed(shear_colour c) {
    return (uint32_t)lround(255.0 * c.r) << 16 | (uint32_t)lround(255.0 * c.g) << 8 |
           (uint32_t)lround(255.0 * c.b);
}

int darkness(shear_figure *f, double x, double y) {
    const uint32_t p = shear_figure_pixel(f, (int)x, (int)y);
    return 765 - (int)((p >> 16 & 255) + (p >> 8 & 255) + (p & 255));
}

void assert_failed(shear_figure *f, int code) {
    shear_error err = {0};
    assert_int_equal(shear_figure_save(f, in_directory("never.png"), true, &err), code);
    assert_int_equal(err.code, code);
    assert_true(err.message[0] != '\0');
    assert_int_equal(entries(), 0);
    shear_figure_free(f);
}

void assert_saves(shear_figure *f) {
    shear_error err = {0};
    assert_int_equal(shear_figure_save(f, in_directory("fine.png"), true, &err), SHEAR_OK);
    assert_int_equal(unlink(in_directory("fine.png")), 0);
    shear_figure_free(f);
}
