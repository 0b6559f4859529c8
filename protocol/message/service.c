/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tables of the messages about the service: greeting, status, and administrators' methods. */
#include "message/table.h"

MSG_WHOLE(limits, MSG(limits, line_bytes), MSG(limits, depth), MSG(limits, values),
          MSG(limits, list), MSG(limits, jobs_page), MSG(limits, fields_page),
          MSG(limits, connections), MSG(limits, in_flight), MSG(limits, idle_s),
          MSG(limits, queue));

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

MSG_WHOLE(subscribed, MSG(subscribed, jobs), MSG(subscribed, fields), MSG(subscribed, all));

/* ---- Parts of the status ---- */

MSG_PART(plans, MSG(plans, kept), MSG(plans, bytes), MSG(plans, hits), MSG(plans, misses));

MSG_PART(memory, MSG(memory, budget), MSG(memory, used), MSG(memory, waiting));

MSG_PART(states, MSG(states, queued), MSG(states, running), MSG(states, waiting), MSG(states, done),
         MSG(states, failed), MSG(states, cancelled), MSG(states, retracted));

MSG_PART(totals, MSG(totals, submitted), MSG(totals, counted), MSG(totals, duplicates),
         MSG(totals, failed), MSG(totals, cancelled), MSG(totals, stamps), MSG(totals, fields),
         MSG(totals, retracted));

MSG_PART(rates, MSG(rates, stamps_per_s), MSG(rates, jobs_per_s));

MSG_PART(loop, MSG(loop, longest_ms), MSG(loop, longest_minute_ms), MSG(loop, unsent_bytes),
         MSG(loop, dropped));

MSG_PART(workers, MSG(workers, total), MSG(workers, busy), MSG(workers, readers));

MSG_PART(queue, MSG(queue, length), MSG(queue, capacity), MSG(queue, blocks));

MSG_PART(ignored, MSG(ignored, name), MSG(ignored, reason));

MSG_PART(log, MSG(log, lost), MSG(log, waiting_bytes));

MSG_PART(disk, MSG(disk, use), MSG(disk, path), MSG(disk, free_bytes), MSG(disk, bytes),
         MSG(disk, same_as), MSG(disk, problem));

MSG_PART(problem, MSG(problem, about), MSG(problem, code), MSG(problem, message),
         MSG_WHEN(problem, since), MSG(problem, count), MSG(problem, attempts),
         MSG_WHEN(problem, next_attempt));

static const msg_member spool_members[] = {
    MSG(spool, path),       MSG(spool, watching), MSG(spool, incoming),
    MSG(spool, active),     MSG(spool, done),     MSG(spool, failed),
    MSG(spool, free_bytes), MSG(spool, ignored),  MSG_LISTED(spool, left_lying, ignored),
};
static MSG_TABLE(spool, NULL);

MSG_PART(store, MSG(store, path), MSG(store, schema), MSG(store, bytes), MSG(store, free_bytes),
         MSG(store, commits));

MSG_PART(root, MSG_NEEDED(root, path), MSG(root, missing), MSG(root, reason));

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

MSG_WHOLE(metrics, MSG(metrics, content_type), MSG_NEEDED(metrics, text));

MSG_WHOLE(probed, MSG_NEEDED(probed, ok), MSG(probed, code), MSG(probed, message),
          MSG(probed, advice), MSG(probed, g1), MSG(probed, g1_err), MSG(probed, g2),
          MSG(probed, g2_err), MSG(probed, true_g1), MSG(probed, true_g2), MSG(probed, stamps),
          MSG(probed, seconds), MSG(probed, landlock), MSG(probed, namespaces));

MSG_WHOLE(reloaded, MSG_STRINGS(reloaded, changed, 0, 0, 0),
          MSG_STRINGS(reloaded, restart, 0, 0, 0), MSG_STRINGS(reloaded, warnings, 0, 0, 0));

MSG_WHOLE(stopping, MSG_NAMED(stopping, state, "state", msg_server_states, MSG_REQUIRED),
          MSG(stopping, running), MSG(stopping, queued));

MSG_WHOLE(lost, MSG_NEEDED(lost, count));
