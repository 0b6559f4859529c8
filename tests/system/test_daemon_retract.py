# SPDX-License-Identifier: GPL-3.0-or-later
"""What was counted is taken back: the field is then as if the file had never been counted; and a
field without a result because of one file names it."""
import os
import shutil
import sqlite3
import struct
import subprocess
import time
import unittest

from daemon import (SLOW, SLOW_OPTIONS, content_of, DaemonTest, measured, mock, numbers, stamps_for, turns, until)
from fitsfile import BLOCK, card
from tool import SANITIZED, SHEARCTL


def poisoned(path):
    """One pixel of one galaxy is a sentinel, -1e30: the sum of w D falls far below 0."""
    content = bytearray(content_of(path))
    end = next(i for i in range(0, len(content), 80) if content[i:i + 80] == card("END"))
    data = -(-(end + 80) // BLOCK) * BLOCK
    at = content.index(b"BITPIX  =                  -32", 0)
    while at > data:  # the galaxies are in the first HDU that has pixels
        end = next(i for i in range(data, len(content), 80) if content[i:i + 80] == card("END"))
        data = -(-(end + 80) // BLOCK) * BLOCK
    at = data + 4 * (7 * 32 * 32 + 5 * 32 + 5)
    content[at:at + 4] = struct.pack(">f", -1e30)
    with open(path, "wb") as f:
        f.write(content)
    return path


FORGOTTEN = 4000 if SANITIZED else 20000
TURN_MS = 300 if SANITIZED else 50  # at once, that many take a second


class Retract(DaemonTest):
    def setUp(self):
        super().setUp()
        self.daemon_ = self.daemon({"catalogues.enabled": "true", "access.admin_users": "root"})

    def file(self, name, seed, stamps=48):
        return mock(os.path.join(self.daemon_.data, name), stamps, 32, seed)

    def count(self, path, **params):
        job = self.daemon_.submit(path, field="f", **params)["id"]
        return self.daemon_.wait_state(job, "done")

    def catalogs(self):
        return sorted(n for n in os.listdir(self.daemon_.path("catalogues")) if n[0] != ".")

    def test_as_if_never(self):
        daemon = self.daemon_
        paths = [self.file(f"{i}.fits", i + 1) for i in range(4)]
        jobs = [self.count(path)["id"] for path in paths]
        for estimator in ("mean", "pdf-sym"):
            settings = {} if estimator == "mean" else {"estimator": estimator}
            if settings:
                jobs = [self.count(path, settings=settings)["id"] for path in paths]
            digest = daemon.job(jobs[0])["digest"]
            options = ("--estimator", estimator)

            def row():
                return next(r for r in daemon.call("field", field="f")["rows"]
                            if r["digest"] == digest)
            self.assertEqual(numbers(row()), measured(paths, *options))
            gone = daemon.call("retract", id=jobs[1])
            self.assertEqual((gone["state"], gone["outcome"], gone["catalogue"]),
                             ("retracted", None, None))
            self.assertEqual(numbers(row()), measured(paths[:1] + paths[2:], *options))
            self.assertEqual(daemon.call("retract", id=jobs[1])["state"], "retracted")
            again = self.count(paths[1], settings=settings)
            self.assertEqual(again["outcome"], "counted")
            self.assertEqual(numbers(row()), measured(paths, *options))
        names = {os.path.basename(j["catalogue"]) for j in daemon.jobs() if j["catalogue"]}
        until(lambda: set(self.catalogs()) == names, "catalogs of retracted jobs are gone")
        daemon.kill()
        daemon.start()
        self.assertEqual(set(self.catalogs()), names)

    def test_last_one(self):
        """A field without contributions is removed; its subscribers are notified."""
        daemon = self.daemon_
        job = self.count(self.file("a.fits", 1))["id"]
        with daemon.client() as client:
            client.call("subscribe", fields=["f"])
            client.call("retract", id=job)

            def told():
                client.call("status")
                return [n["params"]["field"] for n in client.notices
                        if n["method"] == "field_changed" and n["params"]["field"]["jobs"] == 0]
            self.assertEqual(until(told, "the field's change is told", step=0.1)[-1]["g1"], None)
        with self.assertRefused("no_such_field"):
            daemon.call("field", field="f")
        status = daemon.call("status")
        self.assertEqual((status["states"]["retracted"], status["totals"]["retracted"]), (1, 1))

    def test_dropped(self):
        """The file stays in done/, and may be dropped again."""
        daemon = self.daemon_
        path = mock(os.path.join(self.directory, "a.fits"))
        daemon.drop(path, "a.fits")
        job = until(lambda: daemon.jobs(states=["done"]), "it is done")[0]["id"]
        daemon.wait_idle()
        daemon.shearctl("retract", str(job))
        self.assertEqual(daemon.job(job)["file_now"], daemon.folder("done", "a.fits"))
        daemon.drop(path, "a.fits")
        again = until(lambda: daemon.jobs(states=["done"]), "it is done")[0]
        self.assertEqual(again["outcome"], "counted")

    def test_refused(self):
        daemon = self.daemon_
        path = self.file("a.fits", 1)
        first = self.count(path)["id"]
        shutil.copy(path, path + ".fits")
        second = self.count(path + ".fits")
        self.assertEqual(second["outcome"], "duplicate")
        with self.assertRefused("wrong_state") as caught:
            daemon.call("retract", id=second["id"])
        self.assertIn(f"duplicate of job {first}", str(caught.exception))
        with self.assertRefused("no_such_job"):
            daemon.call("retract", id=99)
        with self.assertRefused("no_such_field"):
            daemon.call("forget", field="none")

    def test_forget(self):
        daemon = self.daemon_
        paths = [self.file(f"{i}.fits", i + 1) for i in range(3)]
        for path in paths:
            self.count(path)
        digest = daemon.job(1)["digest"]
        more = self.file("more.fits", 9, stamps_for(10, 32, *SLOW_OPTIONS))
        running = daemon.held(daemon.submit(more, field="f", settings=SLOW)["id"])
        with self.assertRefused("wrong_state"):  # though nothing was counted with its settings yet
            daemon.call("forget", field="f")
        self.assertEqual(daemon.call("forget", field="f", digest=digest)["jobs"], 3)
        daemon.call("cancel", id=running)
        daemon.go_on()
        daemon.wait_state(running, "cancelled")
        for path in paths:
            self.count(path)
        other = self.count(paths[0], settings={"beta-ratio": 1.6})
        run = subprocess.run([SHEARCTL, "forget", "--socket", daemon.socket, "f"],
                             capture_output=True, encoding="utf-8", env=daemon.env)
        self.assertEqual(run.returncode, 2)
        self.assertIn("4 contributions", run.stderr)
        self.assertEqual(len(daemon.call("field", field="f")["rows"]), 2)
        self.assertIn("1 jobs retracted",
                      daemon.shearctl("forget", "f", "--digest", other["digest"], "--yes"))
        self.assertRow(daemon, "f", measured(paths), 3)
        self.assertEqual(daemon.call("forget", field="f"),
                         {"field": "f", "rows": 1, "contributions": 3, "jobs": 3})
        with self.assertRefused("no_such_field"):
            daemon.call("field", field="f")
        until(lambda: not self.catalogs(), "the catalogs are gone")
        self.assertEqual(self.count(paths[0])["outcome"], "counted")

    def counted_many(self, many):
        """The field has that many more of the one contribution that it has: of jobs 2, 3, ..., each with a catalog."""
        daemon = self.daemon_
        catalog = self.count(self.file("a.fits", 1, 2))["catalogue"]
        daemon.stop()
        with sqlite3.connect(os.path.join(daemon.state, "sheard.db")) as base:
            def names(table):
                return [name for _, name, *_ in base.execute(f"pragma table_info({table})")]

            def repeat(table, **other):
                columns = names(table)
                values = ", ".join(other.get(c, c) for c in columns)
                base.execute("with recursive n(i) as (select 2 union all select i + 1 from n where i <= ?)"
                             f" insert into {table} ({', '.join(columns)})"
                             f" select {values} from {table}, n where {table}.id = 1",
                             (many,))
            repeat("jobs", id="i", catalogue=f"'{os.path.dirname(catalog)}/' || i || '.shear.fits'")
            repeat("contributions", id="i", job="i", content="content || i")
            base.execute("update fields set (jobs, n_stamps, n_used) ="
                         " (select count(*), sum(n_stamps), sum(n_used) from contributions)")
            base.execute("update totals set counted = counted + ?", (many,))
        base.close()
        for i in range(2, many + 2):
            with open(os.path.join(os.path.dirname(catalog), f"{i}.shear.fits"), "wb"):
                pass
        daemon.start()

    def assertAllForgotten(self, jobs):
        status = self.daemon_.call("status")
        self.assertEqual(status["totals"]["retracted"], jobs)
        self.assertEqual((status["states"]["done"], status["states"]["retracted"]), (0, jobs))
        self.assertEqual(self.catalogs(), [])
        with self.assertRefused("no_such_field"):
            self.daemon_.call("field", field="f")

    def test_forget_several(self):
        """Each reply is about its own field, whatever else is being forgotten."""
        daemon = self.daemon_
        paths = [self.file(f"{i}.fits", i + 1, 2) for i in range(3)]
        for path in paths:
            self.count(path)
        self.count(paths[0], settings={"beta-ratio": 1.6})
        daemon.wait_state(daemon.submit(paths[0], field="g")["id"], "done")
        with daemon.client() as client:
            asked = [client.ask("forget", {"field": name}) for name in "fgf"]
            self.assertEqual(client.answer(asked[0]), {"field": "f", "rows": 2, "contributions": 4, "jobs": 4})
            self.assertEqual(client.answer(asked[1]), {"field": "g", "rows": 1, "contributions": 1, "jobs": 1})
            with self.assertRefused("no_such_field"):
                client.answer(asked[2])
        self.assertEqual(self.catalogs(), [])

    @turns
    def test_forget_many(self):
        """Others are served meanwhile, and see at once that the field is gone."""
        daemon = self.daemon_
        self.counted_many(FORGOTTEN)
        with daemon.client() as client:
            number = client.ask("forget", {"field": "f"})
            until(lambda: not daemon.call("fields")["fields"], "the field is gone", step=0.001)
            self.assertLess(daemon.call("status")["totals"]["retracted"], FORGOTTEN)
            self.assertEqual(client.answer(number),
                             {"field": "f", "rows": 1, "contributions": FORGOTTEN + 1, "jobs": FORGOTTEN + 1})
        self.assertAllForgotten(FORGOTTEN + 1)
        self.assertTurns(daemon, TURN_MS)

    def test_forget_killed(self):
        """What is left of a field that was being forgotten is removed after the next start; what was counted since stays."""
        daemon = self.daemon_
        self.counted_many(FORGOTTEN)
        with daemon.client() as client:
            client.ask("forget", {"field": "f"})
            until(lambda: daemon.call("status")["totals"]["retracted"] > 0, "some have left", step=0.001)
            daemon.kill()
        daemon.start()
        self.assertLess(daemon.call("status")["totals"]["retracted"], FORGOTTEN)
        with self.assertRefused("no_such_field"):
            daemon.call("field", field="f")
        again = self.count(os.path.join(daemon.data, "a.fits"))
        self.assertEqual(again["outcome"], "counted")
        until(lambda: daemon.call("status")["totals"]["retracted"] > FORGOTTEN, "all have left")
        self.assertRow(daemon, "f", measured([os.path.join(daemon.data, "a.fits")]), 1)
        self.assertEqual(self.catalogs(), [os.path.basename(again["catalogue"])])
        daemon.call("forget", field="f")
        self.assertAllForgotten(FORGOTTEN + 2)

    def retired(self):
        """Of six jobs of a field two are kept, and one of other settings: that one."""
        daemon = self.daemon_
        daemon.settings["retention.jobs_max_count"] = 3
        daemon.write_config()
        daemon.call("reload")
        for i in range(6):
            self.count(self.file(f"{i}.fits", i + 1, 2))
        other = self.count(self.file("other.fits", 9, 2), settings={"beta-ratio": 1.6})
        until(lambda: len(daemon.jobs()) == 3, "the others are retired")
        self.assertEqual(len(self.catalogs()), 7)
        return other

    def test_forget_retired(self):
        """Catalogs of jobs that are no longer listed are removed, too."""
        daemon = self.daemon_
        other = self.retired()
        digest = next(r["digest"] for r in daemon.call("field", field="f")["rows"] if r["digest"] != other["digest"])
        self.assertEqual(daemon.call("forget", field="f", digest=digest),
                         {"field": "f", "rows": 1, "contributions": 6, "jobs": 2})
        self.assertEqual(self.catalogs(), [os.path.basename(other["catalogue"])])

    def test_forget_in_another_s(self):
        """The directory now belongs to another database: files of the same names are not touched."""
        daemon = self.daemon_
        self.retired()
        with open(daemon.path("catalogues", ".sheard-database"), "w", encoding="ascii") as f:
            f.write("another's")
        self.assertEqual(daemon.call("forget", field="f"), {"field": "f", "rows": 2, "contributions": 7, "jobs": 3})
        self.assertEqual(len(self.catalogs()), 7)

    def test_culprit(self):
        """One bad file: the field says why it has no result, whose file it is, and recovers."""
        daemon = self.daemon_
        good = [self.file(f"{i}.fits", i + 1) for i in range(2)]
        for path in good:
            self.count(path)
        row = daemon.call("field", field="f")["rows"][0]
        self.assertEqual((row["reason"], row["culprit"]), (None, None))
        bad = self.count(poisoned(self.file("bad.fits", 9)))
        self.assertEqual(bad["outcome"], "counted")
        row = daemon.call("field", field="f")["rows"][0]
        self.assertIsNone(row["g1"])
        self.assertIn("w D", row["reason"])
        self.assertIn(f"job {bad['id']}", row["reason"])
        self.assertEqual((row["culprit"]["job"], row["culprit"]["file"]), (bad["id"], bad["source"]["path"]))
        self.assertEqual(row["culprit"]["checksum"], bad["checksum"])
        self.assertIn("w D", daemon.call("fields")["fields"][0]["reason"])
        run = subprocess.run([SHEARCTL, "measure", bad["source"]["path"]], capture_output=True, encoding="utf-8")
        self.assertEqual(run.returncode, 3)
        self.assertIn("stamp 7 outweighs all others together: the sum of w D is -", run.stderr)
        for text in (daemon.shearctl("field", "f"), daemon.shearctl("fields")):
            self.assertIn("w D", text)
        self.assertIn(f"shearctl retract {bad['id']}", daemon.shearctl("field", "f"))
        daemon.shearctl("retract", str(bad["id"]))
        self.assertRow(daemon, "f", measured(good), 2)

    @turns
    def test_culprit_of_many(self):
        """The cause is searched while others are served, even among very many files."""
        daemon = self.daemon_
        many = 10000
        self.count(self.file("good.fits", 1, 2))
        bad = self.count(poisoned(self.file("bad.fits", 9)))
        daemon.stop()
        with sqlite3.connect(os.path.join(daemon.state, "sheard.db")) as base:
            base.execute("with recursive n(i) as (select 1 union all select i + 1 from n where i < ?)"
                         " insert into contributions (field, job, content, n_stamps, n_used, counted_ms, sums)"
                         " select field, 100 + i, content || i, n_stamps, n_used, counted_ms, sums"
                         " from contributions, n where job <> ?", (many, bad["id"]))
            base.execute("update fields set jobs = jobs + ?", (many,))
        base.close()
        daemon.start()
        begun = time.monotonic()
        row = daemon.call("field", field="f", limit=1)["rows"][0]
        took_ms = 1e3 * (time.monotonic() - begun)
        self.assertEqual((row["jobs"], row["culprit"]["job"]), (many + 2, bad["id"]))
        self.assertTurns(daemon, took_ms / 5)

    def test_too_few(self):
        daemon = self.daemon_
        self.count(self.file("one.fits", 1, 1))
        row = daemon.call("field", field="f")["rows"][0]
        self.assertEqual(row["reason"], "fewer than two usable stamps: 1 of 1")
        self.assertIsNone(row["culprit"])


if __name__ == "__main__":
    unittest.main()
