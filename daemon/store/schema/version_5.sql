-- SPDX-License-Identifier: GPL-3.0-or-later
-- Removed fields whose contributions are still to be removed, and so refer to no field. A foreign
-- key cannot be altered; its text is changed like that of the check in version_4.sql.

CREATE TABLE forgotten(
 id INTEGER PRIMARY KEY AUTOINCREMENT,
 field INTEGER NOT NULL UNIQUE,
 name TEXT NOT NULL
) STRICT;

PRAGMA writable_schema = ON;
UPDATE sqlite_schema SET sql = replace(sql, ' REFERENCES fields(id)', '')
 WHERE type = 'table' AND name = 'contributions';
PRAGMA writable_schema = RESET;
