# SPDX-License-Identifier: GPL-3.0-or-later
"""Who may do what. The peer is who the kernel says it is: as root, children of the test become
other users and ask."""
import contextlib
import os
import traceback
import unittest

from daemon import DaemonTest, FINAL, RpcError, measured, mock, until

USER, OTHER = 65501, 65502  # uids, of nobody here


def as_user(test, uid, do, groups=()):
    """Call do() as that user, in a child; it must not raise."""
    child = os.fork()
    if child == 0:
        try:
            os.setgroups(groups)
            os.setgid(uid)
            os.setuid(uid)
            do()
            os._exit(0)
        except BaseException:
            traceback.print_exc()
        finally:
            os._exit(1)
    test.assertEqual(os.waitpid(child, 0)[1], 0, "the child's assertion failed; see above")


@unittest.skipUnless(os.getuid() == 0, "only root can become somebody else")
class Access(DaemonTest):
    def setUp(self):
        super().setUp()
        self.d = self.daemon({"daemon.socket_mode": "0666"})
        os.chmod(self.d.data, 0o777)

    def refused(self, uid, path, code, groups=()):
        def ask():
            with self.assertRefused(code):
                self.d.submit(path)
        as_user(self, uid, ask, groups)

    def accepted(self, uid, path, groups=()):
        as_user(self, uid, lambda: self.assertEqual(
            self.d.submit(path, force=True, wait=True)["state"], "done"), groups)

    def file(self, *names, mode=0o644, owner=0, group=0):
        path = os.path.join(self.d.data, *names)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        mock(path, 8, 32)
        os.chown(path, owner, group)
        os.chmod(path, mode)
        return path

    def test_names_that_nobody_has(self):
        """A user who has left does not prevent the start of the service, and a missing group admits nobody."""
        lists = {"access.admin_users": "root, left-9", "access.priority_groups": "gone-9",
                 "access.submit_groups": "missing-9"}
        said = [f"there is no {what}: nobody has its rights"
                for what in ("user 'left-9'", "group 'missing-9'", "group 'gone-9'")]
        path = self.file("a.fits")
        self.d.settings.update(lists)
        self.d.write_config()
        self.assertEqual(self.d.call("reload")["warnings"], ["[access]: " + text for text in said])
        self.d.stop()
        self.d.start()
        for text in said:
            self.assertEqual(self.d.log_text().count(text), 2, "once as reloaded, once as started")
        self.refused(USER, path, "not_owner")
        self.accepted(0, path)

    def test_permissions_of_the_peer(self):
        secret = self.file("secret.fits", mode=0o600)
        self.refused(USER, secret, "not_readable")
        self.accepted(0, secret)
        own = self.file("own.fits", mode=0o400, owner=USER)
        self.accepted(USER, own)
        self.refused(OTHER, own, "not_readable")
        shared = self.file("shared.fits", mode=0o640, group=65510)
        self.refused(USER, shared, "not_readable")
        self.accepted(USER, shared, groups=[65510])
        self.accepted(USER, self.file("open.fits"))

    def test_closed_directory(self):
        path = self.file("closed", "a.fits")
        os.chmod(os.path.dirname(path), 0o700)
        self.refused(USER, path, "not_readable")
        self.accepted(0, path)

    def test_job_file_of_another(self):
        """A dropped job file measures what its owner may read, and nothing else."""
        secret = self.file("secret.fits", mode=0o600)
        self.d.drop(None, ".j", f'{{"path": "{secret}"}}'.encode())
        os.chown(self.d.folder("incoming", ".j"), USER, USER)
        os.rename(self.d.folder("incoming", ".j"), self.d.folder("incoming", "j.json"))
        self.d.wait_idle()
        self.assertEqual(self.d.side("failed", "j.json")["code"], "not_readable")
        self.assertEqual(self.d.call("fields")["fields"], [])

    def test_roots(self):
        inside = self.file("a.fits")
        outside = mock(os.path.join(self.directory, "outside.fits"), 8, 32)
        os.symlink(outside, self.d.data + "/link.fits")
        os.symlink("../outside.fits", self.d.data + "/relative.fits")
        os.symlink(self.directory, self.d.data + "/folder")
        os.symlink("a.fits", self.d.data + "/within.fits")
        os.symlink("loop.fits", self.d.data + "/loop.fits")
        for path in (outside, "/etc/passwd", self.d.data + "/link.fits",
                     self.d.data + "/relative.fits",
                     self.d.data + "/folder/outside.fits", self.directory + "/none.fits",
                     f"/proc/{os.getpid()}/root{inside}", self.d.data + "x/a.fits"):
            with self.subTest(path=path), self.assertRefused("outside_roots"):
                self.d.submit(path)
        for path in ("data/a.fits", self.d.data + "/../outside.fits",
                     self.d.data + "/../data/a.fits"):
            with self.subTest(path=path), self.assertRefused("bad_parameter"):
                self.d.submit(path)
        with contextlib.suppress(RpcError):
            self.d.submit(self.d.data + "/loop.fits")
            self.fail("a loop of links was accepted")
        os.mkfifo(self.d.data + "/pipe.fits")
        with self.assertRefused("not_regular"):
            self.d.submit(self.d.data + "/pipe.fits")
        self.assertEqual(self.d.jobs(), [])
        self.assertEqual(self.d.submit(inside, wait=True)["state"], "done")

    def test_magic_links(self):
        """Links of the kernel in a data root do not lead out of it."""
        outside = mock(os.path.join(self.directory, "outside.fits"), 8, 32)
        with open(outside, "rb") as f:
            d = self.daemon({"access.data_roots": "/proc"}, name="proc")
            for path in (f"/proc/{os.getpid()}/fd/{f.fileno()}",
                         f"/proc/{os.getpid()}/root{outside}", f"/proc/{os.getpid()}/cwd/x"):
                with self.subTest(path=path), self.assertRefused("outside_roots"):
                    d.submit(path)

    def test_swapped_after_submission(self):
        """Permissions are checked again when the job starts and opens its file."""
        self.d.settings["daemon.max_active_jobs"] = 1
        self.d.write_config()
        self.d.call("reload")
        first = self.d.submit(self.file("first.fits"), settings={"interpolation": "bicubic",
                                                                 "oversample": 64})["id"]
        path = self.file("a.fits")
        second = self.d.submit(path)["id"]
        os.unlink(path)
        os.symlink(mock(os.path.join(self.directory, "outside.fits"), 8, 32, 2), path)
        self.d.call("cancel", id=first)
        job = self.d.wait_state(second, *FINAL)
        if job["state"] == "failed":  # else it had been opened before
            self.assertEqual((job["class"], job["code"]), ("data", "outside_roots"))
        self.assertNotEqual(job["checksum"], self.checksum_of("outside.fits"))

    def checksum_of(self, name):
        path = os.path.join(self.d.data, "copy-" + name)
        os.link(os.path.join(self.directory, name), path)
        return self.d.submit(path, wait=True)["checksum"]

    def test_owners_and_administrators(self):
        bad = self.file("bad.fits")
        with open(bad, "r+b") as f:
            f.truncate(3000)
        as_user(self, USER, lambda: self.d.submit(bad, wait=True))
        job = self.d.jobs()[0]
        self.assertEqual((job["state"], job["owner"]), ("failed", USER))

        def meddle():
            for method in ("cancel", "retry"):
                with self.assertRefused("not_owner"):
                    self.d.call(method, id=job["id"])
            for method in ("reload", "drain", "shutdown"):
                with self.assertRefused("not_admin"):
                    self.d.call(method)
            self.assertFalse(self.d.call("hello")["admin"])
            self.assertEqual(self.d.call("hello")["uid"], OTHER)
            self.d.call("status")
        as_user(self, OTHER, meddle)
        as_user(self, USER, lambda: self.d.call("retry", id=job["id"]))
        self.d.wait_state(job["id"], *FINAL)
        self.d.call("retry", id=job["id"])
        until(lambda: self.d.job(job["id"])["state"] in FINAL, "root's retry ran")
        self.assertEqual(self.d.call("status")["state"], "running")

    def test_priorities(self):
        """Above 0 for administrators and those that the configuration names; a job file likewise."""
        path = self.file("a.fits")

        def hurry(code=None):
            self.d.submit(path, force=True, priority=-3)
            if code is None:
                self.d.submit(path, force=True, priority=1)
            else:
                with self.assertRefused(code) as caught:
                    self.d.submit(path, force=True, priority=1)
                self.assertIn("[access] priority_users", str(caught.exception))
        as_user(self, USER, lambda: hurry("priority_not_allowed"))
        hurry()
        job = os.path.join(self.directory, "job.json")
        with open(job, "w", encoding="utf-8") as f:
            f.write('{"path": "%s", "priority": 5, "force": true}' % path)
        os.chown(job, USER, USER)
        os.rename(job, self.d.folder("incoming", "job.json"))
        until(lambda: "job.json.json" in self.d.dropped("failed"), "the job file is refused")
        self.assertEqual(self.d.side("failed", "job.json")["code"], "priority_not_allowed")
        for setting in ("priority_users", "priority_groups"):
            self.d.settings.pop("access.priority_users", None)
            self.d.settings[f"access.{setting}"] = USER
            self.d.write_config()
            self.d.call("reload")
            as_user(self, USER, hurry, [USER])
            as_user(self, OTHER, lambda: hurry("priority_not_allowed"))

    def test_keys_belong_to_owners(self):
        path = self.file("a.fits")
        self.assertFalse(self.d.call("submit", path=path, key="k")["known"])
        as_user(self, USER, lambda: self.assertFalse(
            self.d.call("submit", path=path, key="k", wait=True)["known"]))
        self.assertEqual(len(self.d.jobs()), 2)
        self.d.wait_idle()
        self.assertRow(self.d, "a", measured([path]), 1)

    def test_socket_is_closed_to_others(self):
        d = self.daemon({"daemon.socket_mode": "0600"}, name="private")

        def connect():
            with self.assertRaises(PermissionError):
                d.call("status")
        as_user(self, USER, connect)


class RootAndOthers(DaemonTest):
    @unittest.skipUnless(os.geteuid() == 0, "only root can be refused")
    def test_root_leaves_nothing_in_anothers_state(self):
        d = self.daemon(start=False)
        os.mkdir(d.state)
        os.chown(d.state, 65534, 65534)
        d.spawn()
        self.assertEqual(d.ended(), 1)
        self.assertIn("runuser -u", d.log_text())
        self.assertEqual(os.listdir(d.state), [])
        os.chown(d.state, 0, 0)
        d.start()


if __name__ == "__main__":
    unittest.main()
