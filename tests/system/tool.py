# SPDX-License-Identifier: GPL-3.0-or-later
"""Running shearctl: SHEARCTL in the environment is its path; SHEAR_SANITIZED=1 says that a
sanitizer is built in (memory is not limited then, and more time is allowed)."""
import json
import os
import resource
import signal
import subprocess
import tempfile
import time
import unittest

SHEARCTL = os.path.abspath(os.environ["SHEARCTL"])
SANITIZED = os.environ.get("SHEAR_SANITIZED") == "1"
MEMORY = 2 << 30  # bytes of addresses
# Seconds that a quick answer may take on a busy machine; it takes 0.02 on an idle one.
PATIENCE = 20 if SANITIZED else 2.5

DONE, OTHER, USAGE, INPUT, PARTLY = 0, 1, 2, 3, 4


# In the background of a shell this process would ignore ^C, and so would its children.
signal.signal(signal.SIGINT, signal.default_int_handler)


class Answer:
    """What one run of shearctl gave."""

    def __init__(self, process, seconds):
        self.code, self.seconds = process.returncode, seconds
        self.out, self.err = process.stdout, process.stderr

    def json(self):
        """One object per line."""
        return [json.loads(line, parse_constant=_no_constants) for line in self.out.splitlines()]


def _no_constants(name):
    raise ValueError(f"{name} is not JSON")


# A sanitizer's complaint must not pass for one of the tool's own exit codes.
SANITIZERS = {name + "_OPTIONS": os.environ.get(name + "_OPTIONS", "") + ":exitcode=99"
              for name in ("ASAN", "UBSAN", "TSAN", "LSAN")}
SANITIZERS["ASAN_OPTIONS"] += ":verify_asan_link_order=0"  # FAULTSHIM may come before its runtime


def shearctl(*args, cwd=None, timeout=60, file_size=None, env=None):
    def limit():
        if not SANITIZED:
            resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
        if file_size is not None:
            resource.setrlimit(resource.RLIMIT_FSIZE, (file_size, file_size))

    begun = time.monotonic()
    # restore_signals=False leaves SIGXFSZ ignored: too large a file is then an error of write()
    process = subprocess.run([SHEARCTL, *map(str, args)], cwd=cwd, timeout=timeout,
                             preexec_fn=limit, stdin=subprocess.DEVNULL, capture_output=True,
                             encoding="utf-8", errors="surrogateescape", restore_signals=False,
                             env={**os.environ, **SANITIZERS, **(env or {})})
    return Answer(process, time.monotonic() - begun)


class ToolTest(unittest.TestCase):
    """A test with a directory of its own (self.path) and checks of an answer."""

    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.directory = directory.name

    def path(self, name):
        return os.path.join(self.directory, name)

    def assertCode(self, answer, code):
        self.assertEqual(answer.code, code, f"\nstdout: {answer.out}\nstderr: {answer.err}")

    def assertFails(self, answer, code, *words):
        """Check the exit code and that standard error has one error in the usual form with all the words."""
        self.assertCode(answer, code)
        self.assertRegex(answer.err, r"^shearctl: error: ")
        for word in words:
            self.assertIn(word, answer.err)

    def measure_one(self, *args):
        """Measure what must go well and be one field."""
        answer = shearctl("measure", "--json", *args)
        self.assertCode(answer, DONE)
        objects = answer.json()
        self.assertEqual(len(objects), 1, answer.out)
        return objects[0]
