# SPDX-License-Identifier: GPL-3.0-or-later
# Every outside library, found once. Only the room named beside it may link it (tests/house/rooms.txt has the same rooms).
find_package(PkgConfig REQUIRED)
find_package(OpenMP 4.5 REQUIRED COMPONENTS C)
find_package(Threads REQUIRED)

pkg_check_modules(FFTW REQUIRED IMPORTED_TARGET fftw3>=3.3.5)    # core/fft
pkg_check_modules(CFITSIO REQUIRED IMPORTED_TARGET cfitsio>=4.0) # core/fits
pkg_check_modules(XXHASH REQUIRED IMPORTED_TARGET libxxhash)     # core/fits
pkg_check_modules(ZLIB REQUIRED IMPORTED_TARGET zlib)            # core/fits
pkg_check_modules(GMP REQUIRED IMPORTED_TARGET gmp)              # core/exact
pkg_check_modules(WCSLIB REQUIRED IMPORTED_TARGET wcslib>=7)     # core/survey/wcs
pkg_check_modules(GSL REQUIRED IMPORTED_TARGET gsl)              # mocks, validation, tests
pkg_check_modules(CAIRO REQUIRED IMPORTED_TARGET cairo)          # figures
pkg_check_modules(JANSSON REQUIRED IMPORTED_TARGET jansson)      # protocol
pkg_check_modules(SECCOMP REQUIRED IMPORTED_TARGET libseccomp)   # daemon/reader
pkg_check_modules(UV REQUIRED IMPORTED_TARGET libuv)             # daemon
pkg_check_modules(SQLITE REQUIRED IMPORTED_TARGET sqlite3>=3.37)       # daemon/store

find_path(RANDOM123_INCLUDE_DIR Random123/philox.h REQUIRED)     # mocks, core/survey/cutout

if(BUILD_TESTING)
  pkg_check_modules(CMOCKA REQUIRED IMPORTED_TARGET cmocka)      # tests
  find_package(Python3 REQUIRED COMPONENTS Interpreter)          # tests/system
endif()
