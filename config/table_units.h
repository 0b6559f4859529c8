/* SPDX-License-Identifier: GPL-3.0-or-later */
/* table_units.h: the numbers and members in the rows of the table. */
#ifndef CONFIG_TABLE_UNITS_H
#define CONFIG_TABLE_UNITS_H

#define KiB    (INT64_C(1) << 10)
#define MiB    (INT64_C(1) << 20)
#define GiB    (INT64_C(1) << 30)
#define TiB    (INT64_C(1) << 40)
#define SECOND INT64_C(1000)
#define MINUTE (60 * SECOND)
#define HOUR   (60 * MINUTE)
#define DAY    (24 * HOUR)

#define AT(member) .offset = offsetof(sheard_config, member)

#endif
