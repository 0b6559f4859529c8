# SPDX-License-Identifier: GPL-3.0-or-later
"""kill -9 at random moments, while fields are submitted and dropped: whatever was accepted is done
exactly once, and every field equals the uninterrupted run to the last bit. SHEARD_CRASHES is the
number of kills, SHEARD_SEED makes another run of it."""
import contextlib
import os
import random
import shutil
import sqlite3
import threading
import time
import unittest

from daemon import (SLOW, SLOW_OPTIONS, DaemonTest, RpcError, content_of, measured, mock, named, stamps_for, until)

CRASHES = int(os.environ.get("SHEARD_CRASHES", "12"))
SEED = int(os.environ.get("SHEARD_SEED", "3"))
PARTS = 4     # files of a field: half are submitted, half are dropped
BLOCK = 16        # stamps
CHECKPOINT_S = 5  # between two checkpoints of a job
BACKLOG = 24  # jobs that may be unfinished before the stream pauses


class Stream(threading.Thread):
    """Fields without end, until told to stop: submits each odd part with an idempotency key until
    it is acknowledged, drops each even one into the watch folder. Fields are whole at the end."""

    def __init__(self, daemon, parts, contents):
        super().__init__()
        self.daemon_, self.parts, self.contents = daemon, parts, contents
        self.enough = threading.Event()
        self.accepted, self.dropped, self.fields, self.trouble = {}, [], [], None

    def run(self):
        try:
            while not self.enough.is_set() or not self.fields:
                self.one_field(f"f{len(self.fields)}")
        except BaseException as error:  # told by the test
            self.trouble = error

    def one_field(self, field):
        self.fields.append(field)
        for i, (path, content) in enumerate(zip(self.parts, self.contents)):
            if i % 2 == 1:
                self.submit(path, field, f"{field}/{i}")
            else:
                name = f"{field}-{i}.fits"
                self.daemon_.drop(None, name, named(content, field))
                self.dropped.append(name)
        self.rest()

    def ask(self, method, **params):
        """Again and again, for as long as the service is away."""
        def tried():
            try:
                return self.daemon_.call(method, **params)
            except RpcError as error:
                if not error.error["data"]["retry"]:
                    raise
            except (OSError, EOFError, ValueError):
                pass
            return None
        return until(tried, f"{method} is answered")

    def submit(self, path, field, key):
        self.accepted[key] = self.ask("submit", path=path, field=field, key=key)["job"]["id"]

    def rest(self):
        def few():
            states = self.ask("status")["states"]
            return states["queued"] + states["running"] + states["waiting"] < BACKLOG
        until(few, "the backlog is worked off")


class Crash(DaemonTest):
    def killed(self, daemon):
        """Kill it; its readers die with it."""
        readers = daemon.children()
        daemon.kill()
        until(lambda: not any(os.path.exists(f"/proc/{pid}/exe") for pid in readers),
              "the readers died with the service")

    def test_stream(self):
        rng = random.Random(SEED)
        daemon = self.daemon()
        parts = [mock(os.path.join(daemon.data, f"part{i}.fits"), 12 + 4 * i, 32, i + 1)
                 for i in range(PARTS)]
        contents = [content_of(path) for path in parts]
        expected = measured(parts)
        stream = Stream(daemon, parts, contents)
        stream.start()
        try:
            for _ in range(CRASHES):
                # Half of the kills hit the start, where what the last kill left is put in order.
                stream.join(rng.choice((0.06, 0.8)) * rng.random())
                self.killed(daemon)
                daemon.spawn()
        finally:
            stream.enough.set()
            until(lambda: daemon.ready(), "the service answers")
            stream.join()
        if stream.trouble is not None:
            raise stream.trouble
        daemon.wait_idle(600)
        self.check(daemon, stream, expected)
        self.killed(daemon)
        self.check(daemon.start(), stream, expected)

    def check(self, daemon, stream, expected):
        jobs = {job["id"]: job for job in daemon.jobs()}
        for key, number in stream.accepted.items():
            self.assertIn(number, jobs, f"{key} was accepted and is lost")
            self.assertEqual(jobs[number]["key"], key)
        self.assertEqual(len(set(stream.accepted.values())), len(stream.accepted))
        self.assertEqual(len(jobs), len(stream.accepted) + len(stream.dropped))
        for job in jobs.values():
            self.assertEqual((job["state"], job["outcome"]), ("done", "counted"), job)
        self.assertEqual(daemon.dropped("failed"), [])
        self.assertEqual(daemon.dropped("done"),
                         sorted(stream.dropped + [name + ".json" for name in stream.dropped]))
        for name in stream.dropped:
            self.assertEqual(daemon.side("done", name)["state"], "done")
        for field in stream.fields:
            row = self.assertRow(daemon, field, expected, PARTS, field)
            self.assertEqual(len({c["job"] for c in row["contributions"]}), PARTS)
            self.assertEqual(len({c["checksum"] for c in row["contributions"]}), PARTS)


class Checkpoint(DaemonTest):
    """A job that takes long: what it measured before the kill is not measured again."""

    def saved(self, daemon):
        """The next block of each checkpoint on disk, read from a copy of the database."""
        copy = os.path.join(self.directory, "copy")
        shutil.rmtree(copy, ignore_errors=True)
        shutil.copytree(daemon.state, copy)
        with contextlib.closing(sqlite3.connect(os.path.join(copy, "sheard.db"))) as base:
            try:
                rows = base.execute("select next_block from checkpoints").fetchall()
                self.terms = base.execute("select sum(length(bytes)) / 56 from checkpoint_terms"
                                          ).fetchone()[0]
            except sqlite3.DatabaseError:  # copied while it was written
                return []
        return [row[0] for row in rows]

    def interrupt(self, daemon, job, meanwhile=lambda: None):
        """Kill it when a checkpoint is due, and start it again; return the blocks that it saved."""
        due = time.monotonic() + CHECKPOINT_S + 1
        until(lambda: time.monotonic() > due, "a checkpoint is due")
        before = daemon.job(job)["progress"]["done"]
        daemon.go_on()
        until(lambda: daemon.job(job)["progress"]["done"] > before, "the turn that saves")
        daemon.hold()
        until(lambda: self.saved(daemon), "the checkpoint")
        daemon.kill()
        saved = self.saved(daemon)
        meanwhile()
        daemon.start()
        return saved

    def test_resume(self):
        daemon = self.daemon({"daemon.workers": 1})
        job, path = self.large(daemon)
        saved = self.interrupt(daemon, job)
        self.assertEqual(len(saved), 1, "no checkpoint")
        self.assertGreater(saved[0], 0)
        done = until(lambda: daemon.job(job)["progress"]["done"], "it goes on")
        self.assertGreaterEqual(done, saved[0] * BLOCK, "it began anew")
        daemon.wait_state(job, "done")
        expected = measured([path], *SLOW_OPTIONS)
        self.assertRow(daemon, "large", expected, 1)
        endings = [a["ending"] for a in daemon.call("job", id=job)["history"]]
        self.assertEqual(endings, ["interrupted", "done"])

    def test_resume_with_terms(self):
        """The terms from before the kill are stored with the sums: the symmetry is that of one run."""
        daemon = self.daemon({"daemon.workers": 1})
        job, path = self.large(daemon, estimator="pdf-sym")
        saved = self.interrupt(daemon, job)
        self.assertEqual(len(saved), 1, "no checkpoint")
        self.assertEqual(self.terms, saved[0] * BLOCK)
        done = until(lambda: daemon.job(job)["progress"]["done"], "it goes on")
        self.assertGreaterEqual(done, saved[0] * BLOCK, "it began anew")
        daemon.wait_state(job, "done")
        expected = measured([path], *SLOW_OPTIONS, "--estimator", "pdf-sym")
        self.assertRow(daemon, "large", expected, 1)

    def large(self, daemon, seconds=6, **more):
        """A job that is measured for about so long, held in the middle, and its file."""
        stamps = stamps_for(seconds, 32, *SLOW_OPTIONS)
        path = mock(os.path.join(daemon.data, "large.fits"), stamps, 32, 9)
        return daemon.held(daemon.submit(path, settings={**SLOW, **more})["id"]), path

    def kept(self, daemon):
        """Temporary files of catalogs."""
        return [n for n in os.listdir(daemon.path("catalogues")) if n.endswith(".part")]

    def test_resume_with_catalog(self):
        """The rows from before the kill are on disk: the catalog is that of an uninterrupted run,
        to the last byte."""
        daemon = self.daemon({"daemon.workers": 1, "catalogues.enabled": "true"})
        job, path = self.large(daemon)
        saved = self.interrupt(daemon, job)
        self.assertEqual(len(saved), 1, "no checkpoint")
        self.assertGreater(saved[0], 0)
        done = until(lambda: daemon.job(job)["progress"]["done"], "it goes on")
        self.assertGreaterEqual(done, saved[0] * BLOCK, "it began anew")
        self.assertIn(f"goes on at block {saved[0]}", daemon.log_text())
        self.assertEqual(self.kept(daemon), [f".{job}.shear.fits.part"])
        catalog = daemon.wait_state(job, "done")["catalogue"]
        expected = os.path.join(self.directory, "expected.fits")
        row = measured([path], *SLOW_OPTIONS, "--catalog", expected)
        self.assertRow(daemon, "large", row, 1)
        self.assertEqual(content_of(catalog), content_of(expected))
        self.assertEqual(self.kept(daemon), [])

    def test_without_its_rows_it_begins_anew(self):
        """Temporary files of ended jobs are removed at the start, those of cancelled ones at once."""
        daemon = self.daemon({"daemon.workers": 1, "catalogues.enabled": "true"})
        job, _ = self.large(daemon)

        def lose():
            os.unlink(daemon.path("catalogues", f".{job}.shear.fits.part"))
            for orphan in (".77.shear.fits.part", ".x.shear.fits.part"):
                with open(daemon.path("catalogues", orphan), "wb"):
                    pass
        self.assertEqual(len(self.interrupt(daemon, job, lose)), 1, "no checkpoint")
        until(lambda: daemon.job(job)["progress"]["done"], "it measures")
        self.assertIn("goes on at block 0", daemon.log_text())
        self.assertEqual(sorted(self.kept(daemon)),
                         [f".{job}.shear.fits.part", ".x.shear.fits.part"])
        daemon.call("cancel", id=job)
        daemon.wait_state(job, "cancelled")
        until(lambda: self.kept(daemon) == [".x.shear.fits.part"], "its rows are gone")


if __name__ == "__main__":
    unittest.main()
