/* SPDX-License-Identifier: GPL-3.0-or-later */
/* reader/exchange.h: questions to the reader child, and its answers. */
#ifndef SHEARD_READER_EXCHANGE_H
#define SHEARD_READER_EXCHANGE_H

#include "reader/internal.h"
#include "reader/wire.h"

/* Send a request and receive its reply. `what` it is to do, for messages. An error that the child
 * tells is returned; one of the child itself (enum reader_code) also fails all later calls. */
int exchange_ask(reader *r, const reader_request *request, const char *what, reader_reply *reply,
                 shear_error *err);
/* The child is of no more use: reap it, and remember why for this call and all later ones. Returns
 * the code of that. */
int exchange_give_up(reader *r, int code, const char *what, shear_error *err);
/* Has the caller been told to stop? */
bool exchange_is_stopping(const reader *r);

#endif
