# SPDX-License-Identifier: GPL-3.0-or-later
# shearctl is a program, not a library: its helpers are compiled in.
shear_add_test(client
  SOURCES test_client.c ${PROJECT_SOURCE_DIR}/client/settings_options.c
  LIBRARIES shear_protocol shear_static LABELS client)
target_include_directories(test_client PRIVATE ${PROJECT_SOURCE_DIR}/client)

set(client ${PROJECT_SOURCE_DIR}/client)
shear_add_test(client_service
  SOURCES test_client_service.c
    ${client}/bar.c ${client}/command.c ${client}/completion.c ${client}/conf_text.c ${client}/follow_sum.c
    ${client}/human.c ${client}/input_path.c ${client}/message.c ${client}/options.c ${client}/settings_options.c
    ${client}/style.c
  LIBRARIES shear_protocol shear_static LABELS client)
target_include_directories(test_client_service PRIVATE ${client})
