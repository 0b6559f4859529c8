/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sheard/config.h: the daemon's settings: one table, the file, the command line, the manual.
 *
 * The table (sheard_setting_at) is the only place where a setting's name, type, default, range and
 * help are written; the file's parser, the flags, the validation, the sample file and
 * sheard.conf(5) are made from it. The measurement's settings (shear/settings.h) are its section
 * [measure], under their own names: the defaults of jobs that do not say otherwise.
 *
 * A daemon's life with it:
 *     sheard_config_read(&config, path, &assignments, problems)         at the start
 *     sheard_config_read(&fresh, ...); sheard_config_reload(&config, &fresh, problems)    on SIGHUP
 *     sheard_config_deinit(&config)
 *
 * Not thread-safe for one config; different configs are independent. Errors are SHEAR_E_SETTING,
 * SHEAR_E_IO (the file) and SHEAR_E_NOMEM.
 */
#ifndef SHEARD_CONFIG_H
#define SHEARD_CONFIG_H

#include "shear/error.h"
#include "shear/settings.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

struct option; /* getopt.h */

/* ---- values ---- */

typedef struct sheard_list {
    size_t n;
    char **items; /* [n], owned */
} sheard_list;

/* Append a copy of `text`. SHEAR_OK or SHEAR_E_NOMEM. A list begins as {0}. */
int sheard_list_append(sheard_list *list, const char *text, shear_error *err);
void sheard_list_deinit(sheard_list *list);

enum sheard_log_level {
    SHEARD_LOG_UNKNOWN = -1,
    SHEARD_LOG_ERROR,
    SHEARD_LOG_WARNING,
    SHEARD_LOG_NOTICE,
    SHEARD_LOG_INFO,
    SHEARD_LOG_DEBUG
};

/* What is kept of finished files; 0 = no limit. */
typedef struct sheard_keep {
    int64_t max_age_ms, max_count, max_bytes;
} sheard_keep;

/* Strings are never NULL ("" if nothing is set). The help texts of the table say what each does.
 */
typedef struct sheard_config {
    struct {
        char *state_dir;
        char *socket;
        unsigned socket_mode;
        char *socket_group; /* "" = the daemon's own */
        int64_t workers;    /* 0 = one for each processor that it may use */
        int64_t max_active_jobs;
        enum sheard_log_level log_level;
        int64_t drain_timeout_ms;
        int64_t nice;
    } daemon;
    struct {
        bool enabled;
        char *directory;
        int64_t settle_time_ms, scan_interval_ms;
        sheard_keep done, failed;
    } spool;
    struct {
        bool enabled;
        char *directory;
    } catalogs;
    struct {
        sheard_list data_roots;
        sheard_list admin_users, admin_groups;
        sheard_list submit_groups; /* empty = whoever may open the socket */
        sheard_list priority_users, priority_groups;
    } access;
    struct {
        int64_t queue;
        int64_t connections, requests_in_flight;
        int64_t user_connections; /* 0 = auto */
        int64_t admin_connections;
        int64_t unsent_bytes;
        int64_t idle_timeout_ms; /* 0 = never */
        int64_t wait_timeout_ms;
        int64_t memory_bytes; /* 0 = a quarter of what there is */
    } limits;
    struct {
        int64_t memory_bytes; /* of addresses, the shared memory included */
        int64_t cpu_time_ms, wall_time_ms;
        int64_t shared_memory_bytes;
        int64_t max_file_bytes;
        char *scratch; /* "auto": the first of $TMPDIR, /var/tmp and state_dir that works */
        int64_t unpacked_bytes, scratch_bytes;
    } reader;
    struct {
        int64_t max_count; /* 0 = none */
        int64_t max_bytes;
    } plans;
    struct {
        int64_t first_delay_ms, max_delay_ms;
        int64_t attempts;
    } retry;
    struct {
        int64_t jobs_max_age_ms, jobs_max_count; /* 0 = no limit */
    } retention;
    shear_settings measure;

    /* Private: where each value comes from. */
    char *path;
    int *lines; /* [sheard_settings_count()]; n > 0 = line n of path; the others are in origin.h */
} sheard_config;

/* ---- the table ---- */

/* In brackets: the member's C type. */
enum sheard_setting_type {
    SHEARD_T_PATH,     /* absolute, without '.' and '..' [char *] */
    SHEARD_T_NAME,     /* of a user or group, or empty [char *] */
    SHEARD_T_PATHS,    /* list of paths [sheard_list] */
    SHEARD_T_NAMES,    /* list of users or groups [sheard_list] */
    SHEARD_T_INT,      /* [int64_t] */
    SHEARD_T_BYTES,    /* K, M, G, T: powers of 1024 [int64_t] */
    SHEARD_T_DURATION, /* ms, s, min, h, d [int64_t, milliseconds] */
    SHEARD_T_MODE,     /* octal [unsigned] */
    SHEARD_T_CHOICE,   /* [int, index into choices] */
    SHEARD_T_BOOL,     /* [bool] */
    SHEARD_T_MEASURE   /* one of shear_settings_table */
};

typedef struct sheard_setting {
    const char *section, *key;
    size_t offset;              /* of the member in sheard_config; not of SHEARD_T_MEASURE */
    const char *initial;        /* the default, as text; NULL for SHEARD_T_MEASURE */
    int64_t min, max;           /* of numbers, inclusive; max of paths and names: bytes */
    const char *word;           /* what stands for the number 0, or for no path; or NULL */
    const char *const *choices; /* SHEARD_T_CHOICE: NULL-terminated */
    const char *unit;           /* what an integer counts: "jobs"; may be NULL */
    const char *flag;           /* its own option: "workers" is --workers; may be NULL */
    const char *help;           /* sentences */
    enum sheard_setting_type type;
    bool at_start; /* a change takes effect at the next start only, not on reload */
    const shear_setting_def *measure; /* SHEARD_T_MEASURE only */
} sheard_setting;

size_t sheard_settings_count(void);

/* The i-th setting, in the order of documentation: sections are contiguous. i <
 * sheard_settings_count(). */
sheard_setting sheard_setting_at(size_t i);

/* The index of a setting ('_' and '-' are the same), or -1. */
ptrdiff_t sheard_setting_find(const char *section, const char *key);

/* What a section is about: sentences; NULL if there is no such section. */
const char *sheard_section_help(const char *section);

/* ---- problems ---- */

enum { SHEARD_PROBLEMS_KEPT = 20 };

typedef struct sheard_problem {
    char where[208]; /* "file:line", "file", "command line", "default" */
    bool is_warning;
    shear_error error;
} sheard_problem;

/* Begin as {0}. About 20 kB: not for small stacks. */
typedef struct sheard_problems {
    size_t n_errors, n_warnings; /* all that were found */
    size_t n_kept;
    sheard_problem kept[SHEARD_PROBLEMS_KEPT]; /* the first of them */
} sheard_problems;

/* "where: error: message" and an indented line of advice for each, and how many were left out. */
void sheard_problems_print(const sheard_problems *problems, FILE *out);

/* The first error as one shear_error, with its place and how many more there are. SHEAR_OK without
 * errors. */
int sheard_problems_error(const sheard_problems *problems, shear_error *err);

/* ---- reading ---- */

/* Where the configuration is looked for when nobody says otherwise: etc/sheard/sheard.conf beside
 * the directory of the running program, if there is one, else /etc/sheard/sheard.conf (the
 * build's SHEARD_CONFIG_DIR), which need not exist. Not for several threads at once. */
const char *sheard_config_default_path(void);

/* Defaults + the file (path NULL = the default path) + assignments ("section.key=value", may be
 * NULL) + sheard_config_check. All that is wrong is in *problems. On success the caller frees
 * *config; on failure there is nothing to free. Returns SHEAR_OK or the code of the first error. */
int sheard_config_read(sheard_config *config, const char *path, const sheard_list *assignments,
                       sheard_problems *problems);

/* The steps of sheard_config_read. After an error in load or set, what was good has been set and
 * the rest is as it was; *config is sound and must be freed. A failed init leaves nothing to free.
 * load forgets where the values of an earlier load came from, but keeps them. */
int sheard_config_init(sheard_config *config, shear_error *err);
int sheard_config_load(sheard_config *config, const char *path, sheard_problems *problems);
int sheard_config_set(sheard_config *config, const char *section, const char *key, const char *text,
                      shear_error *err);
int sheard_config_assign(sheard_config *config, const char *assignment, shear_error *err);
void sheard_config_deinit(sheard_config *config);

/* Contradictions between settings. */
int sheard_config_check(const sheard_config *config, sheard_problems *problems);

/* What is allowed but will hardly work on this system: unknown users and groups, data roots that
 * are not there, too few file descriptors, a socket open to everyone. Only warnings; asks the user
 * database. */
void sheard_config_warnings(const sheard_config *config, sheard_problems *problems);

/* File descriptors that the service needs beside those of its clients' connections. */
int64_t sheard_config_own_descriptors(const sheard_config *config);

/* `sheard --check-config`: read, warn, print every problem and a summary to `out`. Returns the
 * number of errors. */
size_t sheard_config_check_file(const char *path, const sheard_list *assignments, FILE *out);

/* ---- command line ---- */

/* getopt_long entries for every setting that has its own flag, and the terminating zeros. Returns
 * how many there are without these. `val` of each is SHEARD_FLAG_FIRST or more. */
enum { SHEARD_FLAG_FIRST = 0x2000 };
size_t sheard_flags_fill(struct option *options, size_t capacity);

/* Append what option `val` with `argument` means, "section.key=argument", to `assignments`. */
int sheard_flags_assign(int val, const char *argument, sheard_list *assignments, shear_error *err);

/* "  --workers N    help (default auto)" for each of them, at most 78 columns wide. */
void sheard_flags_help(FILE *out);

/* ---- writing ---- */

/* The value as the text that sheard_config_set reads back to the same value: malloc'd, the
 * caller's; NULL when out of memory. */
char *sheard_config_format(const sheard_config *config, size_t index);

/* The effective configuration as a file that loads to the same values, each with where it comes
 * from. SHEAR_OK, SHEAR_E_NOMEM or SHEAR_E_IO. */
int sheard_config_print(const sheard_config *config, FILE *out, shear_error *err);

/* The commented sample: every setting with its help, and its default behind a '#'. */
int sheard_config_print_sample(FILE *out, shear_error *err);

/* The settings as the sections of an mdoc manual page. */
int sheard_config_print_manual(FILE *out, shear_error *err);

/* ---- reload ---- */

/* Whether setting `index` has the same value in both. */
bool sheard_config_same(const sheard_config *a, const sheard_config *b, size_t index);

/* Indices of the settings that differ, into changed[capacity], in the table's order; only those of
 * the next start where `at_start`, else all. Returns how many there are (maybe more than capacity).
 */
size_t sheard_config_changes(const sheard_config *a, const sheard_config *b, bool at_start,
                             size_t *changed, size_t capacity);

/* Take over from *fresh what may change while running. Settings of the next start stay as they run,
 * and each that differs is a warning. On an error (the mixture contradicts itself) *running is as
 * before. *fresh must be freed by the caller either way. */
int sheard_config_reload(sheard_config *running, sheard_config *fresh, sheard_problems *problems);

#endif
