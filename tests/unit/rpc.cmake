# SPDX-License-Identifier: GPL-3.0-or-later
# Tests of the wire protocol. They see protocol/'s inner headers, and with them jansson.h: the tables of messages are
# what a message is filled and compared by.
# Objects, not an archive: the linker takes them all, also those that only later libraries call (malloc of scarce.c).
add_library(rpc_fixture OBJECT ${CMAKE_CURRENT_LIST_DIR}/rpc_fixture.c ${CMAKE_CURRENT_LIST_DIR}/scarce.c)
target_include_directories(rpc_fixture PUBLIC ${CMAKE_CURRENT_LIST_DIR} ${PROJECT_SOURCE_DIR}/protocol)
target_link_libraries(rpc_fixture PUBLIC shear_flags shear_protocol shear_static PkgConfig::JANSSON PkgConfig::CMOCKA)
target_link_options(rpc_fixture PUBLIC -Wl,--wrap=malloc,--wrap=calloc,--wrap=realloc)

foreach(name frame rpc rpc_requests rpc_client rpc_hostile messages message_settings message_time job_file)
  shear_add_test(${name} SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_${name}.c LIBRARIES rpc_fixture LABELS protocol)
endforeach()

# docs/protocol.md and docs/protocol.schema.json against the code.
add_executable(protocol_probe ${CMAKE_CURRENT_LIST_DIR}/protocol_probe.c)
target_include_directories(protocol_probe PRIVATE ${PROJECT_SOURCE_DIR}/protocol)
target_link_libraries(protocol_probe PRIVATE shear_flags shear_protocol PkgConfig::JANSSON)
set_target_properties(protocol_probe PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
add_custom_target(protocol-docs
  COMMAND ${Python3_EXECUTABLE} -B ${PROJECT_SOURCE_DIR}/protocol/schema.py $<TARGET_FILE:protocol_probe>
  COMMENT "Renewing docs/protocol.schema.json, and the examples of docs/protocol.md" VERBATIM)
add_dependencies(protocol-docs protocol_probe)
add_test(NAME protocol_docs
  COMMAND ${Python3_EXECUTABLE} -B ${PROJECT_SOURCE_DIR}/tests/system/test_protocol_docs.py)
set_tests_properties(protocol_docs PROPERTIES LABELS protocol TIMEOUT 60
  ENVIRONMENT "PROTOCOL_PROBE=$<TARGET_FILE:protocol_probe>")
# All committed files that are made from tables of the code: tests say when they are not current.
add_custom_target(renew-docs)
add_dependencies(renew-docs config-sample protocol-docs)
