/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "remote/status_text.h"

#include "remote/job_text.h"

#include "base/clock.h"
#include "base/text.h"
#include "terminal/human.h"
#include "terminal/message.h"
#include "terminal/style.h"
#include "terminal/text_line.h"

#include <inttypes.h>

static void print_states(const sheard_msg_status *s, bool colours, FILE *out) {
    const int64_t counts[SHEARD_N_JOB_STATES] = {
        s->states.queued, s->states.running,   s->states.waiting,  s->states.done,
        s->states.failed, s->states.cancelled, s->states.retracted};
    fprintf(out, "  %-10s", "jobs");
    for (int i = 0; i < SHEARD_N_JOB_STATES; i++) {
        if (i == SHEARD_JOB_RETRACTED && counts[i] == 0) {
            continue; /* rare: shown only if not 0 */
        }
        const char *style =
            colours && counts[i] > 0 ? job_state_style((enum sheard_job_state)i) : NULL;
        fprintf(out, "%s %s%s %" PRId64 "%s", i != 0 ? " " : "", style != NULL ? style : "",
                sheard_job_state_name(i), counts[i], style != NULL ? STYLE_END : "");
    }
    fputc('\n', out);
}

char *status_text_problem(const sheard_msg_status *s, size_t i, char *buf, size_t size) {
    char duration[HUMAN_SIZE];
    text_set(buf, size, s->problems[i]);
    if (s->n_problem_details != s->n_problems || s->problem_details[i].next_attempt_ms == 0)
        return buf;
    const sheard_msg_problem *p = &s->problem_details[i];
    const int64_t left_ms = p->next_attempt_ms - clock_ms(CLOCK_REALTIME);
    if (p->attempts > 0)
        text_append(buf, size, "; %" PRId64 " attempts so far", p->attempts);
    text_append(buf, size, "; next attempt %s%s", left_ms > 0 ? "in " : "now",
                left_ms > 0 ? human_duration(1e-3 * (double)left_ms, duration) : "");
    return buf;
}

void status_text_brief(const sheard_msg_status *s, bool colours, FILE *out) {
    char text[1024];
    char line[800];
    char uptime[HUMAN_SIZE];
    char stamps[HUMAN_SIZE];
    char jobs[HUMAN_SIZE];
    const char *style = s->state == SHEARD_SERVER_RUNNING ? STYLE_GOOD : STYLE_DOUBT;
    fprintf(out, "sheard %s  %s%s%s  pid %" PRId64 "  up %s\n",
            message_clean(s->version, text, sizeof text), colours ? style : "",
            sheard_server_state_name(s->state), colours ? STYLE_END : "", s->pid,
            human_duration(s->uptime_s, uptime));
    print_states(s, colours, out);
    text_line(out, "queue",
              "%" PRId64 " of %" PRId64 " unfinished jobs, %" PRId64 " blocks to measure",
              s->queue.length, s->queue.capacity, s->queue.blocks);
    text_line(out, "workers", "%" PRId64 " of %" PRId64 " busy, %" PRId64 " readers",
              s->workers.busy, s->workers.total, s->workers.readers);
    text_line(out, "rate", "%s stamps, %s jobs (last minute)",
              human_rate(s->rates.stamps_per_s, stamps), human_rate(s->rates.jobs_per_s, jobs));
    for (size_t i = 0; i < s->n_problems; i++) {
        fprintf(out, "%s  problem    %s%s\n", colours ? STYLE_BAD : "",
                message_clean(status_text_problem(s, i, line, sizeof line), text, sizeof text),
                colours ? STYLE_END : "");
    }
}

static void print_left_lying(const sheard_msg_spool *s, FILE *out) {
    for (size_t i = 0; i < s->n_left_lying; i++) {
        text_line(out, i == 0 ? "left lying" : "", "%s: %s", s->left_lying[i].name,
                  s->left_lying[i].reason);
    }
    if (s->ignored > (int64_t)s->n_left_lying)
        text_line(out, "", "and %" PRId64 " more", s->ignored - (int64_t)s->n_left_lying);
}

static void print_disks(const sheard_msg_status *s, FILE *out) {
    for (size_t i = 0; i < s->n_disks; i++) {
        const sheard_msg_disk *d = &s->disks[i];
        char left[HUMAN_SIZE];
        char all[HUMAN_SIZE];
        const char *label = i == 0 ? "disks" : "";
        if (d->problem != NULL) {
            text_line(out, label, "%s: %s: %s", d->use, d->path, d->problem);
        } else if (d->same_as != NULL) {
            text_line(out, label, "%s: %s (on the disk of %s)", d->use, d->path, d->same_as);
        } else {
            text_line(out, label, "%s: %s, %s of %s free", d->use, d->path,
                      human_bytes(d->free_bytes, left), human_bytes(d->bytes, all));
        }
    }
}

static void print_spool(const sheard_msg_spool *s, FILE *out) {
    char bytes[HUMAN_SIZE];
    if (s->path == NULL) {
        text_line(out, "spool", "none");
        return;
    }
    text_line(out, "spool", "%s (%s), %s free", s->path, s->watching ? "watched" : "not watched",
              human_bytes(s->free_bytes, bytes));
    text_line(out, "files",
              "%" PRId64 " incoming, %" PRId64 " active, %" PRId64 " done, %" PRId64 " failed",
              s->incoming, s->active, s->done, s->failed);
    print_left_lying(s, out);
}

void status_text_rest(const sheard_msg_status *s, bool utc, FILE *out) {
    char time[HUMAN_SIZE];
    char bytes[HUMAN_SIZE];
    char left[HUMAN_SIZE];
    text_line(out, "started", "%s", human_time(s->started_ms, utc, time));
    text_line(out, "totals",
              "%" PRId64 " submitted, %" PRId64 " counted, %" PRId64 " duplicates, %" PRId64
              " failed, %" PRId64 " cancelled, %" PRId64 " retracted",
              s->totals.submitted, s->totals.counted, s->totals.duplicates, s->totals.failed,
              s->totals.cancelled, s->totals.retracted);
    text_line(out, "measured", "%" PRId64 " stamps in %" PRId64 " fields", s->totals.stamps,
              s->totals.fields);
    text_line(out, "plans", "%" PRId64 " kept (%s), %" PRId64 " hits, %" PRId64 " misses",
              s->plans.kept, human_bytes(s->plans.bytes, bytes), s->plans.hits, s->plans.misses);
    text_line(out, "memory", "%s of %s%s", human_bytes(s->memory.used, bytes),
              human_bytes(s->memory.budget, left),
              s->memory.waiting > 0 ? ", jobs wait for more" : "");
    print_spool(&s->spool, out);
    text_line(out, "state", "%s, %s, %s free, schema %" PRId64 ", %" PRId64 " commits",
              s->store.path != NULL ? s->store.path : "-", human_bytes(s->store.bytes, bytes),
              human_bytes(s->store.free_bytes, left), s->store.schema, s->store.commits);
    print_disks(s, out);
    if (s->log.lost > 0)
        text_line(out, "log", "%" PRId64 " lines were lost: nobody read them", s->log.lost);
    for (size_t i = 0; i < s->n_roots; i++) {
        text_line(out, i == 0 ? "data roots" : "", "%s%s", s->roots[i].path,
                  s->roots[i].missing ? " (missing)" : "");
    }
    text_line(out, "config", "%s, as user %s", s->config != NULL ? s->config : "-",
              s->user != NULL ? s->user : "-");
    text_line(out, "clients",
              "%" PRId64 " connected, %" PRId64 " subscribed, %" PRId64
              " dropped, %s not read, longest turn %.0f ms",
              s->connections, s->subscribers, s->loop.dropped,
              human_bytes(s->loop.unsent_bytes, bytes), s->loop.longest_minute_ms);
}
