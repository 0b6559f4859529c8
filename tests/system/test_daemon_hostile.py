# SPDX-License-Identifier: GPL-3.0-or-later
"""Bad files and bad clients: each gets an error, and others are served meanwhile.
SHEARD_MUTANTS malformed files (from SHEARD_SEED), SHEARD_CLIENTS clients at once,
SHEARD_MALFORMED bad messages."""
import contextlib
import json
import os
import random
import resource
import shutil
import signal
import subprocess
import threading
import unittest

from daemon import SLOW, SLOW_OPTIONS, SHEARD, Client, DaemonTest, FINAL, content_of, measured, mock, named, until
from fitsfile import BLOCK
from tool import SANITIZED

MUTANTS = int(os.environ.get("SHEARD_MUTANTS", "150"))
CLIENTS = int(os.environ.get("SHEARD_CLIENTS", "200"))
MALFORMED = int(os.environ.get("SHEARD_MALFORMED", "500"))
SEED = int(os.environ.get("SHEARD_SEED", "11"))
GOOD_EVERY = 15  # mutants between two good files
ABSURD = ("0", "-1", "1", "7", "65535", "2147483647", "4294967296", "9223372036854775807",
          "-9223372036854775808", "1E30", "T", "'text'", "")
KEYS = (b"NAXIS   ", b"NAXIS1  ", b"NAXIS2  ", b"NAXIS3  ", b"BITPIX  ", b"PCOUNT  ", b"GCOUNT  ",
        b"TFIELDS ", b"TFORM1  ", b"ZNAXIS1 ", b"ZNAXIS3 ", b"ZTILE1  ", b"ZBITPIX ", b"ZCMPTYPE",
        b"XTENSION", b"EXTNAME ", b"SIMPLE  ", b"OVERSAMP", b"BSCALE  ", b"BLANK   ")


class Mutants:
    """Malformed files made of good ones, the same for the same seed."""

    def __init__(self, plain, packed, seed):
        self.rng, self.bases = random.Random(seed), [plain] + packed
        self.kinds = [self.cut, self.cut_anywhere, self.flip, self.flip_headers, self.absurd,
                      self.garbage, self.shuffle]

    def bounds(self, data):
        """Where HDUs begin, and the end."""
        at = [i for i in range(0, len(data), BLOCK)
              if data[i:i + 8] in (b"XTENSION", b"SIMPLE  ")]
        return at + [len(data)]

    def cut(self, data):
        return data[:self.rng.choice(self.bounds(data)) + self.rng.choice((-BLOCK, -1, 0, 1))]

    def cut_anywhere(self, data):
        return data[:self.rng.randrange(len(data))]

    def flip(self, data, begin=0, end=None):
        out = bytearray(data)
        for _ in range(1 << self.rng.randrange(8)):
            out[self.rng.randrange(begin, end or len(out))] ^= 1 << self.rng.randrange(8)
        return bytes(out)

    def flip_headers(self, data):
        begin = self.rng.choice(self.bounds(data)[:-1])
        return self.flip(data, begin, min(begin + BLOCK, len(data)))

    def absurd(self, data):
        """Change values of keywords for the size and type of the data."""
        out = bytearray(data)
        keys = [i for i in range(0, len(out), 80) if out[i:i + 8] in KEYS]
        for at in self.rng.sample(keys, min(len(keys), self.rng.choice((1, 1, 2, 5)))):
            out[at + 8:at + 80] = f"= {self.rng.choice(ABSURD):>20}".ljust(72).encode()
        return bytes(out)

    def garbage(self, data):
        """Replace a piece by noise: in packed files, mostly in the compressed data."""
        n = self.rng.randrange(1, 4000)
        at = self.rng.randrange(max(1, len(data) - n))
        return data[:at] + self.rng.randbytes(n) + data[at + n:]

    def shuffle(self, data):
        at = self.bounds(data)
        hdus = [data[a:b] for a, b in zip(at, at[1:])]
        self.rng.shuffle(hdus)
        return b"".join(hdus)

    def make(self, number):
        """Kinds and bases in turn; the name's end says whether it claims to be packed."""
        base = number // len(self.kinds) % len(self.bases)
        data = self.kinds[number % len(self.kinds)](self.bases[base])
        return f"m{number}.fits" + (".fz" if base else ""), data


class BadFiles(DaemonTest):
    def packed(self, path):
        """The field, tile-compressed with several algorithms, if fpack is installed."""
        if not shutil.which("fpack"):
            return []
        out = []
        for options in (["-r"], ["-g"], ["-h"], ["-p"]):
            with open(path + ".fz", "wb") as f:
                if subprocess.run(["fpack", *options, "-S", path], stdout=f,
                                  stderr=subprocess.DEVNULL).returncode == 0:
                    out.append(content_of(path + ".fz"))
        return out

    def test_mutants(self):
        daemon = self.daemon({"reader.wall_time": "20s", "reader.memory": "256M"})
        path = mock(os.path.join(self.directory, "plain.fits"), 6, 32)
        plain, expected = content_of(path), measured([path])
        mutants = Mutants(plain, self.packed(path), SEED)
        names, good = [], []
        for number in range(MUTANTS):
            if number % GOOD_EVERY == 0:
                good.append(f"good{number}")
                daemon.drop(None, good[-1] + ".fits", named(plain, good[-1]))
            name, data = mutants.make(number)
            names.append(name)
            daemon.drop(None, name, data)
        daemon.wait_idle(60 + MUTANTS)
        self.assertEqual(daemon.call("status")["pid"], daemon.process.pid)
        for field in good:
            self.assertRow(daemon, field, expected, 1)
        done, failed = daemon.dropped("done"), daemon.dropped("failed")
        self.assertEqual(sorted(n for n in done + failed if not n.endswith(".json")),
                         sorted(names + [f + ".fits" for f in good]))
        for name in names:
            if name in failed:
                side = daemon.side("failed", name)
                self.assertTrue(side["code"] and side["message"], side)
                self.assertNotEqual(side["code"], "internal", side)
            else:
                self.assertEqual(daemon.side("done", name)["state"], "done")
        self.assertGreater(sum(name in failed for name in names), MUTANTS // 3)

    def test_reader_dies(self):
        """Kill the process that reads: the job is tried once more, and nothing else notices."""
        daemon = self.daemon({"retry.first_delay": "10ms"})
        path = mock(os.path.join(daemon.data, "a.fits"), 800, 32)
        job = daemon.held(daemon.submit(path, settings=SLOW)["id"])
        other = mock(os.path.join(daemon.data, "b.fits"), 8, 32)
        for pid in daemon.children():
            os.kill(pid, signal.SIGKILL)
        self.assertEqual(daemon.submit(other, wait=True)["state"], "done")
        self.assertEqual(daemon.wait_state(job, *FINAL)["state"], "done")
        history = daemon.call("job", id=job)["history"]
        self.assertEqual([a["ending"] for a in history], ["failed", "done"])
        self.assertEqual((history[0]["class"], history[0]["code"]), ("bug", "reader_crashed"))
        self.assertRow(daemon, "a", measured([path], *SLOW_OPTIONS), 1)

    def test_reader_hangs(self):
        """Twice: then the job has failed, and says that the reader did not answer."""
        daemon = self.daemon({"retry.first_delay": "10ms", "reader.wall_time": "3s"})
        path = mock(os.path.join(daemon.data, "a.fits"), 4000, 32)
        job = daemon.submit(path, settings=SLOW)["id"]
        for attempt in (1, 2):
            until(lambda: (j := daemon.job(job))["attempts"] == attempt and
                  j["progress"]["done"] and daemon.children(), "it measures")
            for pid in daemon.children():
                os.kill(pid, signal.SIGSTOP)
            until(lambda: daemon.job(job)["state"] != "running" or
                  daemon.job(job)["attempts"] > attempt, "the attempt ended")
        job = daemon.wait_state(job, *FINAL)
        self.assertEqual((job["state"], job["class"], job["code"]),
                         ("failed", "bug", "reader_timeout"))
        until(lambda: not daemon.children(), "the reader is gone")


    def test_a_hung_reader_holds_up_its_job_only(self):
        daemon = self.daemon()
        path = mock(os.path.join(daemon.data, "a.fits"), 800, 32)
        job = daemon.held(daemon.submit(path, settings=SLOW)["id"])
        for i in range(4):
            other = mock(os.path.join(daemon.data, f"b{i}.fits"), 40, 32, i)
            self.assertEqual(daemon.submit(other, wait=True)["state"], "done")
        self.assertEqual(daemon.job(job)["state"], "running")
        self.assertTrue(daemon.call("field", field="a")["rows"][0]["partial"])
        daemon.go_on()
        self.assertEqual(daemon.wait_state(job, *FINAL)["state"], "done")
        self.assertRow(daemon, "a", measured([path], *SLOW_OPTIONS), 1)

    def test_more_memory_than_the_reader_has(self):
        daemon = self.daemon({"reader.shared_memory": "1M", "retry.first_delay": "10ms"})
        path = mock(os.path.join(daemon.data, "large.fits"), 4, 512)
        job = daemon.submit(path, wait=True)
        self.assertEqual((job["state"], job["class"], job["code"], job["attempts"]),
                         ("failed", "bug", "reader_memory", 2), job)
        self.assertIn("shared_memory", job["advice"])
        good = mock(os.path.join(daemon.data, "good.fits"), 8, 32)
        self.assertEqual(daemon.submit(good, wait=True)["state"], "done")

    @unittest.skipIf(SANITIZED, "a sanitizer's own memory is not limited")
    def test_less_memory_than_a_tile_takes(self):
        """One tile of the whole cube, unpacked by CFITSIO: more than the address space."""
        daemon = self.daemon({"reader.memory": "64M", "reader.shared_memory": "1M",
                              "retry.first_delay": "10ms"})
        path = mock(os.path.join(daemon.data, "a.fits"), 1500, 64)
        packed = os.path.join(daemon.data, "a.fits.fz")
        if not shutil.which("fpack"):
            self.skipTest("no fpack")
        with open(packed, "wb") as f:
            subprocess.run(["fpack", "-g", "-q", "0", "-w", "-S", path], stdout=f, check=True)
        job = daemon.submit(packed, wait=True)
        self.assertEqual((job["state"], job["class"], job["code"]),
                         ("failed", "bug", "reader_memory"), job)

    def test_what_hangs_can_be_cancelled_and_stopped(self):
        """Without waiting for its reader, and the job is not blamed for it."""
        daemon = self.daemon({"reader.wall_time": "1h"})
        path = mock(os.path.join(daemon.data, "a.fits"), 800, 32)
        job = daemon.held(daemon.submit(path, settings=SLOW)["id"])
        daemon.call("cancel", id=job)
        self.assertEqual(daemon.wait_state(job, *FINAL)["state"], "cancelled")
        job = daemon.held(daemon.submit(path, settings=SLOW)["id"])
        daemon.signal(signal.SIGTERM)
        until(lambda: daemon.call("status")["state"] == "stopping", "it stops")
        daemon.signal(signal.SIGTERM)
        self.assertEqual(daemon.ended(), 0)
        daemon.start()
        self.assertEqual(daemon.wait_state(job, *FINAL)["state"], "done")
        endings = [a["ending"] for a in daemon.call("job", id=job)["history"]]
        self.assertEqual(endings, ["released", "done"])

    def test_files_that_hang_when_opened(self):
        """More of them than workers: the others are measured meanwhile."""
        programs = os.path.join(self.directory, "programs")
        os.mkdir(programs)
        shutil.copy(SHEARD, programs)
        reader = os.path.join(programs, "sheard-reader")
        with open(reader, "w", encoding="utf-8") as f:
            f.write('#!/bin/sh\ncase "$*" in *hangs*) exec /bin/sleep 1000;; esac\n'
                    f'exec {os.path.join(os.path.dirname(SHEARD), "sheard-reader")} "$@"\n')
        os.chmod(reader, 0o755)
        daemon = self.daemon({"daemon.workers": 1, "reader.wall_time": "1h"}, start=False)
        daemon.program = os.path.join(programs, "sheard")
        daemon.start()
        good = mock(os.path.join(daemon.data, "good.fits"), 8, 32)
        hung = []
        for i in range(3):
            shutil.copy(good, os.path.join(daemon.data, f"hangs{i}.fits"))
            hung.append(daemon.submit(os.path.join(daemon.data, f"hangs{i}.fits"))["id"])
            daemon.wait_state(hung[-1], "running")
        self.assertEqual(daemon.submit(good, wait=True)["state"], "done")
        self.assertEqual([daemon.job(job)["state"] for job in hung], ["running"] * 3)
        daemon.call("cancel", id=hung[0])
        self.assertEqual(daemon.wait_state(hung[0], *FINAL)["state"], "cancelled")
        daemon.call("shutdown", mode="now")
        self.assertEqual(daemon.ended(), 0)


class BadClients(DaemonTest):
    def setUp(self):
        super().setUp()
        soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
        resource.setrlimit(resource.RLIMIT_NOFILE, (min(hard, max(soft, CLIENTS + 200)), hard))
        self.d = self.daemon({"limits.connections": CLIENTS + 50})
        self.path = mock(os.path.join(self.d.data, "a.fits"), 8, 32)

    def served(self):
        """The service works for a well-behaved client."""
        self.assertEqual(self.d.submit(self.path, force=True, wait=True)["state"], "done")

    def test_stalls_and_leaves(self):
        with self.d.client() as stalled, self.d.client() as leaving:
            stalled.send(b'{"jsonrpc":"2.0","id":1,"meth')
            large = mock(os.path.join(self.d.data, "large.fits"), 400, 32)
            leaving.ask("submit", {"path": large, "settings": SLOW, "wait": True, "key": "k"})
            leaving.ask("wait", {"ids": [1]})
            until(lambda: self.d.jobs(), "the job is there")
            leaving.close()
            self.served()
            self.assertEqual(self.d.wait_state(1, *FINAL)["state"], "done")
            stalled.send(b'od":"status"}\n')
            self.assertEqual(stalled.receive()["result"]["state"], "running")

    def test_floods(self):
        """Requests without end, and no reply is ever read."""
        over = threading.Event()

        def flood():
            with self.d.client(1) as client:
                while not over.is_set():
                    try:
                        client.send(b'{"jsonrpc":"2.0","id":1,"method":"status"}\n' * 500)
                    except (TimeoutError, BrokenPipeError, ConnectionResetError):
                        return

        threads = [threading.Thread(target=flood) for _ in range(3)]
        for thread in threads:
            thread.start()
        try:
            for _ in range(5):
                self.served()
        finally:
            over.set()
            for thread in threads:
                thread.join()
        self.served()

    def test_malformed(self):
        rng = random.Random(SEED)
        request = {"jsonrpc": "2.0", "id": 1, "method": "jobs", "params": {"limit": 3}}
        good = json.dumps(request).encode()
        lines = [b"[]", b"{}", b"null", b'{"id":1}', b"[" * 50, b"{" * 9000, b"\xff\xfe", b"a\0b",
                 good.replace(b'"id": 1', b'"id": 1, "id": 2'), good[:-1],
                 good.replace(b"3", b"1e99"), good.replace(b'"2.0"', b'"1.0"'), good + good]
        while len(lines) < MALFORMED:
            out = bytearray(good)
            for _ in range(rng.choice((1, 2, 6))):
                out[rng.randrange(len(out))] = rng.choice(b'{}[]",:0x\\\x01\x80\xff ')
            if out.strip():
                lines.append(bytes(out))
        with self.d.client() as client:
            for line in lines:
                client.send(line + b"\n")
                reply = client.receive()
                self.assertTrue("error" in reply or "result" in reply, line)
                if "error" in reply:
                    self.assertTrue(reply["error"]["data"]["code"], line)
        self.served()

    def test_long_line(self):
        """The client gets an error, whatever happens to the connection; others are served."""
        with self.d.client() as other, self.d.client() as client:
            with contextlib.suppress(BrokenPipeError, ConnectionResetError):
                client.send(b"x" * 300000 + b"\n")
            self.assertEqual(client.receive()["error"]["data"]["code"], "line_too_long")
            self.assertEqual(other.call("status")["state"], "running")

    def test_many_clients(self):
        clients = []
        try:
            for _ in range(CLIENTS):
                clients.append(self.d.client())
            asked = [(c, c.ask("submit", {"path": self.path, "key": f"k{i % 20}"}))
                     for i, c in enumerate(clients)]
            ids = {c.answer(number)["job"]["id"] for c, number in asked}
            self.assertEqual(len(ids), min(20, CLIENTS))
            waits = [(c, c.ask("wait", {"ids": sorted(ids)})) for c in clients]
            for c, number in waits:
                self.assertFalse(c.answer(number)["timed_out"])
            row = self.d.call("field", field="a")["rows"][0]
            self.assertEqual(row["jobs"], 1)
        finally:
            for client in clients:
                client.close()
        self.served()

    def refusal(self, client):
        """None, or what the service sent before it hung up."""
        with contextlib.suppress(OSError):  # it may have hung up before this
            client.ask("hello")
        try:
            return client.receive().get("error")
        except OSError:
            return client.receive()["error"]

    def test_too_many(self):
        clients, refused = [], None
        try:
            while refused is None and len(clients) < CLIENTS + 100:
                client = Client(self.d.socket)
                clients.append(client)
                refused = self.refusal(client)
            self.assertIn("too_many_connections", str(refused))
            self.assertEqual(clients[0].call("status")["state"], "running")
        finally:
            for client in clients:
                client.close()
        until(lambda: self.d.ready(), "there is room again")


if __name__ == "__main__":
    unittest.main()
