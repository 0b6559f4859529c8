# SPDX-License-Identifier: GPL-3.0-or-later
# The tests of daemon/server, daemon/notify and daemon/log: real sockets, one loop, no sleeps.
foreach(part socket talk limits turns floods)
  shear_add_test(server_${part} SOURCES test_server_${part}.c server_fixture.c
    LIBRARIES sheard_server Threads::Threads LABELS server)
endforeach()
shear_add_test(notify SOURCES test_notify.c LIBRARIES sheard_notify LABELS server)
shear_add_test(log SOURCES test_log.c LIBRARIES sheard_log Threads::Threads LABELS server)
