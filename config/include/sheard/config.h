/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sheard/config.h: the daemon's settings: their table, the configuration file, the command line,
 * and the texts generated from them.
 *
 * The table (sheard_setting_at) is the only place where a setting's name, type, default, range and
 * help are defined. The file's parser, the options, the validation, the sample file and
 * sheard.conf(5) use it. The measurement's settings (shear/settings.h) form its section [measure],
 * under their own names: they are the defaults of jobs.
 *
 * A daemon's calls:
 *     sheard_config_read(&config, path, &assignments, problems)         at the start
 *     sheard_config_read(&fresh, ...); sheard_config_reload(&config, &fresh, problems)    on SIGHUP
 *     sheard_config_deinit(&config)
 *
 * A config may be used by one thread at a time; different configs are independent. Errors are
 * SHEAR_E_SETTING, SHEAR_E_IO (the file) and SHEAR_E_NOMEM.
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

/* Append a copy of `text`. A list is initialized as {0}. Return SHEAR_OK or SHEAR_E_NOMEM. */
int sheard_list_append(sheard_list *list, const char *text, shear_error *err);
/* Return the items as text, separated by ", ", from malloc, or NULL if out of memory. */
char *sheard_list_join(const sheard_list *list);
void sheard_list_deinit(sheard_list *list);

enum sheard_log_level {
    SHEARD_LOG_UNKNOWN = -1,
    SHEARD_LOG_ERROR,
    SHEARD_LOG_WARNING,
    SHEARD_LOG_NOTICE,
    SHEARD_LOG_INFO,
    SHEARD_LOG_DEBUG
};

/* Limits on finished files that are kept; 0: no limit. */
typedef struct sheard_keep {
    int64_t max_age_ms, max_count, max_bytes;
} sheard_keep;

/* The values of all settings. Strings are never NULL ("" if nothing is set). The help texts of the
 * table describe each member. */
typedef struct sheard_config {
    struct {
        char *state_dir;
        char *socket;
        unsigned socket_mode;
        char *socket_group; /* "": the daemon's own */
        int64_t workers;    /* 0: one per processor that it may use */
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
        sheard_list submit_groups; /* empty: all who may open the socket */
        sheard_list priority_users, priority_groups;
    } access;
    struct {
        int64_t queue;
        int64_t connections, requests_in_flight;
        int64_t user_connections; /* 0: auto */
        int64_t admin_connections;
        int64_t unsent_bytes;
        int64_t idle_timeout_ms; /* 0: never */
        int64_t wait_timeout_ms;
        int64_t memory_bytes; /* 0: a quarter of what the process may use */
    } limits;
    struct {
        int64_t memory_bytes; /* address space, with the shared memory */
        int64_t cpu_time_ms, wall_time_ms;
        int64_t shared_memory_bytes;
        int64_t max_file_bytes;
        char *scratch; /* "auto": the first of $TMPDIR, /var/tmp and state_dir that works */
        int64_t unpacked_bytes, scratch_bytes;
    } reader;
    struct {
        int64_t max_count; /* 0: none */
        int64_t max_bytes;
    } plans;
    struct {
        int64_t first_delay_ms, max_delay_ms;
        int64_t attempts;
    } retry;
    struct {
        int64_t jobs_max_age_ms, jobs_max_count; /* 0: no limit */
    } retention;
    shear_settings measure;

    /* Private: the origin of each value. */
    char *path;
    int *lines; /* [sheard_settings_count()]; n > 0: line n of path; other values: origin.h */
} sheard_config;

/* ---- the table ---- */

/* Types of settings. In brackets: the member's C type. */
enum sheard_setting_type {
    SHEARD_T_PATH,     /* absolute, without '.' and '..' [char *] */
    SHEARD_T_NAME,     /* name of a user or group, or empty [char *] */
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
    size_t offset;       /* offset of the member in sheard_config; not for SHEARD_T_MEASURE */
    const char *initial; /* default value as text; NULL for SHEARD_T_MEASURE */
    int64_t min, max;    /* range of numbers, inclusive; max of paths and names: bytes */
    const char *word;    /* word for the number 0 or for an empty path, or NULL */
    const char *const *choices; /* SHEARD_T_CHOICE: NULL-terminated */
    const char *unit;           /* unit of an integer: "jobs"; may be NULL */
    const char *flag;           /* name of its option: "workers" for --workers; may be NULL */
    const char *help;           /* description in sentences */
    enum sheard_setting_type type;
    bool at_start; /* a change takes effect at the next start only, not on reload */
    const shear_setting_def *measure; /* SHEARD_T_MEASURE only */
} sheard_setting;

size_t sheard_settings_count(void);

/* Return the i-th setting, i < sheard_settings_count(). The order is that of the documentation:
 * sections are contiguous. */
sheard_setting sheard_setting_at(size_t i);

/* Return the index of a setting ('_' and '-' are equal), or -1. */
ptrdiff_t sheard_setting_find(const char *section, const char *key);

/* Return a section's description in sentences, or NULL if there is no such section. */
const char *sheard_section_help(const char *section);

/* ---- problems ---- */

enum { SHEARD_PROBLEMS_KEPT = 20 };

typedef struct sheard_problem {
    char where[208]; /* "file:line", "file", "command line", "default" */
    bool is_warning;
    shear_error error;
} sheard_problem;

/* Problems of a configuration, initialized as {0}. About 20 kB: too large for small stacks. */
typedef struct sheard_problems {
    size_t n_errors, n_warnings; /* of all problems found */
    size_t n_kept;
    sheard_problem kept[SHEARD_PROBLEMS_KEPT]; /* the first problems */
} sheard_problems;

/* Print "where: error: message" and an indented line of advice for each problem, and the number
 * left out. */
void sheard_problems_print(const sheard_problems *problems, FILE *out);

/* Convert the first error, with its place and the number of further errors, to one shear_error.
 * Return its code, or SHEAR_OK if there are no errors. */
int sheard_problems_error(const sheard_problems *problems, shear_error *err);

/* ---- reading ---- */

/* Return the default path of the configuration file: etc/sheard/sheard.conf of the prefix in which
 * the running program is installed, if it exists, else /etc/sheard/sheard.conf (the build's
 * SHEARD_CONFIG_DIR), which need not exist. Only one thread may call it at a time. */
const char *sheard_config_default_path(void);

/* Read a configuration: the defaults, then the file (path NULL: the default path), then the
 * assignments ("section.key=value"; may be NULL), then sheard_config_check. All problems are in
 * *problems. On success the caller frees *config; on failure there is nothing to free. Return
 * SHEAR_OK or the code of the first error. */
int sheard_config_read(sheard_config *config, const char *path, const sheard_list *assignments,
                       sheard_problems *problems);

/* The steps of sheard_config_read. After an error of load or set, valid values have been set and
 * the others are unchanged; *config remains valid and must be freed. A failed init leaves nothing
 * to free. load resets the origins of the values of an earlier load, but keeps the values. */
int sheard_config_init(sheard_config *config, shear_error *err);
int sheard_config_load(sheard_config *config, const char *path, sheard_problems *problems);
int sheard_config_set(sheard_config *config, const char *section, const char *key, const char *text,
                      shear_error *err);
int sheard_config_assign(sheard_config *config, const char *assignment, shear_error *err);
void sheard_config_deinit(sheard_config *config);

/* Check for contradictions between settings. Return SHEAR_OK or SHEAR_E_SETTING. */
int sheard_config_check(const sheard_config *config, sheard_problems *problems);

/* Add warnings about settings that are allowed but will hardly work on this system: unknown users
 * and groups, missing data roots, too few file descriptors, a socket open to everyone. It uses the
 * user database. */
void sheard_config_warnings(const sheard_config *config, sheard_problems *problems);

/* Return the number of file descriptors that the service needs beside those of clients'
 * connections. */
int64_t sheard_config_own_descriptors(const sheard_config *config);

/* Run `sheard --check-config`: read and check the configuration, and print all problems and a
 * summary to `out`. Return the number of errors. */
size_t sheard_config_check_file(const char *path, const sheard_list *assignments, FILE *out);

/* ---- command line ---- */

/* Fill in getopt_long entries for all settings that have an option, then the terminating zeros.
 * Return the number of entries without the zeros. `val` of each is SHEARD_FLAG_FIRST or more. */
enum { SHEARD_FLAG_FIRST = 0x2000 };
size_t sheard_flags_fill(struct option *options, size_t capacity);

/* Append "section.key=argument", the meaning of option `val`, to `assignments`. */
int sheard_flags_assign(int val, const char *argument, sheard_list *assignments, shear_error *err);

/* Print "  --workers N    help (default auto)" for each of them, at most 78 columns wide. */
void sheard_flags_help(FILE *out);

/* ---- writing ---- */

/* Return the value as text, from malloc, which sheard_config_set reads back to the same value; NULL
 * if out of memory. */
char *sheard_config_format(const sheard_config *config, size_t index);

/* Print the effective configuration as a file that loads to the same values, with the origin of
 * each. Return SHEAR_OK, SHEAR_E_NOMEM or SHEAR_E_IO. */
int sheard_config_print(const sheard_config *config, FILE *out, shear_error *err);

/* Print the commented sample: every setting with its help, and its default after a '#'. */
int sheard_config_print_sample(FILE *out, shear_error *err);

/* Print the settings as the sections of an mdoc manual page. */
int sheard_config_print_manual(FILE *out, shear_error *err);

/* ---- reload ---- */

/* Return whether setting `index` has the same value in both. */
bool sheard_config_same(const sheard_config *a, const sheard_config *b, size_t index);

/* Store the indices of the settings that differ into changed[capacity], in the table's order; only
 * those with at_start, if `at_start` is true. Return their number, which may exceed capacity. */
size_t sheard_config_changes(const sheard_config *a, const sheard_config *b, bool at_start,
                             size_t *changed, size_t capacity);

/* Take over from *fresh what may change while running. Settings with at_start keep their value, and
 * each that differs adds a warning. On an error (the result would contradict itself) *running is
 * unchanged. The caller frees *fresh in any case. */
int sheard_config_reload(sheard_config *running, sheard_config *fresh, sheard_problems *problems);

#endif
