# SPDX-License-Identifier: GPL-3.0-or-later
# Who may read what. The test sees the room's inner headers too.
shear_add_test(access SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_access.c LIBRARIES sheard_access LABELS access)
target_include_directories(test_access PRIVATE ${PROJECT_SOURCE_DIR}/daemon/access)
