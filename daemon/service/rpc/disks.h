/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/rpc/disks.h: where the service writes: is it there, may it write, is there room. */
#ifndef SHEARD_SERVICE_DISKS_H
#define SHEARD_SERVICE_DISKS_H

#include "sheard/messages.h"

typedef struct service service;

enum { DISKS = 4 };

/* How many there are. */
size_t disks_get(const service *s, sheard_msg_disk disks[DISKS]);
bool disk_is_full(const sheard_msg_disk *disk); /* ... as good as */

#endif
