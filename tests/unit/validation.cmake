# SPDX-License-Identifier: GPL-3.0-or-later
# What the experiments judge by.
shear_add_test(information
  SOURCES test_information.c ${PROJECT_SOURCE_DIR}/validation/information.c LIBRARIES core_fixtures LABELS validation)
target_include_directories(test_information PRIVATE ${PROJECT_SOURCE_DIR}/validation)
