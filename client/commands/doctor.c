/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shearctl doctor: is the set-up sound? */
#include "doctor/doctor.h"
#include "terminal/message.h"
#include "terminal/style.h"

#include <pwd.h>
#include <stdarg.h>
#include <stdlib.h>
#include <unistd.h>

enum { OPT_CONFIG = 256 };

static const struct option options[] = {
    {"config", required_argument, NULL, OPT_CONFIG},
    SERVICE_OPTIONS,
    {NULL, 0, NULL, 0},
};

static int handle(int value, void *context) {
    (void)value;
    *(const char **)context = optarg;
    return EXIT_CODE_DONE;
}

static void print_line(const sheard_check_result *f) {
    static const char *const names[] = {"OK", "WARN", "FAIL"};
    static const char *const styles[] = {STYLE_GOOD, STYLE_DOUBT, STYLE_BAD};
    const bool colours = style_on(stdout);
    char text[1200];
    printf("%s%-4s%s  %-11s  %s\n", colours ? styles[f->level] : "", names[f->level],
           colours ? STYLE_END : "", f->subject, message_clean(f->message, text, sizeof text));
    if (f->remedy[0]) {
        printf("%19s%s\n", "-> ", message_clean(f->remedy, text, sizeof text));
    }
    fflush(stdout);
}

static void print_json(const sheard_check_result *f) {
    char *text = NULL;
    shear_error err = {0};
    if (sheard_check_result_json(&text, f, &err) != 0) {
        message_error(&err);
        return;
    }
    puts(text);
    free(text);
}

void doctor_say(doctor *d, const char *subject, int level, const char *remedy, const char *format,
                ...) {
    char message[1024];
    va_list args;
    va_start(args, format);
    vsnprintf(message, sizeof message, format, args);
    va_end(args);
    const sheard_check_result result = {subject, level, message, remedy != NULL ? remedy : ""};
    d->worst = level > d->worst ? level : d->worst;
    if (d->service.json) {
        print_json(&result);
    } else {
        print_line(&result);
    }
}

/* The socket of the configuration, where nobody names another one. */
static void choose_socket(doctor *d) {
    const char *environment = getenv("SHEARD_SOCKET");
    const bool named =
        d->service.socket != connection_default_path() || (environment != NULL && *environment);
    if (!named && d->socket != NULL && *d->socket) {
        d->service.socket = d->socket;
    }
}

/* With the service's eyes, where it answers. */
static void look(doctor *d) {
    if (d->reached) {
        doctor_take_paths(d);
    }
    doctor_check_config(d);
    if (d->told) {
        doctor_check_told(d);
    } else {
        const struct passwd *me = getpwuid(geteuid());
        doctor_say(d, "view", SHEARD_CHECK_WARN,
                   "start the service, and run doctor again: then it is asked",
                   "no service tells what it sees: what follows is seen with the eyes of %s",
                   me != NULL ? me->pw_name : "this user");
        doctor_check_disks(d);
    }
    if (!d->reached || !doctor_check_probe(d)) {
        doctor_check_system(d);
    }
}

static int run(int argc, char **argv) {
    doctor d = {.config = NULL};
    const int code = service_parse_operands(&cmd_doctor, argc, argv, options, handle, &d.config,
                                            &d.service, "", 0, 0);
    if (code != SHEAR_OK) {
        return code;
    }
    doctor_check_program(&d);
    choose_socket(&d);
    doctor_check_socket(&d);
    doctor_check_service(&d);
    look(&d);
    sheard_reply_deinit(&d.status, SHEARD_METHOD_STATUS);
    service_close(&d.service);
    free(d.program);
    free(d.state_dir);
    free(d.socket);
    free(d.spool);
    free(d.roots);
    return d.worst == SHEARD_CHECK_FAIL ? EXIT_CODE_OTHER : EXIT_CODE_DONE;
}

const command cmd_doctor = {
    .name = "doctor",
    .summary = "is the set-up of the service sound?",
    .usage =
        "usage: shearctl doctor [OPTION...]\n"
        "\n"
        "Look at the program and configuration of the service, its socket and who may "
        "connect, release and\n"
        "protocol, disks, spool, clocks, data roots. The service that answers is asked for its "
        "paths and\n"
        "for what it sees of them, and measures a tiny field of its own. Where none answers, "
        "it is looked\n"
        "with the eyes of who runs doctor (root tries as the user sheard), and at what the "
        "kernel offers.\n"
        "Each line is OK, WARN or FAIL, with the remedy. Nothing is changed.\n"
        "\n"
        "  --config FILE           the configuration (default: the installed "
        "one)\n" SERVICE_OPTIONS_HELP "\n"
        "exit status: 0 sound (maybe with warnings), 1 something failed, 2 usage.\n",
    .run = run,
};
