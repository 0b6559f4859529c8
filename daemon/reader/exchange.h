/* SPDX-License-Identifier: GPL-3.0-or-later */
/* reader/exchange.h: send requests to the reader child, and receive its replies. */
#pragma once

#include "reader/internal.h"
#include "reader/wire.h"

/* Send a request, with the version filled in, and receive its reply. `what` names the task in
 * messages. Return the error that the child reports, or a failure of the child itself (enum
 * reader_code), with which all later calls fail, too. */
int exchange_ask(reader *r, const reader_request *request, const char *what, reader_reply *reply,
                 shear_error *err);
/* Reap a child that has failed, and record why for this call and all later ones. Return the code
 * recorded. */
int exchange_give_up(reader *r, int code, const char *what, shear_error *err);
/* Return whether the caller has requested a stop. */
bool exchange_is_stopping(const reader *r);
