# SPDX-License-Identifier: GPL-3.0-or-later
# The fixtures of core's tests. Tests see core's inner headers too (measure/axis.h and so on).
add_library(core_fixtures STATIC batch.c gaussian.c oracle.c pair.c)
target_link_libraries(core_fixtures PUBLIC shear_flags shear_static PkgConfig::CMOCKA m)
target_include_directories(core_fixtures PUBLIC ${CMAKE_CURRENT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/core)

function(core_test name)
  shear_add_test(${name} SOURCES test_${name}.c LIBRARIES core_fixtures ${ARGN} LABELS core)
endfunction()

core_test(text)
core_test(gaussian)
core_test(direct)
core_test(laws)
core_test(scale)
core_test(fft)
core_test(axis PkgConfig::GSL)
core_test(image)
core_test(plan)
if(NOT SHEAR_SANITIZE) # whose malloc keeps no statistics
  core_test(memory)
endif()
core_test(plateau)
core_test(noise_level)
core_test(psf)
core_test(psf_quality)
core_test(filter)
core_test(transfer PkgConfig::GSL)
core_test(flags)
core_test(stamps)
core_test(exact)
core_test(sums)
core_test(symmetry)
core_test(jackknife)
core_test(threads Threads::Threads)
core_test(settings)
core_test(error)

# Every allocation of libshear's own goes through the test, which lets the n-th fail.
core_test(nomem)
foreach(call malloc calloc realloc free aligned_alloc strdup open_memstream fftw_plan_many_dft
    fftw_destroy_plan)
  target_link_options(test_nomem PRIVATE -Wl,--wrap=${call})
endforeach()
