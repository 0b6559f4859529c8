/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/cache.h"

#include "base/array.h"
#include "base/clock.h"
#include "engine/must.h"
#include "engine/progress.h"
#include "shear/field.h"

#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

enum { KEY_LENGTH = 12, MAX_NAME = 80 };
static const char head[] = "shear-paper state 1\n";

/* One line of the state file: NAME CHUNK COUNT SECONDS VALUE... end */
typedef struct record {
    char name[MAX_NAME];
    double chunk, n, seconds;
    double *values; /* [n], owned */
} record;

struct cache {
    FILE *file;
    char path[OPTIONS_PATH];
    size_t n, capacity;
    record *records;
    double seconds;
};

static _Noreturn void fail(const cache *c, const char *what) {
    must_fail(SHEAR_E_IO, NULL, "cannot %s '%s': %s", what, c->path, strerror(errno));
}

/* ---- reading ---- */

static bool parse_double(const char **p, double *value) {
    char *end = NULL;
    *value = strtod(*p, &end);
    const bool good = end != *p && *end == ' ';
    *p = good ? end + 1 : *p;
    return good;
}

/* Parse the first word, the name of the task. */
static bool parse_name(const char **p, char *name) {
    const size_t length = strcspn(*p, " ");
    if (length == 0 || length >= MAX_NAME || (*p)[length] != ' ')
        return false;
    snprintf(name, MAX_NAME, "%.*s", (int)length, *p);
    *p += length + 1;
    return true;
}

/* Return whether `line` is a complete record. Its values are allocated in either case. */
static bool parse_record(const char *line, record *r) {
    const char *p = line;
    *r = (record){0};
    if (!parse_name(&p, r->name) || !parse_double(&p, &r->chunk) || !parse_double(&p, &r->n) ||
        !(r->n >= 0.0 && r->n <= (double)strlen(line)) || r->n != floor(r->n) ||
        !parse_double(&p, &r->seconds)) {
        return false;
    }
    r->values = must_allocate((size_t)r->n, sizeof *r->values, "the state of the experiment");
    for (int i = 0; i < r->n; i++) {
        if (!parse_double(&p, &r->values[i]))
            return false;
    }
    return strcmp(p, "end\n") == 0;
}

static void keep(cache *c, const record *r) {
    if (!ARRAY_RESERVE(c->records, c->capacity, c->n + 1))
        must_fail(SHEAR_E_NOMEM, NULL, "out of memory for the state of the experiment");
    c->records[c->n++] = *r;
    c->seconds += r->seconds;
}

/* Read the records of the file. Returns the length of its complete part. */
static off_t read_records(cache *c) {
    CLEANUP(release_free) char *line = NULL;
    size_t size = 0;
    off_t good = 0;
    record r = {0};
    if (getline(&line, &size, c->file) > 0 && strcmp(line, head) == 0) {
        good = ftello(c->file);
        while (getline(&line, &size, c->file) > 0 && parse_record(line, &r)) {
            keep(c, &r);
            r.values = NULL;
            good = ftello(c->file);
        }
    }
    free(r.values);
    return good;
}

static void sync_file(cache *c) {
    if (fflush(c->file) != 0 || fdatasync(fileno(c->file)) != 0)
        fail(c, "write");
}

static void load(cache *c, bool fresh) {
    const off_t good = fresh ? 0 : read_records(c);
    if (ftruncate(fileno(c->file), good) != 0 || fseeko(c->file, 0, SEEK_END) != 0)
        fail(c, "truncate");
    if (good == 0) {
        fputs(head, c->file);
        sync_file(c);
    }
}

/* ---- opening ---- */

static void name_state(cache *c, const options *o) {
    char key[SHEAR_CHECKSUM_SIZE];
    CLEANUP(release_free) char *text = options_describe(o);
    shear_bytes_checksum(text, strlen(text), key);
    key[KEY_LENGTH] = '\0';
    options_path(o, key, "state", c->path);
}

static void open_locked(cache *c) {
    const int fd = open(c->path, O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
    c->file = fd >= 0 ? fdopen(fd, "a+") : NULL;
    if (c->file == NULL)
        fail(c, "open");
    if (flock(fd, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
        must_fail(SHEAR_E_EXISTS, "wait for it, or choose another seed",
                  "another process works on '%s'", c->path);
    }
}

cache *cache_open(const options *o, int64_t total) {
    if (mkdir(o->out, 0777) != 0 && errno != EEXIST)
        must_fail(SHEAR_E_IO, NULL, "cannot make the folder '%s': %s", o->out, strerror(errno));
    cache *c = must_allocate(1, sizeof *c, "the state of the experiment");
    name_state(c, o);
    open_locked(c);
    load(c, o->fresh);
    progress_begin(total, o->quiet);
    return c;
}

void cache_close(cache *c) {
    progress_end();
    fclose(c->file);
    for (size_t i = 0; i < c->n; i++)
        free(c->records[i].values);
    free(c->records);
    free(c);
}

double cache_seconds(const cache *c) {
    return c->seconds;
}

/* ---- tasks ---- */

/* Return the record of a chunk that was finished earlier, or NULL. */
static const record *find(const cache *c, const cache_task *t, int chunk) {
    for (size_t i = 0; i < c->n; i++) {
        const record *r = &c->records[i];
        if (r->chunk == chunk && r->n == t->values && strcmp(r->name, t->name) == 0)
            return r;
    }
    return NULL;
}

static void run_chunk(cache *c, const cache_task *t, int chunk, double *values) {
    const double begun = clock_s(CLOCK_MONOTONIC);
    t->work(t->context, chunk, values);
    const double seconds = clock_s(CLOCK_MONOTONIC) - begun;
    fprintf(c->file, "%s %d %d %.3f ", t->name, chunk, t->values, seconds);
    for (int i = 0; i < t->values; i++)
        fprintf(c->file, "%a ", values[i]);
    fputs("end\n", c->file);
    sync_file(c);
    c->seconds += seconds;
}

double *cache_run(cache *c, const cache_task *t) {
    assert(strlen(t->name) < MAX_NAME && strchr(t->name, ' ') == NULL);
    const size_t n = (size_t)t->values;
    double *values = must_allocate((size_t)t->chunks * n, sizeof *values, t->name);
    for (int i = 0; i < t->chunks; i++) {
        const record *known = find(c, t, i);
        if (known != NULL) {
            memcpy(values + (size_t)i * n, known->values, n * sizeof *values);
        } else {
            run_chunk(c, t, i, values + (size_t)i * n);
        }
        progress_add(t->name, t->stamps_of_chunk, known != NULL);
    }
    return values;
}
