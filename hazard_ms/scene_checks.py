"""Checks of many scenes at once, in several processes; a line for each, and a summary."""

from __future__ import annotations

import multiprocessing
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

LONGEST = 120.0  # that the check of one scene may take before it counts as failed [s]


@dataclass(frozen=True)
class Finding:
    """How the check of one scene went."""

    name: str
    problems: tuple[str, ...]
    size: str = ""  # what the scene holds
    spent: float = 0.0  # on generating it [s]

    def line(self) -> str:
        """For people."""
        if self.problems:
            return "\n".join([f"PROBLEM {self.name}", *(f"    {p}" for p in self.problems)])
        return f"ok {self.name:18s} {self.size}, generated in {self.spent:.2f} s"


def check_one(name: str) -> Finding:
    """Generate or read a scene, and check it, in the simulator too when nothing else is wrong."""
    from hazard_ms import settling
    from hazard_ms.assets import index
    from hazard_ms.scene_commands import read
    from hazard_ms.scenes.check import check

    index()  # is read once, not by the first scene
    before = time.perf_counter()
    try:
        spec = read(name)
    except ValueError as error:
        return Finding(name, (str(error),))
    spent = time.perf_counter() - before
    problems = check(spec) or settling.check(spec)
    w, d = spec.room.size
    size = f"{w:.1f} x {d:.1f} m, {len(spec.fixtures)} pieces of furniture, {len(spec.bodies)} things, {len(spec.targets)} targets"
    return Finding(name, tuple(problems), size, spent)


def check_all(names: Sequence[str], workers: int) -> int:
    """Print a line for each scene and a summary; 1 if there was a problem, else 0.

    With one worker the scenes are checked in this process, one after the other.
    """
    found = []
    for finding in map(check_one, names) if workers == 1 else _in_processes(names, workers):
        print(finding.line(), flush=True)
        found.append(finding)
    bad = [f for f in found if f.problems]
    slowest = max(f.spent for f in found)
    print(f"{len(found)} scenes, {len(bad)} with problems; the slowest was generated in {slowest:.2f} s")
    return 1 if bad else 0


def _in_processes(names: Sequence[str], workers: int) -> Iterator[Finding]:
    """Findings in the order of `names`. A check that crashes or hangs is a problem, and ends with this call."""
    with multiprocessing.get_context("spawn").Pool(min(workers, len(names))) as pool:  # leaving it ends all processes
        waiting = [(name, pool.apply_async(check_one, (name,))) for name in names]
        for name, result in waiting:
            try:
                yield result.get(LONGEST)
            except multiprocessing.TimeoutError:
                yield Finding(name, (f"its check crashed, or took longer than {LONGEST:.0f} s",))
