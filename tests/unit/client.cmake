# SPDX-License-Identifier: GPL-3.0-or-later
# shearctl is a program, not a library: its helpers are compiled in.
shear_add_test(client
  SOURCES test_client.c ${PROJECT_SOURCE_DIR}/client/cmdline/settings_options.c
  LIBRARIES shear_protocol shear_static LABELS client)
target_include_directories(test_client PRIVATE ${PROJECT_SOURCE_DIR}/client)

set(client ${PROJECT_SOURCE_DIR}/client)
shear_add_test(client_service
  SOURCES test_client_service.c
    ${client}/terminal/bar.c ${client}/cmdline/command.c ${client}/cmdline/completion.c ${client}/doctor/conf_text.c ${client}/remote/follow_sum.c
    ${client}/terminal/human.c ${client}/cmdline/input_path.c ${client}/terminal/message.c ${client}/cmdline/options.c ${client}/cmdline/settings_options.c
    ${client}/terminal/style.c
  LIBRARIES shear_protocol shear_static LABELS client)
target_include_directories(test_client_service PRIVATE ${client})
