# SPDX-License-Identifier: GPL-3.0-or-later
"""What the tests of the house share: which sources there are, what they say without comments, where functions begin and
end, and the two text files with the rules (rooms.txt) and what is excepted from them (exceptions.txt)."""
import fnmatch
import functools
import pathlib
import re
import subprocess
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PRODUCT = ("base", "core", "mocks", "figures", "protocol", "config", "daemon", "client", "validation", "bench", "examples")
TOKEN = re.compile(r'//[^\n]*|/\*.*?\*/|"(?:[^"\\\n]|\\.)*"|\'(?:[^\'\\\n]|\\.)*\'', re.S)


class Tree:
    """A source tree: the project's own, or one that a test of the tests has made up."""

    def __init__(self, root=ROOT):
        self.root = pathlib.Path(root)

    def files(self, *endings, folders=PRODUCT):
        """Files with these endings beneath `folders`, as paths from the root, in order."""
        found = [p.relative_to(self.root).as_posix() for folder in folders for p in (self.root / folder).rglob("*")
                 if p.suffix in endings and p.is_file()]
        return sorted(found)

    @functools.lru_cache(maxsize=None)
    def read(self, path):
        return (self.root / path).read_text(encoding="utf-8")

    def sources(self):
        return self.files(".c", ".h")


@functools.lru_cache(maxsize=None)
def code_of(text):
    """The text of a C file without comments; lines keep their numbers, strings their length."""
    def blank(match):
        token = match.group()
        return token if token[0] in "\"'" else re.sub(r"[^\n]", " ", token)
    return TOKEN.sub(blank, text)


@functools.lru_cache(maxsize=None)
def bare_code_of(text):
    """As code_of(), and strings and characters are empty, too."""
    return TOKEN.sub(lambda m: re.sub(r"[^\n]", " ", m.group()) if m.group()[0] == "/" else m.group()[0] * 2, text)


@functools.lru_cache(maxsize=None)
def tokens_of(text):
    """(line, text) of every comment, string and character."""
    found, line, at = [], 1, 0
    for m in TOKEN.finditer(text):
        line += text.count("\n", at, m.start())
        at = m.start()
        found.append((line, m.group()))
    return found


def comments_of(text):
    """(line, text) of every comment."""
    return [(line, token) for line, token in tokens_of(text) if token[0] == "/"]


def strings_of(text):
    """(line, text) of every string."""
    return [(line, token) for line, token in tokens_of(text) if token[0] == '"']


@functools.lru_cache(maxsize=None)
def functions_of(text):
    """(name, first line, last line) of every function, as clang-format lays them out: the head in column 0, `}` alone."""
    lines = bare_code_of(text).split("\n")
    found = []
    begin = None
    for number, line in enumerate(lines, 1):
        if begin is None:
            if re.match(r"[A-Za-z_]", line) and "(" in line and not line.startswith(("typedef", "struct {", "enum {")):
                begin = number
            if begin is not None and ends_head(lines, begin, number) == "no":
                begin = None
        elif line.startswith("}"):
            head = " ".join(lines[begin - 1:number])
            found.append((re.match(r"[^(]*?(\w+)\s*\(", head).group(1), begin, number))
            begin = None
        elif ends_head(lines, begin, number) == "no":
            begin = None
    return found


def ends_head(lines, begin, number):
    """Whether the lines from `begin` on are a function's head: yes, no (a declaration), or open."""
    head = " ".join(lines[begin - 1:number])
    brace, semicolon = head.find("{"), head.find(";")
    if brace >= 0 and (semicolon < 0 or brace < semicolon):
        return "no" if "=" in head[:brace] else "yes"
    return "no" if semicolon >= 0 else "open"


def code_lines(text):
    """How many lines hold code: no blank ones, no comments."""
    return sum(1 for line in code_of(text).split("\n") if line.strip())


def rules(name, folder=None):
    """The lines of a text file of rules as lists of words, without comments and blank lines."""
    path = pathlib.Path(folder or pathlib.Path(__file__).parent) / name
    lines = [line.split("#")[0].split() for line in path.read_text(encoding="utf-8").splitlines()]
    return [words for words in lines if words]


def exceptions(kind, folder=None):
    """The lines of exceptions.txt of one kind, {tuple of words: reason}. An exception without a reason is none."""
    path = pathlib.Path(folder or pathlib.Path(__file__).parent) / "exceptions.txt"
    found = {}
    for line in path.read_text(encoding="utf-8").splitlines():
        if not line.strip() or line.startswith("#"):
            continue
        rule, colon, reason = line.partition(": ")
        words = rule.split()
        if not colon or not reason.strip():
            raise ValueError(f"exceptions.txt: no reason: {line}")
        if words[0] == kind:
            found[tuple(words[1:])] = reason.strip()
    return found


def pending(rule):
    """How many places may still break a rule."""
    return {words[0]: int(words[1]) for words in rules("pending.txt")}.get(rule, 0)


class Case(unittest.TestCase):
    """A test of rules over the tree."""
    maxDiff = None

    def nothing(self, places, rule, kind=None):
        """No place breaks the rule, but for what exceptions.txt names under `kind` (a file, and words that its text has),
        and as many as pending.txt still allows. places: [(file, line, text)]. Every exception is needed."""
        excepted = exceptions(kind) if kind else {}
        wrong = [f"{path}:{line}: {text}" for path, line, text in places
                 if not any(matches(words, path, text) for words in excepted)]
        idle = [words for words in excepted if not any(matches(words, path, text) for path, _, text in places)]
        allowed = pending(rule)
        self.assertLessEqual(len(wrong), allowed, f"{rule}: {len(wrong)} places, {allowed} are allowed\n" + "\n".join(wrong))
        self.assertFalse(idle, "exceptions that are not needed any more")


def matches(words, path, text):
    return fnmatch.fnmatch(path, words[0]) and all(word in text for word in words[1:])


def run(*command, **options):
    return subprocess.run(command, check=True, capture_output=True, encoding="utf-8", **options).stdout
