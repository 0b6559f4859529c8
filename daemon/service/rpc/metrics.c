/* SPDX-License-Identifier: GPL-3.0-or-later */
/* metrics: write the status as Prometheus text. */
#include "base/cleanup.h"
#include "base/text.h"
#include "service/core/parts.h"
#include "service/jobs/rpc_errors.h"
#include "service/rpc/methods.h"
#include "service/rpc/status.h"

#include <inttypes.h>

typedef struct metric {
    const char *name, *help;
    double value;
} metric;
#define METRIC(name, help, value)                                                                  \
    { name, help, (double)(value) }

/* Write the header of a metric. Counters, and only these, have names that end in "_total". */
static void begin(FILE *out, const char *name, const char *help) {
    fprintf(out, "# HELP sheard_%s %s\n# TYPE sheard_%s %s\n", name, help, name,
            text_ends_with(name, "_total") ? "counter" : "gauge");
}

static void write_one(FILE *out, const metric *m) {
    begin(out, m->name, m->help);
    fprintf(out, "sheard_%s %.17g\n", m->name, m->value);
}

/* Write one value of a metric that has several. Labels' values are the service's own names and need
 * no escaping. */
static void write_value(FILE *out, const char *name, const char *label, const char *of, int64_t n) {
    fprintf(out, "sheard_%s{%s=\"%s\"} %" PRId64 "\n", name, label, of, n);
}

static void write_states(FILE *out, const sheard_msg_status *s) {
    const struct {
        const char *name;
        int64_t jobs;
    } states[] = {{"queued", s->states.queued},      {"running", s->states.running},
                  {"waiting", s->states.waiting},    {"done", s->states.done},
                  {"failed", s->states.failed},      {"cancelled", s->states.cancelled},
                  {"retracted", s->states.retracted}};
    begin(out, "jobs", "Kept jobs by state.");
    for (size_t i = 0; i < sizeof states / sizeof states[0]; i++)
        write_value(out, "jobs", "state", states[i].name, states[i].jobs);
}

static void write_numbers(FILE *out, const sheard_msg_status *s, const server_statistics *net) {
    const metric metrics[] = {
        METRIC("uptime_seconds", "Time since the start.", s->uptime_s),
        METRIC("workers", "Worker threads.", s->workers.total),
        METRIC("workers_busy", "Worker threads at work.", s->workers.busy),
        METRIC("queue_capacity", "Unfinished jobs that are taken at most.", s->queue.capacity),
        METRIC("blocks_left", "Blocks of the running jobs that are not yet measured.",
               s->queue.blocks),
        METRIC("plans", "Plans kept in memory.", s->plans.kept),
        METRIC("plans_bytes", "Memory that the kept plans take.", s->plans.bytes),
        METRIC("memory_budget_bytes", "Memory that jobs and plans may take together.",
               s->memory.budget),
        METRIC("memory_used_bytes", "Memory that jobs and plans have reserved.", s->memory.used),
        METRIC("jobs_waiting_for_memory", "Running jobs that wait for memory.", s->memory.waiting),
        METRIC("plan_hits_total", "Jobs that found their plan.", s->plans.hits),
        METRIC("plan_misses_total", "Jobs whose plan had to be made.", s->plans.misses),
        METRIC("jobs_submitted_total", "Jobs taken.", s->totals.submitted),
        METRIC("jobs_counted_total", "Jobs whose stamps count in a field.", s->totals.counted),
        METRIC("jobs_duplicate_total", "Jobs that were counted before.", s->totals.duplicates),
        METRIC("jobs_failed_total", "Jobs that failed for good.", s->totals.failed),
        METRIC("jobs_cancelled_total", "Jobs that were cancelled.", s->totals.cancelled),
        METRIC("contributions_retracted_total", "Contributions that were taken back.",
               s->totals.retracted),
        METRIC("stamps_total", "Stamps in counted jobs.", s->totals.stamps),
        METRIC("fields", "Fields, each set of settings by itself.", s->totals.fields),
        METRIC("stamps_per_second", "Stamps measured, mean of the last minute.",
               s->rates.stamps_per_s),
        METRIC("loop_longest_seconds",
               "Longest turn of the loop in the last minute, processor time.",
               1e-3 * s->loop.longest_minute_ms),
        METRIC("unsent_bytes", "Memory of replies and notifications that are not read.",
               s->loop.unsent_bytes),
        METRIC("clients_dropped_total", "Clients dropped because they did not read.",
               s->loop.dropped),
        METRIC("connections", "Clients connected.", net->connections),
        METRIC("connections_accepted_total", "Clients since the start.", net->accepted),
        METRIC("bytes_in_total", "Bytes from clients.", net->bytes_in),
        METRIC("bytes_out_total", "Bytes to clients.", net->bytes_out),
        METRIC("store_commits_total", "Commits since the start.", s->store.commits),
        METRIC("store_bytes", "Size of the database.", s->store.bytes),
        METRIC("store_free_bytes", "Free space beside the database.", s->store.free_bytes),
        METRIC("log_lines_lost_total", "Lines of the log that nobody read in time.", s->log.lost),
        METRIC("incoming_ignored", "Files that are left lying in incoming/.", s->spool.ignored),
    };
    for (size_t i = 0; i < sizeof metrics / sizeof metrics[0]; i++)
        write_one(out, &metrics[i]);
}

static void write_problems(FILE *out, const problem_list *list) {
    const store_waiting *waiting = list->waiting;
    const sheard_msg_disk *disks = list->disks;
    const metric problems = METRIC("problems", "What an operator should look at.", list->n);
    write_one(out, &problems);
    begin(out, "waiting_jobs", "Jobs that wait for their next attempt, by reason.");
    for (size_t i = 0; i < list->n_waiting; i++)
        write_value(out, "waiting_jobs", "reason", waiting[i].code, waiting[i].jobs);
    begin(out, "waiting_jobs_attempts", "Attempts of the waiting job with the most.");
    for (size_t i = 0; i < list->n_waiting; i++)
        write_value(out, "waiting_jobs_attempts", "reason", waiting[i].code, waiting[i].attempts);
    begin(out, "next_attempt_seconds", "When the first of them is tried again, since 1970.");
    for (size_t i = 0; i < list->n_waiting; i++) {
        fprintf(out, "sheard_next_attempt_seconds{reason=\"%s\"} %.3f\n", waiting[i].code,
                1e-3 * (double)waiting[i].next_ms);
    }
    begin(out, "disk_free_bytes", "Free space where the service writes.");
    for (size_t i = 0; i < list->n_disks; i++)
        write_value(out, "disk_free_bytes", "use", disks[i].use, disks[i].free_bytes);
    begin(out, "disk_usable", "Whether the service can write there.");
    for (size_t i = 0; i < list->n_disks; i++)
        write_value(out, "disk_usable", "use", disks[i].use, disks[i].problem == NULL);
}

static void write_all(FILE *out, const status *st) {
    write_states(out, &st->message);
    write_numbers(out, &st->message, &st->net);
    write_problems(out, &st->problems);
}

int method_metrics(service *s, const server_request *r, sheard_rpc_error *error) {
    CLEANUP(release_free) status *st = NULL;
    CLEANUP(release_free) char *text = NULL;
    shear_error err = {0};
    size_t size = 0;
    TRY(rpc_error_from_store(error, status_new(&st, s, &err), &err));
    FILE *out = open_memstream(&text, &size);
    if (out != NULL)
        write_all(out, st);
    if (out == NULL || fclose(out) != 0) {
        return sheard_rpc_fail(error, SHEARD_RPC_OUT_OF_MEMORY, NULL,
                               "out of memory for the metrics");
    }
    const sheard_reply reply = {
        .metrics = {.content_type = "text/plain; version=0.0.4; charset=utf-8", .text = text}};
    server_reply(s->server, r->handle, &reply);
    return SHEARD_RPC_OK;
}
