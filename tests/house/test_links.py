#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Rooms, as the linker sees them (nm over the objects of each program and library): no circle between files, no use of a
room that is not below one's own. BUILD in the environment is the build directory."""
import os
import unittest

import house
import links
import rooms

PLAN = rooms.House()


def upward(uses, plan):
    return sorted((a, b) for a in uses for b in uses[a] if not plan.may_use(a, b))


def tell_circle(uses, circle):
    return f"in a circle of {len(circle)}\n" + "\n".join(
        f"    {a} -> {b}: {', '.join(sorted(uses[a][b]))}" for a in circle for b in sorted(uses[a]) if b in circle)


class Links(house.Case):
    @classmethod
    def setUpClass(cls):
        cls.links = links.Links(os.environ["BUILD"])
        cls.uses = cls.links.uses
        for a, name in house.exceptions("stands_in"):
            for uses in cls.uses.values():
                uses.get(a, set()).discard(name)
        cls.uses = {a: {b: names for b, names in bs.items() if names} for a, bs in cls.uses.items()}

    def test_every_source_was_read(self):
        read = {links.source_of(o) for o in self.links.names}
        self.assertGreater(len(read), 300)

    def test_no_circle_between_files(self):
        excepted = house.exceptions("circle")
        found = links.circles(links.without(self.uses, excepted))
        self.nothing([(path, 0, tell_circle(self.uses, circle) if path == circle[0] else "the same circle")
                      for circle in found for path in circle], "circles")

    def test_every_excepted_circle_is_one(self):
        whole = links.circles(self.uses)
        for a, b in house.exceptions("circle"):
            self.assertTrue(b in self.uses[a] and any(a in c and b in c for c in whole), f"{a} -> {b} closes no circle")

    def test_nobody_uses_a_room_above(self):
        self.nothing([(a, 0, f"uses {b}: {', '.join(sorted(self.uses[a][b]))}") for a, b in upward(self.uses, PLAN)],
                     "upward", "upward")


if __name__ == "__main__":
    unittest.main()
