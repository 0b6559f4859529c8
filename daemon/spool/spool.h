/* SPDX-License-Identifier: GPL-3.0-or-later */
/* spool/spool.h: the watch folder. It uses the loop and files, but no jobs, SQL or JSON.
 *
 *     <directory>/incoming/NAME            dropped by users
 *     <directory>/active/KEY-NAME          acquired, and reported by `found`; KEY is never reused
 *     <directory>/done/NAME, NAME.json     disposed of, with the report; or failed/NAME, NAME.json
 *
 * A file is in exactly one of these places at any moment, even after a crash. A name is never
 * overwritten (the second a.fits becomes a.1.fits, its report a.1.fits.json).
 *
 * Regular files *.fits, *.fit, *.fits.gz, *.fit.gz, *.fz and *.json, in upper and lower case, are
 * acquired. Dotfiles, *.tmp and *.part are ignored silently. Files with other names, and what is
 * not a regular file, stay in incoming/ and are reported once each (spool_get_ignored lists them).
 *
 * A file is acquired as soon as its writer has closed it or renamed it into place. It must not
 * change for settle_ms if only a scan found it (it was there at the start, events were lost, or
 * another machine wrote it), if it is empty, or if it is a second link to a file; and for twelve
 * times as long (at least two seconds) if it was created here and has not been closed.
 *
 * Crashes: a file that was acquired but not disposed of is reported again after the next
 * spool_open, with the same key. So the owner submits with the key as idempotency key, and commits
 * a job's outcome before it calls spool_dispose; then each file counts once.
 *
 * Threads: only the loop's. Callbacks are called from the loop, `log` also from within calls.
 * `found` may call all functions of this header, the other callbacks none. The calls may wait for
 * the disk. */
#pragma once

#include "shear/error.h"
#include "sheard/config.h"

#include <stdbool.h>
#include <stdint.h>
#include <sys/types.h>
#include <uv.h>

enum spool_code {
    SPOOL_LOCKED = 100, /* another process owns this spool */
    SPOOL_GONE,         /* the file vanished from active/ */
    SPOOL_DENIED,       /* the service may not read the file */
    SPOOL_NOT_REGULAR,  /* a link, directory or device */
    SPOOL_REPLACED      /* another file is in its place, or it was changed there */
};

/* The numbers of enum sheard_log_level. */
enum spool_level { SPOOL_ERROR, SPOOL_WARNING, SPOOL_NOTICE };

/* Sizes in bytes, with the final NUL. */
enum {
    SPOOL_KEY_SIZE = 35,
    SPOOL_NAME_SIZE = 256,
    SPOOL_PLACE_SIZE = 264,
    SPOOL_FINGERPRINT_SIZE = 64
};

typedef struct spool_file {
    const char *active_name; /* identifies the file in the calls below */
    const char *key;  /* first part of active_name: short, unique for ever, the idempotency key */
    const char *name; /* its name in incoming/ */
    uid_t owner;      /* uid of the file's owner */
    bool again;       /* may have been reported before */
} spool_file;

typedef struct spool_callbacks {
    /* Return how many new files may be acquired now; 0: they wait in incoming/. Called before every
     * batch. */
    int64_t (*capacity)(void *context);
    /* A file is in active/, on disk. Its texts live during the call. The owner accepts it (and
     * calls spool_dispose later), or calls spool_refuse to have it reported again. */
    void (*found)(void *context, const spool_file *file);
    void (*log)(void *context, enum spool_level level, const char *text); /* one line */
    void *context;
    /* Return milliseconds since 1970, for the ages of kept files; NULL: use the system's clock. */
    int64_t (*now_ms)(void *context);
} spool_callbacks;

/* The place of a file that was disposed of. */
typedef struct spool_place {
    char name[SPOOL_PLACE_SIZE]; /* "failed/NAME"; "": not known */
    /* Distinguishes it from another file of this name; "": not known. */
    char fingerprint[SPOOL_FINGERPRINT_SIZE];
} spool_place;

/* Settings that may change while the spool is open. */
typedef struct spool_tuning {
    int64_t settle_ms;        /* >= 0 */
    int64_t scan_ms;          /* > 0: interval of scans */
    sheard_keep done, failed; /* the oldest files are removed first, with their reports */
} spool_tuning;

typedef struct spool spool;

/* Own `directory` until spool_close. It and the four folders are made if they are missing: the
 * directory with mode 0750, incoming/ writable for the group and sticky, so that users cannot
 * remove each other's files, the others readable for the group. They must be on one file system.
 * What a crash left incomplete is undone. When the loop runs, files in active/ are reported first,
 * with `again`. *s is NULL on error: SPOOL_LOCKED, SHEAR_E_IO, SHEAR_E_NOMEM. If the system cannot
 * watch incoming/ (no inotify instances left), a warning is logged, and scans alone find files. */
int spool_open(spool **s, uv_loop_t *loop, const char *directory, const spool_tuning *tuning,
               const spool_callbacks *callbacks, shear_error *err);
/* Stop all callbacks and release the lock. Memory is freed by the loop's next iteration, which must
 * follow. NULL is accepted. */
void spool_close(spool *s);

/* Takes effect at once; for done/ and failed/ with the next scan. */
void spool_tune(spool *s, const spool_tuning *tuning);

/* Look for work now, not at the next scan: there is capacity again, or the reason to refuse files
 * is gone. */
void spool_wake(spool *s);
/* Report this file again (`found` with `again`) at the next scan or spool_wake. SHEAR_E_NOMEM: only
 * after the next spool_open. */
int spool_refuse(spool *s, const char *active_name, shear_error *err);

/* Open an acquired file for reading. *fd is -1 on error: an enum spool_code, or SHEAR_E_IO. */
int spool_open_file(const spool *s, const char *active_name, int *fd, shear_error *err);

/* Write the report (a text of the caller's) to done/ (`good`) or failed/, then move the file there.
 * Both are on disk when this returns SHEAR_OK. After an error nothing has happened, or only the
 * last fsync is missing: call it again. If the file is no longer in active/, it has been moved (or
 * taken away) before: SHEAR_OK. *place (NULL: not wanted) is where the file is now, "not known" in
 * that case. SHEAR_E_IO, SHEAR_E_INTERNAL (not an active name). */
int spool_dispose(spool *s, const char *active_name, bool good, const char *report,
                  spool_place *place, shear_error *err);

/* Move the file back from `place` to active/ and remove its report. Both are on disk when this
 * returns SHEAR_OK. The file is reported again only after the next spool_open. If it is in active/
 * already, nothing happens. After an error the file is where it was: SPOOL_GONE, SPOOL_REPLACED,
 * SPOOL_NOT_REGULAR, SHEAR_E_IO, SHEAR_E_INTERNAL (not an active name). */
int spool_restore(spool *s, const char *active_name, const spool_place *place, shear_error *err);
/* Return where the file is: "active/ACTIVE_NAME", written to `buffer`; place->name; or NULL if it
 * is at neither. */
const char *spool_locate(const spool *s, const char *active_name, const spool_place *place,
                         char buffer[SPOOL_PLACE_SIZE]);
/* Find a file whose place was not stored, by a report that contains its key, among the first
 * `names` names that it may have got. *place is "not known" if there is none. */
void spool_find_place(const spool *s, const char *active_name, int names, spool_place *place);

typedef struct spool_stats {
    /* In incoming/: files that settle, and those that wait for capacity. */
    int64_t waiting;
    int64_t ignored; /* in incoming/: files that are not acquired */
    int64_t active;
    int64_t taken, done, failed, removed; /* counts since spool_open; removed: by retention */
    int64_t scans;                        /* completed */
    bool watching;                        /* false: scans alone find files */
    char trouble[256];        /* what keeps files from being acquired now; "": nothing */
    int64_t trouble_since_ms; /* by the callback now_ms */
} spool_stats;
spool_stats spool_get_stats(const spool *s);

/* A file that stays in incoming/, and why. */
typedef struct spool_ignored {
    /* Any bytes; valid until the next call for this spool or the loop's next iteration. */
    const char *name;
    char reason[96];
} spool_ignored;
/* Fill `list` with the first `capacity` of them and return their number. */
size_t spool_get_ignored(const spool *s, spool_ignored *list, size_t capacity);
