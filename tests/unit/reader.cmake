# SPDX-License-Identifier: GPL-3.0-or-later
# The daemon's side of a reader, with the real child and with stubs for it.
shear_add_test(reader SOURCES test_reader.c LIBRARIES fits_fixtures sheard_reader LABELS reader)
target_compile_definitions(test_reader PRIVATE SHEARD_READER="$<TARGET_FILE:sheard-reader>")
add_dependencies(test_reader sheard-reader)
if(SHEAR_SANITIZE)
  target_compile_definitions(test_reader PRIVATE SHEAR_SANITIZED)
endif()
# validate.h is the reader's own.
shear_add_test(reader_validate SOURCES test_reader_validate.c LIBRARIES sheard_reader LABELS reader)
