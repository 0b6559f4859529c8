# SPDX-License-Identifier: GPL-3.0-or-later
"""The method probe: it measures with the engine, reports exactly why it cannot, and delays nobody."""
import json
import os
import shutil
import subprocess
import unittest

from daemon import SLOW, SHEARD, DaemonTest, mock
from tool import SHEARCTL


class Probe(DaemonTest):
    def with_reader(self, script, settings=None):
        """A daemon whose reader is this shell script."""
        programs = os.path.join(self.directory, "programs")
        os.mkdir(programs)
        shutil.copy(SHEARD, programs)
        reader = os.path.join(programs, "sheard-reader")
        with open(reader, "w", encoding="utf-8") as f:
            f.write(f"#!/bin/sh\n{script}\n")
        os.chmod(reader, 0o755)
        d = self.daemon(settings, start=False)
        d.program = os.path.join(programs, "sheard")
        return d.start()

    def test_it_measures(self):
        d = self.daemon()
        before = d.call("status")
        found = d.call("probe")
        self.assertTrue(found["ok"], found)
        self.assertIsNone(found["code"])
        self.assertEqual((found["true_g1"], found["true_g2"], found["stamps"]), (0.02, -0.01, 16))
        self.assertLess(abs(found["g1"] - 0.02), 2e-4)
        self.assertLess(abs(found["g2"] + 0.01), 2e-4)
        self.assertGreater(found["g1_err"], 0)
        self.assertGreater(found["seconds"], 0)
        self.assertIs(type(found["landlock"]), bool)
        again = d.call("probe")
        self.assertEqual([again[k] for k in ("g1", "g1_err", "g2", "g2_err")],
                         [found[k] for k in ("g1", "g1_err", "g2", "g2_err")])
        after = d.call("status")
        for key in ("totals", "states", "queue"):
            self.assertEqual(after[key], before[key], "nothing of it is in the state")
        self.assertEqual(after["store"]["commits"], before["store"]["commits"])
        self.assertEqual(d.call("fields")["fields"], [])

    def test_settings_of_the_service_do_not_matter(self):
        d = self.daemon({"measure.interpolation": "log-bicubic", "measure.beta": "40"})
        self.assertTrue(d.call("probe")["ok"])

    def test_many_ask_at_once(self):
        d = self.daemon()
        with d.client() as client:
            asked = [client.ask("probe") for _ in range(12)]
            answers = [client.answer(number) for number in asked]
        self.assertTrue(all(answer["ok"] for answer in answers))

    def test_the_reader_cannot_start(self):
        d = self.with_reader("echo 'error while loading shared libraries: libcfitsio.so.99' >&2; exit 127")
        found = d.call("probe")
        self.assertFalse(found["ok"])
        self.assertEqual(found["code"], "io")
        self.assertIn("libcfitsio.so.99", found["message"])
        self.assertTrue(found["advice"])
        self.assertIsNone(found["g1"])
        self.assertIn("libcfitsio.so.99", d.log_text())
        os.unlink(os.path.join(os.path.dirname(d.program), "sheard-reader"))
        self.assertIn("No such file", d.call("probe")["message"])

    def test_a_reader_that_hangs_holds_up_nobody(self):
        d = self.with_reader("exec /bin/sleep 1000", {"reader.wall_time": "3s"})
        with d.client() as client:
            asked = client.ask("probe")
            for _ in range(10):
                self.assertEqual(d.call("status")["state"], "running")
            found = client.answer(asked)
        self.assertEqual((found["ok"], found["code"]), (False, "reader_timeout"))

    def test_the_service_can_be_stopped_meanwhile(self):
        d = self.with_reader("exec /bin/sleep 1000", {"reader.wall_time": "1h"})
        with d.client() as client:
            client.ask("probe")
            d.call("status")
            d.call("shutdown", mode="now")
            self.assertEqual(d.ended(), 0)

    def doctor(self, d):
        run = subprocess.run([SHEARCTL, "doctor", "--json", "--socket", d.socket], capture_output=True, text=True)
        return run.returncode, [json.loads(line) for line in run.stdout.splitlines()]

    def test_doctor_asks_the_service(self):
        """Whatever is, or is not, where the installed configuration says."""
        d = self.daemon()
        code, found = self.doctor(d)
        self.assertEqual([f for f in found if f["level"] == "fail"], [])
        self.assertEqual(code, 0)
        told = {f["subject"]: f["message"] for f in found}
        self.assertIn(d.state, told["state"])
        self.assertIn(d.spool, told["spool"])
        self.assertIn(d.config, told["config"])
        self.assertIn(d.data, told["data root"])
        self.assertIn("the service measures", told["probe"])
        self.assertIn("sandbox", told)

    def test_doctor_tells_why_the_service_cannot_measure(self):
        d = self.with_reader("echo 'no libcfitsio.so.99' >&2; exit 127")
        code, found = self.doctor(d)
        self.assertEqual(code, 1)
        bad = [f for f in found if f["level"] == "fail"]
        self.assertEqual([f["subject"] for f in bad], ["probe"])
        self.assertIn("no libcfitsio.so.99", bad[0]["message"])

    def test_beside_jobs(self):
        d = self.daemon()
        slow = d.held(d.submit(mock(d.data + "/a.fits", 400, 32),
                               settings=SLOW)["id"])
        self.assertTrue(d.call("probe")["ok"], "a job whose reader hangs does not hold it up")
        d.call("cancel", id=slow)


if __name__ == "__main__":
    unittest.main()
