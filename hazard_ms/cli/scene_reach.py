"""Prints which targets of scenes robots can get at: a line for each scene and robot, and a sum for each robot."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

from hazard_ms.assets.foreign import printable
from hazard_ms.spec import Build, SceneSpec


def print_reach(names: Sequence[str], robots: Sequence[str]) -> None:
    """Print which targets each of `robots` can get at in scenes.

    `names`: of the scenes, of JSON files that hold one, or of folders of such files.

    Raises ValueError for an unknown scene or robot, and for a file that holds no scene.
    """
    from hazard_ms import registry
    from hazard_ms.scenes.reach import reachable, share

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
    from hazard_ms.cli.scene_checks import find
    from hazard_ms.scenes.files import read_scenes

    for name in names:
        yield from read_scenes(name).values() if Path(name).is_dir() else (find(name),)
