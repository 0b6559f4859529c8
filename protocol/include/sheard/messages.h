/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sheard/messages.h: the messages between the daemon and its clients, as plain structs.
 * docs/protocol.md defines every member; sheard/rpc.h converts them to lines and back.
 *
 * Ownership: a struct filled by a parse function owns its texts and lists until the message that it
 * is part of is deinited. A struct to be written may point at anything; deinit only what was
 * parsed.
 *
 * Absent members (null in JSON) are NULL for texts, NaN for numbers, 0 for times, or as a comment
 * says. Times are milliseconds since 1970, UTC; in JSON "2026-01-31T12:00:00.000Z". */
#ifndef SHEARD_MESSAGES_H
#define SHEARD_MESSAGES_H

#include "shear/error.h"
#include "shear/input.h"
#include "shear/settings.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { SHEARD_PROTOCOL_VERSION = 1, SHEARD_PROTOCOL_OLDEST = 1 };

/* Limits of a request: longest texts in bytes, longest lists in elements, and ranges. */
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
    SHEARD_MSG_OPTION_MAX = 4095, /* an option of an exposure: a row expression, ... */
    SHEARD_MSG_WAIT_MAX = 86400,  /* seconds */
    SHEARD_MSG_JOB_FILE_MAX = 65536,
    SHEARD_MSG_SETTINGS_SIZE = 2048 /* canonical settings, with the NUL */
};

/* The store uses the values of these enums, too. X_UNKNOWN stands for a name of a newer service
 * that this version does not have. */
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
/* What a running job is doing. */
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

/* Return the name in JSON: "" for the value that is null there, "unknown" for any other number.
 * Never NULL. */
const char *sheard_job_state_name(int state);
const char *sheard_job_class_name(int job_class);
const char *sheard_job_outcome_name(int outcome);
const char *sheard_job_phase_name(int phase);
const char *sheard_job_origin_name(int origin);
const char *sheard_attempt_outcome_name(int outcome);
const char *sheard_server_state_name(int state);
/* Return whether the state is done, failed, cancelled or retracted. */
bool sheard_job_state_is_final(int state);

/* ---- The files of a job ---- */

typedef struct sheard_msg_image {
    const char *path;    /* NULL: no such part */
    int64_t hdu;         /* from 0; -1: given by name, or the default */
    const char *extname; /* NULL: given by number, or the default */
} sheard_msg_image;

/* An exposure: its files, and the options of shear_exposure_set(), NULL or -1 if not given. */
typedef struct sheard_msg_exposure {
    sheard_msg_image image, sources, psf; /* all three are there, or none */
    sheard_msg_image weight, mask, segmentation, wcs, noise_image;
    const char *weight_kind, *mask_bad, *columns, *select, *carry, *psf_kind, *noise, *amplifiers;
    const char *frame;
    int64_t origin, stamp, noise_stamps;
} sheard_msg_exposure;

/* The files of a job: one field file; or the three images, with or without a catalog; or an
 * exposure. */
typedef struct sheard_msg_source {
    const char *path;
    sheard_msg_image galaxy, noise, psf, catalog;
    int64_t stamp_nx, stamp_ny, stamps; /* shear_mosaic; 0: by the keywords */
    sheard_msg_exposure exposure;       /* absent if its image has no path */
} sheard_msg_source;

/* Set parts[] to the source's files, by enum shear_part. */
void sheard_source_parts(sheard_msg_source *source, sheard_msg_image *parts[SHEAR_N_PARTS]);
/* Write the path in JSON of a member of part `part`: "galaxy.hdu", "exposure.sources.path". Return
 * buf. */
char *sheard_source_parameter(const sheard_msg_source *source, int part, const char *member,
                              char *buf, size_t size);
/* Convert to the library's struct. The strings stay the source's. */
shear_input sheard_source_input(const sheard_msg_source *source);
/* Set the source to this input. The strings stay the input's. */
void sheard_source_set(sheard_msg_source *source, const shear_input *input);

/* ---- Requests ---- */

/* The parameters of methods without any. */
typedef struct sheard_msg_nothing {
    char unused;
} sheard_msg_nothing;

typedef struct sheard_msg_hello {
    int64_t oldest, newest; /* protocol versions that the client supports; both 1 if absent */
    const char *client;     /* "shearctl 0.1.0"; may be NULL */
} sheard_msg_hello;

typedef struct sheard_msg_submit {
    sheard_msg_source source;
    const char *settings; /* those that are given, canonical (see below); NULL: none */
    const char *field;    /* NULL: the file's own */
    int64_t priority;     /* -100..100 */
    const char *key;      /* idempotency key; NULL: none */
    bool force, wait;
} sheard_msg_submit;

typedef struct sheard_msg_id {
    int64_t id;
} sheard_msg_id;

typedef struct sheard_msg_jobs {
    unsigned states;    /* set of 1u << SHEARD_JOB_FAILED etc.; 0: all */
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
    const char *digest; /* digest of the settings; NULL: all */
    int64_t after;      /* the contribution before the first one listed; 0: none */
    int64_t limit;      /* most contributions listed per row; 0: none */
} sheard_msg_field;

typedef struct sheard_msg_forget {
    const char *field;
    const char *digest; /* digest of the settings; NULL: all */
} sheard_msg_forget;

typedef struct sheard_msg_fields {
    const char *prefix; /* NULL: all */
    const char *cursor;
    int64_t limit;
} sheard_msg_fields;

/* The subscriptions to add (subscribe) or to remove (unsubscribe). For unsubscribe, nothing named
 * means everything. */
typedef struct sheard_msg_subscribe {
    const int64_t *jobs; /* [n_jobs] */
    size_t n_jobs;
    const char *const *fields; /* [n_fields] */
    size_t n_fields;
    bool all;      /* every job and every field */
    bool progress; /* also job_progress; only for subscribe */
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
    int64_t protocol; /* the version that both use from now on */
    int64_t oldest, newest;
    const char *server; /* "sheard 0.1.0" */
    int64_t uid;        /* of the client, as the kernel reports it */
    bool admin;
    const char *const *methods; /* [n_methods] */
    size_t n_methods;
    sheard_msg_limits limits;
} sheard_msg_welcome;

typedef struct sheard_msg_progress {
    int64_t done, total; /* stamps; total is -1 while unknown */
    double rate;         /* stamps per second */
    double eta_s;
    enum sheard_job_phase phase;     /* of a running job */
    int64_t bytes_done, bytes_total; /* bytes of its files while they are hashed, else -1 */
} sheard_msg_progress;

typedef struct sheard_msg_job {
    int64_t id;
    enum sheard_job_state state;
    enum sheard_job_class job_class; /* JSON key "class": of the last failure */
    const char *code;                /* code of the last failure, with its message and advice */
    const char *message, *advice;
    const char *field;
    sheard_msg_source source;
    int64_t owner;    /* uid */
    const char *user; /* the owner's name */
    enum sheard_job_origin origin;
    int64_t priority;
    bool force;
    const char *key;
    bool cancel_asked;
    int64_t created_ms, started_ms, finished_ms;
    int64_t not_before_ms; /* of a waiting job: time of the next attempt */
    int64_t attempts;
    sheard_msg_progress progress;
    enum sheard_job_outcome outcome;
    int64_t duplicate_of; /* 0: none */
    const char *settings; /* canonical */
    const char *digest;   /* of the settings */
    const char *checksum; /* of the content */
    const char *result;   /* a JSON object of sheard_report_json */
    const char *catalog;
    const char *dropped_name; /* file name of a dropped file or job file; NULL: not dropped */
    const char *file_now;     /* current path of that file; NULL: gone, or none */
} sheard_msg_job;

typedef struct sheard_msg_attempt {
    int64_t number; /* from 1 */
    int64_t started_ms, ended_ms;
    enum sheard_attempt_outcome outcome; /* JSON key "ending" */
    enum sheard_job_class job_class;
    const char *code, *message;
} sheard_msg_attempt;

typedef struct sheard_msg_shown { /* reply to `job` */
    sheard_msg_job job;
    const sheard_msg_attempt *history; /* [n_history] oldest first */
    size_t n_history;
} sheard_msg_shown;

typedef struct sheard_msg_submitted {
    sheard_msg_job job;
    bool known; /* the idempotency key exists: this is its job */
} sheard_msg_submitted;

typedef struct sheard_msg_job_page {
    const sheard_msg_job *jobs; /* [n_jobs] newest first, without results */
    size_t n_jobs;
    const char *cursor; /* for the next page; NULL: this is the last */
} sheard_msg_job_page;

typedef struct sheard_msg_waited {
    const sheard_msg_job *jobs; /* [n_jobs] in the order of the request */
    size_t n_jobs;
    bool timed_out;
} sheard_msg_waited;

typedef struct sheard_msg_contribution {
    int64_t id, job;
    const char *checksum;
    int64_t n_stamps, n_used;
    int64_t counted_ms;
} sheard_msg_contribution;

/* The contribution that prevents a field's result. */
typedef struct sheard_msg_culprit {
    int64_t job, contribution;
    const char *file, *checksum; /* file: NULL if the job has been deleted */
} sheard_msg_culprit;

/* A field measured with one set of settings: the keys of `report`, and these. */
typedef struct sheard_msg_field_row {
    const char *report; /* a JSON object of sheard_report_json */
    const char *digest;
    int64_t jobs;           /* counted jobs */
    int64_t unfinished;     /* unfinished jobs of this field */
    bool partial;           /* more jobs will be counted */
    const int64_t *running; /* [n_running] running jobs; at most SHEARD_MSG_LIST_MAX */
    size_t n_running;
    int64_t files_left_out; /* counted files missing in the report's list */
    int64_t updated_ms;
    const sheard_msg_contribution *contributions; /* [n_contributions] */
    size_t n_contributions;
    bool more;                  /* there are further contributions */
    const char *reason;         /* reason why it has no result; NULL if it has one */
    sheard_msg_culprit culprit; /* job 0: none in particular */
} sheard_msg_field_row;

typedef struct sheard_msg_field_result {
    const char *field;
    bool mixed;                       /* the rows have different settings */
    const sheard_msg_field_row *rows; /* [n_rows] */
    size_t n_rows;
} sheard_msg_field_result;

/* An entry in the list of fields. */
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
    int64_t rows, contributions, jobs; /* jobs: retracted by this call */
} sheard_msg_forgotten;

typedef struct sheard_msg_field_page {
    const sheard_msg_summary *fields; /* [n_fields] by name, then digest */
    size_t n_fields;
    const char *cursor;
} sheard_msg_field_page;

typedef struct sheard_msg_subscribed {
    int64_t jobs, fields; /* watched now */
    bool all;
} sheard_msg_subscribed;

typedef struct sheard_msg_states {
    int64_t queued, running, waiting, done, failed, cancelled, retracted;
} sheard_msg_states;

typedef struct sheard_msg_totals { /* since the service's state was created */
    int64_t submitted, counted, duplicates, failed, cancelled;
    int64_t stamps, fields;
    int64_t retracted; /* of the counted contributions */
} sheard_msg_totals;

typedef struct sheard_msg_rates { /* over the last minute */
    double stamps_per_s, jobs_per_s;
} sheard_msg_rates;

typedef struct sheard_msg_loop {
    double longest_ms, longest_minute_ms; /* turn, in processor time: since the start, lately */
    int64_t unsent_bytes, dropped;        /* memory of unsent replies; clients that did not read */
} sheard_msg_loop;

typedef struct sheard_msg_workers {
    int64_t total, busy, readers; /* readers: child processes */
} sheard_msg_workers;

typedef struct sheard_msg_queue {
    int64_t length, capacity; /* unfinished jobs */
    int64_t blocks;           /* unmeasured blocks of the running jobs */
} sheard_msg_queue;

typedef struct sheard_msg_plans {
    int64_t kept, bytes;  /* in memory now, including plans in use */
    int64_t hits, misses; /* jobs since the start that found a plan, and that did not */
} sheard_msg_plans;

typedef struct sheard_msg_memory {
    int64_t budget, used; /* bytes, of jobs and plans */
    int64_t waiting;      /* running jobs that wait for memory */
} sheard_msg_memory;

typedef struct sheard_msg_ignored {
    const char *name, *reason;
} sheard_msg_ignored;

typedef struct sheard_msg_spool {
    const char *path; /* NULL: no watch folder */
    bool watching;
    int64_t incoming, active, done, failed; /* files */
    int64_t free_bytes;
    int64_t ignored;                      /* files of incoming/ that are not taken */
    const sheard_msg_ignored *left_lying; /* [n_left_lying] the first of them */
    size_t n_left_lying;
} sheard_msg_spool;

typedef struct sheard_msg_log {
    int64_t lost;          /* lines lost since the start */
    int64_t waiting_bytes; /* not read yet */
} sheard_msg_log;

/* A directory that the service writes to. */
typedef struct sheard_msg_disk {
    const char *use; /* "state", "spool", "catalogues", "scratch" */
    const char *path;
    int64_t free_bytes, bytes;
    const char *same_as; /* `use` of an earlier entry on the same disk; or NULL */
    const char *problem; /* why it cannot be written to; or NULL */
} sheard_msg_disk;

/* A problem that an operator should look at. */
typedef struct sheard_msg_problem {
    const char *about;       /* "jobs", "store", "spool", "incoming", "disk", "log", "root" */
    const char *code;        /* never changes */
    const char *message;     /* as in sheard_msg_status.problems */
    int64_t since_ms;        /* 0: unknown */
    int64_t count;           /* jobs, files, lines, failures */
    int64_t attempts;        /* most attempts of a waiting job; 0: no job */
    int64_t next_attempt_ms; /* 0: none, or unknown */
} sheard_msg_problem;

typedef struct sheard_msg_store {
    const char *path;
    int64_t schema, bytes, free_bytes;
    int64_t commits; /* since the start */
} sheard_msg_store;

typedef struct sheard_msg_root { /* a data root, as the service finds it */
    const char *path;
    bool missing;
    const char *reason; /* why it is missing; NULL: it is not */
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
    const char *catalogs;         /* directory; NULL: none are written */
    const char *user;             /* user that the service runs as */
    bool activated;               /* systemd owns the socket, and starts the service for a client */
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
    bool ok;                             /* a tiny field was measured, with the right shear */
    const char *code, *message, *advice; /* if not ok */
    double g1, g1_err, g2, g2_err;       /* NaN: not measured */
    double true_g1, true_g2;
    int64_t stamps;
    double seconds;
    bool landlock;   /* Landlock denied its reader all files */
    bool namespaces; /* ... and namespaces hid other processes from it */
} sheard_msg_probed;

typedef struct sheard_msg_reloaded {
    const char *const *changed; /* [n_changed] settings in force now */
    size_t n_changed;
    const char *const *restart; /* [n_restart] settings that need a restart */
    size_t n_restart;
    const char *const *warnings; /* [n_warnings] what will not work as configured now */
    size_t n_warnings;
} sheard_msg_reloaded;

typedef struct sheard_msg_stopping { /* reply to drain and shutdown, and server_state */
    enum sheard_server_state state;
    int64_t running, queued; /* jobs that will still be finished; jobs that stay queued */
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

/* ---- The report file beside an input in done/ and failed/ ---- */

typedef struct sheard_msg_side {
    const char *file;            /* the input's name when it was dropped */
    enum sheard_job_state state; /* a final state */
    const char *code;            /* why it failed; NULL if done */
    const char *message, *advice;
    int64_t written_ms;
    const char *version; /* of the service */
    sheard_msg_job job;  /* id 0: it did not become a job */
} sheard_msg_side;

/* ---- Settings as text ---- */

/* Canonical settings are a line "NAME=VALUE\n" for each setting, in the order of
 * shear_settings_table, with names and values as in the table and shear_settings_format. So equal
 * settings have equal text. A part of the settings (those that a submit gives) is written in the
 * same way.
 *
 * Write all of *s into buf. SHEAR_E_SETTING if `size` is too small; SHEARD_MSG_SETTINGS_SIZE is
 * enough. */
int sheard_settings_write(const shear_settings *s, char *buf, size_t size, shear_error *err);
/* Set in *s what `text` gives (lines NAME=VALUE in any order; NULL: nothing), then check the whole.
 * Return SHEAR_OK or SHEAR_E_SETTING. */
int sheard_settings_apply(shear_settings *s, const char *text, shear_error *err);
/* Read all of *s from a text of sheard_settings_write, also of an earlier version. Settings of 0.1
 * (without a preset) have the paper's values if absent, and their `auto` keeps its meaning of then.
 * Return SHEAR_OK or SHEAR_E_SETTING. */
int sheard_settings_read(shear_settings *s, const char *text, shear_error *err);
/* Compute the digest of all of *s: `hash` of its canonical text. */
typedef void sheard_digest(const void *bytes, size_t n, char *hex, size_t size);
int sheard_settings_digest(const shear_settings *s, sheard_digest *hash, char *hex, size_t size,
                           shear_error *err);

/* ---- Times ---- */

enum { SHEARD_TIME_SIZE = 32 };
/* Format as RFC 3339 in UTC with milliseconds. Return buf. */
char *sheard_time_format(int64_t ms, char buf[SHEARD_TIME_SIZE]);
/* Parse any RFC 3339 time, with any offset; fractions of a second are cut to milliseconds. Return
 * false if the text is not a time. */
bool sheard_time_parse(int64_t *ms, const char *text);

#endif
