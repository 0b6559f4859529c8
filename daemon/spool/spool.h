/* SPDX-License-Identifier: GPL-3.0-or-later */
/* spool/spool.h: the watch folder. It knows the loop and files; no jobs, no SQL, no JSON.
 *
 *     <directory>/incoming/NAME             put there by anybody who may
 *     <directory>/active/KEY-NAME           acquired: `found` tells the owner; KEY is never used
 * again <directory>/done/NAME, NAME.json      disposed of, with the report; or failed/NAME,
 * NAME.json
 *
 * A file is in exactly one of these places at any moment, whatever is killed when; a name is never
 * overwritten (the second a.fits becomes a.1.fits, its report a.1.fits.json).
 *
 * Regular files *.fits, *.fit, *.fits.gz, *.fit.gz, *.fz and *.json, in upper and lower case, are
 * acquired. Dotfiles, *.tmp and *.part are passed over in silence; other names, and what is not a
 * regular file, are left lying with one message each (spool_get_ignored lists them).
 *
 * A file is acquired as soon as its writer has closed it or has renamed it into place. It must
 * stand still for settle_ms where only a scan found it (it was there at the start, events were
 * lost, or another machine wrote it), where it is empty, and where it is a second link to a file;
 * and for twelve times as long (two seconds at least) where it was made here and has not been
 * closed.
 *
 * Crashes: a file that was acquired but not disposed of is found again by the next spool_open, with
 * the same key. So the owner submits with the key as idempotency key, and commits a job's end
 * before it calls spool_dispose; then each file counts once.
 *
 * Threads: one, the loop's. Callbacks come from the loop (only messages come from within calls,
 * too). `found` may call everything here; the other callbacks nothing. The calls may wait for the
 * disk. */
#ifndef SHEARD_SPOOL_H
#define SHEARD_SPOOL_H

#include "shear/error.h"

#include <stdbool.h>
#include <stdint.h>
#include <sys/types.h>
#include <uv.h>

enum spool_code {
    SPOOL_LOCKED = 100, /* another process owns this spool */
    SPOOL_GONE,         /* the file vanished from active/ */
    SPOOL_DENIED,       /* the service may not read the file */
    SPOOL_NOT_REGULAR,  /* a link, directory or device */
    SPOOL_REPLACED      /* another file lies where it lay, or it was changed there */
};

/* As enum sheard_log_level numbers them. */
enum spool_level { SPOOL_ERROR, SPOOL_WARNING, SPOOL_NOTICE };

/* Bytes, with the final NUL. */
enum {
    SPOOL_KEY_SIZE = 35,
    SPOOL_NAME_SIZE = 256,
    SPOOL_PLACE_SIZE = 264,
    SPOOL_FINGERPRINT_SIZE = 64
};

typedef struct spool_file {
    const char *active_name; /* names the file to the calls below */
    const char *key;         /* its first part: short, unique for ever, the idempotency key */
    const char *name;        /* as it was called in incoming/ */
    uid_t owner;             /* the file's */
    bool again;              /* may have been told before */
} spool_file;

typedef struct spool_callbacks {
    /* How many new files may be taken now; 0: they wait in incoming/. Asked before every batch. */
    int64_t (*capacity)(void *context);
    /* It is in active/, and on disk. Texts live during the call. The owner takes it (and calls
     * spool_dispose one day), or refuses it for the time being with spool_refuse. */
    void (*found)(void *context, const spool_file *file);
    void (*log)(void *context, enum spool_level level, const char *text); /* one line */
    void *context;
    /* Milliseconds since 1970, for the ages of what is kept; NULL: the clock's. */
    int64_t (*now_ms)(void *context);
} spool_callbacks;

/* Where an ended file lies. */
typedef struct spool_place {
    char name[SPOOL_PLACE_SIZE];              /* "failed/NAME"; "": not known */
    char fingerprint[SPOOL_FINGERPRINT_SIZE]; /* tells it from another file of this name; "": not
                                                 known */
} spool_place;

/* What stays in done/ or failed/; the oldest go first, a file and its report together. 0: no
 * limit. */
typedef struct spool_retention {
    int64_t max_age_ms, max_count, max_bytes;
} spool_retention;

/* What may change while running. */
typedef struct spool_tuning {
    int64_t settle_ms; /* >= 0 */
    int64_t scan_ms;   /* > 0: between two scans */
    spool_retention done, failed;
} spool_tuning;

typedef struct spool spool;

/* Own `directory` until spool_close; it and the four folders are made where they are missing (the
 * directory 0750, incoming/ writable by the group and sticky, so that users cannot take away each
 * other's files, the others readable by the group). They must be on one file system. What a crash
 * left half done is undone. The files in active/ are told first, with `again`, when the loop runs.
 * *s is NULL on error: SPOOL_LOCKED, SHEAR_E_IO, SHEAR_E_NOMEM. Where the system refuses to watch
 * (out of inotify instances), there is a warning, and scans alone find files. */
int spool_open(spool **s, uv_loop_t *loop, const char *directory, const spool_tuning *tuning,
               const spool_callbacks *callbacks, shear_error *err);
/* No callback comes any more, and the lock is free; memory is freed by the loop's next iteration,
 * which must come. NULL is accepted. */
void spool_close(spool *s);

void spool_tune(spool *s, const spool_tuning *tuning); /* takes effect with the next scan */

/* More files may be acquired again, or what made the owner refuse is over: look now, not at the
 * next scan. */
void spool_wake(spool *s);
/* Tell this file again (`found` with `again`) at the next scan or spool_wake. SHEAR_E_NOMEM: it is
 * told again by the next spool_open only. */
int spool_refuse(spool *s, const char *active_name, shear_error *err);

/* Open a taken file for reading. Errors: enum spool_code, or SHEAR_E_IO. *fd is -1 on error. */
int spool_open_file(const spool *s, const char *active_name, int *fd, shear_error *err);

/* Write the report (a text of the caller's) to done/ (good) or failed/, then move the file there.
 * On disk when this returns SHEAR_OK. After an error nothing has happened, or only the last fsync
 * is missing: call it again. A file that is no longer in active/ has been moved before (or was
 * taken away): SHEAR_OK. *place (NULL: not wanted) tells where it is now; not known in that case.
 * SHEAR_E_IO, SHEAR_E_INTERNAL (not an active name). */
int spool_dispose(spool *s, const char *active_name, bool good, const char *report,
                  spool_place *place, shear_error *err);

/* The way back: the file goes from `place` to active/ and its report away, all on disk when this
 * returns SHEAR_OK. The owner has accepted it already: it is not told, but by the next spool_open.
 * Where it is in active/ nothing happens. An error: the file is where it was. SPOOL_GONE,
 * SPOOL_REPLACED, SPOOL_NOT_REGULAR, SHEAR_E_IO, SHEAR_E_INTERNAL (no such names). */
int spool_restore(spool *s, const char *active_name, const spool_place *place, shear_error *err);
/* Is it in active/, or at `place`? In active/: "active/ACTIVE_NAME"; else place->name, or NULL
 * where it is in neither. `buffer` is for the former. */
const char *spool_locate(const spool *s, const char *active_name, const spool_place *place,
                         char buffer[SPOOL_PLACE_SIZE]);
/* Look for an ended file whose place was not kept: for a report that has its key in it, among the
 * first `names` that it may have been given. The place is not known where there is none. */
void spool_find_place(const spool *s, const char *active_name, int names, spool_place *place);

typedef struct spool_stats {
    int64_t waiting; /* in incoming/: those that settle, and those that wait until more may be
                        acquired */
    int64_t ignored; /* in incoming/: neither taken nor meant to be passed over */
    int64_t active;
    int64_t taken, done, failed, removed; /* since spool_open; removed: by retention */
    int64_t scans;                        /* completed */
    bool watching;                        /* else scans alone find files */
    char trouble[256];                    /* what keeps files from being taken now; "": nothing */
    int64_t trouble_since_ms;             /* as of now_ms */
} spool_stats;
spool_stats spool_get_stats(const spool *s);

/* A file that is left lying in incoming/, and why. */
typedef struct spool_ignored {
    const char
        *name; /* any bytes; lives until the next call for this spool, or the next iteration */
    char reason[96];
} spool_ignored;
/* The first `capacity` of them; how many. */
size_t spool_get_ignored(const spool *s, spool_ignored *list, size_t capacity);

#endif
