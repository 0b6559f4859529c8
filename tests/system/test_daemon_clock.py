# SPDX-License-Identifier: GPL-3.0-or-later
"""The wall clock is set, back and forward, while the service runs and while it does not. FAULTSHIM
(faultshim.c) is preloaded and moves the clock that the service sees."""
import datetime
import os
import shutil
import struct
import time
import unittest

from daemon import DaemonTest, mock, until

FAULTSHIM = os.path.abspath(os.environ["FAULTSHIM"])
DAY = 86400.0


def seconds(text):
    """Since 1970, of a time of the protocol."""
    return datetime.datetime.fromisoformat(text.replace("Z", "+00:00")).timestamp()


class ClockTest(DaemonTest):
    def service(self, ahead=0.0, **settings):
        self.clock = os.path.join(self.directory, "clock")
        self.set_clock(ahead)
        d = self.daemon({"catalogues.enabled": "true", **settings}, preload=FAULTSHIM,
                        env={"FAULT_CLOCK": self.clock})
        mock(d.path("data", "a.fits"))
        return d

    def set_clock(self, ahead):
        """So many seconds ahead of ours. In place: the service has the file in its memory."""
        flags = os.O_RDWR | os.O_CREAT
        file = os.open(self.clock, flags, 0o600)
        os.write(file, struct.pack("=q", round(ahead * 1000)))
        os.close(file)

    def waiting(self, d, name="a.fits"):
        """A job that waits: there is nowhere to write its catalog."""
        shutil.rmtree(d.path("catalogues"), ignore_errors=True)
        number = d.submit(d.path("data", name), force=True)["id"]
        return d.wait_state(number, "waiting")

    def cure(self, d):
        os.mkdir(d.path("catalogues"))

    def test_the_shim_moves_the_clock(self):
        d = self.service(30 * DAY)
        self.assertAlmostEqual(seconds(d.call("status")["started"]) - time.time(), 30 * DAY,
                               delta=DAY / 24)

    def test_set_back_while_it_runs(self):
        d = self.service(30 * DAY, **{"retry.first_delay": "2s", "retry.max_delay": "4s"})
        job = self.waiting(d)
        self.assertGreater(seconds(job["not_before"]), time.time() + 29 * DAY)
        self.set_clock(0)
        self.cure(d)
        self.assertEqual(d.wait_state(job["id"], "done", limit=60)["state"], "done")
        self.assertIn("the clock was set back", d.log_text())

    def test_set_back_while_it_is_down(self):
        d = self.service(30 * DAY, **{"retry.first_delay": "2s", "retry.max_delay": "4s"})
        job = self.waiting(d)
        d.kill()
        self.set_clock(0)
        self.cure(d)
        d.start()
        self.assertEqual(d.wait_state(job["id"], "done", limit=60)["state"], "done")

    def test_set_forward_is_not_waited_through(self):
        d = self.service(**{"retry.first_delay": "1h", "retry.max_delay": "1h"})
        job = self.waiting(d)
        self.set_clock(30 * DAY)
        until(lambda: "the clock was set forward" in d.log_text(), "it has seen that", 60)
        later = until(lambda: (j := d.job(job["id"])) and j["not_before"] != job["not_before"] and j,
                      "the job has moved with the clock")
        self.assertEqual((later["state"], later["attempts"]), ("waiting", 1))
        moved = seconds(later["not_before"]) - seconds(job["not_before"])
        self.assertAlmostEqual(moved, 30 * DAY, delta=5)

    def test_to_and_fro_changes_nothing(self):
        d = self.service(**{"retry.first_delay": "1h", "retry.max_delay": "1h"})
        job = self.waiting(d)
        for n, ahead in enumerate((-3650 * DAY, 3650 * DAY, 3600, 0), 1):
            self.set_clock(ahead)
            until(lambda: d.log_text().count("the clock was set") == n, "it has seen that", 60)
        d.call("status")
        later = d.job(job["id"])
        self.assertAlmostEqual(seconds(later["not_before"]), seconds(job["not_before"]), delta=10)

    def test_uptime(self):
        d = self.service()
        last = d.call("status")["uptime_s"]
        begun = time.monotonic()
        for ahead in (-3650 * DAY, 3650 * DAY, 0):
            self.set_clock(ahead)
            now = d.call("status")["uptime_s"]
            self.assertGreaterEqual(now, last)
            last = now
        self.assertLess(last, time.monotonic() - begun + 60)

    def test_ages(self):
        """What is kept for an hour is not removed because the clock is wrong."""
        d = self.service(**{"retention.jobs_max_age": "1h", "spool.done_max_age": "1h"})
        d.drop(d.path("data", "a.fits"), "a.fits")
        until(lambda: "a.fits" in d.dropped("done"), "it is measured")
        number = d.jobs()[0]["id"]
        self.set_clock(30 * DAY)
        until(lambda: "the clock was set forward" in d.log_text(), "it has seen that", 60)
        # Some turns of what removes, and a file that shows that the watch folder was searched.
        uptime = d.call("status")["uptime_s"]
        until(lambda: d.call("status")["uptime_s"] > uptime + 4, "it has gone on")
        self.assertEqual(d.job(number)["state"], "done")
        self.assertIn("a.fits", d.dropped("done"))

    def test_ages_pass(self):
        """... but what is old is removed."""
        d = self.service(**{"retention.jobs_max_age": "1s", "spool.done_max_age": "1s"})
        d.drop(d.path("data", "a.fits"), "a.fits")
        until(lambda: d.call("status")["totals"]["counted"] == 1, "it is measured")
        until(lambda: not d.jobs() and not d.dropped("done"), "it is forgotten")


if __name__ == "__main__":
    unittest.main()
