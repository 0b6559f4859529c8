#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""schema.py PROBE [--check]: update the documents that depend on the tables of messages. The program PROBE
(tests/unit/protocol_probe.c) prints these. The documents are docs/protocol.schema.json, from the tables and
protocol/schema.in.json (what is in no table), and docs/protocol.md, in whose examples the settings of a job and the list of
methods are updated. With --check nothing is written: stale documents are named, and the exit status is 1. The target
`protocol-docs` of the build runs it."""
import json
import os
import re
import subprocess
import sys

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..")
WIDTH = 120
PLAIN = "^[^\\u0000-\\u001f\\u007f]*$"
CLIENT_ONLY = ("bad_reply", "unknown")  # codes that no service sends


def ref(name):
    return {"$ref": f"#/$defs/{name}"}


def or_null(schema):
    return {"anyOf": [schema, {"type": "null"}]}


def kind(name, member):
    """Return the type of a member, which may be null unless it is required."""
    return name if member["required"] else [name, "null"]


def text(member, longest):
    limits = {"minLength": 1, "maxLength": longest, "pattern": PLAIN} if member["plain"] else {"maxLength": longest}
    return {**limits, "pattern": "^/"} if member["absolute"] else limits


def range_of(member):
    most = {"maximum": member["max"]} if 0 < member["max"] < 2**63 - 1 else {}
    return {"minimum": member["min"], **most}


# ---- Messages of a client: limits apply, and other members are errors ----

def asked_member(m):
    names = [n for n in m.get("names", []) if n]
    more = {"maxItems": m["max"], **({"minItems": 1} if m["required"] else {})}
    fallback = {} if m["required"] or m["nullable"] else {"default": m["fallback"]}
    return {
        "bool": lambda: {"type": kind("boolean", m)},
        "int": lambda: {"type": kind("integer", m), **range_of(m), **fallback},
        "real": lambda: {"type": kind("number", m), **range_of(m)},
        "text": lambda: {"type": kind("string", m), **text(m, m["max"])},
        "name": lambda: {"type": kind("string", m), "enum": [*names, None], "default": names[m["fallback"]]},
        "states": lambda: {"type": kind("array", m), "items": {"type": "string", "enum": names}},
        "ints": lambda: {"type": kind("array", m), "items": {"type": "integer", "minimum": 1}, **more},
        "texts": lambda: {"type": kind("array", m), "items": {"type": "string", **text(m, m["item_max"])}, **more},
        "settings": lambda: or_null(ref("settings")),
        "object": lambda: ref(m["table"]) if m["required"] else or_null(ref(m["table"])),
    }[m["type"]]()


def asked(members):
    schema = {"type": "object", "properties": {m["name"]: asked_member(m) for m in members}}
    required = [m["name"] for m in members if m["required"]]
    return {**schema, **({"required": required} if required else {}), "additionalProperties": False}


def asked_parts(members):
    """Return the definitions of all objects among the members, the inner ones first."""
    found = {}
    for m in (m for m in members if "table" in m):
        found.update({**asked_parts(m["members"]), m["table"]: asked(m["members"])})
    return found


# ---- Messages of the service: all members are present, and newer services may add some ----

class Told:
    def __init__(self, code):
        self.defs = {}
        self.asked = set()  # tables that clients use, too: the service's form gets another name
        for method in code["methods"]:
            self.note(method["params"])

    def note(self, members):
        for m in members:
            if "table" in m:
                self.asked |= {m["table"], "source"}  # a source's members are merged into submit's
                self.note(m["members"])

    def name(self, table):
        return f"{table}_told" if table in self.asked else table

    def use(self, table, members):
        name = self.name(table)
        if name not in self.defs:
            self.defs[name] = None
            self.defs[name] = self.whole(members)
        return ref(name)

    def member(self, m):
        names = m.get("names", [])
        if names:
            null = [None] if names[0] == "" else []
            return {"type": ["string", "null"] if null else "string", "enum": [n for n in names if n] + null}
        least = {"minimum": m["min"]} if m["min"] >= 0 else {}
        most = {"maxItems": m["max"]} if m["max"] else {}
        table = (lambda: self.use(m["table"], m["members"])) if "table" in m else None
        return {
            "bool": lambda: {"type": "boolean"},
            "int": lambda: {"type": ["integer", "null"] if m["nullable"] else "integer", **least},
            "real": lambda: {"type": ["number", "null"]},
            "text": lambda: {"type": kind("string", m)},
            "time": lambda: or_null(ref("time")),
            "raw": lambda: or_null(ref("report")),
            "settings": lambda: or_null(ref("job_settings")),
            "ints": lambda: {"type": "array", "items": {"type": "integer", "minimum": 1}, **most},
            "texts": lambda: {"type": "array", "items": {"type": "string"}},
            "object": lambda: or_null(table()) if m["nullable"] else table(),
            "objects": lambda: {"type": "array", "items": table()},
        }[m["type"]]()

    def whole(self, members):
        own = [m for m in members if m["type"] != "merged"]
        schema = {"type": "object", "properties": {m["name"]: self.member(m) for m in own},
                  "required": [m["name"] for m in own]}
        return schema if own == members else {"allOf": [ref("report"), schema]}


# ---- Settings ----

def setting(s):
    limits = {k: int(s[v]) if abs(s[v]) < 1e15 and s[v] == int(s[v]) else s[v]
              for k, v in (("minimum", "min"), ("maximum", "max")) if abs(s[v]) < sys.float_info.max}
    if s["type"] == "choice":
        return {"type": "string", "enum": s["names"]}
    if s["type"] == "bool":
        return {"type": "boolean"}
    number = {"type": "integer" if s["type"] == "int" else "number", **limits}
    return {"anyOf": [number, {"const": s["word"]}]} if s["word"] else number


def settings(code):
    names = [s["name"] for s in code["settings"]]
    properties = {s["name"]: setting(s) for s in code["settings"]}
    other = "|".join(n.replace("-", "_") for n in names if "-" in n)
    return {"settings": {"type": "object", "properties": properties, "patternProperties": {f"^({other})$": {}},
                         "additionalProperties": False},
            "job_settings": {"type": "object", "properties": properties, "required": names}}


# ---- The whole schema ----

def call(method):
    params = ref(f"params_{method['name']}")
    if method["needs_params"]:
        return {"properties": {"method": {"const": method["name"]}, "params": params}, "required": ["params"]}
    return {"properties": {"method": {"const": method["name"]}, "params": or_null(params)}}


def notice(n):
    return {"properties": {"method": {"const": n["name"]}, "params": ref(f"notice_{n['name']}")}}


def schema(code):
    with open(os.path.join(ROOT, "protocol", "schema.in.json"), encoding="utf-8") as file:
        whole = json.load(file)
    more = whole.pop("more")  # additions to definitions that are generated here
    told = Told(code)
    defs = whole["$defs"]
    defs["request"]["oneOf"] = [call(m) for m in code["methods"]]
    defs["notification"]["oneOf"] = [notice(n) for n in code["notifications"]]
    data = defs["error"]["properties"]["error"]["properties"]["data"]
    data["properties"]["code"]["enum"] = [c["name"] for c in code["codes"] if c["name"] not in CLIENT_ONLY]
    defs.update(settings(code))
    defs.update({f"params_{m['name']}": asked(m["params"]) for m in code["methods"]})
    for method in code["methods"]:
        defs.update(asked_parts(method["params"]))
    defs.update({f"reply_{m['name']}": told.use(m["table"], m["reply"]) for m in code["methods"]})
    defs.update({f"notice_{n['name']}": told.use(n["table"], n["params"]) for n in code["notifications"]})
    defs["side_file"] = told.use("side", code["side"])
    defs.update(told.defs)
    for name, part in more.items():
        defs[name] = {**part, **defs[name]} if "description" in part else {**defs[name], **part}
    return whole


def layout(value, indent=0, before=0):
    """Return JSON with each value on one line, if it fits. `before`: characters before it on its line."""
    flat = json.dumps(value, ensure_ascii=False)
    if before + len(flat) < WIDTH or not isinstance(value, (dict, list)) or not value:
        return flat
    inner = " " * (indent + 2)
    if isinstance(value, dict):
        items = [f"{json.dumps(k)}: " for k in value]
        items = [inner + k + layout(v, indent + 2, indent + 2 + len(k)) for k, v in zip(items, value.values())]
        ends = "{}"
    else:
        items = [inner + layout(v, indent + 2, indent + 2) for v in value]
        ends = "[]"
    return ends[0] + "\n" + ",\n".join(items) + "\n" + " " * indent + ends[1]


def examples(code, document):
    """Return the document with all current settings in examples that have all, and the current list of methods."""
    def whole(found):
        old = json.loads(found.group(1))
        new = {s["name"]: old.get(s["name"], s["default"]) for s in code["settings"]}
        if list(old) == list(new):
            return found.group(0)
        if "\n" not in found.group(1):
            return '"settings":' + json.dumps(new, separators=(",", ":"))
        indent = " " * (len(found.group(1).split("\n")[-1]) - 1)
        return '"settings": ' + json.dumps(new, indent=2).replace("\n", "\n" + indent)
    document = re.sub(r'"settings": ?(\{\s*"preset"[^{}]*\})', whole, document)
    methods = json.dumps([m["name"] for m in code["methods"]], separators=(",", ":"))
    return re.sub(r'"methods":\[[^]]*\]', lambda found: f'"methods":{methods}', document)


def renew(name, make, check):
    path = os.path.join(ROOT, "docs", name)
    with open(path, encoding="utf-8") as file:
        old = file.read()
    new = make(old)
    if new == old:
        return 0
    if check:
        print(f"docs/{name} is not what the code's tables say: build the target protocol-docs")
        return 1
    with open(path, "w", encoding="utf-8") as file:
        file.write(new)
    return 0


def main():
    out = subprocess.run([sys.argv[1], "tables"], check=True, capture_output=True, encoding="utf-8").stdout
    code = json.loads(out)
    check = "--check" in sys.argv[2:]
    wrong = renew("protocol.schema.json", lambda old: layout(schema(code)) + "\n", check)
    wrong += renew("protocol.md", lambda old: examples(code, old), check)
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
