# SPDX-License-Identifier: GPL-3.0-or-later
"""docs/protocol.md, docs/protocol.schema.json and the code say the same. PROTOCOL_PROBE in the environment is the path of
protocol_probe, which prints what the code knows and reads messages as the code does. With python3-jsonschema the examples
are validated by it; they are always validated by the small validator below."""
import copy
import json
import os
import re
import subprocess
import sys
import unittest

try:
    import jsonschema
except ImportError:
    jsonschema = None

PROBE = os.path.abspath(os.environ["PROTOCOL_PROBE"])
ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
CLIENT_ONLY = {"bad_reply", "unknown"}  # codes that no service sends
WRONG = {"invalid_request", "unknown_method", "unknown_parameter", "missing_parameter", "bad_parameter", "bad_setting"}


def read(name):
    with open(os.path.join(ROOT, "docs", name), encoding="utf-8") as file:
        return file.read()


DOC = read("protocol.md")
SCHEMA = json.loads(read("protocol.schema.json"))
CODE = json.loads(subprocess.run([PROBE, "tables"], check=True, capture_output=True, encoding="utf-8").stdout)
METHODS = {m["name"]: m for m in CODE["methods"]}


# ---- The schema, read by ourselves ----

TYPES = {"object": dict, "array": list, "string": str, "boolean": bool, "null": type(None)}


def has_type(value, name):
    if name == "integer":
        return isinstance(value, int) and not isinstance(value, bool)
    if name == "number":
        return isinstance(value, (int, float)) and not isinstance(value, bool)
    return isinstance(value, TYPES[name])


def as_list(x):
    return x if isinstance(x, list) else [x]


def faults(value, schema, at="$"):
    """What is wrong with `value`, as a list of texts. A keyword that is not known here is an error of this test."""
    if "$ref" in schema:
        return faults(value, definition(schema["$ref"].removeprefix("#/$defs/")), at)
    found = []
    for keyword, wanted in schema.items():
        found += [f"{at}: {text}" for text in KEYWORDS[keyword](value, wanted, schema)]
    for name, part in schema.get("properties", {}).items():
        if isinstance(value, dict) and name in value:
            found += faults(value[name], part, f"{at}.{name}")
    if "items" in schema and isinstance(value, list):
        for i, item in enumerate(value):
            found += faults(item, schema["items"], f"{at}[{i}]")
    return found


def definition(name):
    return SCHEMA["$defs"][name]


def count_good(value, schemas):
    return sum(not faults(value, s) for s in schemas)


def additional(value, wanted, schema):
    if not isinstance(value, dict):
        return []
    patterns = schema.get("patternProperties", {})
    extra = [k for k in value if k not in schema.get("properties", {}) and not any(re.search(p, k) for p in patterns)]
    if wanted is False:
        return [f"has no member {k}" for k in extra]
    return [text for k in extra for text in faults(value[k], wanted, k)]


def number(test):
    return lambda v, w, s: [] if not has_type(v, "number") or test(v, w) else [f"{v} is beyond {w}"]


def length(kind, test):
    return lambda v, w, s: [] if not isinstance(v, kind) or test(len(v), w) else [f"length {len(v)} is beyond {w}"]


def nothing(value, wanted, schema):
    return []


KEYWORDS = {
    "type": lambda v, w, s: [] if any(has_type(v, t) for t in as_list(w)) else [f"{v!r} is not {w}"],
    "const": lambda v, w, s: [] if v == w and isinstance(v, bool) == isinstance(w, bool) else [f"{v!r} is not {w!r}"],
    "enum": lambda v, w, s: [] if v in w else [f"{v!r} is not one of {w}"],
    "required": lambda v, w, s: [f"{k} is missing" for k in w if isinstance(v, dict) and k not in v],
    "additionalProperties": additional,
    "minimum": number(lambda v, w: v >= w),
    "maximum": number(lambda v, w: v <= w),
    "minLength": length(str, lambda n, w: n >= w),
    "maxLength": length(str, lambda n, w: n <= w),
    "minItems": length(list, lambda n, w: n >= w),
    "maxItems": length(list, lambda n, w: n <= w),
    "pattern": lambda v, w, s: [] if not isinstance(v, str) or re.search(w, v) else [f"{v!r} does not match {w}"],
    "anyOf": lambda v, w, s: [] if count_good(v, w) >= 1 else [f"{v!r:.200} is none of {len(w)}"],
    "oneOf": lambda v, w, s: [] if count_good(v, w) == 1 else [f"{v!r:.200} is {count_good(v, w)} of {len(w)}"],
    "allOf": lambda v, w, s: [text for part in w for text in faults(v, part)],
    "properties": nothing,
    "patternProperties": nothing,
    "items": nothing,
    "description": nothing,
    "title": nothing,
    "default": nothing,
    "$schema": nothing,
    "$defs": nothing,
}


def official_faults(value, name):
    schema = {"$ref": f"#/$defs/{name}", "$defs": SCHEMA["$defs"]}
    return [e.message for e in jsonschema.Draft202012Validator(schema).iter_errors(value)]


# ---- The document ----

def section(title):
    """The text under "## TITLE"."""
    return re.search(rf"^## {title}$(.*?)(?=^## |\Z)", DOC, re.M | re.S).group(1)


def subsections(title):
    return dict(re.findall(r"^### `(\w+)`$(.*?)(?=^### |\Z)", section(title), re.M | re.S))


def rows(text):
    """The cells of all rows of the tables in a text, without head and rule."""
    lines = re.findall(r"^\|(.*)\|$", text, re.M)
    return [[cell.strip() for cell in line.split("|")] for line in lines if not re.match(r"^[-|]+$", line)]


def examples():
    """(kind, method or None, text) of every example; a reply has the method of the request with its id. A request that every
    reader must answer by an error is a "wrong-request"."""
    found = []
    for info, block in re.findall(r"^```([^\n]*)\n(.*?)^```$", DOC, re.M | re.S):
        if info.endswith("-file"):
            found.append((info.removeprefix("json "), None, block))
        asked = {}
        wrong = set(re.findall(r'"id":([^,]+),"error".*?"data":{"code":"(?:%s)"' % "|".join(sorted(WRONG)), block))
        for arrow, text in re.findall(r"^(-->|<--) ([^\n]*)$", block, re.M):
            message = json.loads(text)
            if arrow == "-->":
                asked[message["id"]] = message["method"]
                kind = "wrong-request" if json.dumps(message["id"]) in wrong else "request"
                found.append((kind, message["method"], text))
            elif "id" not in message:
                found.append(("notification", message["method"], text))
            else:
                found.append(("error" if "error" in message else "reply", asked[message["id"]], text))
    return found


def definitions_of(kind, method):
    """The definitions that an example must satisfy, each with the part of the message it is about."""
    whole = (kind.replace("-", "_"), lambda m: m)
    if kind == "reply":
        return [whole, (f"reply_{method}", lambda m: m["result"])]
    if kind == "notification":
        return [whole, (f"notice_{method}", lambda m: m["params"])]
    return [whole]


# ---- The schema against the tables of the code ----

def resolve(schema):
    """Without references and null, and with the parts of allOf joined."""
    while True:
        if "$ref" in schema:
            schema = definition(schema["$ref"].removeprefix("#/$defs/"))
        elif "anyOf" in schema and "type" not in schema:
            schema = next(s for s in schema["anyOf"] if s != {"type": "null"})
        elif "allOf" in schema:
            schema = schema["allOf"][-1]
        else:
            return schema


class SchemaAndTables(unittest.TestCase):
    def compare(self, members, schema, strict, at):
        """`members` of the code's table and an object's schema, all the way down."""
        schema = resolve(schema)
        own = {m["name"]: m for m in members if m["type"] != "merged"}
        self.assertEqual(list(own), list(schema.get("properties", {})), at)
        required = [n for n, m in own.items() if m["required"]] if strict else list(own)
        self.assertEqual(required, schema.get("required", []), at)
        self.assertEqual(schema.get("additionalProperties", True), not strict, at)
        for name, member in own.items():
            self.compare_member(member, schema["properties"][name], strict, f"{at}.{name}")

    def compare_member(self, member, schema, strict, at):
        part = resolve(schema)
        if "members" in member:
            inner = part["items"] if member["type"] == "objects" else part
            self.compare(member["members"], inner, strict, at)
        elif member["type"] in ("name", "states"):
            names = part["items"]["enum"] if member["type"] == "states" else part["enum"]
            self.assertEqual([n for n in member["names"] if n], [n for n in names if n is not None], at)
        elif strict and member["type"] in ("int", "real"):
            bounds = (part["minimum"], part.get("maximum", 2**63 - 1))
            self.assertEqual(bounds, (member["min"], member["max"]), at)
        elif strict and member["type"] == "text":
            self.assertEqual(part["maxLength"], member["max"], at)
        elif strict and member["type"] in ("ints", "texts"):
            self.assertEqual(part["maxItems"], member["max"], at)
        accepts_null = not faults(None, schema)
        if strict:
            self.assertEqual(accepts_null, not member["required"], at)
        elif member["type"] in ("text", "raw", "time", "real", "settings"):
            self.assertEqual(accepts_null, not member["required"], at)

    def test_methods(self):
        for name, method in METHODS.items():
            self.compare(method["params"], definition(f"params_{name}"), True, f"params_{name}")
            self.compare(method["reply"], definition(f"reply_{name}"), False, f"reply_{name}")

    def test_notifications(self):
        for notice in CODE["notifications"]:
            self.compare(notice["params"], definition(f"notice_{notice['name']}"), False, notice["name"])

    def test_side_file(self):
        self.compare(CODE["side"], definition("side_file"), False, "side_file")

    def test_nothing_else(self):
        defined = {n.split("_", 1)[1] for n in SCHEMA["$defs"] if n.startswith(("params_", "reply_"))}
        self.assertEqual(defined, set(METHODS))
        called = [s["properties"]["method"]["const"] for s in definition("request")["oneOf"]]
        self.assertEqual(called, list(METHODS))
        told = [s["properties"]["method"]["const"] for s in definition("notification")["oneOf"]]
        self.assertEqual(told, [n["name"] for n in CODE["notifications"]])

    def test_codes(self):
        listed = definition("error")["properties"]["error"]["properties"]["data"]["properties"]["code"]["enum"]
        self.assertEqual(listed, [c["name"] for c in CODE["codes"] if c["name"] not in CLIENT_ONLY])

    def test_settings(self):
        for kind in ("settings", "job_settings"):
            properties = definition(kind)["properties"]
            self.assertEqual(list(properties), [s["name"] for s in CODE["settings"]])
            for setting in CODE["settings"]:
                part = properties[setting["name"]]
                self.assertEqual(not faults("auto", part), setting["auto"] or "auto" in setting.get("names", []))
                if setting["type"] in ("int", "double"):
                    self.assertEqual(resolve(part)["minimum"], setting["min"])
                    self.assertEqual(resolve(part).get("maximum", setting["max"]), setting["max"])
                elif setting["type"] == "choice":
                    self.assertEqual(part["enum"], setting["names"])

    def test_what_is_made_of_the_tables_is_current(self):
        made = subprocess.run([sys.executable, "-B", os.path.join(ROOT, "protocol", "schema.py"), PROBE, "--check"],
                              capture_output=True, encoding="utf-8", check=False)
        self.assertEqual(made.returncode, 0, made.stdout + made.stderr)

    @unittest.skipUnless(jsonschema, "python3-jsonschema is not installed")
    def test_schema_is_a_schema(self):
        jsonschema.Draft202012Validator.check_schema(SCHEMA)


class DocumentAndTables(unittest.TestCase):
    def test_codes(self):
        told = [(name.strip("`"), int(n), retry == "yes", "" if job == "–" else job)
                for name, n, retry, job, meaning in rows(section("Error codes"))[1:]]
        known = [(c["name"], c["number"], c["retry"], c["class"])
                 for c in CODE["codes"] if c["name"] not in CLIENT_ONLY]
        self.assertEqual(told, known)

    def test_codes_that_are_mentioned_exist(self):
        known = {c["name"] for c in CODE["codes"]}
        for mention in re.findall(r"Errors: (.*?)(?:\.$|\.\n| and those)", section("Methods"), re.M | re.S):
            for name in re.findall(r"`([a-z_]+)`", mention):
                self.assertIn(name, known | set(METHODS))

    def test_methods_and_their_parameters(self):
        told = subsections("Methods")
        self.assertEqual(list(told), list(METHODS))
        for name, text in told.items():
            head = text.find("| parameter |")
            table = text[head:text.find("\n\n", head)] if head >= 0 else ""
            names = [n for row in rows(table)[1:] for n in re.findall(r"`(\w+)`", row[0])]
            self.assertEqual(names, [m["name"] for m in METHODS[name]["params"]], name)
            self.assertEqual("Administrators." in text, METHODS[name]["admin"], name)

    def test_members_of_a_job(self):
        text = re.search(r"^### The job object$(.*?)(?=^## )", DOC, re.M | re.S).group(1)
        names = [n for row in rows(text)[1:] for n in re.findall(r"`(\w+)`", row[0])]
        self.assertEqual(sorted(names), sorted(m["name"] for m in METHODS["cancel"]["reply"]))

    def test_notifications(self):
        self.assertEqual(list(subsections("Notifications")), [n["name"] for n in CODE["notifications"]])

    def test_limits(self):
        text = DOC[DOC.index("### Limits"):DOC.index("### Versions")]
        told = [int(n) for n in re.findall(r"\| (\d+)(?: bytes)? \|", text)]
        limits = CODE["limits"]
        job = {m["name"]: m for m in METHODS["submit"]["params"]}
        ids = {m["name"]: m for m in METHODS["wait"]["params"]}["ids"]
        self.assertEqual(told, [limits["line"], limits["depth"], limits["values"], limits["text"], job["path"]["max"],
                                job["field"]["max"], job["key"]["max"], ids["max"], limits["job_file"]])
        self.assertIn(f"at most {limits['id']} bytes", DOC)
        self.assertIn(f"{limits['reply_line'] >> 20} MiB", DOC)

    def test_numbers_in_parameter_tables(self):
        for name, text in subsections("Methods").items():
            for member in METHODS[name]["params"]:
                row = next((r for r in rows(text) if f"`{member['name']}`" in r[0] and len(r) == 4), None)
                self.assertIsNotNone(row, member["name"])
                if member["required"]:
                    self.assertEqual(row[2], "required")
                elif member["type"] == "int" and not member["nullable"]:
                    self.assertEqual(row[2], str(member["fallback"]))
                if member["name"] in ("limit", "priority"):
                    self.assertIn(f"{member['min']} to {member['max']}", row[3])


class Examples(unittest.TestCase):
    def test_every_method_and_notification_has_one(self):
        told = examples()
        for name in METHODS:
            for kind in ("request", "reply"):
                self.assertTrue(any(e[:2] == (kind, name) for e in told), (kind, name))
        for notice in CODE["notifications"]:
            self.assertTrue(any(e[:2] == ("notification", notice["name"]) for e in told), notice["name"])
        for kind in ("error", "job-file", "side-file"):
            self.assertTrue(any(e[0] == kind for e in told), kind)

    def test_examples_satisfy_the_schema(self):
        for kind, method, text in (e for e in examples() if e[0] != "wrong-request"):
            for name, part in definitions_of(kind, method):
                value = part(json.loads(text))
                self.assertEqual(faults(value, definition(name)), [], text[:200])
                if jsonschema:
                    self.assertEqual(official_faults(value, name), [], text[:200])

    def test_wrong_requests_are_wrong(self):
        told = examples()
        wrong = [(method, text) for kind, method, text in told if kind == "wrong-request"]
        errors = {e["id"]: e["error"] for e in (json.loads(t) for k, m, t in told if k == "error")}
        self.assertTrue(wrong)
        for method, text in wrong:
            request = json.loads(text)
            error = errors[request["id"]]
            self.assertNotEqual(faults(request, definition("request")), [])
            answer = subprocess.run([PROBE, "check"], input=f"request {method}\t{text}\n", check=True, capture_output=True,
                                    encoding="utf-8").stdout
            self.assertEqual(answer, f"{error['data']['code']}: {error['message']}\n")

    def test_the_code_reads_the_examples(self):
        told = [e for e in examples() if e[0] != "wrong-request"]
        lines = "".join(f"{kind}{' ' + method if method else ''}\t{' '.join(text.split(chr(10)))}\n"
                        for kind, method, text in told)
        answers = subprocess.run([PROBE, "check"], input=lines, check=True, capture_output=True, encoding="utf-8").stdout
        self.assertEqual(list(zip(answers.splitlines(), told)), [("ok", example) for example in told])

    def test_members_stand_in_the_order_of_the_tables(self):
        for kind, method, text in examples():
            if kind == "reply":
                value = json.loads(text)["result"]
                self.assertEqual(list(value), [m["name"] for m in METHODS[method]["reply"]], text[:200])


class TheValidatorItself(unittest.TestCase):
    """A validator that finds nothing would make the tests above worthless."""

    def broken(self, value):
        """The value with one thing changed: each member left out, and each put to another type."""
        for key in value:
            less = copy.deepcopy(value)
            del less[key]
            yield less
            other = copy.deepcopy(value)
            other[key] = {"of": "no such type"} if not isinstance(value[key], dict) else 3
            yield other

    def test_broken_replies_are_found(self):
        for kind, method, text in examples():
            if kind != "reply":
                continue
            for value in self.broken(json.loads(text)["result"]):
                ours = bool(faults(value, definition(f"reply_{method}")))
                self.assertTrue(ours, (method, value))

    @unittest.skipUnless(jsonschema, "python3-jsonschema is not installed")
    def test_it_agrees_with_jsonschema(self):
        for kind, method, text in (e for e in examples() if e[0] != "wrong-request"):
            for name, part in definitions_of(kind, method):
                for value in self.broken(part(json.loads(text))):
                    self.assertEqual(bool(faults(value, definition(name))), bool(official_faults(value, name)),
                                     (name, value))

    def test_schema_and_code_refuse_the_same(self):
        """Requests broken in the same way: the code's answer is the schema's."""
        cases = []
        for kind, method, text in examples():
            if kind == "request":
                request = json.loads(text)
                cases += [(method, {**request, "params": p}) for p in self.broken(request.get("params", {}))]
        lines = "".join(f"request {method}\t{json.dumps(request)}\n" for method, request in cases)
        answers = subprocess.run([PROBE, "check"], input=lines, check=True, capture_output=True, encoding="utf-8").stdout
        for (method, request), answer in zip(cases, answers.splitlines(), strict=True):
            self.assertEqual(answer == "ok", not faults(request, definition("request")), (request, answer))


if __name__ == "__main__":
    unittest.main()
