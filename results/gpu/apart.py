"""Runs measurements in processes of their own.

SAPIEN can turn to the GPU only before it has simulated anything in a process, and a process whose GPU memory was
exhausted cannot go on. What the simulator complains of meanwhile, such as contacts that found no room, is kept.
"""

from __future__ import annotations

import json
import re
import signal
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from hazard_ms.machine.processes import environment

COMPLAINT = re.compile(r"\[(?:error|critical)\] *(.+)")  # as SAPIEN's log has it, after time and module
EXHAUSTED = re.compile(
    r"out ?of ?(?:host|device)? ?memory|MemoryError|bad_alloc|cudaErrorMemoryAllocation"
    r"|(?:can't|fail(?:ed)? to) allocate",
    re.I,
)
MOST_COMPLAINTS = 5  # kinds that are kept of one measurement [ours]
LONGEST = 300  # characters of a reason [ours]


class StoppedError(Exception):
    """A measurement gave no result; the message is the reason, in one line.

    `limit` is True if the machine's memory or the time budget ran out, which does not count as a failure.
    """

    def __init__(self, reason: str, limit: bool = False) -> None:
        super().__init__(reason)
        self.limit = limit


@dataclass(frozen=True)
class Answer:
    """The result of a measurement, and what the simulator complained of: each text once, with its number."""

    value: Any
    complaints: Counter[str]


def apart(job: str, budget: float, **words: Any) -> Answer:
    """Run one of `results.gpu.jobs` in a process of its own; its keywords must be what JSON can hold.

    Raises StoppedError where it fails or takes longer than `budget` seconds.
    """
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "answer.json"
        arguments = json.dumps({"job": job, "answer": str(file), **words})
        said = run([sys.executable, "-m", "results.gpu.jobs", arguments], budget)
        return Answer(json.loads(file.read_text(encoding="utf-8")), complaints(said))


def run(command: Sequence[str], budget: float) -> str:
    """All that a command prints. Raises StoppedError where it fails or takes longer than `budget` seconds."""
    try:
        done = subprocess.run(  # what it prints last, to either stream, is the reason of its end
            command,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            errors="replace",
            timeout=budget,
            env=environment(),
        )
    except subprocess.TimeoutExpired:
        raise StoppedError(f"took longer than {budget:g} s", limit=True) from None
    if done.returncode:
        raise failure(done.stdout, done.returncode)
    return done.stdout


def failure(said: str, code: int) -> StoppedError:
    """The reason why a process ended with exit status `code`, negative for a signal, from all that it `said`."""
    lines = [line.strip() for line in said.splitlines() if line.strip()]
    full = next((line for line in reversed(lines) if EXHAUSTED.search(line)), None)
    if full is not None:
        return StoppedError(f"the memory is exhausted: {full[:LONGEST]}", limit=True)
    last = lines[-1][:LONGEST] if lines else "it printed nothing"
    if code == -signal.SIGKILL:
        return StoppedError(f"killed from outside, as Linux does where memory is exhausted: {last}", limit=True)
    if code < 0:
        return StoppedError(f"crashed (signal {-code}): {last}")
    return StoppedError(last)


def complaints(said: str) -> Counter[str]:
    """Count the errors in what SAPIEN's log `said`: each text once, whatever the numbers in it."""
    counts: Counter[str] = Counter()
    first: dict[str, str] = {}
    for text in COMPLAINT.findall(said):
        kind = re.sub(r"\d+", "#", text)
        counts[first.setdefault(kind, text.strip()[:LONGEST])] += 1
    return Counter(dict(counts.most_common(MOST_COMPLAINTS)))
