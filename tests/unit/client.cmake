# SPDX-License-Identifier: GPL-3.0-or-later
# shearctl is a program, not a library: its helpers are compiled in.
shear_add_test(client
  SOURCES test_client.c ${PROJECT_SOURCE_DIR}/client/advice.c ${PROJECT_SOURCE_DIR}/client/settings_options.c
  LIBRARIES shear_static LABELS client)
target_include_directories(test_client PRIVATE ${PROJECT_SOURCE_DIR}/client)
