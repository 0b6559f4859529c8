/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The subcommands of shearctl that send a request, or one for each job, and print the reply: show,
 * cancel, retry, retract, status, metrics, drain, shutdown, reload. */
#include "base/cleanup.h"
#include "commands/commands.h"
#include "remote/job_text.h"
#include "remote/service_query.h"
#include "remote/status_text.h"
#include "terminal/message.h"
#include "terminal/style.h"

#include <inttypes.h>

/* Define a subcommand by its name, its summary and the members of its service_query. */
#define QUERY(name, summary, ...)                                                                  \
    COMMAND(name, summary, service_query_run, &(const service_query){__VA_ARGS__})

/* ---- Jobs ---- */

static void show(const sheard_reply *reply, const service *s) {
    job_text_print(&reply->job, s->utc, stdout);
}

QUERY(show, "everything about a job", SHEARD_METHOD_JOB, show, "job");

/* Print the state of a job. The replies to cancel, retry and retract are the same message. */
static void print_job(const sheard_reply *reply, const service *s) {
    const sheard_msg_job *job = &reply->cancel;
    (void)s;
    printf("job %" PRId64 " %s%s\n", job->id, sheard_job_state_name(job->state),
           job->cancel_asked && !sheard_job_state_is_final(job->state) ? ", being cancelled" : "");
}

QUERY(cancel, "cancel jobs", SHEARD_METHOD_CANCEL, print_job, "jobs");
QUERY(retry, "run failed or cancelled jobs again", SHEARD_METHOD_RETRY, print_job, "jobs");
QUERY(retract, "take back what jobs counted", SHEARD_METHOD_RETRACT, print_job, "jobs");

/* ---- The service ---- */

static void print_status(const sheard_reply *reply, const service *s) {
    status_text_brief(&reply->status, style_on(stdout), stdout);
    status_text_rest(&reply->status, s->utc, stdout);
}

QUERY(status, "the state of the service", SHEARD_METHOD_STATUS, print_status, NULL);

static void print_metrics(const sheard_reply *reply, const service *s) {
    (void)s;
    fputs(reply->metrics.text, stdout);
}

QUERY(metrics, "print the service's metrics (Prometheus text)", SHEARD_METHOD_METRICS,
      print_metrics, NULL);

/* Print what goes on. The replies to drain and shutdown are the same message. */
static void print_stopping(const sheard_reply *reply, const service *s) {
    const sheard_msg_stopping *r = &reply->drain;
    (void)s;
    printf("%s: %" PRId64 " jobs running, %" PRId64 " wait for the next start\n",
           sheard_server_state_name(r->state), r->running, r->queued);
}

QUERY(drain, "finish what runs, take nothing new", SHEARD_METHOD_DRAIN, print_stopping, NULL);

/* Return whether systemd owns the socket: then any client's request would start the service again.
 */
static bool is_activated(service *s) {
    sheard_rpc_error error;
    sheard_reply reply = {0};
    const bool known = connection_call(s->connection, SHEARD_METHOD_STATUS, NULL,
                                       s->reply_timeout_s, &reply, NULL, &error) == CONNECTION_OK;
    const bool activated = known && reply.status.activated;
    sheard_reply_deinit(&reply, SHEARD_METHOD_STATUS);
    return activated;
}

static enum exit_code shut_down(const command *self, int argc, char **argv) {
    CLEANUP(service_close) service s = {0};
    sheard_params p;
    bool now = false;
    sheard_params_init(&p, SHEARD_METHOD_SHUTDOWN);
    const option_entry options[] = {{.name = "now", .flag = &now},
                                    {.name = "timeout", .seconds = &p.shutdown.timeout_s},
                                    SERVICE_OPTIONS(&s),
                                    {0}};
    TRY(service_start(self, argc, argv, options, &s, "", 0, 0));
    if (now)
        p.shutdown.mode = SHEARD_SHUTDOWN_NOW;
    const bool comes_back = !s.json && is_activated(&s);
    TRY(service_ask(&s, SHEARD_METHOD_SHUTDOWN, &p, print_stopping));
    if (comes_back) {
        puts("systemd keeps the socket: the next client, or dropped file, starts the service "
             "again; \"systemctl stop sheard.service\" stops both");
    }
    return EXIT_CODE_DONE;
}

COMMAND(shutdown, "stop the service", shut_down, NULL);

static void print_list(const char *title, const char *const *names, size_t n) {
    for (size_t i = 0; i < n; i++) {
        char name[512];
        printf("%s %s\n", title, message_clean(names[i], name, sizeof name));
    }
}

static void print_reloaded(const sheard_reply *reply, const service *s) {
    const sheard_msg_reloaded *r = &reply->reload;
    (void)s;
    print_list("changed:", r->changed, r->n_changed);
    print_list("needs a restart:", r->restart, r->n_restart);
    print_list("warning:", r->warnings, r->n_warnings);
    if (r->n_changed + r->n_restart == 0)
        puts("nothing has changed");
}

QUERY(reload, "make the service read its configuration again", SHEARD_METHOD_RELOAD, print_reloaded,
      NULL);
