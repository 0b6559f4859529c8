# SPDX-License-Identifier: GPL-3.0-or-later
"""Fields with estimator = pdf-sym or pdf-sym-cross in the service: to the last bit what shearctl measure says of the
same files, whatever the order in which they come. (Killed in the middle: test_daemon_crash.py.)"""
import os
import subprocess
import time
import unittest

from daemon import DaemonTest, measured, mock, numbers, until
from tool import SHEARCTL

STAMPS = (48, 176, 90)  # of the parts
FIELDS = 1400           # more than are kept, less than two pages


class Symmetry(DaemonTest):
    def setUp(self):
        super().setUp()
        self.service = self.daemon()
        self.parts = [mock(os.path.join(self.service.data, f"part{i}.fits"), n, 32, i + 1,
                           "--rotate", 1) for i, n in enumerate(STAMPS)]

    def count(self, part, **settings):
        job = self.service.submit(self.parts[part], field="f", settings=settings)["id"]
        return self.service.wait_state(job, "done")

    def row(self, estimator):
        rows = [r for r in self.service.call("field", field="f")["rows"]
                if r["settings"]["estimator"] == estimator]
        self.assertEqual([r["estimator"] for r in rows], [estimator])
        return rows[0]

    def assertSolved(self, parts, estimator="pdf-sym"):
        expected = measured([self.parts[i] for i in parts], "--estimator", estimator)
        row = self.row(estimator)
        self.assertEqual(row["error_method"], "symmetry")
        self.assertEqual((row["jobs"], row["unfinished"]), (len(parts), 0))
        self.assertEqual(numbers(row), expected)
        summary = [f for f in self.service.call("fields")["fields"] if f["digest"] == row["digest"]]
        self.assertEqual([summary[0][k] for k in ("g1", "g1_err", "g2", "g2_err", "n_used")],
                         [expected[k] for k in ("g1", "g1_err", "g2", "g2_err", "n_used")])

    def test_equals_measure_in_any_order(self):
        for so_far in ((2,), (2, 0), (2, 0, 1)):  # asked for in between: what is kept must go
            job = self.count(so_far[-1], estimator="pdf-sym")
            own = measured([self.parts[so_far[-1]]], "--estimator", "pdf-sym")
            self.assertEqual(numbers(job["result"]), own)
            self.assertSolved(so_far)
        self.assertEqual(self.count(1, estimator="pdf-sym")["outcome"], "duplicate")
        self.assertSolved((0, 1, 2))
        self.service.kill()
        self.service.start()
        self.assertSolved((1, 2, 0))

    def test_beside_the_mean(self):
        """The estimator is a setting: a field by each, of the same files."""
        for part in (1, 0):
            self.count(part, estimator="pdf-sym")
            self.assertEqual(self.count(part, estimator="pdf-sym-cross")["outcome"], "counted")
            self.assertEqual(self.count(part)["outcome"], "counted")
        self.assertSolved((0, 1))
        self.assertSolved((0, 1), "pdf-sym-cross")
        self.assertEqual(numbers(self.row("mean")), measured(self.parts[:2]))
        shown = subprocess.run([SHEARCTL, "field", "--socket", self.service.socket, "f"],
                               check=True, capture_output=True, encoding="utf-8").stdout
        self.assertIn("estimator  pdf-sym", shown)
        self.assertIn("estimator  mean", shown)

    def test_nobody_waits_for_a_solving_but_who_asked(self):
        for part in (0, 1):
            self.count(part, estimator="pdf-sym")
            self.count(part, estimator="pdf-sym-cross")
        with self.service.client() as client:
            asked = [client.ask("field", {"field": "f"}), client.ask("fields"), client.ask("status")]
            order = [client.receive()["id"] for _ in asked]
            self.assertEqual(order, [asked[2], *asked[:2]])
        self.count(2, estimator="pdf-sym")
        with self.service.client() as client:
            client.ask("field", {"field": "f"})  # and goes
        self.assertSolved((0, 1, 2))
        self.assertSolved((0, 1), "pdf-sym-cross")

    def test_changes_are_told_when_solved(self):
        with self.service.client() as client:
            client.call("subscribe", fields=["f"])
            for so_far in ((0,), (0, 1)):
                self.count(so_far[-1], estimator="pdf-sym")
                expected = measured([self.parts[i] for i in so_far], "--estimator", "pdf-sym")
                told = None
                while told is None or told["jobs"] < len(so_far):
                    message = client.receive()
                    told = message["params"]["field"] if message["method"] == "field_changed" else told
                self.assertEqual([told[k] for k in ("g1", "g2_err")],
                                 [expected[k] for k in ("g1", "g2_err")])

    def test_the_last_change_is_told(self):
        """Also if it arrives while the one before is being solved: between two ticks of the service,
        which are a second apart."""
        with self.service.client() as client:
            client.call("subscribe", fields=["f"])
            jobs, end = 0, None
            while end is None or time.monotonic() < end:
                job = self.service.submit(self.parts[0], field="f", force=True,
                                          settings={"estimator": "pdf-sym"})["id"]
                self.service.wait_state(job, "done")
                jobs, end = jobs + 1, end or time.monotonic() + 1
            told = 0
            while told < jobs:
                message = client.receive()
                if message["method"] == "field_changed":
                    field = message["params"]["field"]
                    told = field["jobs"]
                    self.assertEqual(field["n_stamps"], told * STAMPS[0])

    def test_pages_of_many_fields(self):
        """Requests for more fields than are kept when nobody waits do not keep each other waiting."""
        small = mock(os.path.join(self.service.data, "small.fits"), 16, 16, 5, "--rotate", 1)
        with self.service.client() as client:
            asked = []
            for i in range(FIELDS):
                asked.append(client.ask("submit", {"path": small, "field": f"f{i % 2}-{i}",
                                                   "settings": {"estimator": "pdf-sym"}}))
                if len(asked) == 32:
                    client.answer(asked.pop(0))
            for number in asked:
                client.answer(number)
            self.service.wait_idle()
            asked = []
            for i in range(20):
                asked.append(client.ask("fields", {"limit": 1000, "prefix": f"f{i % 2}-"}))
                if len(asked) == 8:
                    self.assertEqual(len(client.answer(asked.pop(0))["fields"]), FIELDS // 2)
            for number in asked:
                self.assertEqual(len(client.answer(number)["fields"]), FIELDS // 2)

    def test_only_what_was_counted(self):
        """Stamps of a running job are in the mean at once, in the symmetry when it is done."""
        self.count(0, estimator="pdf-sym")
        slow = mock(os.path.join(self.service.data, "slow.fits"), 4000, 64, 9)
        job = self.service.submit(slow, field="f", settings={"estimator": "pdf-sym"})["id"]
        until(lambda: self.service.job(job)["progress"]["done"], "it measures")
        self.service.hold()
        row = self.row("pdf-sym")
        if self.service.job(job)["state"] == "running":
            self.assertEqual((row["running"], row["partial"]), ([job], True))
            self.assertEqual(numbers(row), measured(self.parts[:1], "--estimator", "pdf-sym"))
        self.service.go_on()
        self.service.wait_state(job, "done")
        self.parts.append(slow)
        self.assertSolved((0, 3))


if __name__ == "__main__":
    unittest.main()
