"""Measures the page of `hazard-ms serve` as a browser meets it: time to the first picture, pictures, memory.

The server runs in a process of its own; what chooses here speaks with it as the page does, over one WebSocket. It does
whatever comes first in the list, and begins another rescue when one is over.
"""

from __future__ import annotations

import json
import re
import subprocess
import sys
import tempfile
import time
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from hazard_ms.evaluation.report import machine_line
from hazard_ms.machine.processes import environment

ROOM = ord("r")  # first byte of a picture of the third person
PROTOCOL = "hazard_ms"  # of the page's WebSockets
SILENCE = 600.0  # longest time without a word of a rescue [s] [ours]


@dataclass
class Course:
    """The measurements so far."""

    latencies: list[float] = field(default_factory=list)  # from a choice to the first picture after it [s]
    pictures: int = 0  # of the third person while the robot was at it
    seconds: float = 0.0  # wall time for which it was
    rescues: int = 0
    memory: list[tuple[float, float, float]] = field(default_factory=list)  # time [s], server, rescue [MB]


def report(env_id: str, seed: int, minutes: float) -> str:
    """Play for `minutes` through a server, and describe what it cost. Raises ValueError where it does not start."""
    course = Course()
    with tempfile.TemporaryDirectory() as folder, _server(Path(folder) / "rescues") as (process, address):
        start = time.monotonic()
        while not course.rescues or time.monotonic() - start < 60.0 * minutes:
            _play(address, process, env_id, seed + course.rescues, course, start + 60.0 * minutes)
            course.rescues += 1
    return _text(env_id, course, minutes)


@contextmanager
def _server(folder: Path) -> Iterator[tuple[Any, str]]:
    """A server of `folder`: its process and the address that it printed."""
    command = [sys.executable, "-m", "hazard_ms.cli", "serve", "--folder", str(folder), "--sessions", "1"]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment())
    try:
        assert process.stdout is not None
        address = process.stdout.readline().strip()
        if not re.match(r"http://127\.0\.0\.1:\d+/#token=", address):
            raise ValueError(f"the server must print its address, got {address!r:.100}")
        yield process, address
    finally:
        process.terminate()
        process.wait()


def _play(address: str, process: Any, env_id: str, seed: int, course: Course, end: float) -> None:
    """Play one rescue, or a part of it until `end`, by the clock of `time.monotonic` [s]."""
    from websockets.sync.client import connect
    from websockets.typing import Origin, Subprotocol

    origin, token = address.split("/#token=")
    headers = {"Origin": origin, "Authorization": f"Bearer {token}", "Content-Type": "application/json"}
    wanted = json.dumps({"env_id": env_id, "seed": seed}).encode()
    with urllib.request.urlopen(urllib.request.Request(f"{origin}/api/rescues", wanted, headers)) as answer:
        name = json.load(answer)["name"]
    live = f"ws://{origin.removeprefix('http://')}/api/rescues/{name}/live"
    protocols = [Subprotocol(PROTOCOL), Subprotocol(token)]
    with connect(live, origin=Origin(origin), subprotocols=protocols, max_size=None) as socket:
        chosen = doing = 0.0
        while True:
            message = socket.recv(SILENCE)
            now = time.monotonic()
            if isinstance(message, bytes):
                if message[0] == ROOM and doing:
                    course.pictures += 1
                if message[0] == ROOM and chosen:
                    course.latencies.append(now - chosen)
                    chosen, doing = 0.0, now
                continue
            row = json.loads(message)
            if row["type"] in ("failed", "died", "gone"):
                raise ValueError(f"the rescue must continue, got {row}")
            asking = row["type"] == "state" and row["phase"] == "asking"
            if (asking or row["type"] == "over") and doing:
                course.seconds, doing = course.seconds + now - doing, 0.0
            if row["type"] == "over" or (asking and now > end):
                break
            if asking:
                course.memory.append((now, _resident(process.pid), sum(map(_resident, _children(process.pid)))))
                key = row["choices"][0]["key"]
                socket.send(json.dumps({"do": "choose", "number": row["number"], "key": key}))
                chosen = time.monotonic()
    stop = urllib.request.Request(f"{origin}/api/rescues/{name}/end", b"{}", headers)
    urllib.request.urlopen(stop).close()


def _resident(process: int) -> float:
    """Memory of a process [MB]; 0 for one that has ended."""
    try:
        found = re.search(r"VmRSS:\s+(\d+)", Path(f"/proc/{process}/status").read_text())
    except OSError:
        return 0.0
    return int(found.group(1)) / 1024 if found else 0.0


def _children(process: int) -> list[int]:
    return [
        int(child) for tasks in Path(f"/proc/{process}/task").glob("*/children") for child in tasks.read_text().split()
    ]


def _text(env_id: str, course: Course, minutes: float) -> str:
    rows = [
        machine_line(),
        f"{env_id}, {course.rescues} rescues in {minutes:g} minutes, {len(course.latencies)} choices",
        f"from a choice to the first moving picture: {_spread(course.latencies)} s",
        f"pictures of the third person: {course.pictures / max(course.seconds, 1e-9):.1f} a second",
        "memory [MB]: minute, server, rescue",
    ]
    start, shown = course.memory[0][0], -1
    for at, server, rescue in course.memory:
        if int((at - start) / 60.0) > shown:
            shown = int((at - start) / 60.0)
            rows.append(f"{shown:6d} {server:7.0f} {rescue:7.0f}")
    return "\n".join(rows)


def _spread(seconds: list[float]) -> str:
    """The median and the 95th percentile of times [s]."""
    return f"{np.median(seconds):.2f} (median), {np.percentile(seconds, 95):.2f} (95 %)"
