/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The service itself: greeting, status, and what administrators ask for. */
#include "message/table.h"

static const msg_member limits_members[] = {
    MSG_COUNT_(sheard_msg_limits, line_bytes, 0),  MSG_COUNT_(sheard_msg_limits, depth, 0),
    MSG_COUNT_(sheard_msg_limits, values, 0),      MSG_COUNT_(sheard_msg_limits, list, 0),
    MSG_COUNT_(sheard_msg_limits, jobs_page, 0),   MSG_COUNT_(sheard_msg_limits, fields_page, 0),
    MSG_COUNT_(sheard_msg_limits, connections, 0), MSG_COUNT_(sheard_msg_limits, in_flight, 0),
    MSG_COUNT_(sheard_msg_limits, idle_s, 0),      MSG_COUNT_(sheard_msg_limits, queue, 0),
};
const msg_table msg_limits = {MSG_TABLE_(sheard_msg_limits, limits_members), .check = NULL};

static const msg_member welcome_members[] = {
    MSG_COUNT_(sheard_msg_welcome, protocol, MSG_REQUIRED),
    MSG_COUNT_(sheard_msg_welcome, oldest, 0),
    MSG_COUNT_(sheard_msg_welcome, newest, 0),
    MSG_SAID_(sheard_msg_welcome, server, 0),
    MSG_COUNT_(sheard_msg_welcome, uid, 0),
    MSG_BOOL_(sheard_msg_welcome, admin, 0),
    MSG_TEXTS_(sheard_msg_welcome, methods, 0, 0, 0),
    MSG_OBJECT_(sheard_msg_welcome, limits, "limits", sheard_msg_limits, &msg_limits, 0),
};
const msg_table msg_welcome = {MSG_TABLE_(sheard_msg_welcome, welcome_members), .check = NULL};

static const msg_member subscribed_members[] = {
    MSG_COUNT_(sheard_msg_subscribed, jobs, 0),
    MSG_COUNT_(sheard_msg_subscribed, fields, 0),
    MSG_BOOL_(sheard_msg_subscribed, all, 0),
};
const msg_table msg_subscribed = {MSG_TABLE_(sheard_msg_subscribed, subscribed_members),
                                  .check = NULL};

static const msg_member plans_members[] = {
    MSG_COUNT_(sheard_msg_plans, kept, 0),
    MSG_COUNT_(sheard_msg_plans, bytes, 0),
    MSG_COUNT_(sheard_msg_plans, hits, 0),
    MSG_COUNT_(sheard_msg_plans, misses, 0),
};
static const msg_table plans = {MSG_TABLE_(sheard_msg_plans, plans_members), .check = NULL};

static const msg_member memory_members[] = {
    MSG_COUNT_(sheard_msg_memory, budget, 0),
    MSG_COUNT_(sheard_msg_memory, used, 0),
    MSG_COUNT_(sheard_msg_memory, waiting, 0),
};
static const msg_table memory = {MSG_TABLE_(sheard_msg_memory, memory_members), .check = NULL};

static const msg_member states_members[] = {
    MSG_COUNT_(sheard_msg_states, queued, 0),    MSG_COUNT_(sheard_msg_states, running, 0),
    MSG_COUNT_(sheard_msg_states, waiting, 0),   MSG_COUNT_(sheard_msg_states, done, 0),
    MSG_COUNT_(sheard_msg_states, failed, 0),    MSG_COUNT_(sheard_msg_states, cancelled, 0),
    MSG_COUNT_(sheard_msg_states, retracted, 0),
};
static const msg_table states = {MSG_TABLE_(sheard_msg_states, states_members), .check = NULL};

static const msg_member totals_members[] = {
    MSG_COUNT_(sheard_msg_totals, submitted, 0),  MSG_COUNT_(sheard_msg_totals, counted, 0),
    MSG_COUNT_(sheard_msg_totals, duplicates, 0), MSG_COUNT_(sheard_msg_totals, failed, 0),
    MSG_COUNT_(sheard_msg_totals, cancelled, 0),  MSG_COUNT_(sheard_msg_totals, stamps, 0),
    MSG_COUNT_(sheard_msg_totals, fields, 0),     MSG_COUNT_(sheard_msg_totals, retracted, 0),
};
static const msg_table totals = {MSG_TABLE_(sheard_msg_totals, totals_members), .check = NULL};

static const msg_member rates_members[] = {
    MSG_REAL_(sheard_msg_rates, stamps_per_s, 0, 0),
    MSG_REAL_(sheard_msg_rates, jobs_per_s, 0, 0),
};
static const msg_table rates = {MSG_TABLE_(sheard_msg_rates, rates_members), .check = NULL};

static const msg_member loop_members[] = {
    MSG_REAL_(sheard_msg_loop, longest_ms, 0, 0),
    MSG_REAL_(sheard_msg_loop, longest_minute_ms, 0, 0),
    MSG_COUNT_(sheard_msg_loop, unsent_bytes, 0),
    MSG_COUNT_(sheard_msg_loop, dropped, 0),
};
static const msg_table loop = {MSG_TABLE_(sheard_msg_loop, loop_members), .check = NULL};

static const msg_member workers_members[] = {
    MSG_COUNT_(sheard_msg_workers, total, 0),
    MSG_COUNT_(sheard_msg_workers, busy, 0),
    MSG_COUNT_(sheard_msg_workers, readers, 0),
};
static const msg_table workers = {MSG_TABLE_(sheard_msg_workers, workers_members), .check = NULL};

static const msg_member queue_members[] = {
    MSG_COUNT_(sheard_msg_queue, length, 0),
    MSG_COUNT_(sheard_msg_queue, capacity, 0),
    MSG_COUNT_(sheard_msg_queue, blocks, 0),
};
static const msg_table queue = {MSG_TABLE_(sheard_msg_queue, queue_members), .check = NULL};

static const msg_member ignored_members[] = {
    MSG_SAID_(sheard_msg_ignored, name, 0),
    MSG_SAID_(sheard_msg_ignored, reason, 0),
};
static const msg_table ignored = {MSG_TABLE_(sheard_msg_ignored, ignored_members), .check = NULL};

static const msg_member log_members[] = {
    MSG_COUNT_(sheard_msg_log, lost, 0),
    MSG_COUNT_(sheard_msg_log, waiting_bytes, 0),
};
static const msg_table log_table = {MSG_TABLE_(sheard_msg_log, log_members), .check = NULL};

static const msg_member disk_members[] = {
    MSG_SAID_(sheard_msg_disk, use, 0),         MSG_SAID_(sheard_msg_disk, path, 0),
    MSG_COUNT_(sheard_msg_disk, free_bytes, 0), MSG_COUNT_(sheard_msg_disk, bytes, 0),
    MSG_SAID_(sheard_msg_disk, same_as, 0),     MSG_SAID_(sheard_msg_disk, problem, 0),
};
static const msg_table disk = {MSG_TABLE_(sheard_msg_disk, disk_members), .check = NULL};

static const msg_member problem_members[] = {
    MSG_SAID_(sheard_msg_problem, about, 0),
    MSG_SAID_(sheard_msg_problem, code, 0),
    MSG_SAID_(sheard_msg_problem, message, 0),
    MSG_TIME_(sheard_msg_problem, since_ms, "since"),
    MSG_COUNT_(sheard_msg_problem, count, 0),
    MSG_COUNT_(sheard_msg_problem, attempts, 0),
    MSG_TIME_(sheard_msg_problem, next_attempt_ms, "next_attempt"),
};
static const msg_table problem = {MSG_TABLE_(sheard_msg_problem, problem_members), .check = NULL};

static const msg_member spool_members[] = {
    MSG_SAID_(sheard_msg_spool, path, 0),
    MSG_BOOL_(sheard_msg_spool, watching, 0),
    MSG_COUNT_(sheard_msg_spool, incoming, 0),
    MSG_COUNT_(sheard_msg_spool, active, 0),
    MSG_COUNT_(sheard_msg_spool, done, 0),
    MSG_COUNT_(sheard_msg_spool, failed, 0),
    MSG_COUNT_(sheard_msg_spool, free_bytes, 0),
    MSG_COUNT_(sheard_msg_spool, ignored, 0),
    MSG_OBJECTS_(sheard_msg_spool, left_lying, sheard_msg_ignored, &ignored),
};
static const msg_table spool = {MSG_TABLE_(sheard_msg_spool, spool_members), .check = NULL};

static const msg_member store_members[] = {
    MSG_SAID_(sheard_msg_store, path, 0),     MSG_COUNT_(sheard_msg_store, schema, 0),
    MSG_COUNT_(sheard_msg_store, bytes, 0),   MSG_COUNT_(sheard_msg_store, free_bytes, 0),
    MSG_COUNT_(sheard_msg_store, commits, 0),
};
static const msg_table store = {MSG_TABLE_(sheard_msg_store, store_members), .check = NULL};

static const msg_member root_members[] = {
    MSG_SAID_(sheard_msg_root, path, MSG_REQUIRED),
    MSG_BOOL_(sheard_msg_root, missing, 0),
    MSG_SAID_(sheard_msg_root, reason, 0),
};
static const msg_table root = {MSG_TABLE_(sheard_msg_root, root_members), .check = NULL};

static const msg_member status_members[] = {
    MSG_SAID_(sheard_msg_status, version, MSG_REQUIRED),
    MSG_COUNT_(sheard_msg_status, protocol, 0),
    MSG_COUNT_(sheard_msg_status, pid, 0),
    MSG_NAME_(sheard_msg_status, state, "state", msg_server_states, MSG_REQUIRED),
    MSG_TIME_(sheard_msg_status, started_ms, "started"),
    MSG_REAL_(sheard_msg_status, uptime_s, 0, 0),
    MSG_COUNT_(sheard_msg_status, connections, 0),
    MSG_COUNT_(sheard_msg_status, subscribers, 0),
    MSG_OBJECT_(sheard_msg_status, workers, "workers", sheard_msg_workers, &workers, 0),
    MSG_OBJECT_(sheard_msg_status, queue, "queue", sheard_msg_queue, &queue, 0),
    MSG_OBJECT_(sheard_msg_status, plans, "plans", sheard_msg_plans, &plans, 0),
    MSG_OBJECT_(sheard_msg_status, memory, "memory", sheard_msg_memory, &memory, 0),
    MSG_OBJECT_(sheard_msg_status, states, "states", sheard_msg_states, &states, 0),
    MSG_OBJECT_(sheard_msg_status, totals, "totals", sheard_msg_totals, &totals, 0),
    MSG_OBJECT_(sheard_msg_status, rates, "rates", sheard_msg_rates, &rates, 0),
    MSG_OBJECT_(sheard_msg_status, loop, "loop", sheard_msg_loop, &loop, 0),
    MSG_OBJECT_(sheard_msg_status, spool, "spool", sheard_msg_spool, &spool, MSG_NULLABLE),
    MSG_OBJECT_(sheard_msg_status, store, "store", sheard_msg_store, &store, 0),
    MSG_SAID_(sheard_msg_status, config, 0),
    MSG_SAID_(sheard_msg_status, state_dir, 0),
    MSG_TEXT_(sheard_msg_status, catalogs, "catalogues", 0, 0),
    MSG_SAID_(sheard_msg_status, user, 0),
    MSG_BOOL_(sheard_msg_status, activated, 0),
    MSG_OBJECTS_(sheard_msg_status, roots, sheard_msg_root, &root),
    MSG_OBJECT_(sheard_msg_status, limits, "limits", sheard_msg_limits, &msg_limits, 0),
    MSG_TEXTS_(sheard_msg_status, problems, 0, 0, 0),
    MSG_OBJECTS_(sheard_msg_status, problem_details, sheard_msg_problem, &problem),
    MSG_OBJECTS_(sheard_msg_status, disks, sheard_msg_disk, &disk),
    MSG_OBJECT_(sheard_msg_status, log, "log", sheard_msg_log, &log_table, 0),
};
const msg_table msg_status = {MSG_TABLE_(sheard_msg_status, status_members), .check = NULL};

static const msg_member metrics_members[] = {
    MSG_SAID_(sheard_msg_metrics, content_type, 0),
    MSG_SAID_(sheard_msg_metrics, text, MSG_REQUIRED),
};
const msg_table msg_metrics = {MSG_TABLE_(sheard_msg_metrics, metrics_members), .check = NULL};

static const msg_member probed_members[] = {
    MSG_BOOL_(sheard_msg_probed, ok, MSG_REQUIRED), MSG_SAID_(sheard_msg_probed, code, 0),
    MSG_SAID_(sheard_msg_probed, message, 0),       MSG_SAID_(sheard_msg_probed, advice, 0),
    MSG_REAL_(sheard_msg_probed, g1, 0, 0),         MSG_REAL_(sheard_msg_probed, g1_err, 0, 0),
    MSG_REAL_(sheard_msg_probed, g2, 0, 0),         MSG_REAL_(sheard_msg_probed, g2_err, 0, 0),
    MSG_REAL_(sheard_msg_probed, true_g1, 0, 0),    MSG_REAL_(sheard_msg_probed, true_g2, 0, 0),
    MSG_COUNT_(sheard_msg_probed, stamps, 0),       MSG_REAL_(sheard_msg_probed, seconds, 0, 0),
    MSG_BOOL_(sheard_msg_probed, landlock, 0),      MSG_BOOL_(sheard_msg_probed, namespaces, 0),
};
const msg_table msg_probed = {MSG_TABLE_(sheard_msg_probed, probed_members), .check = NULL};

static const msg_member reloaded_members[] = {
    MSG_TEXTS_(sheard_msg_reloaded, changed, 0, 0, 0),
    MSG_TEXTS_(sheard_msg_reloaded, restart, 0, 0, 0),
    MSG_TEXTS_(sheard_msg_reloaded, warnings, 0, 0, 0),
};
const msg_table msg_reloaded = {MSG_TABLE_(sheard_msg_reloaded, reloaded_members), .check = NULL};

static const msg_member stopping_members[] = {
    MSG_NAME_(sheard_msg_stopping, state, "state", msg_server_states, MSG_REQUIRED),
    MSG_COUNT_(sheard_msg_stopping, running, 0),
    MSG_COUNT_(sheard_msg_stopping, queued, 0),
};
const msg_table msg_stopping = {MSG_TABLE_(sheard_msg_stopping, stopping_members), .check = NULL};

static const msg_member lost_members[] = {
    MSG_COUNT_(sheard_msg_lost, count, MSG_REQUIRED),
};
const msg_table msg_lost = {MSG_TABLE_(sheard_msg_lost, lost_members), .check = NULL};
