# SPDX-License-Identifier: GPL-3.0-or-later
"""compare.py OLD OUT: compare what version 0.1 left (OLD: state.tar, jobs.json, fields.json) with what the upgraded service
made of it (OUT: sheard.db, jobs.json, fields.json): every row of the database and all that a client was told, to the last
bit. New rows, columns and keys are allowed. Prints one line per check, in the format of machine.sh."""
import json
import os
import sqlite3
import sys
import tarfile
import tempfile

JOBS = 1000
KEYS = {"jobs": "id", "attempts": "job, number", "fields": "id", "contributions": "id",
        "contribution_terms": "contribution, part", "settings": "digest"}
COUNTED = {"settings": {"uses"}}  # columns that later jobs may change
# Reported in another way: a dropped file's name and where it is now, no longer where it was while it was measured; and the
# name of the owner's number on this machine.
RETOLD = {"source", "user"}
# Computed again from the same sums and terms: errors are rounded differently, and the symmetric estimator's are better.
ERRORS = {"g1_err", "g2_err"}
SHEARS = {"g1", "g2"}


def check(name, problems):
    """A line; problems: texts."""
    problems = list(problems)
    print(f"CHECK FAIL {name}: {len(problems)}, as {'; '.join(problems[:3])}"[:600] if problems else f"CHECK ok   {name}")


def rows(database, table, key):
    cursor = database.execute(f"SELECT * FROM {table} ORDER BY {key}")
    names = [column[0] for column in cursor.description]
    found = [dict(zip(names, row)) for row in cursor]
    return {tuple(row[part] for part in key.split(", ")): row for row in found}


def differing_rows(old, new, table):
    before, after = rows(old, table, KEYS[table]), rows(new, table, KEYS[table])
    if not before:
        yield "there were none: nothing is shown"
    for key, row in before.items():
        if key not in after:
            yield f"{table} {key} is gone"
            continue
        for column, value in row.items():
            if column not in COUNTED.get(table, ()) and after[key].get(column) != value:
                yield f"{table} {key}.{column}: {value!r} became {after[key].get(column)!r}"


def lines(path):
    with open(path, encoding="utf-8") as file:
        return [json.loads(line) for line in file]


def told(path, what):
    """{identity: object} of the pages of a list."""
    found = {}
    for page in lines(path):
        for item in page.get("result", page)[what]:
            identity = item["id"] if what == "jobs" else [item["field"], item["digest"]]
            found[json.dumps(identity, sort_keys=True)] = item
    return found


def differing(before, after, where):
    """Every value of `before` is in `after`; objects may have more keys."""
    if isinstance(before, dict) and isinstance(after, dict):
        for key, value in before.items():
            if key in RETOLD:
                continue
            if key not in after:
                yield f"{where}.{key} is gone"
            else:
                yield from differing(value, after[key], f"{where}.{key}")
    elif before != after or isinstance(before, float) and before.hex() != float(after).hex():
        yield f"{where}: {before!r} became {after!r}"


def digests_of_symmetry(database):
    """Of the settings whose fields are solved, not summed."""
    return {row[0] for row in database.execute("SELECT digest FROM settings WHERE text LIKE '%estimator=pdf-sym%'")}


def differing_fields(before, after, solved, where):
    """A field's row: its shear is the same to the last bit, but for a solved one, which moves within its error."""
    numbers = ERRORS | SHEARS
    yield from differing({k: v for k, v in before.items() if k not in numbers}, after, where)
    for key in numbers:
        old, new = before[key], after[key]
        if old is None or new is None:
            same = old is new
        elif before["digest"] in solved:
            same = abs(new - old) < (before[key + "_err"] if key in SHEARS else 2 * old)
        else:
            same = new == old if key in SHEARS else abs(new - old) < 1e-9 * old
        if not same:
            yield f"{where}.{key}: {old!r} became {new!r}"


def differing_told(old, new, what, solved):
    before, after = told(os.path.join(old, what + ".json"), what), told(os.path.join(new, what + ".json"), what)
    if what == "jobs" and len(before) != JOBS:
        yield f"0.1 had {len(before)} jobs, not {JOBS}"
    for identity, item in before.items():
        if identity not in after:
            yield f"{what} {identity} is gone"
        elif what == "fields":
            yield from differing_fields(item, after[identity], solved, f"{what} {identity}")
        else:
            yield from differing(item, after[identity], f"{what} {identity}")


def main(old, new):
    with tempfile.TemporaryDirectory() as directory:
        with tarfile.open(os.path.join(old, "state.tar")) as tar:
            tar.extractall(directory, [member for member in tar if member.name.startswith("var/lib/sheard/sheard.db")])
        before = sqlite3.connect(os.path.join(directory, "var/lib/sheard/sheard.db"))
        after = sqlite3.connect(os.path.join(new, "sheard.db"))
        for table in KEYS:
            check(f"  0.1's {table} are what they were", differing_rows(before, after, table))
        solved = digests_of_symmetry(before)
    for what in ("jobs", "fields"):
        check(f"  0.1's {what} are told as they were", differing_told(old, new, what, solved))


if __name__ == "__main__":
    try:
        main(*sys.argv[1:])
    except (OSError, sqlite3.Error, ValueError, KeyError) as error:
        print(f"CHECK FAIL   what 0.1 left cannot be compared: {type(error).__name__}: {error}")
