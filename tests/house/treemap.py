# SPDX-License-Identifier: GPL-3.0-or-later
"""The map of the tree in docs/architecture.md: a line for every file, made of the comment at its head, or at that of the
public header of its name. A block

    <!-- files core/fft -->
    <!-- end -->

lists the files of that folder (not of folders within it), a header and its source as one."""
import os
import re

LONGEST = 150
ABBREVIATION = re.compile(r"\b(eqs?|e\.g|i\.e|cf|vs)\.$")  # its full stop ends no sentence
BLOCK = re.compile(r"<!-- files (\S+) -->\n.*?<!-- end -->", re.S)


def head_of(text):
    """What the comment at a file's head says first: its first sentence, without the file's own name."""
    m = re.match(r"/\* SPDX[^\n]*\*/\s*/\*(.*?)\*/", text, re.S)
    if m is None:
        return ""
    paragraph = re.split(r"\n \*[ \t]*\n|\n \*\s{3,}", m.group(1).strip("*\n "))[0]
    words = re.sub(r"\s*\n \*\s?", " ", paragraph).strip()
    words = re.sub(r"^\*?\s*(@file\s+\S+\s+(@brief\s+)?)?", "", words)
    words = re.sub(r"^[\w./-]+\.[ch]: ", "", words)
    ends = (m.end() for m in re.finditer(r"[\w)\]'\"/>]\.(?=\s|$)", words))
    end = next((end for end in ends if not ABBREVIATION.search(words[:end])), len(words))
    return shortened(" ".join(words[:end].split()).rstrip(".:"))


def shortened(text):
    """At most LONGEST characters, up to the end of a clause."""
    if len(text) <= LONGEST:
        return text
    ends = [m.start() for m in re.finditer(r"[:;,] ", text[:LONGEST])]
    return text[:ends[-1]] if ends else text[:text.rindex(" ", 0, LONGEST)]


def stem_of(path):
    return re.sub(r"\.[ch]$", "", path)


def public_header_of(tree, stem):
    """The public header of the same name in the same component, as [path] or []."""
    name = os.path.basename(stem) + ".h"
    return [p for p in tree.files(".h", folders=(stem.split("/")[0] + "/include",)) if os.path.basename(p) == name]


def lines_of(tree, folder):
    """The lines of one block."""
    here = [p for p in tree.files(".c", ".h") if os.path.dirname(p) == folder]
    found = []
    for stem in sorted({stem_of(p) for p in here}):
        kinds = [e for e in (".h", ".c") if stem + e in here]
        files = [stem + e for e in kinds] + public_header_of(tree, stem)
        told = next(filter(None, (head_of(tree.read(p)) for p in files)), "")
        found.append(f"- `{os.path.basename(stem)}{','.join(kinds)}` {told}".rstrip())
    return found


def filled(tree, text):
    """The document with its blocks filled."""
    def block(m):
        return "\n".join([f"<!-- files {m.group(1)} -->"] + lines_of(tree, m.group(1)) + ["<!-- end -->"])
    return BLOCK.sub(block, text)


def folders_of(text):
    return [m.group(1) for m in BLOCK.finditer(text)]
