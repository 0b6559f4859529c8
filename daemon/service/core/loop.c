/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/core/loop.h"

#include "log/log.h"
#include "service/core/parts.h"
#include "service/core/reload.h"

#include <math.h>
#include <signal.h>

static void on_signal(uv_signal_t *handle, int number) {
    service *s = handle->data;
    if (number == SIGHUP) {
        sheard_msg_reloaded reply;
        sheard_rpc_error error;
        reload_config(s, &reply, &error);
        reload_reply_deinit(&reply);
    } else if (s->life.state == SHEARD_SERVER_STOPPING) {
        log_notice("stopping at once: %zu jobs go on at the next start", s->hooks->running_jobs(s));
        s->hooks->stop_jobs(s);
    } else {
        lifecycle_stop(s, NAN);
    }
}

static void on_engine(uv_async_t *async) {
    service *s = async->data;
    s->hooks->engine_events(s);
}

static void on_tick(uv_timer_t *timer) {
    service *s = timer->data;
    s->hooks->tick(s);
}

void loop_start(service *s) {
    static const int numbers[LOOP_SIGNALS] = {SIGTERM, SIGINT, SIGHUP};
    loop_events *e = &s->events;
    uv_async_init(&s->loop, &e->engine, on_engine);
    uv_timer_init(&s->loop, &e->tick);
    e->engine.data = e->tick.data = s;
    uv_timer_start(&e->tick, on_tick, 1000, 1000);
    for (int i = 0; i < LOOP_SIGNALS; i++) {
        uv_signal_init(&s->loop, &e->signals[i]);
        e->signals[i].data = s;
        uv_signal_start(&e->signals[i], on_signal, numbers[i]);
    }
}
