/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shearctl wait: wait until jobs have ended. */
#include "base/cleanup.h"
#include "commands/commands.h"
#include "remote/follow.h"
#include "terminal/message.h"

#include <getopt.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>

static enum exit_code run(const command *self, int argc, char **argv) {
    CLEANUP(service_close) service s = {0};
    follow_options o = {.timeout_s = NAN, .answers = true};
    const option_entry options[] = {{.name = "timeout", .seconds = &o.timeout_s},
                                    {.name = "quiet", .flag = &o.quiet},
                                    SERVICE_OPTIONS(&s),
                                    {0}};
    TRY(service_parse(self, argc, argv, options, &s, "jobs", 1, INT_MAX));
    const size_t n = (size_t)(argc - optind);
    CLEANUP(release_free) int64_t *ids = calloc(n, sizeof *ids);
    if (ids == NULL)
        return message_no_memory();
    for (size_t i = 0; i < n; i++)
        TRY(service_job_id(argv[optind + (int)i], &ids[i]));
    TRY(service_open(&s));
    return follow_jobs(&s, ids, n, &o);
}

COMMAND(wait, "wait until jobs are finished", run, NULL);
