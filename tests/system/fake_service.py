# SPDX-License-Identifier: GPL-3.0-or-later
"""A service with replies chosen by a test: JSON-RPC over a Unix socket, as docs/protocol.md has it."""
import json
import os
import socket
import threading

LIMITS = {"line_bytes": 65536, "depth": 8, "values": 4096, "list": 256, "jobs_page": 200, "fields_page": 1000,
          "connections": 100, "in_flight": 8, "idle_s": 600, "queue": 1000}
WELCOME = {"protocol": 1, "oldest": 1, "newest": 1, "server": "sheard 0.1.0", "uid": 1000, "admin": False,
           "methods": [], "limits": LIMITS}
REPORT = {"field": "deep", "g1": 0.0285, "g1_err": 0.0008, "g2": -0.0301, "g2_err": 0.0009, "cov12": 1e-8,
          "n_stamps": 1000, "n_used": 990, "n_flagged": 10, "flags": {"galaxy_not_finite": 10}, "settings": {},
          "resolved": {"interpolation": "none", "oversample": 1, "beta_px": 2.4, "r_psf_px": 1.6, "filter": "paper",
                       "core_px": 15.5, "core_found": True, "width_px": 2.4, "noise_band": "high", "k_cut": 2.0,
                       "frame": "pixel", "beta_sky": None},
          "files": [], "estimator": "mean", "error_method": "delta", "jackknife": None, "truth": None, "pull": None,
          "delta_err": None, "no_shear": None,
          "noise_level": {"alpha": 1.002, "alpha_err": 0.003, "effect": 0.0004, "shape": 0.01, "shape_err": 0.02,
                          "share": 0.2},
          "influence": {"n_eff": 512.5, "top_share": 0.031, "top_stamp": 17, "top_file": "/data/1.fits"},
          "resolution": {"mean": 0.31, "bright": 80, "sharp": 0, "bright_triples": 240, "sharp_triples": 0},
          "filter_removed": 0.001, "warnings": ["the borders are bright"], "version": "0.1.0", "seconds": 1.5}


def job(number=1, state="done", **other):
    """A job as the service sends it."""
    final = state in ("done", "failed", "cancelled")
    return {"id": number, "state": state, "class": None, "code": None, "message": None, "advice": None, "field": "deep",
            "source": {"path": f"/data/{number}.fits", "galaxy": None, "noise": None, "psf": None, "catalog": None},
            "owner": 1000, "user": "ann", "origin": "socket", "priority": 0, "force": False, "key": None,
            "cancel_asked": False, "created": "2026-01-31T12:00:00.000Z", "started": "2026-01-31T12:00:01.000Z",
            "finished": "2026-01-31T12:03:06.000Z" if final else None, "not_before": None, "attempts": 1,
            "progress": {"done": 1000 if final else 250, "total": 1000, "rate": 500.0, "eta_s": 1.5},
            "outcome": "counted" if state == "done" else None, "duplicate_of": None, "settings": None,
            "digest": "d1", "checksum": "c1", "result": REPORT if state == "done" else None, "catalogue": None, **other}


def failed(number=1, **other):
    return job(number, "failed", **{"class": "data", "code": "bad_file", "message": "GALAXY: no such HDU",
                                    "advice": "look into the file", **other})


def summary(name="deep", **other):
    return {"field": name, "digest": "d1", "g1": 0.0285, "g1_err": 0.0008, "g2": -0.0301, "g2_err": 0.0009,
            "n_stamps": 1000, "n_used": 990, "jobs": 3, "unfinished": 0, "partial": False, "mixed": False,
            "updated": "2026-01-31T12:03:06.000Z", **other}


def status(**other):
    return {"version": "0.1.0", "protocol": 1, "pid": 4711, "state": "running", "started": "2026-01-31T12:00:00.000Z",
            "uptime_s": 7384.0, "connections": 2, "subscribers": 1,
            "workers": {"total": 4, "busy": 3, "readers": 2}, "queue": {"length": 12, "capacity": 1000, "blocks": 5},
            "plans": {"kept": 2, "bytes": 1 << 20, "hits": 38, "misses": 2},
            "memory": {"budget": 6 << 30, "used": 3 << 30, "waiting": 0},
            "states": {"queued": 9, "running": 2, "waiting": 1, "done": 40, "failed": 3, "cancelled": 0},
            "totals": {"submitted": 55, "counted": 39, "duplicates": 1, "failed": 3, "cancelled": 0, "stamps": 40000,
                       "fields": 7},
            "rates": {"stamps_per_s": 12345.0, "jobs_per_s": 0.25},
            "loop": {"longest_ms": 8.5, "longest_minute_ms": 3.2, "unsent_bytes": 0, "dropped": 1},
            "spool": {"path": "/var/spool/sheard", "watching": True, "incoming": 1, "active": 2, "done": 3, "failed": 4,
                      "free_bytes": 5 << 30},
            "disks": [{"use": "state", "path": "/var/lib/sheard", "free_bytes": 6 << 30, "bytes": 9 << 30,
                       "same_as": None, "problem": None}],
            "store": {"path": "/var/lib/sheard/sheard.db", "schema": 1, "bytes": 2 << 20, "free_bytes": 6 << 30,
                      "commits": 99},
            "config": "/etc/sheard/sheard.conf", "state_dir": "/var/lib/sheard", "catalogues": "/var/lib/sheard/catalogues",
            "user": "sheard", "activated": False, "roots": [{"path": "/data", "missing": False, "reason": None}],
            "limits": LIMITS, "problems": [], **other}


class Refusal(Exception):
    """Raised by a method's function: the answer is an error."""

    def __init__(self, code, message="no", advice="do something else", number=-32000, retry=False):
        super().__init__(code)
        self.error = {"code": number, "message": message, "data": {"code": code, "advice": advice, "retry": retry}}


class FakeService:
    """Answers with methods[NAME](params) or methods[NAME] itself; the calls are kept as (name, params) in order.
    `raw`: bytes to say to a connection instead of talking to it (None: talk)."""

    def __init__(self, path, raw=None, **methods):
        self.path, self.raw, self.calls = path, raw, []
        self.methods = {"hello": WELCOME, **methods}
        self.listener = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self.listener.bind(path)
        self.listener.listen(16)
        self.connections = []
        threading.Thread(target=self._accept, daemon=True).start()

    def close(self):
        self.listener.close()
        for connection in self.connections:
            try:
                connection.shutdown(socket.SHUT_RDWR)
            except OSError:
                pass
        if os.path.exists(self.path):
            os.unlink(self.path)

    def named(self, name):
        """The parameters of all calls of one method."""
        return [params for method, params in self.calls if method == name]

    def _accept(self):
        while True:
            try:
                connection, _ = self.listener.accept()
            except OSError:
                return
            self.connections.append(connection)
            threading.Thread(target=self._serve, args=(connection,), daemon=True).start()

    def _serve(self, connection):
        try:
            if self.raw is not None:
                connection.recv(65536)
                connection.sendall(self.raw)
                connection.close()
                return
            with connection, connection.makefile("r", encoding="utf-8") as lines:
                for line in lines:
                    self._answer(connection, json.loads(line))
        except (OSError, ValueError):
            pass

    def notify(self, connection, name, params):
        send(connection, {"jsonrpc": "2.0", "method": name, "params": params})

    def _answer(self, connection, request):
        name, params = request["method"], request.get("params") or {}
        self.calls.append((name, params))
        if name not in self.methods:
            said = {"error": {"code": -32601, "message": f"no {name}", "data": {"code": "unknown_method"}}}
        else:
            method = self.methods[name]
            try:
                said = method(params, connection) if callable(method) else method
                if said is HANG_UP:
                    connection.shutdown(socket.SHUT_RDWR)
                    return
                said = {"result": said}
            except Refusal as refusal:
                said = {"error": refusal.error}
        send(connection, {"jsonrpc": "2.0", "id": request["id"], **said})


HANG_UP = object()


def send(connection, message):
    connection.sendall(json.dumps(message).encode() + b"\n")
