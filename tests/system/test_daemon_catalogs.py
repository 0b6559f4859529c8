# SPDX-License-Identifier: GPL-3.0-or-later
"""The directory of catalogs belongs to one database, and holds only catalogs with which a job
has ended. FAULTSHIM in the environment is the library that kills at a chosen call."""
import contextlib
import itertools
import os
import shutil
import sqlite3
import unittest

from daemon import SLOW_MEASURE, SLOW_OPTIONS, DaemonTest, RpcError, content_of, mock, stamps_for, until

SHIM = os.path.abspath(os.environ["FAULTSHIM"])
MARK = ".sheard-database"


def bytes_of(directory):
    return {name: content_of(os.path.join(directory, name)) for name in os.listdir(directory)}


class Owner(DaemonTest):
    def setUp(self):
        super().setUp()
        self.catalogs = os.path.join(self.directory, "catalogues")
        self.field = mock(os.path.join(self.directory, "field.fits"))

    def one(self, name):
        return self.daemon({"catalogues.enabled": "true", "catalogues.directory": self.catalogs},
                           start=False, name=name)

    def with_catalogs(self, name, count=2):
        daemon = self.one(name).start()
        for i in range(count):
            path = mock(os.path.join(daemon.data, f"{i}.fits"), 16, 32, i + 1)
            daemon.wait_state(daemon.submit(path)["id"], "done")
        return daemon

    def assertRefuses(self, daemon, *said):
        """It does not start, says why, and touches nothing."""
        before = bytes_of(self.catalogs)
        daemon.spawn()
        self.assertNotEqual(daemon.ended(), 0)
        for text in (self.catalogs, daemon.state, "[catalogues] directory", *said):
            self.assertIn(text, daemon.log_text())
        self.assertEqual(bytes_of(self.catalogs), before)

    def test_of_another_state(self):
        first = self.with_catalogs("first")
        first.stop()
        self.assertEqual(set(os.listdir(self.catalogs)),
                         {MARK, "1.shear.fits", "2.shear.fits"})
        for name in (".1.shear.fits.part", ".77.shear.fits.part", MARK + ".77"):  # perhaps somebody's work
            with open(os.path.join(self.catalogs, name), "wb"):
                pass
        other = self.one("other")
        self.assertRefuses(other, content_of(os.path.join(self.catalogs, MARK)).decode().strip())
        first.start()
        self.assertEqual(set(os.listdir(self.catalogs)), {MARK, "1.shear.fits", "2.shear.fits"})
        first.stop()
        # As it is told: a directory of its own.
        other.settings["catalogues.directory"] = os.path.join(self.directory, "more")
        other.write_config()
        self.assertNotIn("error", other.start().call("status"))

    def test_two_at_once(self):
        """Both run: the second does not start, the first continues."""
        first = self.with_catalogs("first", 1)
        self.assertRefuses(self.one("other"))
        path = mock(os.path.join(first.data, "more.fits"), 16, 32, 7)
        first.wait_state(first.submit(path)["id"], "done")

    def test_reload(self):
        """As at a start: another database's directory is refused, a new one is created and marked."""
        first, other = self.with_catalogs("first"), self.one("other")
        own = other.settings["catalogues.directory"] = os.path.join(self.directory, "own")
        other.write_config()
        other.start()
        before = bytes_of(self.catalogs)
        for bad in (self.catalogs, os.path.join(self.directory, "field.fits"),
                    os.path.join(self.directory, "no", "parent"), "/proc"):
            other.settings["catalogues.directory"] = bad
            other.write_config()
            with self.assertRefused("bad_config") as caught:
                other.call("reload")
            self.assertIn(bad, str(caught.exception))
            self.assertEqual(other.call("status")["catalogues"], own)
        path = mock(os.path.join(other.data, "a.fits"), 16, 32, 5)
        other.wait_state(other.submit(path)["id"], "done")
        self.assertEqual(bytes_of(self.catalogs), before)
        more = other.settings["catalogues.directory"] = os.path.join(self.directory, "more")
        other.write_config()
        self.assertEqual(other.call("reload")["changed"], ["catalogues.directory"])
        self.assertEqual(content_of(os.path.join(more, MARK)), content_of(os.path.join(own, MARK)))
        # Switched on only now, where the directory has become another's meanwhile.
        other.settings["catalogues.enabled"] = "false"
        other.write_config()
        other.call("reload")
        shutil.copy(os.path.join(self.catalogs, MARK), more)
        other.settings["catalogues.enabled"] = "true"
        other.write_config()
        with self.assertRefused("bad_config"):
            other.call("reload")
        self.assertNotIn("error", first.call("status"))

    def test_retract_in_another_s(self):
        """The directory that the catalog was in has been left to another database, with a
        catalog of the same name."""
        first = self.with_catalogs("first", 1)
        first.settings["catalogues.directory"] = os.path.join(self.directory, "more")
        first.write_config()
        first.call("reload")
        shutil.rmtree(self.catalogs)
        self.with_catalogs("other", 1)
        before = bytes_of(self.catalogs)
        self.assertEqual(first.call("retract", id=1)["state"], "retracted")
        first.stop()
        first.start()
        self.assertEqual(bytes_of(self.catalogs), before)

    def test_bad_mark(self):
        first = self.with_catalogs("first", 1)
        first.stop()
        mark = os.path.join(self.catalogs, MARK)
        identity = content_of(mark)
        for content in (b"", b"\n", b"x" * 5000, bytes(range(256))):
            with open(mark, "wb") as f:
                f.write(content)
            self.assertRefuses(first, identity.decode().strip())
        with open(mark, "wb") as f:  # as the advice says
            f.write(identity)
        first.start()

    # ---- from before there were marks ----

    def unmarked(self):
        first = self.with_catalogs("first", 3)
        first.stop()
        os.unlink(os.path.join(self.catalogs, MARK))
        return first

    def test_own_of_before(self):
        """It knows its directory: catalogs of retired jobs stay, and orphans, too."""
        first = self.unmarked()
        with sqlite3.connect(os.path.join(first.state, "sheard.db")) as base:
            base.execute("pragma foreign_keys = on")
            base.execute("delete from jobs where id = 1")
            base.execute("update jobs set catalogue = null where id = 2")
        base.close()
        before = bytes_of(self.catalogs)
        for _ in range(3):
            first.start()
            first.stop()
            after = bytes_of(self.catalogs)
            self.assertEqual(len(after.pop(MARK)), 33)
            self.assertEqual(after, before)

    def test_others_of_before(self):
        self.unmarked()
        self.assertRefuses(self.one("other"))

    def test_mixed_of_before(self):
        """Two databases wrote here: the one that knows fewer jobs does not take it."""
        self.unmarked()
        kept = os.path.join(self.directory, "kept")
        os.rename(self.catalogs, kept)
        other = self.with_catalogs("other", 1)
        other.stop()
        os.unlink(os.path.join(self.catalogs, MARK))
        for name in ("2.shear.fits", "3.shear.fits"):
            shutil.copy(os.path.join(kept, name), self.catalogs)
        self.assertRefuses(other, "job 3" if os.listdir(self.catalogs)[0] == "3.shear.fits"
                           else "job ")


class Orphans(DaemonTest):
    def killed(self, at):
        """A job's catalog is about to be put in place, and the at-th of the calls on the way is
        the last thing that the daemon does. Another job, the first, is held meanwhile."""
        name = f"run{at}"
        where = os.path.join(self.directory, name, "catalogues")
        daemon = self.daemon({**SLOW_MEASURE, "catalogues.enabled": "true", "daemon.workers": 2,
                              "daemon.max_active_jobs": 1}, name=name, start=False)
        stamps = stamps_for(10, 32, *SLOW_OPTIONS)
        first = daemon.start().held(daemon.submit(
            mock(os.path.join(daemon.data, "first.fits"), stamps, 32))["id"])
        daemon.kill()
        daemon.settings["daemon.max_active_jobs"] = 2
        daemon.write_config()
        plain, daemon.env = daemon.env, {
            **daemon.env, "LD_PRELOAD": SHIM, "FAULT_BELOW": where, "FAULT_CALLS": "sr",
            "FAULT_AT": str(at), "FAULT_HOW": "KILL"}
        daemon.start().held(first)
        second = daemon.submit(mock(os.path.join(daemon.data, "second.fits"), 16, 32, 2),
                               priority=0)["id"]
        # Every call on the way was made where it is done: then there is no at-th.
        until(lambda: not daemon.alive() or self.is_done(daemon, second), "it is killed")
        killed = not daemon.alive()
        daemon.env = plain
        daemon.settings["daemon.max_active_jobs"] = 1
        daemon.write_config()
        return daemon, first, second, os.listdir(where) if killed else None

    def is_done(self, daemon, job):
        with contextlib.suppress(OSError, EOFError, ValueError):  # killed meanwhile
            return daemon.job(job)["state"] == "done"

    def test_killed_then_cancelled(self):
        """The job is cancelled before it runs again: no catalog of it is left."""
        in_place = 0
        for at in itertools.count(1):
            daemon, first, second, names = self.killed(at)
            if names is None:
                break
            daemon.start().held(first)
            in_place += f"{second}.shear.fits" in names
            self.assertNotIn(f"{second}.shear.fits", os.listdir(daemon.path("catalogues")))
            self.assertEqual(daemon.call("cancel", id=second)["state"], "cancelled", at)
            daemon.call("cancel", id=first)
            daemon.go_on()
            daemon.wait_state(first, "cancelled")
            until(lambda: os.listdir(daemon.path("catalogues")) == [MARK], "nothing is left")
            daemon.kill()
        self.assertGreater(in_place, 0, "no kill came between the rename and the commit")

    def test_cancelled_at_the_end(self):
        """Cancelled while it ends: a catalog that is in place already goes with it."""
        daemon = self.daemon({"catalogues.enabled": "true"})
        path = mock(os.path.join(daemon.data, "a.fits"), 16, 32)
        for i in range(30):
            with daemon.client() as client:
                job = client.call("submit", path=path, field=f"f{i}")["job"]["id"]
                until(lambda: client.call("job", id=job)["job"]["state"] != "queued" or i % 2,
                      "it runs", step=0)
                try:
                    client.call("cancel", id=job)
                except RpcError as error:
                    self.assertEqual(error.code, "wrong_state", error)
                client.call("wait", ids=[job])
        wanted = {os.path.basename(j["catalogue"]) for j in daemon.jobs() if j["catalogue"]}
        until(lambda: set(os.listdir(daemon.path("catalogues"))) == wanted | {MARK},
              "catalogs of done jobs, and no others")


if __name__ == "__main__":
    unittest.main()
