# SPDX-License-Identifier: GPL-3.0-or-later
"""The dialect of CONTRIBUTING.md, "Style", as far as a program of regular expressions can tell. Each rule takes the path and
the text of a file, and gives [(line, what is wrong)]."""
import re

import house

POINTER = re.compile(r"(?<![\w)\]])(?:const\s+|volatile\s+|static\s+|struct\s+|enum\s+|unsigned\s+)*"
                     r"([A-Za-z_]\w*)\s+(?:const\s+)?\*+\s*(?:const\s+|restrict\s+)*([A-Za-z_]\w*)\s*(?=[,;)=\[]|$)")
NOT_TYPES = {"return", "case", "else", "sizeof", "goto"}


def line_of(text, at):
    return text.count("\n", 0, at) + 1


def pointer_tests(path, text):
    """`!p`, `if (p)`, `p && q`: a pointer that is asked without NULL. Pointers are known by their declarations in the same
    function; members are not known."""
    del path
    found = []
    lines = house.bare_code_of(text).split("\n")
    for _, begin, end in house.functions_of(text):
        body = "\n".join(lines[begin - 1:end])
        names = {m.group(2) for m in POINTER.finditer(body) if m.group(1) not in NOT_TYPES}
        names -= {m.group(1) for m in re.finditer(r"\b(?:bool|int|size_t|double|unsigned)\s+(\w+)\s*[;=,)]", body)}
        if not names:
            continue
        name = r"(?:" + "|".join(sorted(map(re.escape, names))) + r")"
        bare = name + r"\b(?!\s*(?:->|\[|\(|\.|[=!<>]=|[-+*/%&<>=]\s*[^&|]))"
        for rule in (r"(?<![\w>.])!\s*" + bare, r"\b(?:if|while)\s*\(" + bare + r"\s*(?=\)|&&|\|\|)",
                     r"(?:&&|\|\|)\s*" + bare + r"\s*(?=\)|&&|\|\||;|\?)", r"(?<![=!<>])=\s*" + bare + r"\s*\?"):
            for m in re.finditer(rule, body):
                found.append((begin + body.count("\n", 0, m.start()),
                              f"a pointer is asked without NULL: {m.group().strip()}"))
    return sorted(set(found))


def declared_types(texts):
    """The names of `typedef struct name name;` in any of the texts: their structs are defined elsewhere."""
    return {name for text in texts for name in re.findall(r"\btypedef struct (\w+) \1;", house.bare_code_of(text))}


def typedefs(path, text, declared=frozenset()):
    """`typedef struct name { ... } name;`, or a typedef of its own; and no typedef of an enum."""
    del path
    found = []
    code = house.bare_code_of(text)
    for m in re.finditer(r"^(?:static\s+|const\s+)*struct\s+(\w+)\s*\{", code, re.M):
        if m.group(1) in declared:
            continue
        found.append((line_of(code, m.start()), f"struct {m.group(1)} without its typedef"))
    for m in re.finditer(r"^typedef\s+enum\b", code, re.M):
        found.append((line_of(code, m.start()), "a typedef of an enum"))
    for m in re.finditer(r"^typedef\s+struct\s+(\w*)\s*\{", code, re.M):
        end = re.compile(r"^\}\s*(\w+)", re.M).search(code, m.end())
        if end is None or m.group(1) != end.group(1):
            found.append((line_of(code, m.start()), f"tag and typedef differ: {m.group(1)}, {end and end.group(1)}"))
    return found


def lengths(path, text):
    """Files of at most 400 lines, functions of at most 60: (0, ...) for the file."""
    del path
    n = len(text.splitlines())
    found = [(0, f"file of {n} lines")] if n > 400 else []
    return found + [(begin, f"function {name} of {end - begin + 1} lines")
                    for name, begin, end in house.functions_of(text) if end - begin + 1 > 60]


def python_lengths(path, text):
    """Lines of Python of at most 125 columns."""
    del path
    return [(number, f"line of {len(line)} columns") for number, line in enumerate(text.split("\n"), 1) if len(line) > 125]


def ladders(path, text):
    """Two and more `if (code == SHEAR_OK` in one function: rungs of a ladder where early returns would do."""
    del path
    lines = house.bare_code_of(text).split("\n")
    found = []
    for name, begin, end in house.functions_of(text):
        rungs = [n for n in range(begin, end + 1)
                 if re.search(r"\bif \(\w+ == SHEARD?_(?:RPC_)?OK\b", lines[n - 1])]
        found += [(n, f"a rung of a ladder in {name}") for n in rungs if len(rungs) > 1]
    return found


def include_style(path, text):
    """The own header first, then "others", and <system> last; a private header is called internal.h."""
    found = []
    seen = [(number, m.group(1), m.group(2)) for number, line in enumerate(house.code_of(text).split("\n"), 1)
            for m in [re.match(r'\s*#\s*include\s*([<"])([^>"]+)[>"]', line)] if m]
    stem = re.sub(r"\.[ch]$", "", path.split("/")[-1])
    for at, (number, kind, name) in enumerate(seen):
        before = seen[:at]
        if kind == '"' and any(k == "<" for _, k, _ in before):
            found.append((number, f'"{name}" after <system>'))
        is_own = path.endswith(".c") and kind == '"' and name.split("/")[-1] == stem + ".h"
        if is_own and before and before[0][2].split("/")[-1] != stem + ".h":
            found.append((number, f'"{name}" is the own header, and not the first'))
        if name.split("/")[-1] == "inner.h":
            found.append((number, f'"{name}": a private header is called internal.h'))
    return found


class Words:
    """The words of words.txt."""

    def __init__(self, lines):
        self.prose, self.parts = [], []
        for kind, word in lines:
            if kind == "prose":
                self.prose.append((word, re.compile(r"\b" + word.replace("_", r"[\s*]+"))))
            else:
                self.parts.append((word, re.compile(r"(?<![A-Za-z0-9])" + word + r"(?![A-Za-z0-9])", re.I)))

    def of_prose(self, text):
        """[(line, word)] in a text of any kind."""
        return sorted((line_of(text, m.start()), word) for word, pattern in self.prose for m in pattern.finditer(text))

    def of_source(self, path, text):
        """[(line, word)] in the comments and strings of a C file, and in its names."""
        del path
        found = [(line + inner - 1, word) for line, token in house.comments_of(text) + house.strings_of(text)
                 for inner, word in self.of_prose(token)]
        code = house.bare_code_of(text)
        names = [(line_of(code, m.start()), m.group()) for m in re.finditer(r"[A-Za-z_]\w*", code)] if self.parts else []
        return sorted(found + [(line, word) for word, pattern in self.parts for line, name in names if pattern.search(name)])


def enums_as_ints(path, text):
    """`int kind; /* enum axis_kind */`: it could be declared so. Codes are of several enums, and stay int."""
    del path
    return [(number, f"{m.group(1)} is of an enum's type: {m.group(2)}")
            for number, line in enumerate(text.split("\n"), 1)
            for m in [re.search(r"\bint (\w+)(?:\[\w+\])?;\s*/\* (enum \w+)", line)]
            if m and m.group(1) not in ("code", "failed")]


def stale_names(names):
    """A rule: a comment speaks of a source file that is not there; `names` are those that are."""
    def rule(path, text):
        del path
        return [(line + token.count("\n", 0, m.start()), f"there is no {m.group()}")
                for line, token in house.comments_of(text)
                for m in re.finditer(r"(?<![\w./<*-])[\w./-]*\w\.[ch]\b(?![\w(.])", token)
                if m.group().split("/")[-1] not in names and "NAME" not in m.group() and not m.group().startswith("linux/")]
    return rule
