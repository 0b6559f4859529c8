# SPDX-License-Identifier: GPL-3.0-or-later
# Any bytes on the socket must be an error at worst. With SHEAR_FUZZ (clang) a libFuzzer target, with the protocol compiled
# again for coverage; docs/protocol.md is a good corpus to begin with.
if(SHEAR_FUZZ)
  get_target_property(protocol_sources shear_protocol SOURCES)
  foreach(source IN LISTS protocol_sources)
    cmake_path(ABSOLUTE_PATH source BASE_DIRECTORY ${PROJECT_SOURCE_DIR}/protocol)
    list(APPEND fuzzed_sources ${source})
  endforeach()
  add_executable(fuzz_rpc ${CMAKE_CURRENT_LIST_DIR}/fuzz_rpc.c ${fuzzed_sources})
  target_include_directories(fuzz_rpc PRIVATE ${PROJECT_SOURCE_DIR}/protocol/include ${PROJECT_SOURCE_DIR}/protocol)
  target_link_libraries(fuzz_rpc PRIVATE shear_flags shear_static PkgConfig::JANSSON)
  target_compile_options(fuzz_rpc PRIVATE -fsanitize=fuzzer)
  target_link_options(fuzz_rpc PRIVATE -fsanitize=fuzzer)
endif()

# The same target on the examples of the protocol's documents, as an ordinary test.
add_executable(fuzz_rpc_replay ${CMAKE_CURRENT_LIST_DIR}/fuzz_rpc.c ${CMAKE_CURRENT_LIST_DIR}/replay_rpc.c)
target_link_libraries(fuzz_rpc_replay PRIVATE shear_flags shear_protocol)
set_target_properties(fuzz_rpc_replay PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
add_test(NAME fuzz_rpc_replay COMMAND fuzz_rpc_replay
  ${PROJECT_SOURCE_DIR}/docs/protocol.md ${PROJECT_SOURCE_DIR}/docs/protocol.schema.json)
set_tests_properties(fuzz_rpc_replay PROPERTIES LABELS "protocol;fuzz" TIMEOUT 120)
