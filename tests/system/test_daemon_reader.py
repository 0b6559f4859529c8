# SPDX-License-Identifier: GPL-3.0-or-later
"""The process that reads: whatever touches the bytes of a file happens there, within its limits, and can be stopped."""
import gzip
import os
import signal
import subprocess
import unittest
import zlib

from daemon import SLOW, DaemonTest, FINAL, content_of, measured, mock, until
from fitsfile import BLOCK, header, image, primary

TIB = 1 << 40


def sparse(path, size):
    """A good field of about `size` bytes, nearly all of them a hole. Nobody lives to see it read."""
    side = 64
    stamps = size // 2 // (side * side * 4)
    cards = [("XTENSION", "IMAGE"), ("BITPIX", -32), ("NAXIS", 3), ("NAXIS1", side), ("NAXIS2", side), ("NAXIS3", stamps),
             ("PCOUNT", 0), ("GCOUNT", 1)]
    with open(path, "wb") as f:
        f.write(primary())
        for name in ("GALAXY", "NOISE"):
            f.write(header(cards + [("EXTNAME", name)]))
            f.seek(-(-stamps * side * side * 4 // BLOCK) * BLOCK, os.SEEK_CUR)
        f.write(image("PSF", (9, 9), [2.718 ** (-((x - 4) ** 2 + (y - 4) ** 2) / 4) for y in range(9) for x in range(9)]))
    return path


class Hashing(DaemonTest):
    def hashing(self, daemon):
        """A job that reads for its hash, and would for hours."""
        path = sparse(os.path.join(daemon.data, "sparse.fits"), 3 * TIB)
        job = daemon.submit(path)["id"]
        until(lambda: (daemon.job(job)["progress"]["bytes_done"] or 0) > 1 << 28, "the hash has begun")
        return job

    def bytes_read(self, daemon):
        with open(f"/proc/{daemon.process.pid}/io", encoding="ascii") as f:
            return int(f.readline().removeprefix("rchar:"))

    def test_cancelled(self):
        daemon = self.daemon({"reader.max_file_bytes": "1024T"})
        job = self.hashing(daemon)
        progress = daemon.job(job)["progress"]
        self.assertEqual((progress["phase"], progress["total"]), ("hashing", None))
        self.assertEqual(progress["bytes_total"], os.path.getsize(os.path.join(daemon.data, "sparse.fits")))
        self.assertLess(self.bytes_read(daemon), 1 << 26, "the service itself has read the file")
        daemon.call("cancel", id=job)
        self.assertEqual(daemon.wait_state(job, *FINAL)["state"], "cancelled")
        until(lambda: not daemon.children(), "its reader is gone")

    def test_two_signals(self):
        """The first signal waits for the running jobs, the second one for nothing. The job continues at the next start."""
        daemon = self.daemon({"reader.max_file_bytes": "1024T", "daemon.drain_timeout": "1h"})
        job = self.hashing(daemon)
        daemon.signal(signal.SIGTERM)
        until(lambda: "stopping" in daemon.log_text(), "the first signal arrived")
        daemon.signal(signal.SIGTERM)
        self.assertEqual(daemon.ended(), 0)
        daemon.start()
        until(lambda: daemon.job(job)["progress"]["phase"] == "hashing", "it goes on")
        daemon.call("cancel", id=job)
        self.assertEqual(daemon.wait_state(job, *FINAL)["state"], "cancelled")

    def test_slow_readers_are_not_blamed(self):
        """Reading all of a file may take longer than one answer may."""
        daemon = self.daemon({"reader.max_file_bytes": "1024T", "reader.wall_time": "2s"})
        job = self.hashing(daemon)
        until(lambda: daemon.call("status")["uptime_s"] > 5, "the limit of one answer has passed")
        self.assertEqual(daemon.job(job)["progress"]["phase"], "hashing", daemon.job(job))
        daemon.call("cancel", id=job)

    def test_notified(self):
        daemon = self.daemon({"reader.max_file_bytes": "1024T"})
        job = self.hashing(daemon)
        with daemon.client() as client:
            client.call("subscribe", jobs=[job], progress=True)
            notice = client.receive()
            self.assertEqual((notice["method"], notice["params"]["progress"]["phase"]), ("job_progress", "hashing"))
            self.assertGreater(notice["params"]["progress"]["bytes_done"], 0)
        daemon.call("cancel", id=job)


def gzipped(content):
    return gzip.compress(content, 6, mtime=0)


def bomb(megabytes):
    """A header, and then nothing but zeros, packed to a thousandth."""
    pack = zlib.compressobj(9, zlib.DEFLATED, 31)
    zeros = bytes(1 << 20)
    return pack.compress(primary()) + b"".join(pack.compress(zeros) for _ in range(megabytes)) + pack.flush()


class Scratch(DaemonTest):
    """Where gzipped files are unpacked to, and how much."""
    def disk(self, size):
        """A small disk of its own."""
        path = os.path.join(self.directory, "scratch")
        os.mkdir(path)
        mount = ["mount", "-t", "tmpfs", "-o", f"size={size}", "tmpfs", path]
        if os.geteuid() != 0 or subprocess.run(mount).returncode != 0:
            self.skipTest("no disk can be mounted here")
        self.addCleanup(subprocess.run, ["umount", "-l", path], check=True)
        return path

    def used(self, path):
        disk = os.statvfs(path)
        return (disk.f_blocks - disk.f_bfree) * disk.f_frsize

    def put(self, daemon, name, content):
        path = os.path.join(daemon.data, name)
        with open(path, "wb") as f:
            f.write(content)
        return path

    def assertOnce(self, job, text):
        self.assertEqual((job["state"], job["class"], job["code"], job["attempts"]), ("failed", "data", "bad_file", 1), job)
        self.assertIn(text, job["message"])

    def test_limit_of_a_file(self):
        daemon = self.daemon({"reader.unpacked": "1M"})
        plain = mock(os.path.join(self.directory, "plain.fits"), 200, 32)
        job = daemon.submit(self.put(daemon, "large.fits.gz", gzipped(content_of(plain))), wait=True)
        self.assertOnce(job, "1048576 bytes")
        self.assertIn("[reader] unpacked", job["advice"])
        small = mock(os.path.join(self.directory, "small.fits"), 8, 32)
        self.assertEqual(daemon.submit(self.put(daemon, "s.fits.gz", gzipped(content_of(small))), wait=True)["state"],
                         "done")

    def test_limit_of_all(self):
        daemon = self.daemon({"reader.scratch_bytes": "1M"})
        job = daemon.submit(self.put(daemon, "bomb.fits.gz", bomb(64)), wait=True)
        self.assertOnce(job, "[reader] scratch_bytes")
        self.assertIn("1048576 bytes", job["message"])

    def test_bomb(self):
        """More than its disk can ever hold: the job fails once as bad data; the disk is freed, and the next file is
        measured."""
        disk = self.disk("48m")
        daemon = self.daemon({"reader.scratch": disk})
        self.assertOnce(daemon.submit(self.put(daemon, "bomb.fits.gz", bomb(3000)), wait=True), disk)
        until(lambda: self.used(disk) == 0, "the copy is gone")
        plain = mock(os.path.join(self.directory, "a.fits"), 200, 32)
        packed = self.put(daemon, "a.fits.gz", gzipped(content_of(plain)))
        self.assertEqual(daemon.submit(packed, field="a", wait=True)["state"], "done")
        self.assertRow(daemon, "a", measured([plain]), 1)

    def test_full(self):
        """Others have filled the disk: the job is tried again until there is room, and says why it waits."""
        disk = self.disk("48m")
        daemon = self.daemon({"reader.scratch": disk, "retry.attempts": 2})
        filler = os.path.join(disk, "filler")
        with open(filler, "wb") as f:
            f.write(bytes(41 << 20))
        plain = mock(os.path.join(self.directory, "a.fits"), 400, 32)
        job = daemon.submit(self.put(daemon, "a.fits.gz", gzipped(content_of(plain))), field="a")["id"]
        until(lambda: (j := daemon.job(job))["state"] == "waiting" and j["attempts"] > 2,
              "it waits, however often it was tried")
        waiting = daemon.job(job)
        self.assertEqual((waiting["class"], waiting["code"]), ("transient", "disk_full"))
        self.assertIn(disk, waiting["message"])
        other = mock(os.path.join(daemon.data, "other.fits"), 8, 32)
        self.assertEqual(daemon.submit(other, wait=True)["state"], "done")
        os.unlink(filler)
        self.assertEqual(daemon.wait_state(job, *FINAL)["state"], "done")
        self.assertRow(daemon, "a", measured([plain]), 1)

    def test_bad_directory(self):
        daemon = self.daemon({"reader.scratch": "/dev/null"}, start=False).spawn()
        self.assertNotEqual(daemon.ended(), 0)
        self.assertIn("[reader] scratch", daemon.log_text())

    def test_one_number(self):
        """The message has the limit that is in force."""
        root = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
        for name, text in (("config/sheard.conf", "#unpacked = 64G"), ("docs/field-files.md", "is limited to 64 GiB"),
                           ("core/include/shear/field.h", "#define SHEAR_UNPACK_LIMIT (INT64_C(64) << 30)")):
            self.assertIn(text, content_of(os.path.join(root, name)).decode(), name)


class TooLarge(DaemonTest):
    def daemon_of_a_megabyte(self):
        daemon = self.daemon({"reader.max_file_bytes": "1M", "daemon.max_active_jobs": 1, "daemon.workers": 1})
        return daemon, mock(os.path.join(daemon.data, "small.fits"), 8, 32)

    def assertTold(self, message, path):
        self.assertIn("[reader] max_file_bytes allows 1048576", message)
        self.assertIn(f"has {os.path.getsize(path)} bytes", message)

    def test_submitted(self):
        daemon, small = self.daemon_of_a_megabyte()
        large = sparse(os.path.join(daemon.data, "large.fits"), TIB)
        for parameter, source in (("path", {"path": large}),
                                  ("noise.path",
                                   {"galaxy": {"path": small}, "noise": {"path": large}, "psf": {"path": small}})):
            with self.assertRefused("file_too_large") as caught:
                daemon.call("submit", **source)
            error = caught.exception.error
            self.assertTold(error["message"], large)
            self.assertEqual((error["data"]["parameter"], error["data"]["retry"]), (parameter, False))
            self.assertIn("max_file_bytes", error["data"]["advice"])
        self.assertEqual(daemon.submit(small, wait=True)["state"], "done")

    def test_dropped(self):
        daemon, small = self.daemon_of_a_megabyte()
        large = sparse(daemon.folder("incoming", ".large"), TIB)
        os.rename(large, daemon.folder("incoming", "large.fits"))
        daemon.drop(small, "small.fits")
        daemon.wait_idle()
        side = daemon.side("failed", "large.fits")
        self.assertEqual(side["code"], "file_too_large")
        self.assertTold(side["message"], daemon.folder("failed", "large.fits"))
        self.assertRow(daemon, "small", measured([small]), 1)

    def test_at_its_turn(self):
        """The limit was lowered, without a restart, while the job waited; or the file has grown."""
        daemon = self.daemon({"daemon.max_active_jobs": 1, "daemon.workers": 1})
        first = daemon.held(daemon.submit(mock(os.path.join(daemon.data, "a.fits"), 800, 32), settings=SLOW)["id"])
        large = mock(os.path.join(daemon.data, "large.fits"), 200, 32)
        second = daemon.submit(large)["id"]
        daemon.settings["reader.max_file_bytes"] = "1M"
        daemon.write_config()
        self.assertEqual(daemon.call("reload")["changed"], ["reader.max_file_bytes"])
        daemon.call("cancel", id=first)
        job = daemon.wait_state(second, *FINAL)
        self.assertEqual((job["state"], job["class"], job["code"], job["attempts"]), ("failed", "data", "file_too_large", 1),
                         job)
        self.assertTold(job["message"], large)


if __name__ == "__main__":
    unittest.main()
