/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/cache.h"

#include "engine/progress.h"
#include "shear/field.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

enum { KEY_LENGTH = 12, MAX_NAME = 80, MAX_PATH = 700 };
static const char head[] = "shear-paper state 1\n";

/* One line: NAME CHUNK COUNT SECONDS VALUE... end */
struct record {
    char name[MAX_NAME];
    int chunk, n;
    double seconds;
    double *values; /* [n], owned */
};

struct ledger {
    int fd;
    char path[MAX_PATH];
    size_t n, room;
    struct record *records;
    struct progress progress;
    double seconds;
};

static int no_memory(shear_error *err) {
    return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for the state of the experiment");
}

static int system_error(const struct ledger *l, const char *what, shear_error *err) {
    return shear_fail(err, SHEAR_E_IO, NULL, "cannot %s '%s': %s", what, l->path, strerror(errno));
}

/* ---- reading ---- */

static bool keep(struct ledger *l, const struct record *r) {
    if (l->n == l->room) {
        size_t room = l->room > 0 ? 2 * l->room : 64;
        struct record *larger = realloc(l->records, room * sizeof *larger);
        if (larger == NULL) {
            return false;
        }
        l->records = larger;
        l->room = room;
    }
    l->records[l->n++] = *r;
    l->seconds += r->seconds;
    return true;
}

static bool parse_double(char **p, double *value) {
    char *end = NULL;
    *value = strtod(*p, &end);
    bool good = end != *p && *end == ' ';
    *p = good ? end + 1 : *p;
    return good;
}

static bool parse_int(char **p, int *value) {
    double number = 0.0;
    bool good = parse_double(p, &number) && number >= 0.0 && number <= INT_MAX;
    *value = good ? (int)number : 0;
    return good;
}

/* The first word, which is the task's name. */
static bool parse_name(char **p, char *name) {
    size_t length = strcspn(*p, " ");
    bool good = length > 0 && length < MAX_NAME && (*p)[length] == ' ';
    snprintf(name, MAX_NAME, "%.*s", good ? (int)length : 0, *p);
    *p += good ? length + 1 : 0;
    return good;
}

/* True where `line` (without its end) is a whole record. */
static bool parse_record(char *line, struct record *r) {
    char *p = line;
    *r = (struct record){0};
    if (!parse_name(&p, r->name) || !parse_int(&p, &r->chunk) || !parse_int(&p, &r->n)) {
        return false;
    }
    r->values = calloc((size_t)r->n + 1, sizeof *r->values);
    bool good = r->values != NULL && parse_double(&p, &r->seconds);
    for (int i = 0; good && i < r->n; i++) {
        good = parse_double(&p, &r->values[i]);
    }
    if (!good || strcmp(p, "end") != 0) {
        free(r->values);
        return false;
    }
    return true;
}

/* Take the records of `text`; *good becomes the length up to which it is whole. */
static int parse_state(struct ledger *l, char *text, size_t length, size_t *good,
                       shear_error *err) {
    *good = 0;
    size_t begin = sizeof head - 1;
    if (length < begin || memcmp(text, head, begin) != 0) {
        return SHEAR_OK;
    }
    *good = begin;
    for (char *end = NULL; begin < length && (end = memchr(text + begin, '\n', length - begin));
         begin = *good) {
        struct record r;
        *end = '\0';
        if (!parse_record(text + begin, &r)) {
            break;
        }
        if (!keep(l, &r)) {
            free(r.values);
            return no_memory(err);
        }
        *good = (size_t)(end - text) + 1;
    }
    return SHEAR_OK;
}

static int read_all(const struct ledger *l, char **text, size_t *length, shear_error *err) {
    struct stat st;
    if (fstat(l->fd, &st) != 0) {
        return system_error(l, "read", err);
    }
    size_t size = (size_t)st.st_size;
    *length = 0;
    *text = malloc(size + 1);
    if (*text == NULL) {
        return no_memory(err);
    }
    while (*length < size) {
        ssize_t got = pread(l->fd, *text + *length, size - *length, (off_t)*length);
        if (got < 0 && errno != EINTR) {
            return system_error(l, "read", err);
        }
        if (got == 0) {
            break;
        }
        *length += got > 0 ? (size_t)got : 0;
    }
    return SHEAR_OK;
}

static int append(const struct ledger *l, const char *text, size_t length, shear_error *err) {
    while (length > 0) {
        ssize_t put = write(l->fd, text, length);
        if (put < 0 && errno != EINTR) {
            return system_error(l, "write", err);
        }
        text += put > 0 ? put : 0;
        length -= put > 0 ? (size_t)put : 0;
    }
    return fdatasync(l->fd) == 0 ? SHEAR_OK : system_error(l, "sync", err);
}

static int load(struct ledger *l, bool fresh, shear_error *err) {
    char *text = NULL;
    size_t length = 0;
    size_t good = 0;
    int code = fresh ? SHEAR_OK : read_all(l, &text, &length, err);
    if (code == SHEAR_OK && text != NULL) {
        code = parse_state(l, text, length, &good, err);
    }
    free(text);
    if (code == SHEAR_OK && ftruncate(l->fd, (off_t)good) != 0) {
        code = system_error(l, "truncate", err);
    }
    if (code == SHEAR_OK && good == 0) {
        code = append(l, head, sizeof head - 1, err);
    }
    return code;
}

/* ---- opening ---- */

static int make_folder(const char *path, shear_error *err) {
    if (mkdir(path, 0777) != 0 && errno != EEXIST) {
        return shear_fail(err, SHEAR_E_IO, NULL, "cannot make the folder '%s': %s", path,
                          strerror(errno));
    }
    return SHEAR_OK;
}

static int name_state(struct ledger *l, const struct request *r, shear_error *err) {
    char key[SHEAR_CHECKSUM_SIZE];
    char *text = request_describe(r);
    if (text == NULL) {
        return no_memory(err);
    }
    shear_bytes_checksum(text, strlen(text), key);
    free(text);
    key[KEY_LENGTH] = '\0';
    request_path(r, key, "state", l->path, sizeof l->path);
    return SHEAR_OK;
}

static int open_locked(struct ledger *l, shear_error *err) {
    l->fd = open(l->path, O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
    if (l->fd < 0) {
        return system_error(l, "open", err);
    }
    if (flock(l->fd, LOCK_EX | LOCK_NB) != 0) {
        return errno == EWOULDBLOCK
                   ? shear_fail(err, SHEAR_E_EXISTS, "wait for it, or choose another seed",
                                "another process works on '%s'", l->path)
                   : system_error(l, "lock", err);
    }
    return SHEAR_OK;
}

int ledger_open(struct ledger **ledger, const struct request *r, int64_t total, shear_error *err) {
    *ledger = NULL;
    struct ledger *l = calloc(1, sizeof *l);
    if (l == NULL) {
        return no_memory(err);
    }
    l->fd = -1;
    int code = make_folder(r->out, err);
    code = code != SHEAR_OK ? code : name_state(l, r, err);
    code = code != SHEAR_OK ? code : open_locked(l, err);
    code = code != SHEAR_OK ? code : load(l, r->fresh, err);
    if (code != SHEAR_OK) {
        ledger_close(l);
        return code;
    }
    progress_begin(&l->progress, total, r->quiet);
    *ledger = l;
    return SHEAR_OK;
}

void ledger_close(struct ledger *l) {
    if (l == NULL) {
        return;
    }
    progress_end(&l->progress);
    if (l->fd >= 0) {
        close(l->fd);
    }
    for (size_t i = 0; i < l->n; i++) {
        free(l->records[i].values);
    }
    free(l->records);
    free(l);
}

double ledger_seconds(const struct ledger *l) {
    return l->seconds;
}

/* ---- tasks ---- */

/* Copy what the state has; done[chunk] says which chunks these are. */
static void recall(const struct ledger *l, const struct task *t, double *values, bool *done) {
    for (size_t i = 0; i < l->n; i++) {
        const struct record *r = &l->records[i];
        if (strcmp(r->name, t->name) == 0 && r->n == t->values && r->chunk >= 0 &&
            r->chunk < t->chunks) {
            memcpy(values + (size_t)r->chunk * (size_t)r->n, r->values,
                   (size_t)r->n * sizeof *values);
            done[r->chunk] = true;
        }
    }
}

static int remember(struct ledger *l, const struct task *t, int chunk, double seconds,
                    const double *values, shear_error *err) {
    char *text = NULL;
    size_t length = 0;
    FILE *out = open_memstream(&text, &length);
    if (out == NULL) {
        return no_memory(err);
    }
    fprintf(out, "%s %d %d %.3f ", t->name, chunk, t->values, seconds);
    for (int i = 0; i < t->values; i++) {
        fprintf(out, "%a ", values[i]);
    }
    fputs("end\n", out);
    int code = fclose(out) == 0 ? append(l, text, length, err) : no_memory(err);
    free(text);
    l->seconds += seconds;
    return code;
}

static int run_chunk(struct ledger *l, const struct task *t, int chunk, double *values,
                     shear_error *err) {
    double begun = progress_seconds();
    int code = t->work(t->context, chunk, values, err);
    return code != SHEAR_OK ? code : remember(l, t, chunk, progress_seconds() - begun, values, err);
}

int ledger_run(struct ledger *l, const struct task *t, double *values, shear_error *err) {
    bool *done = calloc((size_t)t->chunks + 1, sizeof *done);
    if (done == NULL) {
        return no_memory(err);
    }
    recall(l, t, values, done);
    int code = SHEAR_OK;
    for (int i = 0; code == SHEAR_OK && i < t->chunks; i++) {
        bool skipped = done[i];
        if (!skipped) {
            code = run_chunk(l, t, i, values + (size_t)i * (size_t)t->values, err);
        }
        progress_add(&l->progress, t->name, t->stamps_of_chunk, skipped);
    }
    free(done);
    return code;
}
