# SPDX-License-Identifier: GPL-3.0-or-later
# Tests of the wire protocol. They see protocol/'s inner headers, and with them jansson.h: the tables of messages are
# what a message is filled and compared by.
add_library(rpc_fixture STATIC ${CMAKE_CURRENT_LIST_DIR}/rpc_fixture.c ${CMAKE_CURRENT_LIST_DIR}/scarce.c)
target_include_directories(rpc_fixture PUBLIC ${CMAKE_CURRENT_LIST_DIR} ${PROJECT_SOURCE_DIR}/protocol)
target_link_libraries(rpc_fixture PUBLIC shear_flags shear_protocol shear_static PkgConfig::JANSSON PkgConfig::CMOCKA)
target_link_options(rpc_fixture PUBLIC -Wl,--wrap=malloc,--wrap=calloc,--wrap=realloc)

foreach(name frame rpc messages rpc_hostile)
  shear_add_test(${name} SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_${name}.c LIBRARIES rpc_fixture LABELS protocol)
endforeach()
