/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/rpc/disks.h: the directories that the service writes to: whether they exist and are
 * writable, and how much space is free. */
#pragma once

#include "sheard/messages.h"

typedef struct service service;

enum { DISKS = 4 };

/* Fill `disks` and return their number. */
size_t disks_get(const service *s, sheard_msg_disk disks[DISKS]);
bool disk_is_full(const sheard_msg_disk *disk); /* or nearly so */
