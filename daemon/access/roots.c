/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "access/roots.h"

#include "base/buffer.h"
#include "base/cleanup.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Return the next component, beyond slashes and ".". *length is 0 at the end. */
static const char *component(const char *path, size_t *length) {
    for (;;) {
        path += strspn(path, "/");
        *length = strcspn(path, "/");
        if (*length != 1 || path[0] != '.')
            return path;
        path += 1;
    }
}

const char *path_beneath(const char *path, const char *root) {
    size_t n = 0;
    size_t m = 0;
    for (;;) {
        root = component(root, &m);
        path = component(path, &n);
        if (m == 0)
            return n > 0 ? path : NULL;
        if (n != m || strncmp(path, root, n) != 0)
            return NULL;
        path += n;
        root += m;
    }
}

bool path_climbs(const char *path) {
    size_t n = 0;
    for (path = component(path, &n); n > 0; path = component(path + n, &n)) {
        if (n == 2 && strncmp(path, "..", 2) == 0)
            return true;
    }
    return false;
}

int root_open(const char *name, int *fd, shear_error *err) {
    *fd = open(name, O_PATH | O_DIRECTORY | O_CLOEXEC);
    return *fd >= 0 ? SHEAR_OK
                    : shear_fail(err, ACCESS_E_ROOT,
                                 "mount or create it where the service sees it (its unit may hide "
                                 "it: ProtectHome=, PrivateTmp=); or remove it from data_roots",
                                 "data root %.300s is missing: %s", name, strerror(errno));
}

int access_root_check(const char *path, shear_error *err) {
    CLEANUP(release_fd) int fd = -1;
    return root_open(path, &fd, err);
}

int access_roots_check(const access_roots *roots, shear_error *err) {
    for (size_t i = 0; i < roots->n; i++)
        TRY(access_root_check(roots->names[i], err));
    return SHEAR_OK;
}

/* Return all names as text for messages, or NULL if out of memory. */
static char *list_names(char *const *paths, size_t n) {
    buffer names = {0};
    buffer_add_text(&names, n == 0 ? "none is configured" : "");
    for (size_t i = 0; i < n; i++) {
        buffer_add_text(&names, i == 0 ? "" : ", ");
        buffer_add_text(&names, paths[i]);
    }
    return buffer_take(&names, NULL);
}

static bool copy_names(access_roots *roots, char *const *paths, size_t n) {
    roots->names = calloc(n + 1, sizeof *roots->names);
    roots->text = list_names(paths, n);
    bool ok = roots->names != NULL && roots->text != NULL;
    for (; ok && roots->n < n; roots->n++) {
        roots->names[roots->n] = strdup(paths[roots->n]);
        ok = roots->names[roots->n] != NULL;
    }
    return ok;
}

int access_roots_new(access_roots **out, char *const *paths, size_t n, shear_error *err) {
    *out = NULL;
    for (size_t i = 0; i < n; i++) {
        if (paths[i][0] != '/' || path_climbs(paths[i])) {
            return shear_fail(err, SHEAR_E_SETTING, "give an absolute path without '..'",
                              "data root '%s': is not absolute", paths[i]);
        }
    }
    access_roots *roots = calloc(1, sizeof *roots);
    if (roots == NULL || !copy_names(roots, paths, n)) {
        access_roots_free(roots);
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for the data roots");
    }
    *out = roots;
    return SHEAR_OK;
}

void access_roots_free(access_roots *roots) {
    if (roots == NULL)
        return;
    for (size_t i = 0; i < roots->n; i++)
        free(roots->names[i]);
    free(roots->names);
    free(roots->text);
    free(roots);
}
