/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The program sheard: parse the command line, then run the service. */
#include "log/log.h"
#include "service/service.h"
#include "shear/version.h"
#include "sheard/config.h"

#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>

enum { EXIT_USAGE = 2, EXIT_CONFIG = 3 };
enum { LAST_LINES_MS = 500 }; /* milliseconds to write the last lines of the log */
enum { OPT_CONFIG = 256, OPT_SET, OPT_CHECK, OPT_PRINT, OPT_VERSION, OPT_HELP };

static const struct option own[] = {
    {"config", required_argument, NULL, OPT_CONFIG}, {"set", required_argument, NULL, OPT_SET},
    {"check-config", no_argument, NULL, OPT_CHECK},  {"print-config", no_argument, NULL, OPT_PRINT},
    {"version", no_argument, NULL, OPT_VERSION},     {"help", no_argument, NULL, OPT_HELP}};
enum { N_OWN = sizeof own / sizeof own[0], MAX_OPTIONS = 64 };

static int usage(FILE *out, int code) {
    fprintf(out,
            "usage: sheard [--config FILE] [--set section.key=value]... [options]\n"
            "The shear service: see sheard(8) and sheard.conf(5).\n\n"
            "  --config FILE            configuration (default %s)\n"
            "  --set SECTION.KEY=VALUE  set one value, over the file's\n"
            "  --check-config           say what is wrong with the configuration, and end\n"
            "  --print-config           print the configuration in force, and end\n"
            "  --version                print the version, and end\n",
            sheard_config_default_path());
    sheard_flags_help(out);
    return code;
}

typedef struct command_line {
    const char *path;
    sheard_list assignments;
    int action; /* OPT_CHECK, OPT_PRINT, ..., or 0: run the service */
} command_line;

/* Parse the command line. Return 0, or an exit code plus one if the program is to end. */
static int parse(int argc, char **argv, command_line *line) {
    struct option options[MAX_OPTIONS] = {0};
    shear_error err = {0};
    memcpy(options, own, sizeof own);
    sheard_flags_fill(options + N_OWN, MAX_OPTIONS - N_OWN);
    int got;
    while ((got = getopt_long(argc, argv, "", options, NULL)) != -1) {
        int code = SHEAR_OK;
        if (got == OPT_CONFIG) {
            line->path = optarg;
        } else if (got == OPT_SET) {
            code = sheard_list_append(&line->assignments, optarg, &err);
        } else if (got >= SHEARD_FLAG_FIRST) {
            code = sheard_flags_assign(got, optarg, &line->assignments, &err);
        } else if (got == '?') {
            return usage(stderr, EXIT_USAGE) + 1;
        } else {
            line->action = got;
        }
        if (code != SHEAR_OK) {
            fprintf(stderr, "sheard: error: %s\n", err.message);
            return EXIT_USAGE + 1;
        }
    }
    return optind < argc ? usage(stderr, EXIT_USAGE) + 1 : 0;
}

static int serve(sheard_config *config, const command_line *line) {
    shear_error err = {0};
    service *s = NULL;
    log_options options;
    log_options_init(&options);
    options.level = (enum log_level)config->daemon.log_level;
    log_open(&options);
    if (config->daemon.nice != 0)
        setpriority(PRIO_PROCESS, 0, (int)config->daemon.nice);
    umask(027);
    if (service_open(&s, config, line->path, &line->assignments, &err) != SHEAR_OK) {
        log_error("%s", err.message);
        if (err.advice[0] != '\0')
            log_error("advice: %s", err.advice);
        log_drain(LAST_LINES_MS);
        return 1;
    }
    service_run(s);
    service_close(s);
    log_flush();
    log_drain(LAST_LINES_MS);
    return 0;
}

static int act(const command_line *line) {
    static sheard_problems problems;
    sheard_config config;
    shear_error err = {0};
    if (line->action == OPT_HELP)
        return usage(stdout, 0);
    if (line->action == OPT_VERSION) {
        printf("sheard %s\n", shear_version());
        return 0;
    }
    if (line->action == OPT_CHECK) {
        return sheard_config_check_file(line->path, &line->assignments, stdout) > 0 ? EXIT_CONFIG
                                                                                    : 0;
    }
    const int code = sheard_config_read(&config, line->path, &line->assignments, &problems);
    if (problems.n_errors + problems.n_warnings > 0)
        sheard_problems_print(&problems, stderr);
    if (code != SHEAR_OK)
        return EXIT_CONFIG;
    if (line->action == OPT_PRINT) {
        const int printed = sheard_config_print(&config, stdout, &err);
        sheard_config_deinit(&config);
        return printed == SHEAR_OK ? 0 : 1;
    }
    return serve(&config, line);
}

int main(int argc, char **argv) {
    command_line line = {0};
    int code = parse(argc, argv, &line);
    code = code != 0 ? code - 1 : act(&line);
    sheard_list_deinit(&line.assignments);
    return code;
}
