/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "local/catalog_path.h"

#include "base/cleanup.h"
#include "base/text.h"
#include "terminal/message.h"

#include <errno.h>
#include <libgen.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static bool is_directory(const char *path) {
    struct stat st;
    return stat(path, &st) == 0 && S_ISDIR(st.st_mode);
}

/* Return "DIRECTORY/stamps.shear.fits" for "in/stamps.fits.gz": malloc'd, or NULL if out of memory.
 */
static char *path_in(const char *directory, const char *input) {
    static const char *const endings[] = {".gz", ".fz", ".fits", ".fit"};
    const char *slash = strrchr(input, '/');
    CLEANUP(release_free) char *base = strdup(slash != NULL ? slash + 1 : input);
    char *path = NULL;
    for (size_t i = 0; base != NULL && i < sizeof endings / sizeof *endings; i++) {
        const size_t n = strlen(endings[i]);
        if (strlen(base) > n && text_ends_with(base, endings[i]))
            base[strlen(base) - n] = '\0';
    }
    return base == NULL || asprintf(&path, "%s/%s.shear.fits", directory, base) < 0 ? NULL : path;
}

static bool same_file(const struct stat *st, const char *path) {
    struct stat other;
    return stat(path, &other) == 0 && other.st_dev == st->st_dev && other.st_ino == st->st_ino;
}

static bool reads_file(const shear_input *input, const struct stat *st) {
    bool reads = input->path != NULL && same_file(st, input->path);
    for (int i = 0; i < SHEAR_N_PARTS && input->path == NULL; i++)
        reads = reads || (input->parts[i].path != NULL && same_file(st, input->parts[i].path));
    return reads;
}

/* Check whether an existing file at the catalog's path may be replaced. */
static enum exit_code check_existing(const char *path, const struct stat *st,
                                     const measure_input *inputs, size_t n, bool force) {
    for (size_t i = 0; i < n; i++) {
        if (reads_file(&inputs[i].source, st)) {
            return message_fail(EXIT_CODE_USAGE, NULL,
                                "--catalog %s: that is one of the input files", path);
        }
    }
    if (!S_ISREG(st->st_mode)) {
        return message_fail(EXIT_CODE_OTHER, NULL, "--catalog %s: exists and is not a regular file",
                            path);
    }
    if (!force) {
        return message_fail(EXIT_CODE_OTHER, "--force replaces it", "--catalog %s: the file exists",
                            path);
    }
    return EXIT_CODE_DONE;
}

/* Return 0 if files can be created in `directory`, or else errno. */
static int unwritable(const char *directory) {
    struct stat st;
    if (stat(directory, &st) != 0)
        return errno;
    if (!S_ISDIR(st.st_mode))
        return ENOTDIR;
    return access(directory, W_OK | X_OK) == 0 ? 0 : errno;
}

static enum exit_code check_parent(const char *path) {
    CLEANUP(release_free) char *copy = strdup(path); /* dirname may modify it */
    if (copy == NULL)
        return message_no_memory();
    const char *parent = dirname(copy);
    const int why = unwritable(parent);
    if (why != 0) {
        return message_fail(EXIT_CODE_OTHER, "choose a directory that you may write to",
                            "--catalog %s: cannot write in %s: %s", path, parent, strerror(why));
    }
    return EXIT_CODE_DONE;
}

static enum exit_code check_path(const char *path, const measure_input *inputs, size_t n,
                                 bool force) {
    struct stat st;
    if (stat(path, &st) == 0)
        TRY(check_existing(path, &st, inputs, n, force));
    return check_parent(path);
}

static enum exit_code check_all(const measure_input *inputs, size_t n, bool force) {
    for (size_t i = 0; i < n; i++) {
        if (inputs[i].catalog == NULL)
            continue;
        for (size_t j = 0; j < i; j++) {
            if (inputs[j].catalog != NULL && strcmp(inputs[j].catalog, inputs[i].catalog) == 0) {
                return message_fail(EXIT_CODE_USAGE, "measure them in separate runs, or rename one",
                                    "--catalog: %s and %s would share the catalog %s",
                                    inputs[j].path, inputs[i].path, inputs[i].catalog);
            }
        }
        TRY(check_path(inputs[i].catalog, inputs, n, force));
    }
    return EXIT_CODE_DONE;
}

enum exit_code catalog_paths_resolve(measure_input *inputs, size_t n, const char *out, bool force) {
    bool directory = is_directory(out);
    size_t length = strlen(out);
    if (!directory && (n > 1 || length == 0 || out[length - 1] == '/')) {
        return message_fail(n > 1 ? EXIT_CODE_USAGE : EXIT_CODE_OTHER,
                            "make it first; each input gets DIRECTORY/BASE.shear.fits",
                            "--catalog %s: %s", out,
                            n > 1 ? "for several input files this must be an existing directory"
                                  : "there is no such directory");
    }
    for (size_t i = 0; i < n; i++) {
        if (measure_input_is_wanted(&inputs[i])) {
            inputs[i].catalog =
                directory ? path_in(out, shear_input_name(&inputs[i].source)) : strdup(out);
            if (inputs[i].catalog == NULL)
                return message_no_memory();
        }
    }
    return check_all(inputs, n, force);
}
