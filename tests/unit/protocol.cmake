# SPDX-License-Identifier: GPL-3.0-or-later
# test_report sees jansson.h for its allocator only: to let the n-th allocation fail.
shear_add_test(report
  SOURCES test_report.c LIBRARIES shear_protocol shear_static PkgConfig::JANSSON LABELS protocol)
shear_add_test(advice SOURCES test_advice.c LIBRARIES shear_protocol shear_static LABELS protocol)
