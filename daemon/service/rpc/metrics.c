/* SPDX-License-Identifier: GPL-3.0-or-later */
/* metrics: write the status as Prometheus text. */
#include "base/cleanup.h"
#include "service/core/parts.h"
#include "service/jobs/rpc_errors.h"
#include "service/rpc/methods.h"
#include "service/rpc/status.h"

#include <inttypes.h>

typedef struct metric {
    const char *name, *type, *help;
    double value;
} metric;

static void write_one(FILE *out, const metric *m) {
    fprintf(out, "# HELP sheard_%s %s\n# TYPE sheard_%s %s\nsheard_%s %.17g\n", m->name, m->help,
            m->name, m->type, m->name, m->value);
}

/* Write the header of a metric that has labels. */
static void begin(FILE *out, const char *name, const char *help) {
    fprintf(out, "# HELP sheard_%s %s\n# TYPE sheard_%s gauge\n", name, help, name);
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
        fprintf(out, "sheard_jobs{state=\"%s\"} %" PRId64 "\n", states[i].name, states[i].jobs);
}

static void write_numbers(FILE *out, const sheard_msg_status *s, const server_statistics *net) {
    const metric metrics[] = {
        {"uptime_seconds", "gauge", "Time since the start.", s->uptime_s},
        {"workers", "gauge", "Worker threads.", (double)s->workers.total},
        {"workers_busy", "gauge", "Worker threads at work.", (double)s->workers.busy},
        {"queue_capacity", "gauge", "Unfinished jobs that are taken at most.",
         (double)s->queue.capacity},
        {"blocks_left", "gauge", "Blocks of the running jobs that are not yet measured.",
         (double)s->queue.blocks},
        {"plans", "gauge", "Plans kept in memory.", (double)s->plans.kept},
        {"plans_bytes", "gauge", "Memory that the kept plans take.", (double)s->plans.bytes},
        {"memory_budget_bytes", "gauge", "Memory that jobs and plans may take together.",
         (double)s->memory.budget},
        {"memory_used_bytes", "gauge", "Memory that jobs and plans have reserved.",
         (double)s->memory.used},
        {"jobs_waiting_for_memory", "gauge", "Running jobs that wait for memory.",
         (double)s->memory.waiting},
        {"plan_hits_total", "counter", "Jobs that found their plan.", (double)s->plans.hits},
        {"plan_misses_total", "counter", "Jobs whose plan had to be made.",
         (double)s->plans.misses},
        {"jobs_submitted_total", "counter", "Jobs taken.", (double)s->totals.submitted},
        {"jobs_counted_total", "counter", "Jobs whose stamps count in a field.",
         (double)s->totals.counted},
        {"jobs_duplicate_total", "counter", "Jobs that were counted before.",
         (double)s->totals.duplicates},
        {"jobs_failed_total", "counter", "Jobs that failed for good.", (double)s->totals.failed},
        {"jobs_cancelled_total", "counter", "Jobs that were cancelled.",
         (double)s->totals.cancelled},
        {"contributions_retracted_total", "counter", "Contributions that were taken back.",
         (double)s->totals.retracted},
        {"stamps_total", "counter", "Stamps in counted jobs.", (double)s->totals.stamps},
        {"fields", "gauge", "Fields, each set of settings by itself.", (double)s->totals.fields},
        {"stamps_per_second", "gauge", "Stamps measured, mean of the last minute.",
         s->rates.stamps_per_s},
        {"loop_longest_seconds", "gauge",
         "Longest turn of the loop in the last minute, processor time.",
         1e-3 * s->loop.longest_minute_ms},
        {"unsent_bytes", "gauge", "Memory of replies and notifications that are not read.",
         (double)s->loop.unsent_bytes},
        {"clients_dropped_total", "counter", "Clients dropped because they did not read.",
         (double)s->loop.dropped},
        {"connections", "gauge", "Clients connected.", (double)net->connections},
        {"connections_accepted_total", "counter", "Clients since the start.",
         (double)net->accepted},
        {"bytes_in_total", "counter", "Bytes from clients.", (double)net->bytes_in},
        {"bytes_out_total", "counter", "Bytes to clients.", (double)net->bytes_out},
        {"store_commits_total", "counter", "Commits since the start.", (double)s->store.commits},
        {"store_bytes", "gauge", "Size of the database.", (double)s->store.bytes},
        {"store_free_bytes", "gauge", "Free space beside the database.",
         (double)s->store.free_bytes},
        {"log_lines_lost_total", "counter", "Lines of the log that nobody read in time.",
         (double)s->log.lost},
        {"incoming_ignored", "gauge", "Files that are left lying in incoming/.",
         (double)s->spool.ignored},
    };
    for (size_t i = 0; i < sizeof metrics / sizeof metrics[0]; i++)
        write_one(out, &metrics[i]);
}

/* Codes and uses are the service's own names and need no escaping. */
static void write_problems(FILE *out, const problem_list *list) {
    write_one(out,
              &(metric){"problems", "gauge", "What an operator should look at.", (double)list->n});
    begin(out, "waiting_jobs", "Jobs that wait for their next attempt, by reason.");
    for (size_t i = 0; i < list->n_waiting; i++) {
        fprintf(out, "sheard_waiting_jobs{reason=\"%s\"} %" PRId64 "\n", list->waiting[i].code,
                list->waiting[i].jobs);
    }
    begin(out, "waiting_jobs_attempts", "Attempts of the waiting job with the most.");
    for (size_t i = 0; i < list->n_waiting; i++) {
        fprintf(out, "sheard_waiting_jobs_attempts{reason=\"%s\"} %" PRId64 "\n",
                list->waiting[i].code, list->waiting[i].attempts);
    }
    begin(out, "next_attempt_seconds", "When the first of them is tried again, since 1970.");
    for (size_t i = 0; i < list->n_waiting; i++) {
        fprintf(out, "sheard_next_attempt_seconds{reason=\"%s\"} %.3f\n", list->waiting[i].code,
                1e-3 * (double)list->waiting[i].next_ms);
    }
    begin(out, "disk_free_bytes", "Free space where the service writes.");
    for (size_t i = 0; i < list->n_disks; i++) {
        fprintf(out, "sheard_disk_free_bytes{use=\"%s\"} %" PRId64 "\n", list->disks[i].use,
                list->disks[i].free_bytes);
    }
    begin(out, "disk_usable", "Whether the service can write there.");
    for (size_t i = 0; i < list->n_disks; i++) {
        fprintf(out, "sheard_disk_usable{use=\"%s\"} %d\n", list->disks[i].use,
                list->disks[i].problem == NULL);
    }
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
