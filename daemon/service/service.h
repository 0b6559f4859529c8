/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/service.h: the service: socket, watch folder, store and engine on one loop.
 *
 * All of it runs on one thread, the loop's. The changes of the store in one turn of the loop form
 * one group, committed by one fsync at the end of the turn; replies, moved files and notifications
 * follow after the commit (service/core/group.h).
 *
 * The rooms, each of which may use those before it:
 *
 *     core    group commit, lifecycle, reload, permissions
 *     jobs    the queue, the engine's events; the files that a job reads and leaves
 *     fields  results of fields, and notifications of their changes
 *     intake  submissions, and the files of the watch folder
 *     rpc     the methods of the protocol
 *
 * Calls upwards are callbacks, registered in service.c; loop.c has the events of the loop. */
#pragma once

#include "sheard/config.h"

typedef struct service service;

/* Open the service. *config is taken over, and deinited by service_close or on error. `assignments`
 * are the command line's, for reloads; they and the path must outlive the service. *s is NULL on
 * error. */
int service_open(service **s, sheard_config *config, const char *config_path,
                 const sheard_list *assignments, shear_error *err);
/* Serve until a signal (SIGTERM, SIGINT) or a client stops the service. */
void service_run(service *s);
void service_close(service *s);
