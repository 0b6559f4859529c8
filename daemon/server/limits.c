/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/limits.h"

#include "server/connection_table.h"

void server_limits_init(server_limits *limits) {
    *limits = (server_limits){.line_bytes = sheard_rpc_request_limits.line,
                              .connections = 2048,
                              .reserved_connections = 16,
                              .in_flight = 64,
                              .subscriptions = 1024,
                              .queue_bytes = (size_t)32 << 20,
                              .unsent_bytes = (size_t)64 << 20,
                              .slice_us = 3000,
                              .idle_timeout_ms = 600000,
                              .stall_timeout_ms = 60000,
                              .crowded_ms = 5000};
}

static size_t or_default(size_t given, size_t initial) {
    return given != 0 ? given : initial;
}

static size_t at_most(size_t n, size_t most) {
    return n < most ? n : most;
}

void limits_fill(server_limits *l, const server_limits *given) {
    server_limits d;
    server_limits_init(&d);
    *l = (server_limits){
        .line_bytes = or_default(given->line_bytes, d.line_bytes),
        .connections = or_default(given->connections, d.connections),
        .reserved_connections = or_default(given->reserved_connections, d.reserved_connections),
        .in_flight = or_default(given->in_flight, d.in_flight),
        .subscriptions = or_default(given->subscriptions, d.subscriptions),
        .queue_bytes = or_default(given->queue_bytes, d.queue_bytes),
        .unsent_bytes = or_default(given->unsent_bytes, d.unsent_bytes),
        .slice_us = or_default(given->slice_us, d.slice_us),
        .idle_timeout_ms = given->idle_timeout_ms,
        .stall_timeout_ms = given->stall_timeout_ms,
        .crowded_ms = given->crowded_ms,
    };
    l->line_bytes = at_most(l->line_bytes, d.line_bytes);
    l->connections = at_most(l->connections, CONNECTION_SLOTS);
    l->reserved_connections = at_most(l->reserved_connections, l->connections / 4);
    l->user_connections = or_default(given->user_connections, l->connections / 4);
    l->user_connections += l->user_connections == 0; /* of very few: one */
}
