/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "access/roots.h"

#include "base/cleanup.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>

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
    for (size_t i = 0; i < roots->names.n; i++)
        TRY(access_root_check(roots->names.items[i], err));
    return SHEAR_OK;
}

CLEANUP_DEFINE(access_roots, access_roots_free)

int access_roots_new(access_roots **out, char *const *paths, size_t n, shear_error *err) {
    *out = NULL;
    for (size_t i = 0; i < n; i++) {
        if (paths[i][0] != '/' || path_climbs(paths[i])) {
            return shear_fail(err, SHEAR_E_SETTING, "give an absolute path without '..'",
                              "data root '%s': is not absolute", paths[i]);
        }
    }
    CLEANUP(access_roots_release) access_roots *roots = calloc(1, sizeof *roots);
    if (roots == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for the data roots");
    for (size_t i = 0; i < n; i++)
        TRY(sheard_list_append(&roots->names, paths[i], err));
    roots->text = n > 0 ? sheard_list_join(&roots->names) : strdup("none is configured");
    if (roots->text == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for the data roots");
    *out = CLEANUP_TAKE(roots);
    return SHEAR_OK;
}

void access_roots_free(access_roots *roots) {
    if (roots == NULL)
        return;
    sheard_list_deinit(&roots->names);
    free(roots->text);
    free(roots);
}
