/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Define the daemon's own settings. Apart from the member of sheard_config, a setting is defined
 * only here: the code, the sample, the manual page and the options use these rows. */
#include "table.h"

#include "base/member.h"

#define KiB    (INT64_C(1) << 10)
#define MiB    (INT64_C(1) << 20)
#define GiB    (INT64_C(1) << 30)
#define TiB    (INT64_C(1) << 40)
#define SECOND INT64_C(1000)
#define MINUTE (60 * SECOND)
#define HOUR   (60 * MINUTE)
#define DAY    (24 * HOUR)

/* The C type of the member of each type of setting. */
#define C_PATH     char *
#define C_NAME     char *
#define C_PATHS    sheard_list
#define C_NAMES    sheard_list
#define C_INT      int64_t
#define C_BYTES    int64_t
#define C_DURATION int64_t
#define C_MODE     unsigned
#define C_CHOICE   int
#define C_BOOL     bool

#define ROW(kind, its_section, its_key, member)                                                    \
    .section = (its_section), .key = (its_key), .type = SHEARD_T_##kind,                           \
    .offset = MEMBER_AT(sheard_config, member, C_##kind)
#define RANGE(least, most) .min = (least), .max = (most)
/* A limit of this range, and none by default. */
#define UNLIMITED(least, most) .initial = "unlimited", .word = "unlimited", RANGE(least, most)

#define KEPT_FOREVER                                                                               \
    "If no limit is set, nothing is removed: these may be the only copies of your data."

static const char *const log_levels[] = {"error", "warning", "notice", "info", "debug", NULL};

/* clang-format off */
const sheard_setting config_rows[] = {
    {ROW(PATH, "daemon", "state_dir", daemon.state_dir), .initial = "/var/lib/sheard",
     .max = CONFIG_PATH_MAX, .flag = "state-dir", .at_start = true,
     .help = "Directory of the job database, with the checkpoints in it. It must be on a local "
             "disk: the database's write-ahead log does not work on network file systems."},
    {ROW(PATH, "daemon", "socket", daemon.socket), .initial = "/run/sheard/sheard.sock",
     .max = CONFIG_SOCKET_MAX, .flag = "socket", .at_start = true,
     .help = "Unix socket that clients connect to. If systemd hands over a socket "
             "(sheard.socket), that one is used, with the path, mode and group that are written "
             "there."},
    {ROW(MODE, "daemon", "socket_mode", daemon.socket_mode), .initial = "0660", RANGE(0600, 0777),
     .at_start = true,
     .help = "Permissions of the socket, octal. Only users who may write to it can connect."},
    {ROW(NAME, "daemon", "socket_group", daemon.socket_group), .initial = "",
     .max = CONFIG_NAME_MAX, .at_start = true,
     .help = "Group of the socket. Empty: the daemon's own group."},
    {ROW(INT, "daemon", "workers", daemon.workers), .initial = "auto", RANGE(1, 1024),
     .word = "auto", .unit = "threads", .flag = "workers", .at_start = true,
     .help = "Threads that measure stamps. auto: as many as the processors that the service may "
             "use: its affinity and the quotas of its control groups (CPUAffinity=, CPUQuota=, a "
             "container's) count."},
    {ROW(INT, "daemon", "max_active_jobs", daemon.max_active_jobs), .initial = "8", RANGE(1, 256),
     .unit = "jobs", .flag = "max-active-jobs",
     .help = "Jobs that are measured side by side and share the workers, so that a small one need "
             "not wait for a large one. Each has a reader process of its own; see [reader] for "
             "what that may take."},
    {ROW(CHOICE, "daemon", "log_level", daemon.log_level), .initial = "info",
     .choices = log_levels, .flag = "log-level",
     .help = "The least important messages that are logged."},
    {ROW(DURATION, "daemon", "drain_timeout", daemon.drain_timeout_ms), .initial = "90s",
     RANGE(0, HOUR), .flag = "drain-timeout",
     .help = "When asked to stop, wait this long for the running jobs; what is unfinished then "
             "goes on from its checkpoint at the next start. TimeoutStopSec in sheard.service "
             "must be longer."},
    {ROW(INT, "daemon", "nice", daemon.nice), .initial = "0", RANGE(0, 19), .at_start = true,
     .help = "Niceness of the daemon: 19 leaves the cores to everybody else."},

    {ROW(BOOL, "spool", "enabled", spool.enabled), .initial = "true", .at_start = true,
     .help = "Whether there is a watch folder."},
    {ROW(PATH, "spool", "directory", spool.directory), .initial = "/var/spool/sheard",
     .max = CONFIG_PATH_MAX, .flag = "spool", .at_start = true,
     .help = "Directory with the folders incoming, active, done and failed, all on one file "
             "system. Only one daemon may use it."},
    {ROW(DURATION, "spool", "settle_time", spool.settle_time_ms), .initial = "5s", RANGE(0, HOUR),
     .help = "A file that the kernel did not announce (written on another machine of a network "
             "file system, or while the daemon was down) is taken once its size and times have "
             "stood still for this long."},
    {ROW(DURATION, "spool", "scan_interval", spool.scan_interval_ms), .initial = "1min",
     RANGE(SECOND, DAY),
     .help = "How often the folder is searched for files that the kernel did not announce."},
    {ROW(DURATION, "spool", "done_max_age", spool.done.max_age_ms), UNLIMITED(SECOND, 36500 * DAY),
     .help = "Files in done that are older are removed, with their reports. " KEPT_FOREVER},
    {ROW(INT, "spool", "done_max_count", spool.done.max_count),
     UNLIMITED(1, 1000000000), .unit = "files",
     .help = "The oldest files in done beyond this number are removed."},
    {ROW(BYTES, "spool", "done_max_bytes", spool.done.max_bytes), UNLIMITED(MiB, 1024 * 1024 * TiB),
     .help = "The oldest files in done are removed until the rest has at most this size."},
    {ROW(DURATION, "spool", "failed_max_age", spool.failed.max_age_ms),
     UNLIMITED(SECOND, 36500 * DAY), .help = "As done_max_age, for failed."},
    {ROW(INT, "spool", "failed_max_count", spool.failed.max_count),
     UNLIMITED(1, 1000000000), .unit = "files", .help = "As done_max_count, for failed."},
    {ROW(BYTES, "spool", "failed_max_bytes", spool.failed.max_bytes),
     UNLIMITED(MiB, 1024 * 1024 * TiB), .help = "As done_max_bytes, for failed."},

    {ROW(BOOL, "catalogues", "enabled", catalogs.enabled), .initial = "true",
     .help = "Whether catalogs are written."},
    {ROW(PATH, "catalogues", "directory", catalogs.directory),
     .initial = "/var/lib/sheard/catalogues", .max = CONFIG_PATH_MAX, .flag = "catalogues",
     .help = "Where they are written. A catalog appears under its name only when it is complete. "
             "The directory belongs to one state directory's database (.sheard-database in it "
             "says to which): with another one the service does not start, and a reload is "
             "refused. The unit sheard.service lets the daemon write nowhere but in its own "
             "directories: another one needs ReadWritePaths= in a drop-in."},

    {ROW(PATHS, "access", "data_roots", access.data_roots), .initial = "", .max = CONFIG_PATH_MAX,
     .flag = "data-roots",
     .help = "Clients may name files beneath these directories only. Empty: none, and files come "
             "only from the watch folder. A missing directory causes a warning, and jobs "
             "beneath it wait until it exists. Data under /home also needs the drop-in "
             "home-data.conf of sheard.service."},
    {ROW(NAMES, "access", "admin_users", access.admin_users), .initial = "root",
     .max = CONFIG_NAME_MAX,
     .help = "Users who may cancel and retry the jobs of others, reload, drain and shut down."},
    {ROW(NAMES, "access", "admin_groups", access.admin_groups), .initial = "",
     .max = CONFIG_NAME_MAX,
     .help = "Groups whose members may do so too."},
    {ROW(NAMES, "access", "submit_groups", access.submit_groups), .initial = "",
     .max = CONFIG_NAME_MAX,
     .help = "Groups whose members may submit jobs. Empty: everybody who may connect. "
             "Administrators always may."},
    {ROW(NAMES, "access", "priority_users", access.priority_users), .initial = "",
     .max = CONFIG_NAME_MAX,
     .help = "Users who may give their jobs a priority above 0, so that they run before those of "
             "others. Administrators always may."},
    {ROW(NAMES, "access", "priority_groups", access.priority_groups), .initial = "",
     .max = CONFIG_NAME_MAX,
     .help = "Groups whose members may do so too."},

    {ROW(INT, "limits", "queue", limits.queue), .initial = "100000", RANGE(1, 10000000),
     .unit = "jobs",
     .help = "Jobs that may wait. A submit beyond is refused with queue_full, and files stay in "
             "incoming."},
    {ROW(INT, "limits", "connections", limits.connections), .initial = "2048", RANGE(1, 100000),
     .unit = "connections",
     .help = "Clients that may be connected at once. Each needs a file descriptor (LimitNOFILE in "
             "sheard.service): if there are fewer descriptors, fewer clients are accepted."},
    {ROW(INT, "limits", "user_connections", limits.user_connections), .initial = "auto",
     RANGE(1, 100000), .word = "auto", .unit = "connections",
     .help = "Of these, those that one user may have, unless it is an administrator. auto: a "
             "quarter of them."},
    {ROW(INT, "limits", "admin_connections", limits.admin_connections), .initial = "16",
     RANGE(1, 1000), .unit = "connections",
     .help = "The last of these, which are kept for administrators: so they get in when everybody "
             "else has filled the service. At most a quarter of all."},
    {ROW(BYTES, "limits", "unsent_bytes", limits.unsent_bytes), .initial = "64M",
     RANGE(MiB, 64 * GiB),
     .help = "Memory for replies that clients have not read yet, half of it at most for one user. "
             "When it is used up, long replies wait, and clients that read nothing for 5 s are "
             "dropped."},
    {ROW(INT, "limits", "requests_in_flight", limits.requests_in_flight), .initial = "64",
     RANGE(1, 10000), .unit = "requests",
     .help = "Unanswered requests of one connection; beyond, it is not read from until some are "
             "answered."},
    {ROW(DURATION, "limits", "idle_timeout", limits.idle_timeout_ms), .initial = "10min",
     RANGE(SECOND, 7 * DAY), .word = "never",
     .help = "A connection is closed that has neither requests nor subscriptions, or stays in the "
             "middle of a message, for this long."},
    {ROW(DURATION, "limits", "wait_timeout", limits.wait_timeout_ms), .initial = "1h",
     RANGE(SECOND, 7 * DAY),
     .help = "A wait request is answered at the latest after this time, whatever it asks for."},
    {ROW(BYTES, "limits", "memory", limits.memory_bytes), .initial = "auto",
     RANGE(MiB, 1024 * TiB), .word = "auto",
     .help = "Memory that the jobs under way and the kept plans may take together. What a job "
             "needs is known before it starts; it waits until that much is free, and one that "
             "needs more than this is refused. auto: a quarter of the machine's memory, or of "
             "what the service's control groups (MemoryMax, MemoryHigh) and RLIMIT_AS leave it. "
             "What reader processes take besides is bounded by reader.memory."},

    {ROW(BYTES, "reader", "memory", reader.memory_bytes), .initial = "1G", RANGE(64 * MiB, TiB),
     .help = "Address space of the process, the shared memory included."},
    {ROW(DURATION, "reader", "cpu_time", reader.cpu_time_ms), .initial = "12h",
     RANGE(SECOND, 30 * DAY),
     .help = "Processor time for the whole of one file, from its hash to its last block, in whole "
             "seconds (rounded up)."},
    {ROW(DURATION, "reader", "wall_time", reader.wall_time_ms), .initial = "10min",
     RANGE(100, DAY),
     .help = "Time for one answer: opening (and unpacking) the file, the next 256M at most for "
             "its hash, or one block of stamps. Network file systems that hang for longer fail "
             "the job, which is then retried."},
    {ROW(BYTES, "reader", "shared_memory", reader.shared_memory_bytes), .initial = "128M",
     RANGE(MiB, 64 * GiB),
     .help = "Memory through which a reader hands over its blocks, for each active job. It must "
             "hold a block of 16 stamp pairs and their PSFs in double precision."},
    {ROW(BYTES, "reader", "max_file_bytes", reader.max_file_bytes), .initial = "256G",
     RANGE(MiB, 1024 * TiB),
     .help = "Larger files are refused by their size alone, unread: when they are submitted or "
             "dropped, and when their turn comes."},
    {ROW(PATH, "reader", "scratch", reader.scratch), .initial = "auto", .max = CONFIG_PATH_MAX,
     .word = "auto", .at_start = true,
     .help = "Directory whose disk holds the unpacked copies of gzipped files, as files without "
             "names. The last gibibyte of it, or eighth of a small disk, is left free. auto: "
             "$TMPDIR, /var/tmp or the state directory, the first in which a file can be made."},
    {ROW(BYTES, "reader", "unpacked", reader.unpacked_bytes), .initial = "64G",
     RANGE(MiB, 1024 * TiB),
     .help = "A gzipped file that unpacks to more is refused: its job fails, once."},
    {ROW(BYTES, "reader", "scratch_bytes", reader.scratch_bytes), .initial = "128G",
     RANGE(MiB, 1024 * TiB),
     .help = "What all unpacked copies may take together. A job that would take more is tried "
             "again later; one that would by itself is refused."},

    {ROW(INT, "plans", "max_count", plans.max_count), .initial = "64", RANGE(1, 100000),
     .word = "none", .unit = "plans",
     .help = "Plans that are kept beyond their jobs, those that were used last."},
    {ROW(BYTES, "plans", "max_bytes", plans.max_bytes), .initial = "256M", RANGE(MiB, TiB),
     .help = "Memory that they may take together. A plan for stamps of 64 x 64 px takes 32K, for "
             "ones of 32 x 32 px interpolated eightfold about 1M."},

    {ROW(DURATION, "retry", "first_delay", retry.first_delay_ms), .initial = "10s", RANGE(10, DAY),
     .help = "Time until the second attempt. It doubles with every further one."},
    {ROW(DURATION, "retry", "max_delay", retry.max_delay_ms), .initial = "1h", RANGE(10, 7 * DAY),
     .help = "Longest time between two attempts."},
    {ROW(INT, "retry", "attempts", retry.attempts), .initial = "20", RANGE(1, 1000),
     .unit = "attempts",
     .help = "A job fails for good after this many (with the default delays: after half a day). "
             "For a data root that is missing and for a full disk it waits, however long."},

    {ROW(DURATION, "retention", "jobs_max_age", retention.jobs_max_age_ms),
     UNLIMITED(SECOND, 36500 * DAY),
     .help = "Finished jobs that are older are forgotten. What they contributed to their fields "
             "stays, and the same input is still recognised."},
    {ROW(INT, "retention", "jobs_max_count", retention.jobs_max_count),
     UNLIMITED(1, 1000000000), .unit = "jobs",
     .help = "The oldest finished jobs beyond this number are forgotten."},
};
/* clang-format on */
const size_t config_n_rows = sizeof config_rows / sizeof config_rows[0];
