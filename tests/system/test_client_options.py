# SPDX-License-Identifier: GPL-3.0-or-later
"""Options and operands of the service's subcommands: wrong ones, and those in help and completion data."""
import re
import unittest

from fake_service import failed, job, status
from service_test import ServiceTest
from tool import USAGE, shearctl


class Usage(ServiceTest):
    def test_errors(self):
        self.serve()
        cases = [
            (["submit"], "which files"), (["show"], "which job"), (["wait"], "which jobs"), (["cancel"], "which jobs"),
            (["field"], "which field"), (["field", "a", "b"], "unexpected"), (["jobs", "x"], "unexpected"),
            (["fields", "a", "b"], "unexpected"), (["status", "x"], "unexpected"),
            (["jobs", "--state", "sleeping"], "not a state"), (["jobs", "--state", "done,x"], "not a state"),
            (["jobs", "--user", "no such user"], "no such user"), (["jobs", "--limit", "0"], "--limit"),
            (["jobs", "--limits", "3"], "--limit"), (["wait", "x"], "not the number"), (["wait", "0"], "not the number"),
            (["wait", "-1"], "-1"), (["wait", "9" * 30], "not the number"),
            (["wait", "1", "--timeout", "soon"], "--timeout"),
            (["wait", "1", "--timeout", "-3"], "--timeout"), (["status", "--reply-timeout", "0"], "--reply-timeout"),
            (["status", "--reply-timeout", "1y"], "--reply-timeout"), (["watch", "--interval", "1ms"], "--interval"),
            (["watch", "--count", "0"], "--count"), (["watch", "--jobs", "1000"], "--jobs"),
            (["submit", "--priority", "101", "x"], "--priority"), (["submit", "--galaxy", "a", "b.fits"], "either"),
            (["submit", "--galaxy", "a", "--noise", "b"], "belong together"), (["submit", "--key", "k", "a", "b"], "--key"),
            (["submit", "--timeout", "3", "a"], "--wait"), (["submit", "--beta", "wide", "a"], "beta"),
            (["submit", "--galaxy", "a:99999", "--noise", "b", "--psf", "c"], "HDU"),
            (["submit", "--catalog", "t"], "belong"),
            (["shutdown", "--timeout", "x"], "--timeout"), (["shutdown", "--json=1"], "takes no value"),
        ]
        for args, word in cases:
            with self.subTest(args=args):
                answer = self.ctl(*args)
                self.assertFails(answer, USAGE, word)
                self.assertEqual(answer.out, "")

    def test_help_names_the_exit_codes(self):
        for name in ("submit", "wait"):
            text = shearctl("help", name).out
            for word in ("5 failed", "6 timed out", "7 the", "8 cancelled"):
                self.assertIn(word, " ".join(text.split()))


class Completions(ServiceTest):
    def test_data_names_every_option_of_the_help(self):
        lines = shearctl("help", "--completion-data").out.splitlines()
        commands = [line.split("|") for line in lines if line.startswith("command|")]
        options = [line.split("|") for line in lines if line.startswith("option|")]
        self.assertEqual({len(c) for c in commands}, {4})
        self.assertEqual({len(o) for o in options}, {6})
        self.assertEqual(len(commands) + len(options), len(lines))
        for name in (c[1] for c in commands):
            text = shearctl("help", name).out
            said = set(re.findall(r"(?m)^  (?:-\w, )?(--[a-z-]+)", text)) | {"--help"}
            self.assertEqual(said - {o[2] for o in options if o[1] == name}, set(), name)
        self.assertIn(["option", "submit", "--zeros", "POLICY", "skip floor"], [o[:5] for o in options])
        self.assertIn(["option", "submit", "--no-noise-correction"], [o[:3] for o in options])


if __name__ == "__main__":
    unittest.main()
