/* SPDX-License-Identifier: GPL-3.0-or-later */
/* store-bench: times of the store's operations on a big database and on a small one (they should be
 * the same), and durable submits per second compared to SQLite's plain commits in the same
 * directory. The two alternate, so that both have the same disturbances. */
#include "base/cleanup.h"
#include "store_fill.h"
#include "timer.h"

#include <errno.h>
#include <ftw.h>
#include <inttypes.h>
#include <sqlite3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    ROUNDS = 31,
    CALLS = 64,
    PAGE = 100,
    COMMITS = 200,
    MAX_GROUP = 64,
    SMALL_JOBS = 10000,
    SMALL_FIELDS = 1000
};

typedef struct database {
    store *s;
    int64_t jobs, fields;
    int64_t next; /* steps through the database in large strides, the same in every run */
    char *sums;
} database;

/* Of the call that failed; then the program ends. */
static shear_error failure;

static void must(int code) {
    if (code != SHEAR_OK) {
        fprintf(stderr, "store-bench: %s\n", failure.message);
        exit(1);
    }
}

/* ---- One call of each kind ---- */

static int64_t pick(database *d, int64_t n) {
    d->next = (d->next + 104395301) % 2147483647;
    return d->next % n;
}

static void pick_field(database *d, char name[32]) {
    snprintf(name, 32, "field-%07" PRId64, pick(d, d->fields));
}

static int64_t submit(store *s, int priority) {
    int64_t id = 0;
    must(store_fill_submit(s, "/survey/night-001/new.fits", priority, 5, &id, &failure));
    return id;
}

static void call_submit(database *d) {
    submit(d->s, 0);
}

/* Do all operations of a job's life except those on its file. */
static void call_life(database *d) {
    char field[32];
    char content[32];
    CLEANUP(store_job_deinit) store_job job = {0};
    int64_t of = 0;
    store_finished end;
    const int64_t id = submit(d->s, 1);
    pick_field(d, field);
    snprintf(content, sizeof content, "new %" PRId64, id);
    const store_input input = {field, content, 16};
    const store_work work = {.sums = d->sums, .result = "{}", .elapsed_us = 9, .now_ms = 9};
    must(store_next(d->s, 6, &job, &failure));
    must(store_set_input(d->s, job.id, &input, &of, &failure));
    must(store_finish(d->s, job.id, &work, &end, &failure));
}

static void call_count(database *d) {
    store_counts counts;
    must(store_count(d->s, &counts, &failure));
}

static void call_totals(database *d) {
    store_totals totals;
    must(store_total(d->s, &totals, &failure));
}

static void call_job(database *d) {
    CLEANUP(store_job_deinit) store_job job = {0};
    must(store_job_get(d->s, 1 + pick(d, d->jobs), &job, &failure));
}

static void call_jobs(database *d) {
    CLEANUP(store_job_page_deinit) store_job_page page = {0};
    const store_job_filter filter = {.states = 1u << STORE_DONE,
                                     .before = PAGE + 1 + pick(d, d->jobs - PAGE)};
    must(store_jobs(d->s, &filter, PAGE, &page, &failure));
}

static void call_jobs_of_field(database *d) {
    char field[32];
    CLEANUP(store_job_page_deinit) store_job_page page = {0};
    pick_field(d, field);
    const store_job_filter filter = {.field = field, .by_owner = true, .owner = 1000};
    must(store_jobs(d->s, &filter, PAGE, &page, &failure));
}

static void call_field(database *d) {
    char field[32];
    CLEANUP(store_field_page_deinit) store_field_page page = {0};
    pick_field(d, field);
    must(store_field_get(d->s, field, &page, &failure));
}

/* full pages only, not the last ones */
static void call_fields(database *d) {
    char field[32];
    CLEANUP(store_field_page_deinit) store_field_page page = {0};
    snprintf(field, sizeof field, "field-%07" PRId64, pick(d, d->fields - PAGE));
    const store_field_filter filter = {
        .prefix = "field-", .after_name = field, .after_digest = "1"};
    must(store_fields(d->s, &filter, PAGE, &page, &failure));
}

static void call_contributions(database *d) {
    char field[32];
    CLEANUP(store_contribution_page_deinit) store_contribution_page page = {0};
    pick_field(d, field);
    must(store_contributions(d->s, field, "0123456789abcdef0123456789abcdef", 0, PAGE, &page,
                             &failure));
}

typedef struct operation {
    const char *name;
    void (*call)(database *d);
} operation;

static const operation operations[] = {
    {"submit (no fsync)", call_submit},
    {"submit to done (no fsync)", call_life},
    {"status counts", call_count},
    {"metrics totals", call_totals},
    {"job", call_job},
    {"jobs, page of 100", call_jobs},
    {"jobs of a field and owner", call_jobs_of_field},
    {"field", call_field},
    {"fields, page of 100", call_fields},
    {"contributions of a field", call_contributions},
};

/* Return microseconds per call. The calls are in a group that is rolled back, so that the database
 * does not change. */
static double time_calls(database *d, const operation *op) {
    must(store_begin(d->s, &failure));
    const double start = timer_now_us();
    for (int i = 0; i < CALLS; i++)
        op->call(d);
    const double us = (timer_now_us() - start) / CALLS;
    store_rollback(d->s);
    return us;
}

static void compare_databases(database *small, database *big) {
    static double few[ROUNDS];
    static double many[ROUNDS];
    static double ratio[ROUNDS];
    printf("| microseconds | %" PRId64 " jobs | %" PRId64 " jobs | ratio |\n|---|---|---|---|\n",
           small->jobs, big->jobs);
    for (size_t i = 0; i < sizeof operations / sizeof operations[0]; i++) {
        time_calls(small, &operations[i]); /* warm-up */
        time_calls(big, &operations[i]);
        for (int r = 0; r < ROUNDS; r++) {
            few[r] = time_calls(small, &operations[i]);
            many[r] = time_calls(big, &operations[i]);
            ratio[r] = many[r] / few[r];
        }
        printf("| %-26s | %9.1f | %9.1f | %5.2f |\n", operations[i].name, timer_median(few, ROUNDS),
               timer_median(many, ROUNDS), timer_median(ratio, ROUNDS));
    }
}

/* ---- Durable submits ---- */

static sqlite3 *open_bare(const char *path) {
    sqlite3 *db = NULL;
    if (sqlite3_open(path, &db) != SQLITE_OK ||
        sqlite3_exec(db,
                     "PRAGMA locking_mode = EXCLUSIVE; PRAGMA journal_mode = WAL;"
                     "PRAGMA synchronous = FULL; CREATE TABLE t(x)",
                     NULL, NULL, NULL) != SQLITE_OK) {
        fprintf(stderr, "store-bench: %s: %s\n", path, sqlite3_errmsg(db));
        exit(1);
    }
    return db;
}

/* Return commits of one row per second: the limit of disk and SQLite. */
static double bare_rate(sqlite3 *db) {
    sqlite3_stmt *stmt = NULL;
    sqlite3_prepare_v2(db, "INSERT INTO t VALUES (1)", -1, &stmt, NULL);
    const double start = timer_now_us();
    for (int i = 0; i < COMMITS; i++) {
        sqlite3_step(stmt);
        sqlite3_reset(stmt);
    }
    const double us = timer_now_us() - start;
    sqlite3_finalize(stmt);
    return 1e6 * COMMITS / us;
}

static double submit_rate(store *s, int group) {
    const double start = timer_now_us();
    for (int i = 0; i < COMMITS; i++) {
        must(store_begin(s, &failure));
        for (int k = 0; k < group; k++)
            submit(s, 0);
        must(store_commit(s, &failure));
    }
    return 1e6 * COMMITS * group / (timer_now_us() - start);
}

static void compare_rates(sqlite3 *bare, store *s) {
    static double plain[ROUNDS];
    static double ours[ROUNDS];
    static double ratio[ROUNDS];
    enum { ITERATIONS = 5 };
    printf("\n| durable submits per second | store | bare commits | ratio |\n|---|---|---|---|\n");
    for (int group = 1; group <= MAX_GROUP; group *= 8) {
        for (int r = 0; r < ITERATIONS; r++) {
            plain[r] = bare_rate(bare);
            ours[r] = submit_rate(s, group);
            ratio[r] = ours[r] / plain[r];
        }
        printf("| groups of %-2d | %9.0f | %9.0f | %6.2f |\n", group,
               timer_median(ours, ITERATIONS), timer_median(plain, ITERATIONS),
               timer_median(ratio, ITERATIONS));
    }
}

/* ---- The program ---- */

static database open_filled(const char *dir, const char *name, int64_t jobs, int64_t fields) {
    char path[4200];
    database d = {.jobs = jobs, .fields = fields, .next = 1, .sums = store_fill_sums()};
    snprintf(path, sizeof path, "%s/%s", dir, name);
    const double start = timer_now_us();
    must(store_fill(path, jobs, fields, &failure));
    fprintf(stderr, "store-bench: %" PRId64 " jobs in %" PRId64 " fields made in %.0f s\n", jobs,
            fields, 1e-6 * (timer_now_us() - start));
    must(store_open(&d.s, path, NULL, 10, &failure));
    return d;
}

static void run(const char *dir, int64_t jobs, int64_t fields) {
    char path[4200];
    database small = open_filled(dir, "small.db", SMALL_JOBS, SMALL_FIELDS);
    database big = open_filled(dir, "big.db", jobs, fields);
    compare_databases(&small, &big);
    snprintf(path, sizeof path, "%s/bare.db", dir);
    sqlite3 *bare = open_bare(path);
    compare_rates(bare, big.s);
    sqlite3_close(bare);
    store_close(small.s);
    store_close(big.s);
    free(small.sums);
    free(big.sums);
}

static int remove_one(const char *path, const struct stat *st, int type, struct FTW *at) {
    (void)st;
    (void)type;
    (void)at;
    return remove(path);
}

static int64_t number(const char *text) {
    char *end = NULL;
    const long long value = text != NULL ? strtoll(text, &end, 10) : 0;
    if (value < 1 || *end != '\0') {
        fprintf(stderr, "usage: store-bench [--jobs N] [--fields N] [--dir DIRECTORY]\n");
        exit(2);
    }
    return value;
}

int main(int argc, char **argv) {
    char dir[4096];
    const char *parent = getenv("TMPDIR") != NULL ? getenv("TMPDIR") : "/tmp";
    int64_t jobs = 1000000;
    int64_t fields = 100000;
    for (int i = 1; i < argc; i += 2) {
        const char *value = i + 1 < argc ? argv[i + 1] : NULL;
        if (strcmp(argv[i], "--dir") == 0 && value != NULL) {
            parent = value;
        } else if (strcmp(argv[i], "--jobs") == 0) {
            jobs = number(value);
        } else if (strcmp(argv[i], "--fields") == 0) {
            fields = number(value);
        } else {
            number(NULL);
        }
    }
    if (fields > jobs || fields <= PAGE ||
        snprintf(dir, sizeof dir, "%s/store-bench-XXXXXX", parent) >= 4096 ||
        mkdtemp(dir) == NULL) {
        fprintf(stderr,
                "store-bench: give more jobs than fields, and those more than 100; or %s is not a "
                "directory: %s\n",
                parent, strerror(errno));
        return 2;
    }
    run(dir, jobs, fields);
    nftw(dir, remove_one, 16, FTW_DEPTH | FTW_PHYS);
    return 0;
}
