/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sheard/messages.h: what the daemon and its clients say to each other, as plain structs.
 * docs/protocol.md is the meaning of every member; sheard/rpc.h makes lines of them and back.
 *
 * Ownership: a struct filled by a parse function owns its texts and lists until the deinit of what
 * it is part of. A struct that is to be written may point at anything: only deinit what was parsed.
 * Absent (null in JSON): texts NULL, numbers NaN, times 0, and what a comment says.
 * Times are milliseconds since 1970, UTC; in JSON "2026-01-31T12:00:00.000Z".
 */
#ifndef SHEARD_MESSAGES_H
#define SHEARD_MESSAGES_H

#include "shear/error.h"
#include "shear/input.h"
#include "shear/settings.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { SHEARD_PROTOCOL_VERSION = 1, SHEARD_PROTOCOL_OLDEST = 1 };

/* Longest texts (bytes) and lists (elements) of a request. */
enum {
    SHEARD_MSG_PATH_MAX = 4095,
    SHEARD_MSG_FIELD_MAX = 71,
    SHEARD_MSG_KEY_MAX = 128,
    SHEARD_MSG_DIGEST_MAX = 128,
    SHEARD_MSG_CURSOR_MAX = 512,
    SHEARD_MSG_NAME_MAX = 64,
    SHEARD_MSG_LIST_MAX = 256,
    SHEARD_MSG_JOBS_PAGE = 200,    /* most jobs in a page */
    SHEARD_MSG_FIELDS_PAGE = 1000, /* most fields, and contributions, in a page */
    SHEARD_MSG_PRIORITY_MAX = 100,
    SHEARD_MSG_HDU_MAX = 9999,
    SHEARD_MSG_EXTNAME_MAX = 68,
    SHEARD_MSG_WAIT_MAX = 86400, /* seconds */
    SHEARD_MSG_JOB_FILE_MAX = 65536,
    SHEARD_MSG_SETTINGS_SIZE = 2048 /* canonical settings, with the NUL */
};

/* The numbers of these enums are also those of the store. X_UNKNOWN is a name that this version
 * does not know, said by a newer service. */
enum sheard_job_state {
    SHEARD_JOB_UNKNOWN = -1,
    SHEARD_JOB_QUEUED = 0,
    SHEARD_JOB_RUNNING = 1,
    SHEARD_JOB_WAITING = 2,
    SHEARD_JOB_DONE = 3,
    SHEARD_JOB_FAILED = 4,
    SHEARD_JOB_CANCELLED = 5,
    SHEARD_JOB_RETRACTED = 6,
    SHEARD_N_JOB_STATES = 7
};
enum sheard_job_class {
    SHEARD_CLASS_UNKNOWN = -1,
    SHEARD_CLASS_NONE = 0,
    SHEARD_CLASS_TRANSIENT = 1,
    SHEARD_CLASS_DATA = 2,
    SHEARD_CLASS_BUG = 3
};
/* What a running job is at. */
enum sheard_job_phase {
    SHEARD_PHASE_UNKNOWN = -1,
    SHEARD_PHASE_NONE,
    SHEARD_PHASE_OPENING,
    SHEARD_PHASE_HASHING,
    SHEARD_PHASE_WAITING_MEMORY,
    SHEARD_PHASE_PREPARING,
    SHEARD_PHASE_MEASURING,
    SHEARD_PHASE_FINISHING
};

enum sheard_job_outcome {
    SHEARD_OUTCOME_UNKNOWN = -1,
    SHEARD_OUTCOME_NONE = 0,
    SHEARD_OUTCOME_COUNTED = 1,
    SHEARD_OUTCOME_DUPLICATE = 2
};
enum sheard_job_origin {
    SHEARD_ORIGIN_UNKNOWN = -1,
    SHEARD_ORIGIN_SPOOL = 0,
    SHEARD_ORIGIN_SOCKET = 1
};
enum sheard_attempt_outcome {
    SHEARD_ATTEMPT_UNKNOWN = -1,
    SHEARD_ATTEMPT_OPEN = 0,
    SHEARD_ATTEMPT_DONE = 1,
    SHEARD_ATTEMPT_FAILED = 2,
    SHEARD_ATTEMPT_CANCELLED = 3,
    SHEARD_ATTEMPT_RELEASED = 4,
    SHEARD_ATTEMPT_INTERRUPTED = 5
};
enum sheard_server_state {
    SHEARD_SERVER_UNKNOWN = -1,
    SHEARD_SERVER_RUNNING = 0,
    SHEARD_SERVER_DRAINING,
    SHEARD_SERVER_STOPPING
};
enum sheard_shutdown_mode {
    SHEARD_SHUTDOWN_UNKNOWN = -1,
    SHEARD_SHUTDOWN_DRAIN = 0,
    SHEARD_SHUTDOWN_NOW
};

/* The name in JSON; "" for the one that is null there, "unknown" for any other number. Never NULL.
 */
const char *sheard_job_state_name(int state);
const char *sheard_job_class_name(int job_class);
const char *sheard_job_outcome_name(int outcome);
const char *sheard_job_phase_name(int phase);
const char *sheard_job_origin_name(int origin);
const char *sheard_attempt_outcome_name(int outcome);
const char *sheard_server_state_name(int state);
/* done, failed, cancelled or retracted */
bool sheard_job_state_is_final(int state);

/* ---- What a job reads ---- */

typedef struct sheard_msg_image {
    const char *path;    /* NULL: no such part */
    int64_t hdu;         /* from 0; -1: by its name, or the default */
    const char *extname; /* NULL: by its number, or the default */
} sheard_msg_image;

/* Either a field file, or all three images, with or without a catalog. */
typedef struct sheard_msg_source {
    const char *path;
    sheard_msg_image galaxy, noise, psf, catalog;
} sheard_msg_source;

/* The same as the library has it; the texts stay the source's. */
shear_input sheard_source_input(const sheard_msg_source *source);

/* ---- Requests ---- */

/* Of methods without parameters. */
typedef struct sheard_msg_nothing {
    char unused;
} sheard_msg_nothing;

typedef struct sheard_msg_hello {
    int64_t oldest, newest; /* protocol versions that the client speaks; both 1 where not given */
    const char *client;     /* "shearctl 0.1.0"; may be NULL */
} sheard_msg_hello;

typedef struct sheard_msg_submit {
    sheard_msg_source source;
    const char *settings; /* those that are given, canonical (see below); NULL: none */
    const char *field;    /* NULL: as the file says */
    int64_t priority;     /* -100..100 */
    const char *key;      /* idempotency key; NULL: none */
    bool force, wait;
} sheard_msg_submit;

typedef struct sheard_msg_id {
    int64_t id;
} sheard_msg_id;

typedef struct sheard_msg_jobs {
    unsigned states;    /* 1u << SHEARD_JOB_FAILED and so on, or'ed; 0: all */
    const char *field;  /* NULL: all */
    int64_t owner;      /* uid; -1: all */
    const char *cursor; /* NULL: from the newest */
    int64_t limit;
} sheard_msg_jobs;

typedef struct sheard_msg_wait {
    const int64_t *ids; /* [n_ids], at least 1 */
    size_t n_ids;
    double timeout_s; /* NaN: none */
} sheard_msg_wait;

typedef struct sheard_msg_field {
    const char *field;
    const char *digest; /* of the settings; NULL: all */
    int64_t after;      /* contribution to go on after; 0: from the first */
    int64_t limit;      /* contributions listed for each row; 0: none */
} sheard_msg_field;

typedef struct sheard_msg_forget {
    const char *field;
    const char *digest; /* of the settings; NULL: all */
} sheard_msg_forget;

typedef struct sheard_msg_fields {
    const char *prefix; /* NULL: all */
    const char *cursor;
    int64_t limit;
} sheard_msg_fields;

/* Of subscribe: what to add. Of unsubscribe: what to take away; nothing named means everything. */
typedef struct sheard_msg_subscribe {
    const int64_t *jobs; /* [n_jobs] */
    size_t n_jobs;
    const char *const *fields; /* [n_fields] */
    size_t n_fields;
    bool all;      /* every job and every field */
    bool progress; /* of subscribe: job_progress, too */
} sheard_msg_subscribe;
typedef sheard_msg_subscribe sheard_msg_unsubscribe;

typedef struct sheard_msg_shutdown {
    enum sheard_shutdown_mode mode;
    double timeout_s; /* NaN: as configured */
} sheard_msg_shutdown;

/* ---- Replies ---- */

typedef struct sheard_msg_limits {
    int64_t line_bytes, depth, values; /* of a request */
    int64_t list, jobs_page, fields_page;
    int64_t connections, in_flight, idle_s; /* in_flight: requests of one connection */
    int64_t queue;                          /* unfinished jobs */
} sheard_msg_limits;

typedef struct sheard_msg_welcome {
    int64_t protocol; /* the version that both speak from now on */
    int64_t oldest, newest;
    const char *server; /* "sheard 0.1.0" */
    int64_t uid;        /* of the peer, as the kernel says */
    bool admin;
    const char *const *methods; /* [n_methods] */
    size_t n_methods;
    sheard_msg_limits limits;
} sheard_msg_welcome;

typedef struct sheard_msg_progress {
    int64_t done, total; /* stamps; total -1: not known yet */
    double rate;         /* stamps per second */
    double eta_s;
    enum sheard_job_phase phase;     /* of a running job */
    int64_t bytes_done, bytes_total; /* of its files, while they are hashed; else -1 */
} sheard_msg_progress;

typedef struct sheard_msg_job {
    int64_t id;
    enum sheard_job_state state;
    enum sheard_job_class job_class; /* "class", of the last failure */
    const char *code;                /* the last failure's, its message and advice */
    const char *message, *advice;
    const char *field;
    sheard_msg_source source;
    int64_t owner;    /* uid */
    const char *user; /* its name */
    enum sheard_job_origin origin;
    int64_t priority;
    bool force;
    const char *key;
    bool cancel_asked;
    int64_t created_ms, started_ms, finished_ms;
    int64_t not_before_ms; /* of a waiting job */
    int64_t attempts;
    sheard_msg_progress progress;
    enum sheard_job_outcome outcome;
    int64_t duplicate_of; /* 0: none */
    const char *settings; /* canonical */
    const char *digest;   /* of the settings */
    const char *checksum; /* of the content */
    const char *result;   /* a JSON object as sheard_report_json writes it */
    const char *catalog;
    const char *dropped_name; /* of a file of the watch folder (also a job file); NULL: none was */
    const char *file_now;     /* where that file is; NULL: nowhere any more, or none was */
} sheard_msg_job;

typedef struct sheard_msg_attempt {
    int64_t number; /* from 1 */
    int64_t started_ms, ended_ms;
    enum sheard_attempt_outcome outcome; /* "ending" */
    enum sheard_job_class job_class;
    const char *code, *message;
} sheard_msg_attempt;

typedef struct sheard_msg_shown { /* of job */
    sheard_msg_job job;
    const sheard_msg_attempt *history; /* [n_history] oldest first */
    size_t n_history;
} sheard_msg_shown;

typedef struct sheard_msg_submitted {
    sheard_msg_job job;
    bool known; /* the idempotency key had been seen: this is that job */
} sheard_msg_submitted;

typedef struct sheard_msg_job_page {
    const sheard_msg_job *jobs; /* [n_jobs] newest first, without results */
    size_t n_jobs;
    const char *cursor; /* of the next page; NULL: this is the last */
} sheard_msg_job_page;

typedef struct sheard_msg_waited {
    const sheard_msg_job *jobs; /* [n_jobs] in the order asked for */
    size_t n_jobs;
    bool timed_out;
} sheard_msg_waited;

typedef struct sheard_msg_contribution {
    int64_t id, job;
    const char *checksum;
    int64_t n_stamps, n_used;
    int64_t counted_ms;
} sheard_msg_contribution;

/* Whose contribution keeps a field from being measured. */
typedef struct sheard_msg_culprit {
    int64_t job, contribution;
    const char *file, *checksum; /* file: NULL if the job is forgotten */
} sheard_msg_culprit;

/* A field as measured with one set of settings: all keys of `report`, and these. */
typedef struct sheard_msg_field_row {
    const char *report; /* a JSON object as sheard_report_json writes it */
    const char *digest;
    int64_t jobs;           /* counted */
    int64_t unfinished;     /* known to belong here */
    bool partial;           /* more is to come */
    const int64_t *running; /* [n_running] jobs; not more than SHEARD_MSG_LIST_MAX */
    size_t n_running;
    int64_t files_left_out; /* counted, but not in the report's list of files */
    int64_t updated_ms;
    const sheard_msg_contribution *contributions; /* [n_contributions] */
    size_t n_contributions;
    bool more;                  /* contributions follow */
    const char *reason;         /* why it has no result; NULL if it has one */
    sheard_msg_culprit culprit; /* job 0: none in particular */
} sheard_msg_field_row;

typedef struct sheard_msg_field_result {
    const char *field;
    bool mixed;                       /* there are rows of different settings */
    const sheard_msg_field_row *rows; /* [n_rows] */
    size_t n_rows;
} sheard_msg_field_result;

/* A line of the list of fields. */
typedef struct sheard_msg_summary {
    const char *field, *digest;
    double g1, g1_err, g2, g2_err;
    int64_t n_stamps, n_used;
    int64_t jobs, unfinished;
    bool partial, mixed;
    int64_t updated_ms;
    const char *reason; /* as in sheard_msg_field_row */
} sheard_msg_summary;

typedef struct sheard_msg_forgotten {
    const char *field;
    int64_t rows, contributions, jobs; /* jobs: retracted now; others were forgotten before */
} sheard_msg_forgotten;

typedef struct sheard_msg_field_page {
    const sheard_msg_summary *fields; /* [n_fields] by name, then digest */
    size_t n_fields;
    const char *cursor;
} sheard_msg_field_page;

typedef struct sheard_msg_subscribed {
    int64_t jobs, fields; /* that are watched now */
    bool all;
} sheard_msg_subscribed;

typedef struct sheard_msg_states {
    int64_t queued, running, waiting, done, failed, cancelled, retracted;
} sheard_msg_states;

typedef struct sheard_msg_totals { /* since the state was made */
    int64_t submitted, counted, duplicates, failed, cancelled;
    int64_t stamps, fields;
    int64_t retracted; /* contributions, of the counted ones */
} sheard_msg_totals;

typedef struct sheard_msg_rates { /* of the last minute */
    double stamps_per_s, jobs_per_s;
} sheard_msg_rates;

typedef struct sheard_msg_loop {
    double longest_ms, longest_minute_ms; /* turn, in processor time: since the start, lately */
    int64_t unsent_bytes, dropped;        /* memory of what is not read; clients that did not */
} sheard_msg_loop;

typedef struct sheard_msg_workers {
    int64_t total, busy, readers; /* readers: child processes */
} sheard_msg_workers;

typedef struct sheard_msg_queue {
    int64_t length, capacity; /* unfinished jobs */
    int64_t blocks;           /* of the running jobs: not yet measured */
} sheard_msg_queue;

typedef struct sheard_msg_plans {
    int64_t kept, bytes;  /* in memory now, with those in use */
    int64_t hits, misses; /* jobs since the start that found theirs, and that did not */
} sheard_msg_plans;

typedef struct sheard_msg_memory {
    int64_t budget, used; /* bytes, of jobs and plans */
    int64_t waiting;      /* running jobs that wait for some */
} sheard_msg_memory;

typedef struct sheard_msg_ignored {
    const char *name, *reason;
} sheard_msg_ignored;

typedef struct sheard_msg_spool {
    const char *path; /* NULL: no watch folder */
    bool watching;
    int64_t incoming, active, done, failed; /* files */
    int64_t free_bytes;
    int64_t ignored;                      /* files that are left lying in incoming/ */
    const sheard_msg_ignored *left_lying; /* [n_left_lying] the first of them */
    size_t n_left_lying;
} sheard_msg_spool;

typedef struct sheard_msg_log {
    int64_t lost;          /* lines since the start */
    int64_t waiting_bytes; /* not yet read by whoever reads the log */
} sheard_msg_log;

/* A directory that the service writes to. */
typedef struct sheard_msg_disk {
    const char *use; /* "state", "spool", "catalogues", "scratch" */
    const char *path;
    int64_t free_bytes, bytes;
    const char *same_as; /* the use of one before that is on the same disk; or NULL */
    const char *problem; /* why it cannot be written to; or NULL */
} sheard_msg_disk;

/* What an operator should look at. */
typedef struct sheard_msg_problem {
    const char *about;       /* "jobs", "store", "spool", "incoming", "disk", "log", "root" */
    const char *code;        /* stable */
    const char *message;     /* as in the list of lines */
    int64_t since_ms;        /* 0: not known */
    int64_t count;           /* jobs, files, lines, failures */
    int64_t attempts;        /* of the waiting job with the most; 0: of no job */
    int64_t next_attempt_ms; /* 0: none, or not known */
} sheard_msg_problem;

typedef struct sheard_msg_store {
    const char *path;
    int64_t schema, bytes, free_bytes;
    int64_t commits; /* since the start */
} sheard_msg_store;

typedef struct sheard_msg_root { /* a data root, as the service sees it */
    const char *path;
    bool missing;
    const char *reason; /* why it is missing; NULL: it is there */
} sheard_msg_root;

typedef struct sheard_msg_status {
    const char *version;
    int64_t protocol, pid;
    enum sheard_server_state state;
    int64_t started_ms;
    double uptime_s;
    int64_t connections, subscribers;
    sheard_msg_workers workers;
    sheard_msg_queue queue;
    sheard_msg_plans plans;
    sheard_msg_memory memory;
    sheard_msg_states states;
    sheard_msg_totals totals;
    sheard_msg_rates rates;
    sheard_msg_loop loop;
    sheard_msg_spool spool;
    sheard_msg_store store;
    const char *config, *state_dir;
    const char *catalogs; /* directory; NULL: none are written */
    const char *user;     /* that the service runs as */
    bool activated;       /* the socket is systemd's, and starts the service when a client comes */
    const sheard_msg_root *roots; /* [n_roots] */
    size_t n_roots;
    sheard_msg_limits limits;
    const char *const *problems; /* [n_problems] what an operator should look at */
    size_t n_problems;
    const sheard_msg_problem *problem_details; /* [n_problem_details] the same, for programs */
    size_t n_problem_details;
    const sheard_msg_disk *disks; /* [n_disks] */
    size_t n_disks;
    sheard_msg_log log;
} sheard_msg_status;

typedef struct sheard_msg_metrics {
    const char *content_type, *text;
} sheard_msg_metrics;

typedef struct sheard_msg_probed {
    bool ok;                             /* a tiny field was measured, and its shear is right */
    const char *code, *message, *advice; /* why not */
    double g1, g1_err, g2, g2_err;       /* NaN: not measured */
    double true_g1, true_g2;
    int64_t stamps;
    double seconds;
    bool landlock;   /* the file system was closed to its reader */
    bool namespaces; /* ... which saw no other process */
} sheard_msg_probed;

typedef struct sheard_msg_reloaded {
    const char *const *changed; /* [n_changed] settings that are in force now */
    size_t n_changed;
    const char *const *restart; /* [n_restart] settings that need a restart */
    size_t n_restart;
    const char *const *warnings; /* [n_warnings] what will not work as it is now */
    size_t n_warnings;
} sheard_msg_reloaded;

typedef struct sheard_msg_stopping { /* of drain and shutdown; and of the notification server_state
                                      */
    enum sheard_server_state state;
    int64_t running, queued; /* jobs that are still to be finished; that wait for later */
} sheard_msg_stopping;

/* ---- Notifications ---- */

typedef struct sheard_msg_job_changed {
    sheard_msg_job job;
} sheard_msg_job_changed;

typedef struct sheard_msg_job_progress {
    int64_t id;
    sheard_msg_progress progress;
} sheard_msg_job_progress;

typedef struct sheard_msg_field_changed {
    sheard_msg_summary field;
} sheard_msg_field_changed;

typedef struct sheard_msg_lost {
    int64_t count; /* notifications left out because the client did not read */
} sheard_msg_lost;

/* ---- The file beside an input in done/ and failed/ ---- */

typedef struct sheard_msg_side {
    const char *file;            /* the input's name when it was dropped */
    enum sheard_job_state state; /* a final one */
    const char *code;            /* why it failed; NULL for done */
    const char *message, *advice;
    int64_t written_ms;
    const char *version; /* of the service */
    sheard_msg_job job;  /* id 0: it never became a job */
} sheard_msg_side;

/* ---- Settings as text ---- */

/* Canonical settings: "NAME=VALUE\n" for each, in the order of the table (shear_settings_table),
 * names and values as the table and shear_settings_format write them: equal settings have equal
 * text. A part of the settings (those that a submit gives) is written in the same way.
 *
 * The whole of *s in buf. SHEAR_E_SETTING where `size` is too small (SHEARD_MSG_SETTINGS_SIZE is
 * not). */
int sheard_settings_write(const shear_settings *s, char *buf, size_t size, shear_error *err);
/* Set in *s what `text` gives (lines NAME=VALUE, in any order; NULL: nothing), then check the
 * whole. SHEAR_E_SETTING. */
int sheard_settings_apply(shear_settings *s, const char *text, shear_error *err);
/* The whole of *s from what sheard_settings_write wrote, also in an earlier version: settings of
 * 0.1 (without a preset) are the paper's where they say nothing, and their `auto` means what it
 * did. SHEAR_E_SETTING. */
int sheard_settings_read(shear_settings *s, const char *text, shear_error *err);
/* The digest of the whole of *s: `hash` of its canonical text. */
typedef void sheard_digest(const void *bytes, size_t n, char *hex, size_t size);
int sheard_settings_digest(const shear_settings *s, sheard_digest *hash, char *hex, size_t size,
                           shear_error *err);

/* ---- Times ---- */

enum { SHEARD_TIME_SIZE = 32 };
/* RFC 3339, UTC, milliseconds. Returns buf. */
char *sheard_time_format(int64_t ms, char buf[SHEARD_TIME_SIZE]);
/* Reads any RFC 3339 time (an offset, other fractions of a second: cut to milliseconds); false if
 * the text is no time. */
bool sheard_time_parse(int64_t *ms, const char *text);

#endif
