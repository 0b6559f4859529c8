/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "roots.h"

#include "walk.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* The next component: slashes and "." are skipped. *length 0 at the end. */
static const char *component(const char *path, size_t *length) {
    for (;;) {
        path += strspn(path, "/");
        *length = strcspn(path, "/");
        if (*length != 1 || path[0] != '.') {
            return path;
        }
        path += 1;
    }
}

const char *path_beneath(const char *path, const char *root) {
    size_t n = 0;
    size_t m = 0;
    for (;;) {
        root = component(root, &m);
        path = component(path, &n);
        if (m == 0) {
            return n > 0 ? path : NULL;
        }
        if (n != m || strncmp(path, root, n) != 0) {
            return NULL;
        }
        path += n;
        root += m;
    }
}

bool path_climbs(const char *path) {
    size_t n = 0;
    for (path = component(path, &n); n > 0; path = component(path + n, &n)) {
        if (n == 2 && strncmp(path, "..", 2) == 0) {
            return true;
        }
    }
    return false;
}

static int open_root(access_root *root, const char *path, shear_error *err) {
    *root = (access_root){-1, NULL, NULL};
    if (path[0] != '/' || path_climbs(path)) {
        return shear_fail(err, SHEAR_E_SETTING, "give an absolute path without '..'",
                          "data root '%s': is not absolute", path);
    }
    root->fd = open(path, O_PATH | O_DIRECTORY | O_CLOEXEC);
    if (root->fd < 0) {
        return shear_fail(err, SHEAR_E_IO, "make the directory, or remove it from data_roots",
                          "data root %s: cannot be opened: %s", path, strerror(errno));
    }
    root->name = strdup(path);
    const int error = root->name == NULL ? ENOMEM : walk_name(root->fd, &root->canonical);
    if (error != 0) {
        return shear_fail(err, error == ENOMEM ? SHEAR_E_NOMEM : SHEAR_E_IO, NULL,
                          "data root %s: its name cannot be found: %s", path, strerror(error));
    }
    return SHEAR_OK;
}

/* The names of all, for people. */
static char *list_names(const access_roots *roots, char *const *paths) {
    size_t size = sizeof "none is configured";
    for (size_t i = 0; i < roots->n; i++) {
        size += strlen(paths[i]) + 2;
    }
    char *names = malloc(size);
    if (names == NULL) {
        return NULL;
    }
    snprintf(names, size, "%s", roots->n == 0 ? "none is configured" : "");
    for (size_t i = 0, at = 0; i < roots->n; i++) {
        at += (size_t)snprintf(names + at, size - at, "%s%s", i == 0 ? "" : ", ", paths[i]);
    }
    return names;
}

int access_roots_open(access_roots **out, char *const *paths, size_t n, shear_error *err) {
    int code = SHEAR_OK;
    *out = NULL;
    access_roots *roots = calloc(1, sizeof *roots);
    if (roots != NULL) {
        roots->roots = calloc(n + 1, sizeof *roots->roots);
    }
    if (roots == NULL || roots->roots == NULL) {
        access_roots_close(roots);
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for the data roots");
    }
    for (size_t i = 0; i < n && code == SHEAR_OK; i++) {
        roots->n++;
        code = open_root(&roots->roots[i], paths[i], err);
    }
    if (code == SHEAR_OK) {
        roots->names = list_names(roots, paths);
        code = roots->names != NULL
                   ? SHEAR_OK
                   : shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for the data roots");
    }
    if (code != SHEAR_OK) {
        access_roots_close(roots);
        return code;
    }
    *out = roots;
    return SHEAR_OK;
}

void access_roots_close(access_roots *roots) {
    if (roots == NULL) {
        return;
    }
    for (size_t i = 0; i < roots->n; i++) {
        if (roots->roots[i].fd >= 0) {
            close(roots->roots[i].fd);
        }
        free(roots->roots[i].name);
        free(roots->roots[i].canonical);
    }
    free(roots->roots);
    free(roots->names);
    free(roots);
}
