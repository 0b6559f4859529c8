/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shearctl watch: the service, live. */
#include "cmdline/options.h"
#include "remote/watch_view.h"
#include "terminal/human.h"
#include "terminal/message.h"
#include "terminal/screen.h"
#include "terminal/style.h"

#include <stdlib.h>

enum { OPT_INTERVAL = 256, OPT_COUNT, OPT_JOBS };
enum { DEFAULT_JOBS = 8, MAX_JOBS = 50 };

static const struct option options[] = {
    {"interval", required_argument, NULL, OPT_INTERVAL},
    {"count", required_argument, NULL, OPT_COUNT},
    {"jobs", required_argument, NULL, OPT_JOBS},
    SERVICE_OPTIONS,
    {NULL, 0, NULL, 0},
};

typedef struct watch_options {
    service service;
    double interval_s;
    int64_t count; /* pictures; 0: no end */
    int64_t jobs;
} watch_options;

static int handle(int value, void *context) {
    watch_options *w = context;
    if (value == OPT_COUNT) {
        return options_int("count", optarg, 1, INT64_MAX, &w->count);
    }
    if (value == OPT_JOBS) {
        return options_int("jobs", optarg, 1, MAX_JOBS, &w->jobs);
    }
    if (!human_parse_duration(optarg, &w->interval_s) || w->interval_s < 0.05 ||
        w->interval_s > 86400.0) {
        message_fail(NULL, "--interval %s: expected a time from 50ms to 1d", optarg);
        return EXIT_CODE_USAGE;
    }
    return EXIT_CODE_DONE;
}

/* ---- Lines, where there is no terminal ---- */

static int print_one(watch_options *w) {
    watch_view view;
    sheard_rpc_error error = {0};
    int code = service_say(watch_view_init(&view, &w->service, w->jobs, &error), &error);
    if (code == SHEAR_OK && w->service.json) {
        watch_view_json(&view, stdout);
    } else if (code == SHEAR_OK) {
        code = watch_view_print(&view, stdout, false, 0);
        putchar('\n');
        fflush(stdout);
    }
    watch_view_deinit(&view);
    return code;
}

static int print_many(watch_options *w) {
    int code = service_open(&w->service);
    for (int64_t i = 1; code == SHEAR_OK; i++) {
        code = print_one(w);
        if (code != SHEAR_OK || i == w->count || ferror(stdout) != 0 ||
            screen_sleep(w->interval_s)) {
            break;
        }
    }
    return code;
}

/* ---- The screen ---- */

/* One picture, or why there is none, as text. */
static void compose(watch_options *w, FILE *out) {
    char time[HUMAN_SIZE];
    sheard_rpc_error error = {0};
    watch_view view;
    int status = CONNECTION_OK;
    if (w->service.connection == NULL) {
        status = connection_open(&w->service.connection, w->service.socket,
                                 w->service.reply_timeout_s, &error);
    }
    if (status == CONNECTION_OK) {
        status = watch_view_init(&view, &w->service, w->jobs, &error);
        if (status == CONNECTION_OK) {
            watch_view_print(&view, out, style_on(stdout), 0);
        } else {
            service_close(&w->service); /* and try again */
        }
        watch_view_deinit(&view);
    }
    if (status != CONNECTION_OK) {
        char text[512];
        fprintf(out, "%s\n", message_clean(error.message, text, sizeof text));
        fprintf(out, "%s\n", message_clean(error.advice, text, sizeof text));
    }
    fprintf(out, "\n%s   q ends\n", human_time(human_now_ms(), w->service.utc, time));
}

static bool draw(watch_options *w) {
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    if (out == NULL) {
        return false;
    }
    compose(w, out);
    const bool good = fclose(out) == 0 && text != NULL;
    if (good) {
        screen_draw(text);
    }
    free(text);
    return good;
}

static int live(watch_options *w) {
    int code = service_open(&w->service);
    if (code != SHEAR_OK) {
        return code;
    }
    screen_begin();
    for (int64_t i = 1;; i++) {
        if (!draw(w)) {
            code = EXIT_CODE_OTHER;
            break;
        }
        if (i == w->count || screen_wait(w->interval_s)) {
            break;
        }
    }
    screen_end();
    if (code != SHEAR_OK) {
        message_fail(NULL, "out of memory");
    }
    return code;
}

static int run(int argc, char **argv) {
    watch_options w = {.interval_s = 1.0, .jobs = DEFAULT_JOBS};
    int code =
        service_parse_operands(&cmd_watch, argc, argv, options, handle, &w, &w.service, "", 0, 0);
    if (code != SHEAR_OK) {
        return code;
    }
    code = !w.service.json && screen_possible() ? live(&w) : print_many(&w);
    service_close(&w.service);
    return code;
}

const command cmd_watch = {
    .name = "watch",
    .summary = "watch the service live",
    .usage = "usage: shearctl watch [OPTION...]\n"
             "\n"
             "Show the queue, the workers, the rate, the running and the last finished jobs and "
             "their fields,\n"
             "refreshed in place; q or ^C ends. A service that goes away is waited for. With "
             "--json, or where\n"
             "standard input or output is no terminal, a picture is printed per interval.\n"
             "\n"
             "  --interval TIME         time between two pictures (default 1s)\n"
             "  --count N               end after so many pictures\n"
             "  --jobs N                jobs in each list (default 8)\n" SERVICE_OPTIONS_HELP
             "\n" EXIT_CODES_SERVICE ".\n",
    .run = run,
};
