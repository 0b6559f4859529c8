/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks as the running service reports them: its directories, and whether it can measure. It may
 * have another configuration, other permissions and other mounts than this process (PrivateTmp,
 * ProtectHome). */
#include "doctor/internal.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static char *copy(const char *text) {
    return text != NULL ? strdup(text) : NULL;
}

void doctor_use_paths(doctor *d) {
    const sheard_msg_status *s = &d->status.status;
    if (s->config == NULL || s->state_dir == NULL) {
        return; /* an older release, which does not report its paths */
    }
    free(d->state_dir);
    free(d->spool);
    free(d->roots);
    d->told = true;
    d->state_dir = copy(s->state_dir);
    d->spool = copy(s->spool.path);
    d->has_spool = s->spool.path != NULL;
    d->roots = NULL;
    if (d->config == NULL) {
        d->config = s->config;
    } else if (strcmp(d->config, s->config) != 0) {
        doctor_warn(d, "config", "leave --config out to examine that of the running service",
                    "the service that answers was configured by %s", s->config);
    }
}

static void tell_root(doctor *d, const sheard_msg_root *r) {
    if (r->missing) {
        doctor_warn(d, "data root",
                    "mount or create it where the service sees it (home-data.conf if it is beneath "
                    "/home); jobs beneath it wait",
                    "%s", r->reason != NULL ? r->reason : r->path);
    } else if (access(r->path, R_OK | X_OK) != 0) {
        doctor_warn(d, "data root", "ask for read permission on it",
                    "%s is there for the service, but you may not read it, so no file in it will "
                    "be measured for you",
                    r->path);
    } else {
        doctor_ok(d, "data root", "%s is there for the service, and readable for you", r->path);
    }
}

static void tell_disk(doctor *d, const sheard_msg_disk *disk) {
    if (disk->problem != NULL) {
        doctor_fail(d, disk->use, "make sure that it exists and that the service may write to it",
                    "%s: %s", disk->path, disk->problem);
    } else {
        doctor_report_space(d, disk->use, disk->path, disk->free_bytes);
    }
}

void doctor_check_view(doctor *d) {
    const sheard_msg_status *s = &d->status.status;
    for (size_t i = 0; i < s->n_disks; i++)
        tell_disk(d, &s->disks[i]);
    doctor_check_local(d, s->state_dir);
    if (s->spool.path != NULL)
        doctor_check_clock(d);
    for (size_t i = 0; i < s->n_roots; i++)
        tell_root(d, &s->roots[i]);
    if (s->n_roots == 0)
        doctor_report_no_roots(d);
}

/* ---- can it measure? ---- */

static void tell_probe(doctor *d, const sheard_msg_probed *p) {
    if (!p->ok) {
        doctor_fail(
            d, "probe", p->advice, "the service cannot measure a tiny field of its own: %s%s%s%s",
            p->message != NULL ? p->message : "no reason was given", p->code != NULL ? " [" : "",
            p->code != NULL ? p->code : "", p->code != NULL ? "]" : "");
        return;
    }
    doctor_ok(d, "probe",
              "the service measures: g1 %+.5f (true %+.5f), g2 %+.5f (true %+.5f), %.2f s", p->g1,
              p->true_g1, p->g2, p->true_g2, p->seconds);
    doctor_report(d, "sandbox", p->landlock ? SHEARD_CHECK_OK : SHEARD_CHECK_WARN,
                  "boot with landlock among the security modules (lsm=landlock,...)", "%s%s",
                  p->landlock ? "the service's readers have system calls filtered and the file "
                                "system closed (seccomp, Landlock)"
                              : "no Landlock: only seccomp guards the service's readers",
                  p->namespaces ? ", and see no other process (namespaces)" : "");
}

bool doctor_check_probe(doctor *d) {
    sheard_rpc_error error = {0};
    sheard_reply reply = {0};
    const enum connection_status status =
        connection_call(d->service.connection, SHEARD_METHOD_PROBE, NULL,
                        d->service.reply_timeout_s, &reply, NULL, &error);
    if (status == CONNECTION_OK) {
        tell_probe(d, &reply.probe);
        sheard_reply_deinit(&reply, SHEARD_METHOD_PROBE);
        return true;
    }
    const bool old = status == CONNECTION_REFUSED && error.code == SHEARD_RPC_UNKNOWN_METHOD;
    doctor_report(d, "probe", old ? SHEARD_CHECK_WARN : SHEARD_CHECK_FAIL,
                  old ? "install one release, and restart the service" : error.advice,
                  old ? "the service is too old to be asked whether it can measure"
                      : "the service does not say whether it can measure: %s",
                  error.message);
    return false;
}
