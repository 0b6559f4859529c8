/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shearctl watch: a live view of the service. */
#include "base/cleanup.h"
#include "base/clock.h"
#include "commands/commands.h"
#include "remote/watch_view.h"
#include "terminal/human.h"
#include "terminal/message.h"
#include "terminal/screen.h"
#include "terminal/style.h"

enum { DEFAULT_JOBS = 8, MAX_JOBS = 50 };

typedef struct watch_options {
    service service;
    double interval_s;
    int64_t count; /* number of snapshots; 0: no limit */
    int64_t jobs;
} watch_options;

static enum exit_code set_interval(const option_entry *e, const char *value) {
    double *seconds = e->context;
    if (!human_parse_duration(value, seconds) || *seconds < 0.05 || *seconds > 86400.0) {
        return message_fail(EXIT_CODE_USAGE, NULL, "--interval %s: expected a time from 50ms to 1d",
                            value);
    }
    return EXIT_CODE_DONE;
}

/* ---- Lines, without a terminal ---- */

static enum exit_code print_one(watch_options *w) {
    CLEANUP(watch_view_deinit) watch_view view = {0};
    sheard_rpc_error error = {0};
    TRY(service_say(watch_view_init(&view, &w->service, w->jobs, &error), &error));
    if (w->service.json) {
        watch_view_json(&view, stdout);
        return EXIT_CODE_DONE;
    }
    const enum exit_code printed = watch_view_print(&view, stdout, false);
    putchar('\n');
    fflush(stdout);
    return printed;
}

static enum exit_code print_many(watch_options *w) {
    enum exit_code code = service_open(&w->service);
    for (int64_t i = 1; code == EXIT_CODE_DONE; i++) {
        code = print_one(w);
        if (i == w->count || ferror(stdout) != 0 ||
            (code == EXIT_CODE_DONE && screen_wait(w->interval_s, false))) {
            break;
        }
    }
    return code;
}

/* ---- The screen ---- */

/* Request a snapshot and print it; connect first if necessary. */
static enum connection_status print_view(watch_options *w, FILE *out, sheard_rpc_error *error) {
    service *s = &w->service;
    if (s->connection == NULL)
        TRY(connection_open(&s->connection, s->socket, s->reply_timeout_s, error));
    CLEANUP(watch_view_deinit) watch_view view = {0};
    const enum connection_status status = watch_view_init(&view, s, w->jobs, error);
    if (status == CONNECTION_OK) {
        watch_view_print(&view, out, style_on(stdout));
    } else {
        service_close(s);
    }
    return status;
}

/* Build the text of a snapshot, or of the reason why there is none. */
static void compose(watch_options *w, FILE *out) {
    char time[HUMAN_SIZE];
    char text[512];
    sheard_rpc_error error = {0};
    if (print_view(w, out, &error) != CONNECTION_OK) {
        fprintf(out, "%s\n", message_clean(error.message, text, sizeof text));
        fprintf(out, "%s\n", message_clean(error.advice, text, sizeof text));
    }
    fprintf(out, "\n%s   q ends\n", human_time(clock_ms(CLOCK_REALTIME), w->service.utc, time));
}

/* Draw. Returns false if out of memory. */
static bool draw(watch_options *w) {
    CLEANUP(release_free) char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    if (out == NULL)
        return false;
    compose(w, out);
    if (fclose(out) != 0 || text == NULL)
        return false;
    screen_draw(text);
    return true;
}

static enum exit_code live(watch_options *w) {
    TRY(service_open(&w->service));
    screen_begin();
    bool drawn = draw(w);
    for (int64_t i = 1; drawn && i != w->count && !screen_wait(w->interval_s, true); i++)
        drawn = draw(w);
    screen_end();
    return drawn ? EXIT_CODE_DONE : message_no_memory();
}

static enum exit_code run(const command *self, int argc, char **argv) {
    watch_options w = {.interval_s = 1.0, .jobs = DEFAULT_JOBS};
    const option_entry options[] = {
        {.name = "interval", .set = set_interval, .context = &w.interval_s},
        {.name = "count", .integer = &w.count, .min = 1, .max = INT64_MAX},
        {.name = "jobs", .integer = &w.jobs, .min = 1, .max = MAX_JOBS},
        SERVICE_OPTIONS(&w.service),
        {0}};
    TRY(service_parse(self, argc, argv, options, &w.service, "", 0, 0));
    const enum exit_code code = !w.service.json && screen_possible() ? live(&w) : print_many(&w);
    service_close(&w.service);
    return code;
}

COMMAND(watch, "watch the service live", run, NULL);
