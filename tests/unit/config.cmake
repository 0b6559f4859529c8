# SPDX-License-Identifier: GPL-3.0-or-later
# The configuration: values, the file, the sample and what is printed, reload. Sees config's inner headers too.
add_library(config_fixtures STATIC config_file.c)
target_link_libraries(config_fixtures PUBLIC shear_flags sheard_config PkgConfig::CMOCKA)
target_include_directories(config_fixtures PUBLIC ${CMAKE_CURRENT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/config)

foreach(name config_value config_load config_text config_reload)
  shear_add_test(${name} SOURCES test_${name}.c LIBRARIES config_fixtures LABELS config)
endforeach()
target_compile_definitions(test_config_text PRIVATE CONFIG_SAMPLE="${PROJECT_SOURCE_DIR}/config/sheard.conf")
