/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/jobs/catalog_directory.h"

#include "base/cleanup.h"
#include "base/io.h"
#include "log/log.h"
#include "service/core/clock.h"
#include "service/core/directory.h"
#include "service/core/parts.h"

#include <assert.h>
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <string.h>
#include <sys/stat.h>

static const char mark_name[] = ".sheard-database";
static const char final_suffix[] = ".shear.fits";
static const char part_suffix[] = ".shear.fits.part";
enum { MARK_SIZE = 64 };

/* ---- names ---- */

char *catalog_directory_path(const char *directory, int64_t job) {
    char *path = NULL;
    return asprintf(&path, "%s/%" PRId64 "%s", directory, job, final_suffix) > 0 ? path : NULL;
}

/* Return the job of "JOB.shear.fits" or ".JOB.shear.fits.part", or 0 for other names. */
static int64_t job_of(const char *name, bool *part) {
    *part = name[0] == '.';
    const char *digits = name + (*part ? 1 : 0);
    char *end = NULL;
    const int64_t job = digits[0] >= '1' && digits[0] <= '9' ? strtoll(digits, &end, 10) : 0;
    return end != NULL && strcmp(end, *part ? part_suffix : final_suffix) == 0 ? job : 0;
}

bool catalog_directory_is_name(const char *path, int64_t job) {
    bool part = false;
    const char *slash = strrchr(path, '/');
    return slash != NULL && job_of(slash + 1, &part) == job && !part;
}

int catalog_directory_visit(service *s, const char *path, catalog_visitor *visit, void *context,
                            shear_error *err) {
    DIR *directory = opendir(path);
    if (directory == NULL) {
        return shear_fail(err, SHEAR_E_IO, "let the service read and write it",
                          "the catalogs' directory '%s' cannot be read: %s", path, strerror(errno));
    }
    for (const struct dirent *e; (e = readdir(directory)) != NULL;) {
        bool part = false;
        const int64_t job = job_of(e->d_name, &part);
        if (job > 0)
            visit(s, job, part, context);
    }
    closedir(directory);
    return SHEAR_OK;
}

/* ---- the mark ---- */

static char *mark_path(const char *directory) {
    char *path = NULL;
    return asprintf(&path, "%s/%s", directory, mark_name) > 0 ? path : NULL;
}

/* Read the mark's text. Return 0 or errno (ENOENT: there is no mark). */
static int read_mark(const char *path, char text[MARK_SIZE]) {
    CLEANUP(release_fd) const int fd = open(path, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    const ssize_t n = fd >= 0 ? io_read(fd, text, MARK_SIZE - 1) : -1;
    if (n < 0)
        return errno;
    text[n] = '\0';
    text[strcspn(text, "\n")] = '\0';
    return 0;
}

static int sync_directory(const char *path) {
    CLEANUP(release_fd) const int fd = open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    return fd >= 0 && fsync(fd) == 0 ? 0 : errno;
}

/* Write the mark atomically and durably. Return 0 or errno (EEXIST: another service was faster). */
static int write_mark(const char *identity, const char *directory, const char *path) {
    char text[MARK_SIZE];
    char temporary[4400];
    snprintf(temporary, sizeof temporary, "%s.%ld", path, (long)getpid());
    snprintf(text, sizeof text, "%s\n", identity);
    unlink(temporary);
    const int fd = open(temporary, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0640);
    int error = fd >= 0 ? io_finish(fd, io_write(fd, text, strlen(text))) : errno;
    if (error == 0 && link(temporary, path) != 0)
        error = errno;
    unlink(temporary);
    return error == 0 ? sync_directory(directory) : error;
}

bool catalog_directory_is_since_mark(const char *directory, const char *path) {
    CLEANUP(release_free) char *mark = mark_path(directory);
    struct stat marked;
    struct stat st;
    if (mark == NULL || stat(mark, &marked) != 0 || stat(path, &st) != 0)
        return false;
    return st.st_ctim.tv_sec > marked.st_mtim.tv_sec ||
           (st.st_ctim.tv_sec == marked.st_mtim.tv_sec &&
            st.st_ctim.tv_nsec >= marked.st_mtim.tv_nsec);
}

bool catalog_directory_is_ours(const service *s, const char *path, bool unmarked) {
    const char *slash = strrchr(path, '/');
    assert(slash != NULL);
    CLEANUP(release_free) char *directory = strndup(path, (size_t)(slash - path));
    CLEANUP(release_free) char *mark = directory != NULL ? mark_path(directory) : NULL;
    char text[MARK_SIZE];
    const int error = mark != NULL ? read_mark(mark, text) : ENOMEM;
    return error == ENOENT ? unmarked : error == 0 && strcmp(text, store_identity(s->store)) == 0;
}

/* ---- the claim ---- */

/* What is in a directory without a mark. */
typedef struct directory_content {
    const char *directory;
    int64_t last_job; /* the last one of this database */
    int64_t known;    /* catalogs that this database knows */
    int64_t strange;  /* a job's number that this database has not used yet, but that has a catalog
                         here; 0: none */
    bool any;
} directory_content;

static bool same_file(const char *a, const char *b) {
    struct stat x;
    struct stat y;
    return strcmp(a, b) == 0 ||
           (stat(a, &x) == 0 && stat(b, &y) == 0 && x.st_dev == y.st_dev && x.st_ino == y.st_ino);
}

static void count(service *s, int64_t id, bool part, void *context) {
    directory_content *c = context;
    CLEANUP(store_job_deinit) store_job job = {0};
    CLEANUP(release_free) char *path = catalog_directory_path(c->directory, id);
    shear_error ignored;
    c->any = true;
    c->strange = id > c->last_job ? id : c->strange;
    if (path == NULL || store_job_get(s->store, id, &job, &ignored) != SHEAR_OK)
        return;
    const bool known = part ? !store_state_is_final(job.state)
                            : job.catalog != NULL && same_file(job.catalog, path);
    c->known += known;
}

static int fail_foreign(const service *s, const char *directory, const char *why,
                        shear_error *err) {
    char advice[240];
    snprintf(advice, sizeof advice,
             "set [catalogues] directory to another one, or move its *.shear.fits files and "
             "%s away; if they are this database's after all, write %s into that file",
             mark_name, store_identity(s->store));
    return shear_fail(err, SHEAR_E_EXISTS, advice,
                      "the catalogs in '%s' belong to another database than %s/sheard.db: %s",
                      directory, s->config.daemon.state_dir, why);
}

/* Claim a directory without a mark, if it is free or was ours before there were marks. */
static int claim_unmarked(service *s, const char *directory, const char *mark, shear_error *err) {
    char why[160];
    directory_content c = {.directory = directory};
    TRY(store_last_job(s->store, &c.last_job, err));
    TRY(catalog_directory_visit(s, directory, count, &c, err));
    if (c.strange != 0) {
        snprintf(why, sizeof why,
                 "there is one of a job %" PRId64 ", which this one has not had yet", c.strange);
        return fail_foreign(s, directory, why, err);
    }
    if (c.any && c.known == 0)
        return fail_foreign(s, directory, "this one tells of none of them", err);
    const int error = write_mark(store_identity(s->store), directory, mark);
    if (error == EEXIST) {
        return fail_foreign(s, directory, "another service is taking the directory at this moment",
                            err);
    }
    return error == 0 ? SHEAR_OK
                      : shear_fail(err, SHEAR_E_IO, "let the service write into that directory",
                                   "%s cannot be written: %s", mark, strerror(error));
}

int catalog_directory_claim(service *s, const char *directory, shear_error *err) {
    char text[MARK_SIZE];
    char why[160];
    CLEANUP(release_free) char *mark = mark_path(directory);
    if (mark == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "no memory for the catalogs' mark");
    TRY(directory_make(directory, 0750, err));
    const int error = read_mark(mark, text);
    if (error == ENOENT)
        return claim_unmarked(s, directory, mark, err);
    if (error != 0) {
        return shear_fail(err, SHEAR_E_IO, "let the service read that file", "%s: %s", mark,
                          strerror(error));
    }
    if (strcmp(text, store_identity(s->store)) != 0) {
        snprintf(why, sizeof why, "that has the id '%.40s', this one is %s", text,
                 store_identity(s->store));
        return fail_foreign(s, directory, why, err);
    }
    return SHEAR_OK;
}

/* ---- after a clean-up ---- */

/* Remove marks that were being written when a service died. */
static void remove_begun_marks(const char *path) {
    const size_t n = sizeof mark_name - 1;
    DIR *directory = opendir(path);
    if (directory == NULL)
        return;
    for (const struct dirent *e; (e = readdir(directory)) != NULL;) {
        if (strncmp(e->d_name, mark_name, n) == 0 && e->d_name[n] == '.')
            unlinkat(dirfd(directory), e->d_name, 0);
    }
    closedir(directory);
}

/* The margin allows for file times that lag behind the clock. If this fails, the next start
 * examines more files. */
void catalog_directory_renew_mark(const char *directory) {
    enum { MARGIN_S = 2 };
    CLEANUP(release_free) char *mark = mark_path(directory);
    struct stat st;
    const int64_t now_s = clock_wall_ms() / 1000 - MARGIN_S;
    const struct timespec seen[2] = {{.tv_nsec = UTIME_OMIT}, {.tv_sec = now_s}};
    remove_begun_marks(directory);
    if (mark != NULL && stat(mark, &st) == 0 && st.st_mtim.tv_sec < now_s &&
        utimensat(AT_FDCWD, mark, seen, AT_SYMLINK_NOFOLLOW) != 0) {
        log_warning("%s: %s", mark, strerror(errno));
    }
}
