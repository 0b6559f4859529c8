/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/loop.h: the loop's events other than clients and files: signals, a tick every second, the
 * engine. */
#pragma once

typedef struct service service;

void loop_start(service *s);
