# SPDX-License-Identifier: GPL-3.0-or-later
# store-bench: times of the store's operations with 10^6 finished jobs, and durable submits compared
# to SQLite's plain commits. Not installed.
add_executable(store-bench store_bench.c store_fill.c timer.c)
target_link_libraries(store-bench PRIVATE shear_flags sheard_store PkgConfig::SQLITE)
