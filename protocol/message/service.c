/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The service itself: greeting, status, and what administrators ask for. */
#include "message/table.h"

static const msg_member limits_members[] = {
    MSG(limits, line_bytes),  MSG(limits, depth),     MSG(limits, values),
    MSG(limits, list),        MSG(limits, jobs_page), MSG(limits, fields_page),
    MSG(limits, connections), MSG(limits, in_flight), MSG(limits, idle_s),
    MSG(limits, queue),
};
MSG_TABLE(limits, NULL);

static const msg_member welcome_members[] = {
    MSG_NEEDED(welcome, protocol),
    MSG(welcome, oldest),
    MSG(welcome, newest),
    MSG(welcome, server),
    MSG(welcome, uid),
    MSG(welcome, admin),
    MSG_STRINGS(welcome, methods, 0, 0, 0),
    MSG_STRUCT(welcome, limits, limits, 0),
};
MSG_TABLE(welcome, NULL);

static const msg_member subscribed_members[] = {MSG(subscribed, jobs), MSG(subscribed, fields),
                                                MSG(subscribed, all)};
MSG_TABLE(subscribed, NULL);

/* ---- The parts of the status ---- */

static const msg_member plans_members[] = {MSG(plans, kept), MSG(plans, bytes), MSG(plans, hits),
                                           MSG(plans, misses)};
static MSG_TABLE(plans, NULL);

static const msg_member memory_members[] = {MSG(memory, budget), MSG(memory, used),
                                            MSG(memory, waiting)};
static MSG_TABLE(memory, NULL);

static const msg_member states_members[] = {
    MSG(states, queued), MSG(states, running),   MSG(states, waiting),   MSG(states, done),
    MSG(states, failed), MSG(states, cancelled), MSG(states, retracted),
};
static MSG_TABLE(states, NULL);

static const msg_member totals_members[] = {
    MSG(totals, submitted), MSG(totals, counted), MSG(totals, duplicates), MSG(totals, failed),
    MSG(totals, cancelled), MSG(totals, stamps),  MSG(totals, fields),     MSG(totals, retracted),
};
static MSG_TABLE(totals, NULL);

static const msg_member rates_members[] = {MSG(rates, stamps_per_s), MSG(rates, jobs_per_s)};
static MSG_TABLE(rates, NULL);

static const msg_member loop_members[] = {MSG(loop, longest_ms), MSG(loop, longest_minute_ms),
                                          MSG(loop, unsent_bytes), MSG(loop, dropped)};
static MSG_TABLE(loop, NULL);

static const msg_member workers_members[] = {MSG(workers, total), MSG(workers, busy),
                                             MSG(workers, readers)};
static MSG_TABLE(workers, NULL);

static const msg_member queue_members[] = {MSG(queue, length), MSG(queue, capacity),
                                           MSG(queue, blocks)};
static MSG_TABLE(queue, NULL);

static const msg_member ignored_members[] = {MSG(ignored, name), MSG(ignored, reason)};
static MSG_TABLE(ignored, NULL);

static const msg_member log_members[] = {MSG(log, lost), MSG(log, waiting_bytes)};
static MSG_TABLE(log, NULL);

static const msg_member disk_members[] = {MSG(disk, use),        MSG(disk, path),
                                          MSG(disk, free_bytes), MSG(disk, bytes),
                                          MSG(disk, same_as),    MSG(disk, problem)};
static MSG_TABLE(disk, NULL);

static const msg_member problem_members[] = {
    MSG(problem, about),
    MSG(problem, code),
    MSG(problem, message),
    MSG_WHEN(problem, since),
    MSG(problem, count),
    MSG(problem, attempts),
    MSG_WHEN(problem, next_attempt),
};
static MSG_TABLE(problem, NULL);

static const msg_member spool_members[] = {
    MSG(spool, path),       MSG(spool, watching), MSG(spool, incoming),
    MSG(spool, active),     MSG(spool, done),     MSG(spool, failed),
    MSG(spool, free_bytes), MSG(spool, ignored),  MSG_LISTED(spool, left_lying, ignored),
};
static MSG_TABLE(spool, NULL);

static const msg_member store_members[] = {MSG(store, path), MSG(store, schema), MSG(store, bytes),
                                           MSG(store, free_bytes), MSG(store, commits)};
static MSG_TABLE(store, NULL);

static const msg_member root_members[] = {MSG_NEEDED(root, path), MSG(root, missing),
                                          MSG(root, reason)};
static MSG_TABLE(root, NULL);

static const msg_member status_members[] = {
    MSG_NEEDED(status, version),
    MSG(status, protocol),
    MSG(status, pid),
    MSG_NAMED(status, state, "state", msg_server_states, MSG_REQUIRED),
    MSG_WHEN(status, started),
    MSG(status, uptime_s),
    MSG(status, connections),
    MSG(status, subscribers),
    MSG_STRUCT(status, workers, workers, 0),
    MSG_STRUCT(status, queue, queue, 0),
    MSG_STRUCT(status, plans, plans, 0),
    MSG_STRUCT(status, memory, memory, 0),
    MSG_STRUCT(status, states, states, 0),
    MSG_STRUCT(status, totals, totals, 0),
    MSG_STRUCT(status, rates, rates, 0),
    MSG_STRUCT(status, loop, loop, 0),
    MSG_STRUCT(status, spool, spool, MSG_NULLABLE),
    MSG_STRUCT(status, store, store, 0),
    MSG(status, config),
    MSG(status, state_dir),
    MSG_STRING_AS(status, catalogs, "catalogues", 0, 0),
    MSG(status, user),
    MSG(status, activated),
    MSG_LISTED(status, roots, root),
    MSG_STRUCT(status, limits, limits, 0),
    MSG_STRINGS(status, problems, 0, 0, 0),
    MSG_LISTED(status, problem_details, problem),
    MSG_LISTED(status, disks, disk),
    MSG_STRUCT(status, log, log, 0),
};
MSG_TABLE(status, NULL);

/* ---- Other replies ---- */

static const msg_member metrics_members[] = {MSG(metrics, content_type), MSG_NEEDED(metrics, text)};
MSG_TABLE(metrics, NULL);

static const msg_member probed_members[] = {
    MSG_NEEDED(probed, ok), MSG(probed, code),       MSG(probed, message), MSG(probed, advice),
    MSG(probed, g1),        MSG(probed, g1_err),     MSG(probed, g2),      MSG(probed, g2_err),
    MSG(probed, true_g1),   MSG(probed, true_g2),    MSG(probed, stamps),  MSG(probed, seconds),
    MSG(probed, landlock),  MSG(probed, namespaces),
};
MSG_TABLE(probed, NULL);

static const msg_member reloaded_members[] = {MSG_STRINGS(reloaded, changed, 0, 0, 0),
                                              MSG_STRINGS(reloaded, restart, 0, 0, 0),
                                              MSG_STRINGS(reloaded, warnings, 0, 0, 0)};
MSG_TABLE(reloaded, NULL);

static const msg_member stopping_members[] = {
    MSG_NAMED(stopping, state, "state", msg_server_states, MSG_REQUIRED), MSG(stopping, running),
    MSG(stopping, queued)};
MSG_TABLE(stopping, NULL);

static const msg_member lost_members[] = {MSG_NEEDED(lost, count)};
MSG_TABLE(lost, NULL);
