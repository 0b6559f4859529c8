# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs of lines that stand in two places. Only what functions do counts: tables, declarations, includes and comments do
not; white space is folded, and lines of punctuation alone are passed over. Two lines are the same where they are so to the
letter, or (`shape`) but for their names, numbers and strings."""
import collections
import re

import house

WORDS = {"if", "else", "for", "while", "do", "switch", "case", "default", "return", "goto", "break", "continue", "sizeof",
         "const", "static", "struct", "enum", "int", "char", "double", "bool", "void", "size_t", "unsigned", "NULL"}


def lines_of(text):
    """(function, line, code) of every line of a function's body that says something, tables within it left out."""
    lines = house.code_of(text).split("\n")
    found = []
    for name, begin, end in house.functions_of(text):
        depth = 0  # within a braced initialiser
        for number in range(begin, end + 1):
            line = " ".join(lines[number - 1].split())
            opens = line.count("{") - line.count("}")
            if depth or re.search(r"=\s*(\([^()]*\))?\s*\{", line):
                depth = max(0, depth + opens)
            elif re.search(r"\w", line) and not re.match(r"case [\w']+:$", line):
                found.append((name, number, line))
    return found


def shape_of(line):
    line = re.sub(r'"(?:[^"\\]|\\.)*"', "S", line)
    return re.sub(r"\b\w+\b", lambda m: m.group() if m.group() in WORDS else "N" if m.group()[0].isdigit() else "x", line)


def runs(texts, least, shape=False):
    """[(length, file, line, file, line)] of runs of at least `least` lines, longest first; texts is {file: text}. A run
    ends with its function."""
    places = collections.defaultdict(list)  # a window of lines -> where it begins
    bodies = {}
    for path, text in sorted(texts.items()):
        body = lines_of(text)
        keys = [(shape_of(line) if shape else line) for _, _, line in body]
        bodies[path] = (body, keys)
        for at in range(len(keys) - least + 1):
            one_function = body[at][0] == body[at + least - 1][0]
            if one_function and 2 * len(set(keys[at:at + least])) >= least:  # else a table, one row a line
                places[tuple(keys[at:at + least])].append((path, at))
    found, seen = [], set()
    for spots in places.values():
        for i, (a, at) in enumerate(spots):
            for b, bt in spots[i + 1:]:
                if a == b and bt < at + least or (a, at, b, bt) in seen:
                    continue
                n = 0
                while grows(bodies[a], at, bodies[b], bt, n) and not (a == b and at + n >= bt):
                    n += 1
                    seen.add((a, at + n, b, bt + n))
                if n >= least and not (at and bt and grows(bodies[a], at - 1, bodies[b], bt - 1, 0)):
                    found.append((n, a, bodies[a][0][at][1], b, bodies[b][0][bt][1]))
    return sorted(found, reverse=True)


def grows(a, at, b, bt, n):
    """Whether line n of the two runs is the same, and of the functions that they began in."""
    (body_a, keys_a), (body_b, keys_b) = a, b
    return (at + n < len(keys_a) and bt + n < len(keys_b) and keys_a[at + n] == keys_b[bt + n]
            and body_a[at + n][0] == body_a[at][0] and body_b[bt + n][0] == body_b[bt][0])
