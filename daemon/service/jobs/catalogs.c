/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The jobs' result catalogs, and their temporary files, which wait for a job's next attempt.
 *
 * They are called after the jobs' numbers, which every database counts from 1. So a directory
 * belongs to one database: the file .sheard-database in it says which. A directory without it is
 * taken where nothing of the kind lies in it, or where this database knows what does (0.1 left no
 * mark).
 *
 * A catalog is in place before its job's end is on disk. Where the service dies between, or that
 * end is another one (cancelled meanwhile), it is nobody's: it goes at the job's end, or at the
 * next start. The mark's time of change says since when there may be such ones: what was there
 * before the directory was marked is never taken for one, and no start looks at what the last one
 * has seen. */
#include "service/inner.h"

#include "shear/catalog.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const char mark_name[] = ".sheard-database";
static const char final_suffix[] = ".shear.fits";
static const char part_suffix[] = ".shear.fits.part";

static char *path_in(const char *directory, int64_t job) {
    char *path = NULL;
    return asprintf(&path, "%s/%" PRId64 "%s", directory, job, final_suffix) > 0 ? path : NULL;
}

char *catalog_path(const service *s, int64_t job) {
    return s->config.catalogs.enabled ? path_in(s->config.catalogs.directory, job) : NULL;
}

/* The job of "JOB.shear.fits" or ".JOB.shear.fits.part"; 0 for other names. */
static int64_t job_of(const char *name, bool *part) {
    *part = name[0] == '.';
    const char *digits = name + *part;
    char *end = NULL;
    const int64_t job = digits[0] >= '1' && digits[0] <= '9' ? strtoll(digits, &end, 10) : 0;
    return end != NULL && strcmp(end, *part ? part_suffix : final_suffix) == 0 ? job : 0;
}

static void remove_part(const char *path, int64_t job) {
    shear_error err = {0};
    if (shear_catalog_discard(path, &err) != SHEAR_OK) {
        log_warning("job %" PRId64 ": %s", job, err.message);
    }
}

static void remove_final(const char *path, int64_t job) {
    if (unlink(path) == 0) {
        log_notice("job %" PRId64 ": %s is removed: the job did not end with it", job, path);
    } else if (errno != ENOENT) {
        log_warning("job %" PRId64 ": %s cannot be removed: %s", job, path, strerror(errno));
    }
}

static char *mark_in(const char *directory) {
    char *path = NULL;
    return asprintf(&path, "%s/%s", directory, mark_name) > 0 ? path : NULL;
}

/* Its text, or errno as a negative number; -ENOENT: there is none. */
static int read_mark(const char *path, char *text, size_t size) {
    const int fd = open(path, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    const ssize_t n = fd >= 0 ? read(fd, text, size - 1) : -1;
    const int error = n < 0 ? -errno : 0;
    if (fd >= 0) {
        close(fd);
    }
    text[n > 0 ? n : 0] = '\0';
    text[strcspn(text, "\n")] = '\0';
    return error;
}

static bool is_since_mark(const service *s, const char *path) {
    char *mark = mark_in(s->config.catalogs.directory);
    struct stat marked;
    struct stat st;
    const bool found = mark != NULL && stat(mark, &marked) == 0 && stat(path, &st) == 0;
    free(mark);
    return found && (st.st_ctim.tv_sec > marked.st_mtim.tv_sec ||
                     (st.st_ctim.tv_sec == marked.st_mtim.tv_sec &&
                      st.st_ctim.tv_nsec >= marked.st_mtim.tv_nsec));
}

/* Is this the name that a catalog of the job has, wherever its directory was? */
static bool is_catalog_of(const char *path, int64_t job) {
    bool part = false;
    const char *slash = strrchr(path, '/');
    return slash != NULL && job_of(slash + 1, &part) == job && !part;
}

/* Its directory may have been left to another database since: what has this name is that one's. Is
 * what lies in a directory without a mark ours? */
static bool is_ours(const service *s, const char *path, bool unmarked) {
    char text[64];
    char *directory = strndup(path, (size_t)(strrchr(path, '/') - path));
    char *mark = directory != NULL ? mark_in(directory) : NULL;
    const int error = mark != NULL ? read_mark(mark, text, sizeof text) : -ENOMEM;
    free(directory);
    free(mark);
    return (error == -ENOENT && unmarked) ||
           (error == 0 && strcmp(text, store_identity(s->store)) == 0);
}

/* True: there is none any more. */
static bool remove_retracted(int64_t id, const char *path) {
    const bool gone = unlink(path) == 0 || errno == ENOENT;
    if (!gone) {
        log_warning("job %" PRId64 " is retracted: its catalog %s cannot be removed: %s", id, path,
                    strerror(errno));
    }
    return gone;
}

bool catalog_leaves(const service *s, const store_removal *l) {
    char *path = l->kept ? NULL : path_in(s->config.catalogs.directory, l->job);
    const char *named = l->kept ? l->catalog : path;
    const bool gone = named == NULL || !is_catalog_of(named, l->job) ||
                      !is_ours(s, named, l->kept) || remove_retracted(l->job, named);
    free(path);
    return gone;
}

/* A failure: the next start tries it again. */
void catalogs_remove_retracted(service *s) {
    shear_error err = {0};
    int64_t id = 0;
    char *path = NULL;
    int code = store_next_leftover(s->store, 0, &id, &path, &err);
    while (code == SHEAR_OK && id != 0) {
        const bool gone =
            !is_catalog_of(path, id) || !is_ours(s, path, true) || remove_retracted(id, path);
        code = gone ? group_begin(s, &err) : SHEAR_OK;
        if (code == SHEAR_OK && gone) {
            code = store_catalog_gone(s->store, id, &err);
        }
        free(path);
        path = NULL;
        if (code == SHEAR_OK) {
            code = store_next_leftover(s->store, id, &id, &path, &err);
        }
    }
    if (code != SHEAR_OK) {
        log_warning("catalogs of retracted jobs: %s", err.message);
    }
}

void catalog_forget(const service *s, const store_job *job) {
    char *path = catalog_path(s, job->id);
    if (path != NULL) {
        remove_part(path, job->id);
        if (job->catalog == NULL && job->started_ms != 0 && is_since_mark(s, path)) {
            remove_final(path, job->id);
        }
    }
    free(path);
}

/* ---- what lies in the directory ---- */

typedef struct found {
    const char *directory;
    int64_t last_job; /* of this database */
    int64_t known;    /* files that this database tells of */
    int64_t strange;  /* a job that has one, and that this database has not had yet; or 0 */
    bool any;
} found;

static bool same_file(const char *a, const char *b) {
    struct stat x;
    struct stat y;
    return strcmp(a, b) == 0 ||
           (stat(a, &x) == 0 && stat(b, &y) == 0 && x.st_dev == y.st_dev && x.st_ino == y.st_ino);
}

typedef void visitor(service *s, int64_t id, bool part, void *context);

static int for_each(service *s, const char *path, visitor *visit, void *context, shear_error *err) {
    DIR *directory = opendir(path);
    if (directory == NULL) {
        return shear_fail(err, SHEAR_E_IO, "let the service read and write it",
                          "the catalogs' directory '%s' cannot be read: %s", path, strerror(errno));
    }
    for (const struct dirent *e; (e = readdir(directory)) != NULL;) {
        bool part = false;
        const int64_t job = job_of(e->d_name, &part);
        if (job > 0) {
            visit(s, job, part, context);
        }
    }
    closedir(directory);
    return SHEAR_OK;
}

static void judge(service *s, int64_t id, bool part, void *context) {
    found *f = context;
    store_job job = {0};
    shear_error ignored;
    char *path = path_in(f->directory, id);
    f->any = true;
    f->strange = id > f->last_job ? id : f->strange;
    if (path != NULL && store_job_get(s->store, id, &job, &ignored) == SHEAR_OK) {
        f->known += part ? !sheard_job_state_is_final(job.state)
                         : job.catalog != NULL && same_file(job.catalog, path);
    }
    store_job_deinit(&job);
    free(path);
}

/* ---- the mark ---- */

static int sync_directory(const char *path) {
    const int fd = open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    const int error = fd < 0 || fsync(fd) != 0 ? errno : 0;
    if (fd >= 0) {
        close(fd);
    }
    return error;
}

/* It appears whole; EEXIST where another service was faster. */
static int write_mark(const service *s, const char *directory, const char *path) {
    char text[64];
    char temporary[4400];
    snprintf(temporary, sizeof temporary, "%s.%ld", path, (long)getpid());
    const int n = snprintf(text, sizeof text, "%s\n", store_identity(s->store));
    unlink(temporary);
    const int fd = open(temporary, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0640);
    if (fd < 0) {
        return errno;
    }
    int error = write(fd, text, (size_t)n) == n && fsync(fd) == 0 ? 0 : errno;
    if (close(fd) != 0 && error == 0) {
        error = errno;
    }
    if (error == 0 && link(temporary, path) != 0) {
        error = errno;
    }
    unlink(temporary);
    return error == 0 ? sync_directory(directory) : error;
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

/* Without a mark: is it free, or was it ours before there were marks? */
static int take_directory(service *s, const char *directory, const char *path, shear_error *err) {
    char why[160];
    found f = {.directory = directory};
    int code = store_last_job(s->store, &f.last_job, err);
    if (code == SHEAR_OK) {
        code = for_each(s, directory, judge, &f, err);
    }
    if (code != SHEAR_OK) {
        return code;
    }
    if (f.strange != 0) {
        snprintf(why, sizeof why,
                 "there is one of a job %" PRId64 ", which this one has not had yet", f.strange);
        return fail_foreign(s, directory, why, err);
    }
    if (f.any && f.known == 0) {
        return fail_foreign(s, directory, "this one tells of none of them", err);
    }
    const int error = write_mark(s, directory, path);
    if (error == EEXIST) {
        return fail_foreign(s, directory, "another service takes the directory at this moment",
                            err);
    }
    return error == 0 ? SHEAR_OK
                      : shear_fail(err, SHEAR_E_IO, "let the service write into that directory",
                                   "%s cannot be written: %s", path, strerror(error));
}

int catalogs_claim(service *s, const char *directory, shear_error *err) {
    char text[64];
    char why[160];
    char *path = mark_in(directory);
    if (path == NULL) {
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "no memory for the catalogs' mark");
    }
    int code = make_directory(directory, 0750, err);
    const int error = code == SHEAR_OK ? read_mark(path, text, sizeof text) : 0;
    if (code != SHEAR_OK) {
        /* as it is told */
    } else if (error == -ENOENT) {
        code = take_directory(s, directory, path, err);
    } else if (error != 0) {
        code = shear_fail(err, SHEAR_E_IO, "let the service read that file", "%s: %s", path,
                          strerror(-error));
    } else if (strcmp(text, store_identity(s->store)) != 0) {
        snprintf(why, sizeof why, "that has the id '%.40s', this one is %s", text,
                 store_identity(s->store));
        code = fail_foreign(s, directory, why, err);
    }
    free(path);
    return code;
}

/* ---- the start ---- */

/* Of a job that is over, what it did not end with; of one that is not, what an attempt that the
 * store does not know of has put in place. Catalogs of retired jobs stay. */
static void clean(service *s, int64_t id, bool part, void *context) {
    (void)context;
    store_job job = {0};
    shear_error ignored;
    char *path = catalog_path(s, id);
    if (path != NULL && (part || is_since_mark(s, path))) {
        const int code = store_job_get(s->store, id, &job, &ignored);
        const bool over =
            code == STORE_NOT_FOUND || (code == SHEAR_OK && sheard_job_state_is_final(job.state));
        if (part && over) {
            remove_part(path, id);
        } else if (!part && code == SHEAR_OK && job.catalog == NULL) {
            remove_final(path, id);
        }
        store_job_deinit(&job);
    }
    free(path);
}

/* What is left of a mark that was being written when its service died. */
static void remove_begun_marks(const char *path) {
    const size_t n = sizeof mark_name - 1;
    DIR *directory = opendir(path);
    for (const struct dirent *e; directory != NULL && (e = readdir(directory)) != NULL;) {
        if (strncmp(e->d_name, mark_name, n) == 0 && e->d_name[n] == '.') {
            unlinkat(dirfd(directory), e->d_name, 0);
        }
    }
    if (directory != NULL) {
        closedir(directory);
    }
}

/* Files' times may lag behind the clock by a tick of it. */
static int sweep(service *s, const char *directory, shear_error *err) {
    enum { MARGIN_S = 2 };
    struct stat st;
    const int64_t now_s = wall_ms() / 1000 - MARGIN_S;
    const struct timespec seen[2] = {{.tv_nsec = UTIME_OMIT}, {.tv_sec = now_s}};
    char *mark = mark_in(directory);
    const int code = for_each(s, directory, clean, NULL, err);
    remove_begun_marks(directory);
    /* Where this fails the next start has more to look at. */
    if (code == SHEAR_OK && mark != NULL && stat(mark, &st) == 0 && st.st_mtim.tv_sec < now_s &&
        utimensat(AT_FDCWD, mark, seen, AT_SYMLINK_NOFOLLOW) != 0) {
        log_warning("%s: %s", mark, strerror(errno));
    }
    free(mark);
    return code;
}

int catalogs_open(service *s, shear_error *err) {
    if (!s->config.catalogs.enabled) {
        return SHEAR_OK;
    }
    const char *directory = s->config.catalogs.directory;
    const int code = catalogs_claim(s, directory, err);
    return code == SHEAR_OK ? sweep(s, directory, err) : code;
}
