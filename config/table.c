/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "table.h"

#define KiB (INT64_C(1) << 10)
#define MiB (INT64_C(1) << 20)
#define GiB (INT64_C(1) << 30)
#define TiB (INT64_C(1) << 40)
#define SECOND INT64_C(1000)
#define MINUTE (60 * SECOND)
#define HOUR (60 * MINUTE)
#define DAY (24 * HOUR)

#define AT(member) .offset = offsetof(sheard_config, member)
#define KEPT_FOREVER "Where nothing is said, nothing is removed: these may be the only copies of your data."

static const char *const log_levels[] = {"error", "warning", "notice", "info", "debug", NULL};

const struct section config_sections[] = {
    {"daemon", "The process, its socket and its threads."},
    {"spool", "The watch folder: files that appear in DIRECTORY/incoming are measured, and then moved to "
              "DIRECTORY/done or DIRECTORY/failed."},
    {"catalogues", "One result catalogue per job, with a row per stamp."},
    {"access", "Who may do what, and which files clients may name. A client's file is only read if that "
               "client may read it."},
    {"limits", "Bounds that keep one client, or all of them, from taking the service down."},
    {"reader", "Bounds on the sandboxed process that reads one file. A file that needs more fails, and "
               "nothing else does."},
    {"retry", "Jobs that failed for reasons that pass: a full disk, a file that vanished, no memory."},
    {"retention", "How long the records of finished jobs are kept."},
    {"measure", "The measurement, for jobs that do not say otherwise. Jobs keep the settings that they were "
                "accepted with."},
};
const size_t config_n_sections = sizeof config_sections / sizeof config_sections[0];

const sheard_setting config_rows[] = {
    {.section = "daemon", .key = "state_dir", .type = SHEARD_T_PATH, AT(daemon.state_dir),
     .initial = "/var/lib/sheard", .max = CONFIG_PATH_MAX, .flag = "state-dir", .at_start = true,
     .help = "Directory of the job database, the checkpoints and the transforms' plans. It must be on a local "
             "disk: the database's write-ahead log does not work on network file systems."},
    {.section = "daemon", .key = "socket", .type = SHEARD_T_PATH, AT(daemon.socket),
     .initial = "/run/sheard/sheard.sock", .max = CONFIG_SOCKET_MAX, .flag = "socket", .at_start = true,
     .help = "Unix socket that clients connect to. Where systemd hands over a socket (sheard.socket), that "
             "one is used, with the path, mode and group that are written there."},
    {.section = "daemon", .key = "socket_mode", .type = SHEARD_T_MODE, AT(daemon.socket_mode),
     .initial = "0660", .min = 0600, .max = 0777, .at_start = true,
     .help = "Permissions of the socket, octal. Who may not write to it cannot connect."},
    {.section = "daemon", .key = "socket_group", .type = SHEARD_T_NAME, AT(daemon.socket_group),
     .initial = "", .max = CONFIG_NAME_MAX, .at_start = true,
     .help = "Group of the socket. Empty: the daemon's own group."},
    {.section = "daemon", .key = "workers", .type = SHEARD_T_INT, AT(daemon.workers),
     .initial = "auto", .min = 1, .max = 1024, .word = "auto", .unit = "threads", .flag = "workers",
     .at_start = true, .help = "Threads that measure stamps. auto: as many as cores may be used."},
    {.section = "daemon", .key = "max_active_jobs", .type = SHEARD_T_INT, AT(daemon.max_active_jobs),
     .initial = "8", .min = 1, .max = 256, .unit = "jobs", .flag = "max-active-jobs",
     .help = "Jobs that are measured side by side and share the workers, so that a small one need not wait for a "
             "large one. Each has a reader process of its own; see [reader] for what that may take."},
    {.section = "daemon", .key = "log_level", .type = SHEARD_T_CHOICE, AT(daemon.log_level),
     .initial = "info", .choices = log_levels, .flag = "log-level",
     .help = "The least important messages that are logged."},
    {.section = "daemon", .key = "drain_timeout", .type = SHEARD_T_DURATION, AT(daemon.drain_timeout_ms),
     .initial = "90s", .min = 0, .max = HOUR, .flag = "drain-timeout",
     .help = "When asked to stop, wait this long for the running jobs; what is unfinished then goes on from "
             "its checkpoint at the next start. TimeoutStopSec in sheard.service must be longer."},
    {.section = "daemon", .key = "nice", .type = SHEARD_T_INT, AT(daemon.nice), .initial = "0",
     .min = 0, .max = 19, .at_start = true,
     .help = "Niceness of the daemon: 19 leaves the cores to everybody else."},

    {.section = "spool", .key = "enabled", .type = SHEARD_T_BOOL, AT(spool.enabled), .initial = "true",
     .at_start = true, .help = "Whether there is a watch folder."},
    {.section = "spool", .key = "directory", .type = SHEARD_T_PATH, AT(spool.directory),
     .initial = "/var/spool/sheard", .max = CONFIG_PATH_MAX, .flag = "spool", .at_start = true,
     .help = "Directory with the folders incoming, active, done and failed, all on one file system. Only one "
             "daemon may use it."},
    {.section = "spool", .key = "settle_time", .type = SHEARD_T_DURATION, AT(spool.settle_time_ms),
     .initial = "5s", .min = 0, .max = HOUR,
     .help = "A file that the kernel did not announce (written on another machine of a network file system, or "
             "while the daemon was down) is taken once its size and times have stood still for this long."},
    {.section = "spool", .key = "scan_interval", .type = SHEARD_T_DURATION, AT(spool.scan_interval_ms),
     .initial = "1min", .min = SECOND, .max = DAY,
     .help = "How often the folder is searched for files that the kernel did not announce."},
    {.section = "spool", .key = "done_max_age", .type = SHEARD_T_DURATION, AT(spool.done.max_age_ms),
     .initial = "unlimited", .min = SECOND, .max = 36500 * DAY, .word = "unlimited",
     .help = "Files in done that are older are removed, with their reports. " KEPT_FOREVER},
    {.section = "spool", .key = "done_max_count", .type = SHEARD_T_INT, AT(spool.done.max_count),
     .initial = "unlimited", .min = 1, .max = 1000000000, .word = "unlimited", .unit = "files",
     .help = "The oldest files in done beyond this number are removed."},
    {.section = "spool", .key = "done_max_bytes", .type = SHEARD_T_BYTES, AT(spool.done.max_bytes),
     .initial = "unlimited", .min = MiB, .max = 1024 * 1024 * TiB, .word = "unlimited",
     .help = "The oldest files in done are removed until the rest has at most this size."},
    {.section = "spool", .key = "failed_max_age", .type = SHEARD_T_DURATION, AT(spool.failed.max_age_ms),
     .initial = "unlimited", .min = SECOND, .max = 36500 * DAY, .word = "unlimited",
     .help = "As done_max_age, for failed."},
    {.section = "spool", .key = "failed_max_count", .type = SHEARD_T_INT, AT(spool.failed.max_count),
     .initial = "unlimited", .min = 1, .max = 1000000000, .word = "unlimited", .unit = "files",
     .help = "As done_max_count, for failed."},
    {.section = "spool", .key = "failed_max_bytes", .type = SHEARD_T_BYTES, AT(spool.failed.max_bytes),
     .initial = "unlimited", .min = MiB, .max = 1024 * 1024 * TiB, .word = "unlimited",
     .help = "As done_max_bytes, for failed."},

    {.section = "catalogues", .key = "enabled", .type = SHEARD_T_BOOL, AT(catalogues.enabled),
     .initial = "true", .help = "Whether catalogues are written."},
    {.section = "catalogues", .key = "directory", .type = SHEARD_T_PATH, AT(catalogues.directory),
     .initial = "/var/lib/sheard/catalogues", .max = CONFIG_PATH_MAX, .flag = "catalogues",
     .help = "Where they are written. A catalogue appears under its name only when it is complete. The unit "
             "sheard.service lets the daemon write nowhere but in its own directories: another one needs "
             "ReadWritePaths= in a drop-in."},

    {.section = "access", .key = "data_roots", .type = SHEARD_T_PATHS, AT(access.data_roots),
     .initial = "", .max = CONFIG_PATH_MAX, .flag = "data-roots",
     .help = "Clients may name files beneath these directories only. Empty: none, and files are taken from the watch "
             "folder alone. Data under /home also needs the drop-in home-data.conf of sheard.service."},
    {.section = "access", .key = "admin_users", .type = SHEARD_T_NAMES, AT(access.admin_users),
     .initial = "root", .max = CONFIG_NAME_MAX,
     .help = "Users who may cancel and retry the jobs of others, reload, drain and shut down."},
    {.section = "access", .key = "admin_groups", .type = SHEARD_T_NAMES, AT(access.admin_groups),
     .initial = "", .max = CONFIG_NAME_MAX, .help = "Groups whose members may do so too."},
    {.section = "access", .key = "submit_groups", .type = SHEARD_T_NAMES, AT(access.submit_groups),
     .initial = "", .max = CONFIG_NAME_MAX,
     .help = "Groups whose members may submit jobs. Empty: everybody who may connect. Administrators always may."},

    {.section = "limits", .key = "queue", .type = SHEARD_T_INT, AT(limits.queue), .initial = "100000",
     .min = 1, .max = 10000000, .unit = "jobs",
     .help = "Jobs that may wait. A submit beyond is refused with queue_full, and files stay in incoming."},
    {.section = "limits", .key = "line_bytes", .type = SHEARD_T_BYTES, AT(limits.line_bytes),
     .initial = "256K", .min = 4 * KiB, .max = 64 * MiB,
     .help = "Longest message from a client, and largest job file in the watch folder."},
    {.section = "limits", .key = "json_depth", .type = SHEARD_T_INT, AT(limits.json_depth),
     .initial = "16", .min = 4, .max = 256, .unit = "levels", .help = "Deepest nesting of a message."},
    {.section = "limits", .key = "connections", .type = SHEARD_T_INT, AT(limits.connections),
     .initial = "2048", .min = 1, .max = 100000, .unit = "connections",
     .help = "Clients that may be connected at once. Each needs a file descriptor (LimitNOFILE in "
             "sheard.service)."},
    {.section = "limits", .key = "requests_in_flight", .type = SHEARD_T_INT, AT(limits.requests_in_flight),
     .initial = "64", .min = 1, .max = 10000, .unit = "requests",
     .help = "Unanswered requests of one connection; beyond, it is not read from until some are answered."},
    {.section = "limits", .key = "idle_timeout", .type = SHEARD_T_DURATION, AT(limits.idle_timeout_ms),
     .initial = "10min", .min = SECOND, .max = 7 * DAY, .word = "never",
     .help = "A connection is closed that has neither requests nor subscriptions, or stays in the middle of a "
             "message, for this long."},
    {.section = "limits", .key = "wait_timeout", .type = SHEARD_T_DURATION, AT(limits.wait_timeout_ms),
     .initial = "1h", .min = SECOND, .max = 7 * DAY,
     .help = "A wait request is answered at the latest after this time, whatever it asks for."},

    {.section = "reader", .key = "memory", .type = SHEARD_T_BYTES, AT(reader.memory_bytes),
     .initial = "1G", .min = 64 * MiB, .max = TiB,
     .help = "Address space of the process, the shared memory included."},
    {.section = "reader", .key = "cpu_time", .type = SHEARD_T_DURATION, AT(reader.cpu_time_ms),
     .initial = "12h", .min = SECOND, .max = 30 * DAY,
     .help = "Processor time for the whole of one file, in whole seconds (rounded up)."},
    {.section = "reader", .key = "wall_time", .type = SHEARD_T_DURATION, AT(reader.wall_time_ms),
     .initial = "10min", .min = 100, .max = DAY,
     .help = "Time for one answer: opening the file, or one block of stamps. Network file systems that hang "
             "for longer fail the job, which is then retried."},
    {.section = "reader", .key = "shared_memory", .type = SHEARD_T_BYTES, AT(reader.shared_memory_bytes),
     .initial = "128M", .min = MiB, .max = 64 * GiB,
     .help = "Memory through which a reader hands over its blocks, for each active job. It must hold a block "
             "of 16 stamp pairs and their PSFs in double precision."},
    {.section = "reader", .key = "max_file_bytes", .type = SHEARD_T_BYTES, AT(reader.max_file_bytes),
     .initial = "256G", .min = MiB, .max = 1024 * TiB, .help = "Larger files are refused."},

    {.section = "retry", .key = "first_delay", .type = SHEARD_T_DURATION, AT(retry.first_delay_ms),
     .initial = "10s", .min = 10, .max = DAY,
     .help = "Time until the second attempt. It doubles with every further one."},
    {.section = "retry", .key = "max_delay", .type = SHEARD_T_DURATION, AT(retry.max_delay_ms),
     .initial = "1h", .min = 10, .max = 7 * DAY, .help = "Longest time between two attempts."},
    {.section = "retry", .key = "attempts", .type = SHEARD_T_INT, AT(retry.attempts), .initial = "20",
     .min = 1, .max = 1000, .unit = "attempts",
     .help = "A job fails for good after this many (with the default delays: after half a day)."},

    {.section = "retention", .key = "jobs_max_age", .type = SHEARD_T_DURATION,
     AT(retention.jobs_max_age_ms), .initial = "unlimited", .min = SECOND, .max = 36500 * DAY,
     .word = "unlimited",
     .help = "Finished jobs that are older are forgotten. What they contributed to their fields stays, and "
             "the same input is still recognised."},
    {.section = "retention", .key = "jobs_max_count", .type = SHEARD_T_INT, AT(retention.jobs_max_count),
     .initial = "unlimited", .min = 1, .max = 1000000000, .word = "unlimited", .unit = "jobs",
     .help = "The oldest finished jobs beyond this number are forgotten."},
};
const size_t config_n_rows = sizeof config_rows / sizeof config_rows[0];
