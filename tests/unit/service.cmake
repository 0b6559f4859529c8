# SPDX-License-Identifier: GPL-3.0-or-later
# Tests of modules of daemon/service that need no running service.
shear_add_test(estimate_cache SOURCES test_estimate_cache.c LIBRARIES sheard_service LABELS service)
shear_add_test(owner SOURCES test_owner.c LIBRARIES sheard_service LABELS service)
shear_add_test(problem_notes SOURCES test_problem_notes.c LIBRARIES sheard_service LABELS service)
