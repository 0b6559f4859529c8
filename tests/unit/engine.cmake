# SPDX-License-Identifier: GPL-3.0-or-later
# The tests of daemon/engine.
shear_add_test(engine_plans SOURCES test_engine_plans.c
  LIBRARIES core_fixtures sheard_engine Threads::Threads LABELS engine)
shear_add_test(machine SOURCES test_machine.c LIBRARIES core_fixtures sheard_engine LABELS engine)
