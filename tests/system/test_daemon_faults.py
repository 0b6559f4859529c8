# SPDX-License-Identifier: GPL-3.0-or-later
"""The n-th write, fsync or rename of the daemon fails, or is the last thing that it does, for every
n (SHEARD_FAULTS=all) or some of them (the default: that many of each kind). A single failure is
survived, or ends the daemon with a message; afterwards all that was acknowledged is there, and
each field has each of its files exactly once. FAULTSHIM in the environment is the library that lets
the calls fail."""
import os
import random
import struct
import unittest

from daemon import (DaemonTest, RpcError, content_of, measured, mock, named, until)

SHIM = os.path.abspath(os.environ["FAULTSHIM"])
FAULTS = os.environ.get("SHEARD_FAULTS", "4")
SEED = int(os.environ.get("SHEARD_SEED", "5"))
FIELDS = ("one", "two")
DROPPED = ["one-0.fits", "two-0.fits"]
KEYS = ["one/1", "two/1"]


class Faults(DaemonTest):
    @classmethod
    def setUpClass(cls):
        cls.rng = random.Random(SEED)

    def setUp(self):
        super().setUp()
        self.files = [mock(os.path.join(self.directory, f"part{i}.fits"), 8 + 4 * i, 32, i + 1)
                      for i in range(2)]
        self.contents = [content_of(path) for path in self.files]
        self.expected = measured(self.files)
        self.runs = 0

    def sheltered(self, calls="wsr", at=0, how="EIO", length=1):
        """A daemon that has not been started, below the shim."""
        self.runs += 1
        name = f"run{self.runs}"
        where = os.path.join(self.directory, name)
        faults = {"FAULT_BELOW": f"{where}/state:{where}/spool", "FAULT_CALLS": calls,
                  "FAULT_AT": str(at), "FAULT_HOW": how, "FAULT_LENGTH": str(length),
                  "FAULT_COUNT": os.path.join(self.directory, "count")}
        daemon = self.daemon(name=name, start=False, preload=SHIM, env=faults)
        for i, path in enumerate(self.files):
            os.link(path, os.path.join(daemon.data, f"part{i}.fits"))
        for i in ("incoming", "active", "done", "failed"):
            os.makedirs(daemon.folder(i), mode=0o755)
        return daemon

    def calls(self):
        return struct.unpack("=q", content_of(os.path.join(self.directory, "count")))[0]

    # ---- what is done while the fault strikes ----

    def submit(self, daemon, acknowledged):
        """Each job once more, until it is acknowledged or the daemon is gone."""
        for key in KEYS:
            def tried():
                try:
                    path = os.path.join(daemon.data, "part1.fits")
                    result = daemon.call("submit", path=path, field=key[:3], key=key)
                    acknowledged.setdefault(key, result["job"]["id"])
                    self.assertEqual(acknowledged[key], result["job"]["id"])
                    return True
                except RpcError as error:
                    self.assertTrue(error.error["data"]["retry"], error)
                except (OSError, EOFError):
                    pass
                return not daemon.alive()
            until(tried, f"{key} is acknowledged, or the daemon is gone")

    def drop(self, daemon):
        for field, name in zip(FIELDS, DROPPED):
            daemon.drop(None, name, named(self.contents[0], field))
        daemon.drop(None, "bad.fits", self.contents[0][:5000])

    def work(self, daemon, acknowledged):
        """All of it, or as much as the daemon does before it dies."""
        daemon.spawn()
        self.drop(daemon)
        self.submit(daemon, acknowledged)

        def over():
            try:
                return not daemon.alive() or self.idle(daemon)
            except (OSError, EOFError, RpcError):
                return False
        until(over, f"the daemon is idle or gone: {self.point}", step=0.02)

    def idle(self, daemon):
        states = daemon.call("status")["states"]
        return not (states["queued"] or states["running"] or states["waiting"] or
                    daemon.dropped("incoming") or daemon.dropped("active"))

    def check(self, daemon, acknowledged):
        message = self.point
        jobs = {job["id"]: job for job in daemon.jobs()}
        for key, number in acknowledged.items():
            self.assertIn(number, jobs, f"{key} was acknowledged and is lost: {message}")
        self.assertEqual(sorted(acknowledged), KEYS, message)
        self.assertEqual(sorted(job["state"] for job in jobs.values()),
                         ["done"] * 4 + ["failed"], message)
        self.assertEqual(daemon.dropped("done"),
                         sorted(DROPPED + [name + ".json" for name in DROPPED]), message)
        self.assertEqual(daemon.dropped("failed"), ["bad.fits", "bad.fits.json"], message)
        self.assertEqual(daemon.side("failed", "bad.fits")["code"], "bad_file")
        for field in FIELDS:
            self.assertRow(daemon, field, self.expected, 2, message)

    def run_one(self, calls="wsr", at=0, how="EIO", length=1):
        self.point = f"calls {calls}, {how} at {at} for {length}"
        daemon, acknowledged = self.sheltered(calls, at, how, length), {}
        self.work(daemon, acknowledged)
        counted = self.calls()
        self.assertGreaterEqual(counted, at, f"nothing failed: {self.point}")
        if daemon.alive():
            self.check(daemon, acknowledged)
            daemon.kill()
        elif how != "KILL":
            self.assertEqual(daemon.process.returncode, 1, self.point)
            self.assertIn("error", daemon.log_text(), self.point)
        daemon.env.pop("LD_PRELOAD")
        daemon.start()
        self.submit(daemon, acknowledged)
        daemon.wait_idle()
        self.check(daemon, acknowledged)
        self.assertEqual(os.listdir(daemon.folder("active")), [], self.point)
        daemon.close()
        return counted

    def points(self, calls):
        # Turns of the loop take what has come meanwhile, so that the number differs a little.
        total = self.run_one(calls) * 3 // 4
        self.assertGreater(total, 4)
        if FAULTS == "all":
            return range(1, total + 1)
        return sorted(self.rng.sample(range(1, total + 1), min(total, int(FAULTS))))

    def loop(self, calls, how, length=1):
        for at in self.points(calls):
            with self.subTest(calls=calls, how=how, at=at):
                self.run_one(calls, at, how, length)

    def test_writes(self):
        self.loop("w", "EIO")

    def test_syncs(self):
        self.loop("s", "EIO")

    def test_renames(self):
        self.loop("r", "EIO")

    def test_no_space(self):
        self.loop("ws", "ENOSPC", 20)

    def test_death(self):
        self.loop("wsr", "KILL")


if __name__ == "__main__":
    unittest.main()
