"""Checks many scenes: for faults, in several processes, and for what robots can get at; a line for each, and a sum."""

from __future__ import annotations

import multiprocessing
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from hazard_ms.machine.processes import end_with_parent, without_keys
from hazard_ms.spec import Build, SceneSpec
from hazard_ms.spec.foreign.files import printable

LONGEST = 120.0  # that the check of one scene may take before it counts as failed [s]


@dataclass(frozen=True)
class CheckedScene:
    """The outcome of the check of one scene."""

    name: str
    problems: tuple[str, ...]
    size: str = ""  # what the scene holds
    spent: float = 0.0  # on generating it [s]

    def line(self) -> str:
        """A line of text, or several where there are problems."""
        if self.problems:
            return "\n".join([f"PROBLEM {printable(self.name)}", *(f"    {printable(p)}" for p in self.problems)])
        return f"ok {printable(self.name):18s} {self.size}, generated in {self.spent:.2f} s"


def find(name: str) -> SceneSpec:
    """The scene of that name, or in the JSON file of that name. Raises ValueError if there is none."""
    from hazard_ms.scenes.files import read_scene
    from hazard_ms.scenes.splits import scene

    return read_scene(Path(name)) if name.endswith(".json") else scene(name)


def check_one(name: str) -> CheckedScene:
    """Generate or read a scene, and check it; in the simulator too when nothing else is wrong."""
    from hazard_ms.scenes.assets.shipped import shipped_index
    from hazard_ms.scenes.check import check
    from hazard_ms.simulation import rest_check

    shipped_index()  # is read once, not by the first scene
    before = time.perf_counter()
    try:
        spec = find(name)
    except ValueError as error:
        return CheckedScene(name, (str(error),))
    spent = time.perf_counter() - before
    problems = check(spec) or rest_check.check(spec)
    w, d = spec.room.size
    size = f"{w:.1f} x {d:.1f} m, {len(spec.fixtures)} pieces of furniture, {len(spec.bodies)} things"
    size += f", {len(spec.targets)} targets"
    return CheckedScene(name, tuple(problems), size, spent)


def check_all(names: Sequence[str], workers: int) -> int:
    """Print a line for each scene and a summary; 1 if there was a problem, else 0.

    With one worker the scenes are checked in this process, one after the other.
    """
    found = []
    for checked in map(check_one, names) if workers == 1 else _in_processes(names, workers):
        print(checked.line(), flush=True)
        found.append(checked)
    bad = [f for f in found if f.problems]
    slowest = max(f.spent for f in found)
    print(f"{len(found)} scenes, {len(bad)} with problems; the slowest was generated in {slowest:.2f} s")
    return 1 if bad else 0


def _in_processes(names: Sequence[str], workers: int) -> Iterator[CheckedScene]:
    """The checked scenes in the order of `names`. A check that crashes or hangs is a problem, and is ended."""
    with without_keys(), multiprocessing.get_context("spawn").Pool(min(workers, len(names)), end_with_parent) as pool:
        waiting = [(name, pool.apply_async(check_one, (name,))) for name in names]
        for name, result in waiting:
            try:
                yield result.get(LONGEST)
            except multiprocessing.TimeoutError:
                yield CheckedScene(name, (f"its check crashed, or took longer than {LONGEST:.0f} s",))


def print_reach(names: Sequence[str], robots: Sequence[str]) -> None:
    """Print which targets each of `robots` can get at in scenes.

    `names`: of the scenes, of JSON files that hold one, or of folders of such files.

    Raises ValueError for an unknown scene or robot, and for a file that holds no scene.
    """
    from hazard_ms.scenes.reach import reachable, share
    from hazard_ms.spec import registry

    builds: dict[str, Build] = {
        r: registry.load(registry.find(registry.ROBOTS, r, "robot").robot).build for r in robots
    }
    sums: dict[str, list[tuple[int, int, float]]] = {r: [] for r in robots}
    for spec in _scenes(names):
        for robot, build in builds.items():
            found = reachable(spec, build)
            missing = [t.name for t in spec.targets if t.name not in found]
            line = f"{printable(spec.name):22s} {robot:8s} {len(found):2d} of {len(spec.targets):2d} targets"
            print(printable(line + ("; not " + ", ".join(missing) if missing else "")), flush=True)
            sums[robot].append((len(found), len(spec.targets), share(spec, found)))
    for robot, counts in sums.items():
        got, whole, value = (sum(c[k] for c in counts) for k in range(3))
        print(
            f"{len(counts)} scenes: {robot} can get at {got:.0f} of {whole:.0f} targets, "
            f"{100 * value / len(counts):.0f} % of a scene's value on average"
        )


def _scenes(names: Sequence[str]) -> Iterator[SceneSpec]:
    from hazard_ms.scenes.files import read_scenes

    for name in names:
        yield from read_scenes(name).values() if Path(name).is_dir() else (find(name),)
