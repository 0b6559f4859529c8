# SPDX-License-Identifier: GPL-3.0-or-later
"""The memory that all jobs may use together: jobs wait for it, those that need more than all of it are refused, and what
they use is what they announced."""
import os
import re
import time
import unittest

from daemon import DaemonTest, FINAL, measured, mock, until
from tool import SANITIZED

MIB = 1 << 20
# A sanitizer makes plans slow: a quarter of the pixels, and of the memory, there.
SIDE, LESS = (64, 4) if SANITIZED else (128, 1)
HEAVY = {"interpolation": "spline", "oversample": 32}  # 520 MiB / LESS while it is planned
SLACK = 64 * MIB  # what the service itself takes, its threads and its database's cache


def memory(process):
    """Resident memory: private, and shared with readers."""
    with open(f"/proc/{process.pid}/status", encoding="ascii") as f:
        fields = dict(line.split(":", 1) for line in f)
    return 1024 * sum(int(fields[name].split()[0]) for name in ("RssAnon", "RssShmem"))


class Budget(DaemonTest):
    def heavy(self, daemon, n, **settings):
        path = mock(os.path.join(daemon.data, "a.fits"), 4, SIDE, 1, "--psf-size", 33)
        return [daemon.submit(path, field=f"f{i}", settings={**HEAVY, "beta": 2.5 + i / 10, **settings})["id"]
                for i in range(n)]

    @unittest.skipIf(SANITIZED, "a sanitizer's own memory would count")
    def test_many_large_jobs(self):
        """Each job needs 520 MiB while it is planned. All are done, but not all at once: never do they exceed the budget."""
        daemon = self.daemon({"limits.memory": "600M", "daemon.max_active_jobs": 8, "plans.max_bytes": "1T"})
        jobs, most, waited, phases = self.heavy(daemon, 8), 0, 0, set()
        with daemon.client() as client:
            while any(client.call("job", id=job)["job"]["state"] not in FINAL for job in jobs):
                most = max(most, memory(daemon.process))
                said = client.call("status")["memory"]
                self.assertEqual(said["budget"], 600 * MIB)
                self.assertLessEqual(said["used"], said["budget"])
                waited = max(waited, said["waiting"])
                time.sleep(0.02)
                phases |= {client.call("job", id=job)["job"]["progress"]["phase"] for job in jobs}
        print(f"\n8 jobs in a budget of 600 MiB: at most {most // MIB} MiB; {waited} waited at a time", flush=True)
        self.assertEqual({daemon.job(job)["state"] for job in jobs}, {"done"})
        self.assertLess(most, 600 * MIB + SLACK)
        self.assertGreater(most, 350 * MIB, "the jobs are too small for this test")
        self.assertGreater(waited, 0)
        self.assertIn("waiting_memory", phases)
        until(lambda: daemon.call("status")["memory"]["used"] == daemon.call("status")["plans"]["bytes"],
              "all is given back")

    def test_impossible(self):
        """Refused for good; the message has the memory needed, the limit and the setting. Smaller jobs run meanwhile."""
        budget = 100 * MIB // LESS
        daemon = self.daemon({"limits.memory": str(budget)})
        job = daemon.wait_state(self.heavy(daemon, 1)[0], *FINAL)
        self.assertEqual((job["state"], job["class"], job["code"], job["attempts"]), ("failed", "data", "memory_budget", 1),
                         job)
        needed, = re.findall(rf"need (\d+) bytes of memory, and \[limits\] memory allows {budget} for all jobs",
                             job["message"])
        self.assertGreater(int(needed), budget)
        self.assertIn("limits", job["advice"])
        small = mock(os.path.join(daemon.data, "small.fits"), 8, 32)
        self.assertEqual(daemon.submit(small, wait=True)["state"], "done")
        # With as much as it says, the same job is done, by one worker.
        daemon.settings["limits.memory"] = needed
        daemon.write_config()
        daemon.call("reload")
        self.assertEqual(daemon.call("status")["memory"]["budget"], int(needed))
        daemon.call("retry", id=job["id"])
        retried = daemon.wait_state(job["id"], *FINAL)
        if retried["state"] == "failed":  # planning took the most at first
            self.assertEqual(retried["code"], "memory_budget")
            more, = re.findall(r"need (\d+) bytes", retried["message"])
            self.assertGreater(int(more), int(needed))
            daemon.settings["limits.memory"] = more
            daemon.write_config()
            daemon.call("reload")
            daemon.call("retry", id=job["id"])
            retried = daemon.wait_state(job["id"], *FINAL)
        self.assertEqual(retried["state"], "done", retried)
        self.assertRow(daemon, "f0",
                       measured([os.path.join(daemon.data, "a.fits")], "--interpolation", "spline", "--oversample",
                                              "32", "--beta", "2.5"), 1)

    def test_waiting_can_be_cancelled_and_stopped(self):
        daemon = self.daemon({"limits.memory": str(600 * MIB // LESS), "daemon.max_active_jobs": 4})
        path = mock(os.path.join(daemon.data, "long.fits"), 400, SIDE, 1, "--psf-size", 33)
        first = daemon.held(daemon.submit(path, settings=HEAVY)["id"])
        second, third = self.heavy(daemon, 2)
        for job in (second, third):
            until(lambda: daemon.job(job)["progress"]["phase"] == "waiting_memory", f"job {job} waits")
        self.assertEqual(daemon.call("status")["memory"]["waiting"], 2)
        daemon.call("cancel", id=second)
        self.assertEqual(daemon.wait_state(second, *FINAL)["state"], "cancelled")
        daemon.call("cancel", id=first)
        self.assertEqual(daemon.wait_state(first, *FINAL)["state"], "cancelled")
        self.assertEqual(daemon.wait_state(third, *FINAL)["state"], "done")
        first = daemon.held(daemon.submit(path, settings=HEAVY)["id"])
        fourth = daemon.submit(path, field="other", settings={**HEAVY, "beta": 3})["id"]
        until(lambda: daemon.job(fourth)["progress"]["phase"] == "waiting_memory", "it waits")
        daemon.go_on()
        self.assertEqual(daemon.call("shutdown", mode="now")["state"], "stopping")
        self.assertEqual(daemon.ended(), 0)


class Estimates(DaemonTest):
    SHAPES = [(64, {"interpolation": "bicubic", "oversample": 32}),
              (128, {"interpolation": "spline", "oversample": 16, "filter": "edge"}),
              (128, {"interpolation": "spline", "oversample": 32}),
              (256, {"interpolation": "bilinear", "oversample": 8, "filter": "edge"})]

    @unittest.skipIf(SANITIZED, "a sanitizer's own memory would count")
    def test_within_a_factor(self):
        """The most that a job took, and what was reserved for it: neither is half as much again as the other."""
        daemon = self.daemon({"limits.memory": "8G", "plans.max_count": "none", "daemon.max_active_jobs": 1})
        for side, settings in self.SHAPES:
            path = mock(os.path.join(daemon.data, f"s{side}.fits"), 4, side, 1, "--psf-size", 33)
            until(lambda: daemon.call("status")["memory"]["used"] == daemon.call("status")["plans"]["bytes"],
                  "the job before gave its memory back")
            before, most, said = memory(daemon.process), 0, 0
            job = daemon.submit(path, field="x", force=True, settings={**settings, "beta": 2.5})["id"]
            with daemon.client() as client:
                while client.call("job", id=job)["job"]["state"] not in FINAL:
                    most = max(most, memory(daemon.process) - before)
                    said = max(said, client.call("status")["memory"]["used"])
            self.assertEqual(daemon.job(job)["state"], "done", daemon.job(job))
            print(f"\n{side} px, {settings}: reserved {said / MIB:.0f} MiB, taken {most / MIB:.0f} MiB", end="", flush=True)
            self.assertLess(most, 1.5 * said + 16 * MIB)
            self.assertLess(said, 1.5 * most + 16 * MIB)


if __name__ == "__main__":
    unittest.main()
