# SPDX-License-Identifier: GPL-3.0-or-later
# store-bench: what the store costs with 10^6 finished jobs, and durable submits beside SQLite's own
# commits. Not installed.
add_executable(store-bench store_bench.c store_fill.c timer.c)
target_link_libraries(store-bench PRIVATE shear_flags sheard_store PkgConfig::SQLITE)
