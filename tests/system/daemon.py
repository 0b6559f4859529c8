# SPDX-License-Identifier: GPL-3.0-or-later
"""A private sheard for a test: its own directories, socket and configuration below one temporary
directory. SHEARD and SHEARCTL in the environment are the paths of the programs (sheard-reader lies
beside sheard).

Nothing here sleeps for a fixed time and hopes: what is waited for is polled, with a limit that only
a broken service reaches."""
import contextlib
import functools
import json
import os
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
import unittest

from fitsfile import BLOCK, card, pad
from tool import SANITIZED, SANITIZERS, SHEARCTL

SHEARD = os.path.abspath(os.environ["SHEARD"])
LIMIT = float(os.environ.get("SHEARD_TEST_LIMIT", "120"))  # seconds that a wait may take at most

# What a field's row must have in common with `shearctl measure --json` on the same files.
NUMBERS = ("g1", "g1_err", "g2", "g2_err", "cov12", "n_stamps", "n_used", "n_flagged", "flags")
FINAL = ("done", "failed", "cancelled")
SMALL = {"daemon.workers": 2, "daemon.max_active_jobs": 4, "daemon.drain_timeout": "60s",
         "spool.settle_time": "200ms", "spool.scan_interval": "1s", "catalogues.enabled": "false",
         "retry.first_delay": "50ms", "retry.max_delay": "200ms", "limits.queue": 100000}


class RpcError(Exception):
    """An error reply; `code` is the stable name."""

    def __init__(self, error):
        super().__init__(f"{error['data']['code']}: {error['message']}")
        self.code, self.error = error["data"]["code"], error


def until(true, what, limit=None, step=0.01):
    """Poll until true() is true; return its value."""
    limit = LIMIT if limit is None else limit
    end = time.monotonic() + limit
    while True:
        value = true()
        if value:
            return value
        if time.monotonic() > end:
            raise AssertionError(f"{limit:.0f} s went by, and still not: {what}")
        time.sleep(step)


class Client:
    """One connection. Notifications that come between replies are kept in `notices`."""

    def __init__(self, path, timeout=None):
        self.socket = socket.socket(socket.AF_UNIX)
        self.socket.settimeout(LIMIT if timeout is None else timeout)
        try:
            self.socket.connect(path)
        except BaseException:
            self.socket.close()
            raise
        self.buffer, self.last, self.notices, self.replies = b"", 0, [], {}

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def close(self):
        self.socket.close()

    def send(self, data):
        self.socket.sendall(data)

    def receive(self):
        """The next object of the service; EOFError if it hung up."""
        while b"\n" not in self.buffer:
            data = self.socket.recv(1 << 16)
            if not data:
                raise EOFError("the service closed the connection")
            self.buffer += data
        line, _, self.buffer = self.buffer.partition(b"\n")
        return json.loads(line)

    def ask(self, method, params=None):
        """Send a request; return its id."""
        self.last += 1
        request = {"jsonrpc": "2.0", "id": self.last, "method": method, "params": params or {}}
        self.send(json.dumps(request).encode() + b"\n")
        return self.last

    def answer(self, number):
        """The reply to that request, whatever comes before it."""
        while number not in self.replies:
            message = self.receive()
            if "method" in message:
                self.notices.append(message)
            else:
                self.replies[message["id"]] = message
        reply = self.replies.pop(number)
        if "error" in reply:
            raise RpcError(reply["error"])
        return reply["result"]

    def call(self, method, **params):
        return self.answer(self.ask(method, params))


def children_of(pid):
    pids = []
    with contextlib.suppress(OSError):
        for task in os.listdir(f"/proc/{pid}/task"):
            with contextlib.suppress(OSError), open(f"/proc/{pid}/task/{task}/children") as f:
                pids += [int(child) for child in f.read().split()]
    return pids


class Daemon:
    def __init__(self, directory, settings=None, preload=None, env=None, state=None, spool=None):
        self.directory = directory
        self.state = state or self.path("state")
        self.spool = spool or self.path("spool")
        self.data, self.socket, self.log = self.path("data"), self.path("s.sock"), self.path("log")
        self.config = self.path("sheard.conf")
        self.settings = {**SMALL, "daemon.state_dir": self.state, "daemon.socket": self.socket,
                         "spool.directory": self.spool, "access.data_roots": self.data,
                         "catalogues.directory": self.path("catalogues"), **(settings or {})}
        self.env = {**os.environ, **SANITIZERS, **(env or {})}
        if preload is not None:
            self.env["LD_PRELOAD"] = preload
        self.process, self.starts, self.program = None, 0, SHEARD
        self.prefix = []  # what runs the program, where something does
        os.makedirs(self.data, exist_ok=True)
        self.write_config()

    def path(self, *names):
        return os.path.join(self.directory, *names)

    def folder(self, name, *more):
        return os.path.join(self.spool, name, *more)

    def write_config(self):
        sections = {}
        for key, value in self.settings.items():
            section, _, name = key.partition(".")
            sections.setdefault(section, []).append(f"{name} = {value}\n")
        with open(self.config, "w", encoding="utf-8") as f:
            f.write("".join(f"[{s}]\n{''.join(lines)}\n" for s, lines in sections.items()))

    # ---- life ----

    def spawn(self):
        """Start it, and do not wait."""
        assert not self.alive()
        self.starts += 1
        with open(self.log, "ab") as log:
            self.process = subprocess.Popen([*self.prefix, self.program, "--config", self.config], env=self.env,
                                            stdin=subprocess.DEVNULL, stdout=log, stderr=log)
        return self

    def start(self):
        self.spawn()
        until(self.ready, "the service answers")
        return self

    def ready(self):
        if not self.alive():
            raise AssertionError(f"sheard ended with {self.process.returncode}:\n{self.log_text()}")
        try:
            with Client(self.socket, 5) as client:
                return client.call("status")
        except (OSError, EOFError):
            return None

    def alive(self):
        return self.process is not None and self.process.poll() is None

    def kill(self):
        self.process.kill()
        return self.process.wait()

    def signal(self, number):
        self.process.send_signal(number)

    def ended(self, limit=None):
        """Wait until it has ended by itself; return the exit code."""
        until(lambda: not self.alive(), "the service ended", limit)
        return self.process.returncode

    def stop(self):
        """Send SIGTERM; return the exit code."""
        self.signal(signal.SIGTERM)
        return self.ended()

    def close(self):
        if self.alive():
            self.kill()

    def log_text(self, tail=6000):
        with open(self.log, encoding="utf-8", errors="replace") as f:
            return f.read()[-tail:]

    def children(self):
        """Process ids of its readers: of those that read, where others only wait for them."""
        return [pid for child in children_of(self.process.pid) for pid in children_of(child) or [child]]

    def held(self, number):
        """The job, once it is in the middle of its measurement, which it does not leave before
        go_on(): however slow this test may be, and however fast the machine."""
        until(lambda: self.job(number)["progress"]["done"], f"job {number} measures")
        self.hold()
        state = self.job(number)["state"]
        assert state == "running", f"job {number} is {state} already: it is too small"
        return number

    def hold(self):
        """Stop its readers: the jobs that run cannot end before go_on()."""
        for pid in self.children():
            os.kill(pid, signal.SIGSTOP)

    def go_on(self):
        for pid in self.children():
            os.kill(pid, signal.SIGCONT)

    # ---- talking ----

    def client(self, timeout=None):
        return Client(self.socket, timeout)

    def call(self, method, **params):
        with self.client() as client:
            return client.call(method, **params)

    def shearctl(self, *arguments):
        """What it prints; it must succeed."""
        run = subprocess.run([SHEARCTL, arguments[0], "--socket", self.socket, *arguments[1:]],
                             check=True, capture_output=True, encoding="utf-8",
                             env={**self.env, "COLUMNS": "400"})
        return run.stdout

    def submit(self, path, **params):
        return self.call("submit", path=path, **params)["job"]

    def job(self, number):
        return self.call("job", id=number)["job"]

    def jobs(self, **params):
        """All pages."""
        jobs, cursor = [], None
        while True:
            page = self.call("jobs", limit=200, cursor=cursor, **params)
            jobs, cursor = jobs + page["jobs"], page["cursor"]
            if cursor is None:
                return jobs

    def wait_state(self, number, *states, limit=None):
        return until(lambda: (job := self.job(number)) and job["state"] in states and job,
                     f"job {number} is {' or '.join(states)}", limit)

    def wait_idle(self, limit=None):
        """No job is unfinished, and nothing lies in incoming/ or active/."""
        def idle():
            states = self.call("status")["states"]
            return not (states["queued"] or states["running"] or states["waiting"] or
                        self.dropped("incoming") or self.dropped("active"))
        return until(idle, "the service is idle", limit, 0.05)

    # ---- the watch folder ----

    def drop(self, source, name, content=None):
        """Drop a file into incoming/, by renaming it into place."""
        hidden = self.folder("incoming", "." + name)
        if content is not None:
            with open(hidden, "wb") as f:
                f.write(content)
        else:
            shutil.copyfile(source, hidden)
        os.rename(hidden, self.folder("incoming", name))

    def dropped(self, folder):
        return sorted(name for name in os.listdir(self.folder(folder)) if name[0] != ".")

    def side(self, folder, name):
        with open(self.folder(folder, name + ".json"), encoding="utf-8") as f:
            return json.load(f)


# ---- files and what they must give ----

def content_of(path):
    with open(path, "rb") as f:
        return f.read()


def mock(path, stamps=16, size=32, seed=1, *more):
    """A small field of mock galaxies; quick to measure."""
    subprocess.run([SHEARCTL, "mock", "--stamps", str(stamps), "--size", str(size), "--points",
                    "40", "--r-gal", "3", "--seed", str(seed), "--force", *map(str, more), path],
                   check=True, stdout=subprocess.DEVNULL)
    return path


@functools.lru_cache(maxsize=None)
def rate(size, *options):
    """Stamps per second that `shearctl measure` manages here with these options on all processors."""
    with tempfile.TemporaryDirectory(prefix="sheard-test-") as folder:
        stamps, seconds = 64, 0.0
        while seconds < 0.4:
            stamps *= 2
            path = mock(os.path.join(folder, "rate.fits"), stamps, size)
            begun = time.monotonic()
            measured([path], *options)
            seconds = time.monotonic() - begun
        return stamps / seconds


# A measurement that takes long for few stamps; a sanitizer makes it slower by itself.
SLOW_OVERSAMPLE = 8 if SANITIZED else 16
SLOW = {"interpolation": "bicubic", "oversample": SLOW_OVERSAMPLE}
SLOW_MEASURE = {f"measure.{key}": value for key, value in SLOW.items()}  # of the configuration
SLOW_OPTIONS = ("--interpolation", "bicubic", "--oversample", str(SLOW_OVERSAMPLE), "--threads", "1")


def stamps_for(seconds, size, *options):
    """The number of stamps that take about this long to measure, or somewhat longer, however fast the machine
    and the measurement are. Never so few that all could have been read when the first are measured:
    a job that is held then would not stay."""
    return max(320, 16 * round(seconds * rate(size, *options) / 16 + 1))


def named(content, name):
    """The same field file with a field name of its own: a FIELD card in the first header."""
    end = next(i for i in range(0, len(content), 80) if content[i:i + 80] == card("END"))
    data = end + 80 + -(end + 80) % BLOCK
    return pad(content[:end] + card("FIELD", name) + card("END"), b" ") + content[data:]


def measured(paths, *options):
    """The result of `shearctl measure` for these files as one field."""
    run = subprocess.run([SHEARCTL, "measure", "--json", "--field", "x", *options, *paths],
                         check=True, capture_output=True, encoding="utf-8")
    return numbers(json.loads(run.stdout))


def numbers(row):
    return {key: row[key] for key in NUMBERS}


class LongTurn(AssertionError):
    """A turn of the service's loop took too long."""


def turns(test):
    """A test of how long turns take. A virtual machine that is paused in the middle of one has it last longer, in processor
    time, too: that does not happen twice, while what the service does is as long each time."""
    @functools.wraps(test)
    def tried(self):
        try:
            test(self)
        except LongTurn as error:
            print(f"{self.id()}: once more: {error}", file=sys.stderr)
            self.doCleanups()
            self.setUp()
            test(self)
    return tried


class DaemonTest(unittest.TestCase):
    """A test with a directory of its own and daemons that do not outlive it."""

    def setUp(self):
        directory = tempfile.TemporaryDirectory(prefix="sheard-test-")
        self.addCleanup(directory.cleanup)
        self.directory = directory.name
        os.chmod(self.directory, 0o755)

    def daemon(self, settings=None, start=True, name="", **more):
        where = os.path.join(self.directory, name)
        os.makedirs(where, exist_ok=True)
        daemon = Daemon(where, settings, **more)
        self.addCleanup(self.assertNoReport, daemon)
        self.addCleanup(daemon.close)
        return daemon.start() if start else daemon

    def assertNoReport(self, daemon):
        """No sanitizer complained, neither of the daemon nor of its readers."""
        if SANITIZED and os.path.exists(daemon.log):
            text = daemon.log_text(1 << 20)
            self.assertNotRegex(text, r"ERROR: \w+Sanitizer|WARNING: \w+Sanitizer|runtime error: ")

    @contextlib.contextmanager
    def assertRefused(self, code):
        with self.assertRaises(RpcError) as caught:
            yield caught
        self.assertEqual(caught.exception.code, code, caught.exception)

    def assertTurns(self, daemon, limit_ms):
        """Check that no turn since its start took as long; within a test of turns."""
        loop = daemon.call("status")["loop"]
        if loop["longest_ms"] >= limit_ms:
            raise LongTurn(f"a turn of {loop['longest_ms']:.1f} ms is not below {limit_ms:.1f}: {loop}")

    def assertRow(self, daemon, field, expected, jobs, message=None):
        """Check that the field has one row, of this many jobs, with these numbers to the last bit."""
        rows = daemon.call("field", field=field)["rows"]
        self.assertEqual(len(rows), 1, message)
        self.assertEqual((rows[0]["jobs"], rows[0]["unfinished"]), (jobs, 0), message)
        self.assertEqual(numbers(rows[0]), expected, message)
        return rows[0]
