# SPDX-License-Identifier: GPL-3.0-or-later
"""Dropped files: what was accepted is measured, despite interruptions; a failed one can be tried
again as long as its file exists."""
import os
import random
import shutil
import signal
import sqlite3
import time
import unittest

from daemon import SLOW_MEASURE, SLOW_OPTIONS, DaemonTest, RpcError, content_of, mock, named, stamps_for, until

FILES = int(os.environ.get("SHEARD_DROPPED", "100"))
KILLS = int(os.environ.get("SHEARD_DROPPED_KILLS", "10"))
SEED = int(os.environ.get("SHEARD_SEED", "7"))

MANY = 100  # more than the spool tells in a turn


def large(path):
    """A field that is measured for long enough to be held in the middle."""
    return mock(path, stamps_for(2, 32, *SLOW_OPTIONS), 32)


class Restart(DaemonTest):
    """All in active/, none measured: the readers are held."""

    def full(self, count=MANY, settings=None):
        daemon = self.daemon({**SLOW_MEASURE, "daemon.workers": 1, "daemon.max_active_jobs": 1,
                              **(settings or {})})
        first = large(os.path.join(self.directory, "first.fits"))
        daemon.drop(first, "first.fits")
        daemon.held(until(daemon.jobs, "the first is a job")[0]["id"])
        content = content_of(mock(os.path.join(self.directory, "small.fits"), 16, 32))
        for i in range(count):
            daemon.drop(None, f"x{i}.fits", named(content, f"f{i}"))
        until(lambda: len(daemon.dropped("active")) == count + 1 and not daemon.dropped("incoming"),
              "all are taken")
        until(lambda: len(daemon.jobs()) == count + 1, "all are jobs", step=0.1)
        return daemon

    def finished(self, daemon, count=MANY):
        daemon.wait_idle()
        jobs = daemon.jobs()
        self.assertEqual(len(jobs), count + 1)
        self.assertEqual({(j["state"], j["outcome"]) for j in jobs}, {("done", "counted")},
                         [j for j in jobs if j["state"] != "done"][:2])
        self.assertEqual(daemon.dropped("failed"), [])
        self.assertEqual(len(daemon.dropped("done")), 2 * (count + 1))
        self.assertEqual(daemon.call("status")["totals"]["counted"], count + 1)

    def test_killed(self):
        daemon = self.full()
        daemon.kill()
        self.finished(daemon.start())

    def test_stopped(self):
        daemon = self.full(settings={"daemon.drain_timeout": "1s"})
        daemon.signal(signal.SIGTERM)
        daemon.signal(signal.SIGTERM)
        daemon.ended()
        self.finished(daemon.start())

    def test_other_defaults(self):
        """The settings of a file are those of the time when it was accepted."""
        daemon = self.full(8)
        daemon.kill()
        daemon.settings["measure.beta"] = "1.4"
        daemon.write_config()
        self.finished(daemon.start(), 8)
        betas = {j["settings"]["beta"] for j in daemon.jobs()}
        self.assertEqual(len(betas), 1, betas)

    def test_moved_spool(self):
        """The whole spool has moved before the next start."""
        daemon = self.full(8)
        daemon.kill()
        os.rename(daemon.spool, daemon.path("elsewhere"))
        daemon.spool = daemon.settings["spool.directory"] = daemon.path("elsewhere")
        daemon.write_config()
        self.finished(daemon.start(), 8)

    def test_job_file(self):
        """Its input is missing when the file is announced again: the job fails, the file is not lost."""
        daemon = self.daemon({**SLOW_MEASURE, "daemon.workers": 1, "daemon.max_active_jobs": 1,
                              "retry.attempts": 1})
        path = large(os.path.join(daemon.data, "large.fits"))
        daemon.held(daemon.submit(path)["id"])
        lost = mock(os.path.join(daemon.data, "lost.fits"))
        daemon.drop(None, "job.json", f'{{"path": "{lost}"}}'.encode())
        job = until(lambda: daemon.jobs(states=["queued"]), "it is a job")[0]["id"]
        daemon.kill()
        os.unlink(lost)
        daemon.start()
        self.assertEqual(daemon.wait_state(job, "failed")["code"], "file_vanished")
        daemon.wait_idle()
        self.assertEqual(daemon.side("failed", "job.json")["job"]["id"], job)


class Retry(DaemonTest):
    def setUp(self):
        super().setUp()
        self.large = large(os.path.join(self.directory, "large.fits"))

    def one(self, name="a.fits"):
        """A dropped file's job in the middle of its measurement."""
        daemon = self.daemon({**SLOW_MEASURE, "daemon.workers": 1, "retry.attempts": 1})
        daemon.drop(self.large, name)
        return daemon, daemon.held(until(daemon.jobs, "it is a job")[0]["id"])

    def cancelled(self):
        daemon, job = self.one()
        daemon.call("cancel", id=job)
        daemon.wait_state(job, "cancelled")
        until(lambda: daemon.dropped("failed") == ["a.fits", "a.fits.json"], "its file is there")
        return daemon, job

    def succeeds(self, daemon, job, name="a.fits", jobs=1):
        self.assertEqual(daemon.call("retry", id=job)["state"], "queued")
        self.assertEqual(daemon.dropped("failed"), [])
        self.assertEqual(daemon.wait_state(job, "done")["outcome"], "counted")
        daemon.wait_idle()
        self.assertEqual(daemon.dropped("done"), [name, name + ".json"])
        self.assertEqual(content_of(daemon.folder("done", name)), content_of(self.large))
        self.assertEqual(daemon.side("done", name)["job"]["id"], job)
        self.assertEqual(len(daemon.jobs()), jobs)

    def test_names(self):
        """Its original name, and its place."""
        daemon, job = self.one()
        record = daemon.job(job)
        self.assertEqual(record["dropped_name"], "a.fits")
        self.assertEqual(record["file_now"], daemon.folder("active", daemon.dropped("active")[0]))
        self.assertIn("a.fits (active)", daemon.shearctl("jobs"))
        with daemon.client() as client:
            client.call("subscribe", jobs=[job])
            client.call("cancel", id=job)
            waited = client.call("wait", ids=[job])["jobs"][0]
            notices = [n["params"]["job"] for n in client.notices if n["method"] == "job_changed"]
        failed = daemon.folder("failed", "a.fits")
        self.assertEqual([waited["file_now"], notices[-1]["file_now"]], [failed, failed])
        self.assertEqual(daemon.jobs()[0]["file_now"], failed)
        self.assertIn("a.fits (failed/a.fits)", daemon.shearctl("jobs"))
        self.assertIn(failed, daemon.shearctl("show", str(job)))
        self.assertEqual(daemon.side("failed", "a.fits")["job"]["dropped_name"], "a.fits")
        os.unlink(failed)
        self.assertIsNone(daemon.job(job)["file_now"])
        self.assertIn("a.fits (gone)", daemon.shearctl("jobs"))
        self.assertIn("taken away", daemon.shearctl("show", str(job)))

    def test_cancelled(self):
        self.succeeds(*self.cancelled())

    def test_failed(self):
        daemon, job = self.one("b.fits")
        daemon.go_on()

        def failed():
            for pid in daemon.children():
                os.kill(pid, signal.SIGKILL)
            return daemon.job(job)["state"] == "failed"
        until(failed, "its reader was killed twice")
        self.assertEqual(daemon.job(job)["code"], "reader_crashed")
        until(lambda: len(daemon.dropped("failed")) == 2, "its file is there")
        self.succeeds(daemon, job, "b.fits")

    def test_after_a_restart(self):
        daemon, job = self.cancelled()
        daemon.kill()
        self.succeeds(daemon.start(), job)

    def test_place_unknown(self):
        """As in a database of 0.1, or after a power failure: the report identifies the file."""
        daemon, job = self.cancelled()
        daemon.stop()
        with sqlite3.connect(os.path.join(daemon.state, "sheard.db")) as base:
            base.execute("update jobs set resting = null, resting_print = null")
        base.close()
        shutil.copy(self.large, daemon.folder("failed", "a.1.fits"))
        daemon.start()
        self.assertEqual(daemon.call("retry", id=job)["state"], "queued")
        self.assertEqual(daemon.dropped("failed"), ["a.1.fits"])
        daemon.wait_state(job, "done")

    def test_fails_again(self):
        daemon = self.daemon({"retry.attempts": 1})
        daemon.drop(None, "bad.fits", b"x" * 2880)
        job = until(lambda: daemon.jobs(states=["failed"]), "it failed")[0]["id"]
        for _ in range(3):
            until(lambda: daemon.dropped("failed") == ["bad.fits", "bad.fits.json"], "it is there")
            self.assertEqual(daemon.call("retry", id=job)["state"], "queued")
            daemon.wait_state(job, "failed")
        daemon.wait_idle()
        self.assertEqual(daemon.dropped("failed"), ["bad.fits", "bad.fits.json"])

    def test_gone_or_replaced(self):
        daemon, job = self.cancelled()
        path = daemon.folder("failed", "a.fits")
        os.rename(path, daemon.path("kept"))
        with self.assertRefused("no_such_file") as caught:
            daemon.call("retry", id=job)
        self.assertIn("failed/a.fits", str(caught.exception))
        self.assertIn("incoming", caught.exception.error["data"]["advice"])
        mock(path, 16, 32)
        with self.assertRefused("file_changed") as caught:
            daemon.call("retry", id=job)
        self.assertIn("failed/a.fits", str(caught.exception))
        self.assertEqual(daemon.job(job)["state"], "cancelled")
        self.assertEqual(daemon.dropped("active"), [])
        os.rename(daemon.path("kept"), path)
        self.succeeds(daemon, job)

    def test_refused(self):
        """If the job may not run again, its file stays where it is."""
        daemon, job = self.cancelled()
        daemon.settings["limits.queue"] = 1
        daemon.write_config()
        daemon.call("reload")
        other = shutil.copy(self.large, os.path.join(daemon.data, "other.fits"))
        number = daemon.held(daemon.submit(other)["id"])
        with self.assertRefused("queue_full"):
            daemon.call("retry", id=job)
        self.assertEqual(daemon.dropped("failed"), ["a.fits", "a.fits.json"])
        self.assertEqual(daemon.dropped("active"), [])
        daemon.call("cancel", id=number)
        daemon.wait_state(number, "cancelled")
        self.succeeds(daemon, job, jobs=2)


class Crashes(DaemonTest):
    """kill -9 at random moments with many files in active/, while jobs are cancelled and tried
    again: each file is measured once, and none is lost. SHEARD_DROPPED files, SHEARD_DROPPED_KILLS
    kills; SHEARD_SEED makes another run of it."""
    # What a client may hear; anything else of a retry would be a file lost.
    EXPECTED = ("wrong_state", "queue_full", "draining", "stopping")

    def mischief(self, daemon, rng, until_then):
        """Some waiting jobs are cancelled, and cancelled ones tried again."""
        with daemon.client(max(0.01, until_then - time.monotonic())) as client:
            for method, state in (("cancel", "queued"), ("retry", "cancelled")):
                for job in client.call("jobs", states=[state], limit=40)["jobs"]:
                    if rng.random() < 0.3:
                        try:
                            client.call(method, id=job["id"])
                        except RpcError as error:
                            self.assertIn(error.code, self.EXPECTED, error)

    def live(self, daemon, rng, seconds):
        end = time.monotonic() + seconds
        daemon.spawn()
        while time.monotonic() < end:
            try:
                self.mischief(daemon, rng, end)
            except (OSError, EOFError, ValueError):
                time.sleep(0.002)
        self.assertTrue(daemon.alive(), daemon.log_text())
        daemon.kill()

    def settle(self, daemon):
        """Retry all cancelled jobs, until nothing is left to do."""
        def done():
            with daemon.client() as client:
                for job in client.call("jobs", states=["cancelled"], limit=200)["jobs"]:
                    client.call("retry", id=job["id"])
                states = client.call("status")["states"]
            return states["done"] == FILES and not daemon.dropped("active")
        until(done, "all are done", 1200, 0.05)

    def test_many(self):
        rng = random.Random(SEED)
        daemon = self.daemon({**SLOW_MEASURE, "daemon.workers": 1})  # so that there is much left to kill
        content = content_of(mock(os.path.join(self.directory, "a.fits"), 8, 32))
        large = content_of(mock(os.path.join(self.directory, "b.fits"), 64, 32))
        contents = {f"x{i}.fits": named(large if i % 16 == 0 else content, f"f{i}")
                    for i in range(FILES)}
        daemon.kill()
        for name, text in contents.items():
            daemon.drop(None, name, text)
        daemon.start()
        until(lambda: not daemon.dropped("incoming"), "all are taken")
        daemon.kill()
        left, before = 0, 0
        for _ in range(KILLS):
            before = len(daemon.dropped("active"))
            left += before
            self.live(daemon, rng, rng.choice((0.05, 0.3)) * rng.random())
        self.settle(daemon.start())
        print(f"{KILLS} kills with {left / KILLS:.0f} of {FILES} files in active/ on average, "
              f"{before} before the last")
        jobs = daemon.jobs()
        self.assertEqual(len(jobs), FILES)
        self.assertEqual({(j["state"], j["outcome"]) for j in jobs}, {("done", "counted")})
        self.assertEqual(sorted(j["dropped_name"] for j in jobs), sorted(contents))
        self.assertEqual({j["file_now"] for j in jobs},
                         {daemon.folder("done", name) for name in contents})
        self.assertEqual(daemon.call("status")["totals"]["counted"], FILES)
        for folder, names in (("incoming", []), ("active", []), ("failed", []),
                              ("done", [*contents, *(name + ".json" for name in contents)])):
            self.assertEqual(daemon.dropped(folder), sorted(names), folder)
        for name, text in contents.items():
            self.assertEqual(content_of(daemon.folder("done", name)), text)
            self.assertEqual(daemon.side("done", name)["state"], "done")


if __name__ == "__main__":
    unittest.main()
