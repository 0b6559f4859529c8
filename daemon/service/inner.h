/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/inner.h: what the files of this room share. */
#ifndef SHEARD_SERVICE_INNER_H
#define SHEARD_SERVICE_INNER_H

#include "access/access.h"
#include "engine/engine.h"
#include "log/log.h"
#include "notify/notify.h"
#include "server/server.h"
#include "service/service.h"
#include "shear/version.h"
#include "sheard/messages.h"
#include "sheard/rpc.h"
#include "spool/spool.h"
#include "store/store.h"

#include <sys/queue.h>
#include <uv.h>

/* ---- group.c ---- */

typedef struct changed_field changed_field; /* news.c */
typedef struct solutions solutions;         /* solutions.c */
typedef struct data_roots data_roots;       /* roots.c */
typedef struct probe probe;                 /* probe.c */

/* What is to happen once the group is on disk (code SHEAR_OK) or has failed. Freed after its run.
 */
typedef struct after after;
struct after {
    after *next;
    void (*run)(service *s, after *a, int code, const shear_error *err);
    server_handle to; /* whom to reply to; {0}: nobody */
    int64_t job;
    int method;
    char *name; /* active name of a file of the watch folder; owned */
    void *data; /* run()'s own, which frees it */
    bool flag;
};

/* ---- jobs.c ---- */

/* A job that this process works on. */
typedef struct active_job {
    struct active_job *next;
    int64_t id;
    int origin;
    int64_t failures;   /* so far, for the back-off */
    int64_t started_ms; /* steady_ms */
    char *active_name;  /* of the watch folder, or NULL */
    char *path;         /* for messages */
    char *field;        /* asked for, or learned */
    char *digest;
    shear_settings settings;
    char checksum[SHEAR_CHECKSUM_SIZE];
    shear_field_info info;
    shear_plan_info plan;
    int64_t failed_commits; /* as the service's when the store learned of its content */
    bool ended;             /* the engine's last event of it needs no more attention */
} active_job;

/* ---- waits.c ---- */

typedef struct waiter waiter;
typedef TAILQ_HEAD(waiter_list, waiter) waiter_list;
typedef struct wait_user {
    TAILQ_ENTRY(wait_user) link;
    uid_t uid;
    size_t ids; /* that its waits name */
} wait_user;

/* ---- method_forget.c ---- */

typedef struct forgotten forgotten;

/* ---- users.c ---- */

enum { KNOWN_USERS = 64 };
typedef struct known_user {
    int64_t until_ms; /* loop time; 0: nothing is known */
    uid_t uid;
    char name[64]; /* empty: none */
} known_user;

/* ---- clock.c ---- */

typedef struct service_clock {
    int64_t offset_ms;      /* from steady_ms to wall_ms at the last look */
    int64_t aged_offset_ms; /* the same, for ages: a clock set forward is not believed at once */
    int64_t jumped_ms;      /* steady_ms: it was set last */
    int64_t owed_ms;        /* waiting jobs are still to be moved by this */
} service_clock;

/* ---- problems.c ---- */

enum {
    PROBLEM_NOTES = 16,
    PROBLEM_TEXT = 512,
    PROBLEM_REASONS = 16,
    PROBLEMS_TOLD = 48,
    DISKS = 4
};

/* Something that failed and is tried again. */
typedef struct problem_note {
    char about[16], code[40]; /* "" where the note is free */
    char message[320];        /* the last one */
    int64_t since_ms;         /* wall clock: it failed for the first time */
    int64_t until_ms;         /* steady_ms: it is over if it has not failed again by then */
    int64_t count;
    int64_t burst_from_ms, burst, unlogged; /* of its lines in the log */
} problem_note;

/* What there is to tell now, with the texts. */
typedef struct problem_list {
    sheard_msg_problem items[PROBLEMS_TOLD];
    const char *lines[PROBLEMS_TOLD]; /* the messages of items */
    size_t n;
    char texts[PROBLEMS_TOLD][PROBLEM_TEXT];
    sheard_msg_disk disks[DISKS];
    size_t n_disks;
    store_waiting waiting[PROBLEM_REASONS];
    size_t n_waiting;
} problem_list;

typedef struct disk_seen {
    const char *uses[DISKS];
    dev_t devices[DISKS];
    size_t n;
} disk_seen;

enum { RATE_SLOTS = 61 };

struct service {
    uv_loop_t loop;
    sheard_config config;
    char *config_path;
    sheard_list assignments;

    store *store;
    engine *engine;
    server *server;
    spool *spool; /* NULL: no watch folder */
    access_list *admins, *submitters;
    access_list *hurried; /* who may give priorities above 0 */
    access_roots *roots;
    data_roots *data_roots; /* which of them are there */
    probe *probe;           /* NULL: nobody has asked for one */
    char user[64];          /* that this process runs as */
    bool activated;         /* the socket is systemd's: the next client starts the service again */
    notify notify;

    uv_async_t engine_wake;
    uv_check_t commit_check;
    uv_idle_t commit_now; /* active while a group is open: the loop must not sleep on it */
    uv_signal_t signals[3];
    uv_timer_t tick; /* once a second */
    uv_timer_t drain_end;

    bool group_open;
    int64_t commits, failed_commits;
    int64_t retractions; /* of contributions, since the start */
    bool strays; /* jobs may be running on disk that nobody works on: jobs_fill puts them back */
    after *first_after, **last_after;

    active_job *active;
    int n_active;
    waiter_list waiters; /* asleep */
    TAILQ_HEAD(, wait_user) wait_users;
    size_t wait_ids; /* of all users */
    TAILQ_HEAD(, forgotten) forgotten;
    bool forgetting; /* this group has contributions of forgotten fields that leave */
    changed_field *news;
    uv_timer_t news_soon;
    int64_t news_round;
    solutions *solutions;

    int state; /* enum sheard_server_state */
    int exit_code;
    bool closing;
    bool drain_pending;        /* drained jobs are left, and their end is to be told */
    int64_t started_ms;        /* wall clock */
    int64_t started_steady_ms; /* steady_ms */
    service_clock clock;
    int64_t stamps_at[RATE_SLOTS], jobs_at[RATE_SLOTS]; /* a ring of the last minute */
    int64_t ticks, jobs_ended;
    known_user known_users[KNOWN_USERS];
    uv_prepare_t mark; /* see pace.c */
    int64_t marked_ns, longest_ns, longest_at[RATE_SLOTS];
    int64_t store_trouble_ms; /* loop time of the last failed commit; 0: none lately */
    problem_note notes[PROBLEM_NOTES];
};

int64_t wall_ms(void);   /* to tell and to store; may be set at any time */
int64_t steady_ms(void); /* to measure with; it counts on while the machine sleeps */
/* What waits on disk must not wait longer than this service would have let it: clocks may have been
 * set while it did not run. */
int clock_start(service *s, shear_error *err);
/* Was the clock set? Then waiting jobs move with it. Before jobs are looked for, and once a second.
 */
void clock_look(service *s);
/* The wall clock for what is removed because of its age: never ahead of the present one; one that
 * was set forward is believed after a day. */
int64_t clock_for_ages(const service *s);

/* The group: call before every change of the store. */
int group_begin(service *s, shear_error *err);
/* Queue `run` for after the commit; NULL when memory is out. */
after *group_after(service *s, void (*run)(service *, after *, int, const shear_error *));
void group_start(service *s);

/* jobs.c */
void jobs_fill(service *s);
void jobs_stop_all(service *s);
active_job *jobs_find(service *s, int64_t id);
void jobs_forget(service *s, active_job *j); /* this process has done with it */

/* events.c: take all that the engine tells */
void events_take(service *s);

/* endings.c */
typedef struct ending_reason {
    int class;        /* enum store_class */
    const char *name; /* stable code */
} ending_reason;
/* What an error of the library, the reader or the engine means for a job. */
ending_reason ending_reason_of(const shear_error *error);
/* The attempt failed: to be tried again, or for good. `failures`: of this job before. */
void ending_fail(service *s, int64_t id, int64_t failures, ending_reason reason,
                 const shear_error *error);
/* The job's new state is in this group: tell it when that is on disk. */
void ending_settle(service *s, int64_t id);
/* The job is final: those who waited for it are answered. Its file is where it belongs. */
void ending_tell(service *s, const store_job *job);

/* spooled.c: files of the watch folder. What the store says of a job tells whether it has such a
 * file and what it is called, not whether the spool has told of it since the start. */
int spooled_open(service *s, shear_error *err);
/* The name in active/ of a job's file (also a job file's); false where it has none. */
bool spooled_name(const store_job *job, char name[SPOOL_NAME_SIZE]);
/* Is the file that it measures the watch folder's own? (Else it is a client's, though a job file
 * may have asked for it.) */
bool spooled_is_own(const store_job *job);
/* "DIRECTORY/failed/NAME", malloc'd: where a job's file is now; NULL: nowhere, or it has none. */
char *spooled_where(const service *s, const store_job *job);
/* Where the job is final: its file, if it has one, goes to done/ or failed/, and *job says where it
 * is. */
void spooled_end(service *s, store_job *job);
/* A final job is to run again: its file, if it has one, back into active/. Errors as
 * spool_restore; a job file may be missing, for the job knows all that it said. */
int spooled_take_back(service *s, const store_job *job, shear_error *err);

int make_directory(const char *path, mode_t mode, shear_error *err); /* start.c; may be there */

/* catalogs.c */
char *catalog_path(const service *s, int64_t job); /* malloc'd; NULL where there are none */
/* A job is over: its temporary file, and a catalog that it did not end with, go. */
void catalog_forget(const service *s, const store_job *job);
/* The directory is made, where it is not there, and is this database's from now on. SHEAR_E_EXISTS
 * where it is another's. */
int catalogs_claim(service *s, const char *directory, shear_error *err);
/* At the start: their directory is claimed, and what nobody needs goes. */
int catalogs_open(service *s, shear_error *err);
/* Jobs were retracted, and that is on disk: their catalogs go. */
void catalogs_remove_retracted(service *s);
/* That of a contribution of a forgotten field; of a retired job, as it is called in the directory.
 * True: there is none any more. */
bool catalog_leaves(const service *s, const store_removal *leaving);

/* method_forget.c */
/* Contributions of fields that were forgotten are left, it may be from before the start: some of
 * them leave with this group, and the others after it. Where that fails, it is tried with the next
 * call, once a second. */
void forget_go_on(service *s);
void forget_free(service *s);

/* reasons.c: why a field has no result. The contributions that may be to blame are looked at some
 * at a time, for there may be very many. */
typedef struct field_reason {
    char *text; /* NULL: it has one */
    char *file, *checksum;
    int64_t job, contribution; /* of the worst contribution, where one is to blame; else 0 */
    double worst_d;            /* its sum of w D */
    const char *brief;         /* what is known without them */
    int64_t n_stamps, n_used;
    double sum_d;
    int64_t seen; /* contributions up to this one have been looked at */
    bool done;
} field_reason;
void reason_begin(const store_field *f, const shear_result *result, field_reason *out);
/* Some more; true: that was all, and the texts are made. What cannot be found out is left out. */
bool reason_look(service *s, const store_field *f, field_reason *r);
void reason_deinit(field_reason *r);
/* The same without looking at the contributions. Static text; NULL: it has a result. */
const char *reason_brief(const store_field *f, const shear_result *result);

/* submit.c */
typedef struct submission {
    const sheard_msg_submit *submit;
    access_peer peer; /* groups borrowed */
    int origin;
    const char *key;
    const char *source;  /* path to store, for the watch folder's own files; NULL: a client's */
    const char *dropped; /* name of the file that was dropped; NULL: none was */
} submission;
/* Into the store, within the group. SHEARD_RPC_OK and *id, or an error. */
int submit_job(service *s, const submission *sub, int64_t *id, bool *known,
               sheard_rpc_error *error);
/* From the store's or the library's error to the protocol's. */
int rpc_from_store(sheard_rpc_error *error, int code, const shear_error *err);
int rpc_from_access(sheard_rpc_error *error, int code, const shear_error *err);

/* present.c: records of the store as messages. Texts are borrowed from the record. */
void present_job(service *s, const store_job *job, sheard_msg_job *out);
void present_job_free(sheard_msg_job *out);
/* What a job that runs now is at; false, and nothing is changed, where it does not. */
bool present_running(service *s, int64_t id, sheard_msg_progress *p);
/* Add the rows of a field that have no contribution yet, but running jobs. */
int present_begun(service *s, const char *name, store_field_page *page, shear_error *err);
/* `counted`: the contributions whose files are to be listed. *why is begun, for the row's reason
 * and culprit, which are left out. */
int present_field(service *s, const store_field *f, const store_contribution_page *counted,
                  sheard_msg_field_row *out, field_reason *why, shear_error *err);
void present_field_free(sheard_msg_field_row *out);
void present_summary(service *s, const store_field *f, sheard_msg_summary *out);
void publish_job(service *s, const store_job *job);

/* field_report.c: what `shearctl measure --json` prints of a field's files, those of `counted`
 * listed. *text is malloc'd. */
int field_report(service *s, const store_field *f, const shear_settings *settings,
                 const shear_result *result, const store_contribution_page *counted, char **text,
                 shear_error *err);

/* solutions.c: results of fields whose estimator is a symmetric one */
int solutions_new(solutions **all, shear_error *err);
void solutions_free(solutions *all);
/* Are the results of these fields at hand (of those with this digest; NULL: all)? Where not, the
 * request's work is to pause: it is woken when they are solved, and asks again. They are kept, or
 * solved, for it until solutions_forget. Where memory is out, the request has been answered. */
bool solutions_ready(service *s, server_handle to, const store_field_page *page,
                     const char *digest);
/* The same of one field, for whom it is enough to ask again later. */
bool solutions_at_hand(service *s, const store_field *f);
/* Of a field that changes faster than it is solved nobody would ever see a result. So to those that
 * began to wait when so many solvings had begun, later ones are as good as the newest: to be set
 * before asking for them, and back to INT64_MAX (newest only) after. */
int64_t solutions_begun(const service *s);
void solutions_since(service *s, int64_t begun);
/* Then, of one of them with a symmetric estimator: the result, and how many jobs are in it. `sums`:
 * of what was counted. */
int solutions_get(service *s, const store_field *f, const shear_field_sums *sums, shear_result *out,
                  int64_t *jobs, shear_error *err);
/* The request asks for nothing any more. */
void solutions_forget(service *s, server_handle to);

/* users.c: NULL: it has none. Borrowed until the next call. */
const char *user_name(service *s, uid_t uid);

/* pace.c */
void pace_start(service *s);
void pace_tick(service *s); /* once a second, when `ticks` has moved on */
sheard_msg_loop pace_tell(const service *s);

/* news.c */
void news_field_changed(service *s, const char *name, const char *digest); /* NULL: no name yet */
void news_publish(service *s); /* once a second: soon, a few at a time */
void news_publish_all(service *s);
void news_free(service *s);

/* methods.c */
void methods_request(void *context, const server_request *request);
bool peer_is_admin(const service *s, const access_peer *peer);

/* status.c */
#define SHEARD_VERSION SHEAR_VERSION_STRING
sheard_msg_limits status_limits(const service *s);
void status_reply(service *s, server_handle to);
void metrics_reply(service *s, server_handle to);
void status_tick(service *s);

/* problems.c */
/* It failed, and it is over if it does not fail again in lasts_ms. */
void problem_noted(service *s, const char *about, const char *code, int64_t lasts_ms,
                   const char *message);
void problem_over(service *s, const char *about); /* whatever its code */
/* These write into the log, too: each reason a few times, then how often. */
void problem_job_waits(service *s, const store_job *job);
void problem_file_waits(service *s, const char *name, const char *code, const char *message);
void problems_tick(service *s);
/* All that there is; free(). NULL: out of memory. */
problem_list *problems_look(service *s, shear_error *err);

/* disks.c */
size_t disks_look(const service *s, sheard_msg_disk disks[DISKS]);
bool disk_is_full(const sheard_msg_disk *disk); /* ... as good as */

/* waits.c */
void waits_for_submitted(service *s, server_handle to, bool known, int64_t id);
void waits_job_ended(service *s, int64_t id);
void waits_expire(service *s);

/* life.c */
void life_start(service *s); /* signals and timers */
void life_close(service *s, int64_t flush_ms);
sheard_msg_stopping life_left(service *s); /* the state, and the jobs that are left */
void life_drain_queue(service *s);         /* take no new jobs, finish all that there are, stay */
void life_drain(service *s, double timeout_s);
void life_stop_now(service *s);
void life_announce(service *s); /* the state, to those who watch */
void life_check(service *s);    /* has the last job ended while draining? */

/* probe.c */
enum { PROBE_JOB = -1 }; /* the engine's name for it: no job of the store has it */
void probe_event(service *s, const engine_event *e);
void probe_free(service *s);

/* roots.c */
/* Those of the configuration, looked at; missing ones are warned of. On an error: as before. */
int roots_set(service *s, shear_error *err);
void roots_free(service *s);
void roots_tick(service *s);
const sheard_msg_root *roots_tell(const service *s, size_t *n); /* valid until the next call */
/* One line for each that is missing, as long as there is room; returns how many. */
size_t roots_problems(const service *s, const char **list, size_t room);

/* reload.c */
int reload_config(service *s, sheard_msg_reloaded *reply, sheard_rpc_error *error);
void reload_reply_deinit(sheard_msg_reloaded *reply);
/* Lists of users and groups, and the data roots; all or nothing. */
int reload_access(const sheard_config *c, access_list **admins, access_list **submitters,
                  access_roots **roots, shear_error *err);
int reload_hurried(const sheard_config *c, access_list **hurried, shear_error *err);
void reload_warn_names(const service *s); /* log those that are no user or group */
server_limits reload_server_limits(const sheard_config *c);
spool_tuning reload_spool_tuning(const sheard_config *c);
int64_t reload_memory(const sheard_config *c);              /* the jobs' budget, in bytes */
reader_limits reload_reader_limits(const sheard_config *c); /* but its paths */

#endif
