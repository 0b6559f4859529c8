/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/service.h: the service itself: socket, watch folder, store and engine joined on one loop.
 *
 * All on one thread, the loop's. Changes of the store that one turn of the loop brings are one
 * group, committed (one fsync) at the turn's end; what the outside may see of them (replies, moved
 * files, notifications) happens after that commit, never before (service/core/group.h).
 *
 * The rooms, each of which may use those before it:
 *
 *     core    the loop, group commit, lifecycle, reload, permissions
 *     jobs    from the queue into the engine and back; what a job reads, and what it leaves
 *     fields  results of fields, and who is told that they changed
 *     intake  submissions, and the files of the watch folder
 *     rpc     the methods of the protocol
 *
 * Calls upwards are callbacks, registered in service.c.
 */
#ifndef SHEARD_SERVICE_H
#define SHEARD_SERVICE_H

#include "sheard/config.h"

typedef struct service service;

/* Take over *config (deinited by service_close, also on error). `assignments`: of the command line,
 * for reloads. */
int service_open(service **s, sheard_config *config, const char *config_path,
                 const sheard_list *assignments, shear_error *err);
/* Serve until asked to stop: SIGTERM, SIGINT, or a client. */
void service_run(service *s);
void service_close(service *s);

#endif
