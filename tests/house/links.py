# SPDX-License-Identifier: GPL-3.0-or-later
"""Which source file uses which, as the linker sees it. For each program and library of build.ninja the objects that it is
made of are read by nm; a use is a name that one object wants and another object of the same target defines, so that equal
names in two programs do not meet."""
import collections
import os
import pathlib
import re

import house

DEFINES, WANTS = "TDRBVWCu", "U"


class Links:
    """uses[a][b]: the names of b that a uses; a and b are paths of sources from the root."""

    def __init__(self, build):
        self.build = str(build)
        self.inputs = read_ninja(self.build)
        targets = [t for t in self.inputs if re.match(r"(bin|lib)/", t)]
        self.objects = {t: objects_of(self.inputs, t) for t in targets}
        every = sorted({o for objects in self.objects.values() for o in objects})
        self.names = read_names(self.build, [o for o in every if os.path.exists(os.path.join(self.build, o))])
        self.uses = collections.defaultdict(lambda: collections.defaultdict(set))
        for objects in self.objects.values():
            self._add(objects)

    def _add(self, objects):
        owner = {}
        for o in objects:
            for name in self.names.get(o, ((), ()))[0]:
                owner.setdefault(name, o)
        for o in objects:
            for name in self.names.get(o, ((), ()))[1]:
                if name in owner and owner[name] != o:
                    self.uses[source_of(o)][source_of(owner[name])].add(name)


def source_of(obj):
    """core/fits/CMakeFiles/shear_fits.dir/io/file.c.o -> core/fits/io/file.c"""
    return os.path.normpath(re.sub(r"CMakeFiles/[^/]+\.dir/", "", obj)[:-2])


def read_ninja(build):
    """{output: [inputs]} of the objects, libraries and programs of build.ninja."""
    text = pathlib.Path(build, "build.ninja").read_text(encoding="utf-8").replace("$\n", "")
    inputs = {}
    for outputs, rest in re.findall(r"^build ([^:\n]+): (\S+ [^\n]+)$", text, re.M):
        words = [w for w in rest.split()[1:] if w not in ("|", "||", "|@")]
        for output in outputs.replace("|", " ").split():
            inputs[output] = words
    return inputs


def objects_of(inputs, target, seen=None):
    """The objects of a target and of the archives that it links; a shared library of the tree counts like an archive."""
    seen = set() if seen is None else seen
    found = set()
    for word in inputs.get(target, ()):
        if word in seen:
            continue
        seen.add(word)
        if word.endswith(".c.o"):
            found.add(word)
        elif re.search(r"\.(a|so)(\.\d+)*$", word):
            found |= objects_of(inputs, word, seen)
    return {o for o in found if not o.startswith("tests/")}


def read_names(build, objects):
    """{object: (names it defines, names it wants)}"""
    names = {o: (set(), set()) for o in objects}
    for at in range(0, len(objects), 200):
        for line in house.run("nm", "-A", *objects[at:at + 200], cwd=build).splitlines():
            obj, _, symbol = line.partition(":")
            words = symbol.split()
            if words[-2] in DEFINES:
                names[obj][0].add(words[-1])
            elif words[-2] in WANTS:
                names[obj][1].add(words[-1])
    return names


def circles(uses):
    """The circles among files, each a sorted list (Tarjan's strongly connected components of two and more)."""
    index, low, stack, found = {}, {}, [], []

    def visit(v):
        index[v] = low[v] = len(index)
        stack.append(v)
        for w in uses.get(v, ()):
            if w not in index:
                visit(w)
                low[v] = min(low[v], low[w])
            elif w in stack:
                low[v] = min(low[v], index[w])
        if low[v] == index[v]:
            at = stack.index(v)
            component = sorted(stack[at:])
            del stack[at:]
            if len(component) > 1:
                found.append(component)

    for v in sorted(uses):
        if v not in index:
            visit(v)
    return found


def without(uses, excepted):
    """uses without the excepted pairs of files."""
    return {a: {b: names for b, names in bs.items() if (a, b) not in excepted} for a, bs in uses.items()}
