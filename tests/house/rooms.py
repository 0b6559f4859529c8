# SPDX-License-Identifier: GPL-3.0-or-later
"""The rooms of the house and their floors, read from rooms.txt, and what may use what."""
import os
import re

import house


class House:
    def __init__(self, lines=None):
        self.height = 0    # how many floors there are
        self.floors = {}   # room -> floor, from 0
        self.apart = set()  # pairs of rooms that stay apart
        self.outside = {}  # header or folder of headers -> rooms
        self.roots = []    # where quoted includes are looked for
        self.made = set()  # headers that the build makes
        for words in house.rules("rooms.txt") if lines is None else lines:
            getattr(self, "_" + words[0])(*words[1:])

    def _floor(self, *rooms):
        for room in rooms:
            if room in self.floors:
                raise ValueError(f"rooms.txt: {room} has two floors")
            self.floors[room] = self.height
        self.height += 1

    def _apart(self, a, b):
        self.apart |= {(a, b), (b, a)}

    def _outside(self, header, *rooms):
        self.outside[header] = rooms

    def _root(self, *folders):
        self.roots += folders

    def _made(self, *headers):
        self.made |= set(headers)

    def room_of(self, path):
        """The room of a file: the longest folder above it that is one."""
        folder = os.path.dirname(path)
        while folder and folder not in self.floors:
            folder = os.path.dirname(folder)
        return folder or None

    def may_use(self, a, b):
        """Whether file a may use file b."""
        ra, rb = self.room_of(a), self.room_of(b)
        if ra is None or rb is None or ra == rb:
            return True
        if any(ra.startswith(x) and rb.startswith(y) for x, y in self.apart):
            return False
        return self.floors[rb] < self.floors[ra]


def component_of(path):
    return path.split("/")[0]


class Includes:
    """The quoted and the other includes of every source of a tree."""

    def __init__(self, tree, plan):
        self.tree, self.plan = tree, plan
        self.quoted = {}  # file -> [(as written, path found or None)]
        self.angled = {}  # file -> [header]
        for path in tree.sources():
            code = house.code_of(tree.read(path))
            self.angled[path] = re.findall(r"^\s*#\s*include\s*<([^>]+)>", code, re.M)
            self.quoted[path] = [(name, self.find(path, name))
                                 for name in re.findall(r'^\s*#\s*include\s*"([^"]+)"', code, re.M)]

    def find(self, path, name):
        """The file that `#include "name"` in `path` means; its own component's roots come first."""
        own = component_of(path) + "/"
        roots = sorted(self.plan.roots, key=lambda root: not (root + "/").startswith(own))
        for root in [os.path.dirname(path)] + roots:
            candidate = os.path.normpath(os.path.join(root, name))
            if (self.tree.root / candidate).is_file():
                return candidate
        return None


def is_public(path):
    return "/include/" in path


def private_uses(includes):
    """(file, header): a private header that is included from outside: internal.h beyond its folder, any private header
    beyond its component."""
    found = []
    for path, headers in includes.quoted.items():
        for _, header in headers:
            if header is None or is_public(header):
                continue
            folder = os.path.dirname(header)
            if os.path.basename(header) == "internal.h" and not path.startswith(folder + "/"):
                found.append((path, header))
            elif component_of(header) != component_of(path) and component_of(header) != "base":
                found.append((path, header))
    return found
