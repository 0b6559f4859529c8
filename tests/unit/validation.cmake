# SPDX-License-Identifier: GPL-3.0-or-later
# What the experiments judge by.
shear_add_test(information
  SOURCES test_information.c ${PROJECT_SOURCE_DIR}/validation/engine/information.c LIBRARIES core_fixtures LABELS validation)
target_include_directories(test_information PRIVATE ${PROJECT_SOURCE_DIR}/validation)
shear_add_test(light
  SOURCES test_light.c ${PROJECT_SOURCE_DIR}/validation/engine/light.c ${PROJECT_SOURCE_DIR}/validation/engine/population.c
          ${PROJECT_SOURCE_DIR}/validation/engine/flaw.c
  LIBRARIES core_fixtures PkgConfig::GSL OpenMP::OpenMP_C LABELS validation)
target_include_directories(test_light PRIVATE ${PROJECT_SOURCE_DIR}/validation)
shear_add_test(aliases
  SOURCES test_aliases.c ${PROJECT_SOURCE_DIR}/validation/engine/aliases.c LIBRARIES core_fixtures LABELS validation)
target_include_directories(test_aliases PRIVATE ${PROJECT_SOURCE_DIR}/validation)
