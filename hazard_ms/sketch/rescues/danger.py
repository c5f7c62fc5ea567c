"""Measures what the hazards do to things while nobody acts, for `hazard-ms danger`: the table of docs/physics.md 4.6.

Scenes are played in the simulator without a robot (`hazard_ms.sketch.recording`); a record that there is already is
read instead.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from hazard_ms.hazards.presets import PRESETS
from hazard_ms.sketch.recording import recorded
from hazard_ms.sketch.timeline import Timeline
from hazard_ms.spec import SceneSpec
from hazard_ms.spec.checks import one_of, whole
from hazard_ms.spec.severity import SCALED, SEVERITIES, USUAL
from hazard_ms.tasks import task_of

RESCUES = (
    *("HazardFire-v1", "HazardFlood-v1", "HazardWind-v1", "HazardCompound-v1"),
    *("HazardHouseFire-v1", "HazardHouseFlood-v1", "HazardGale-v1"),
)
MOVED = 0.25  # distance from its place beyond which a thing counts as moved [m] [ours]
QUARTERS = 4  # of an episode, at whose ends is counted
MOST_SCENES = 1000  # more must be a mistake [ours]


@dataclass(frozen=True)
class Row:
    """A row of the table: one task, preset and severity, at the ends of the quarters of an episode."""

    task: str
    physics: str
    severity: str  # empty where the preset has only one strength
    targets: int  # number of all of them
    moved: tuple[float, ...]  # share of the targets that are out of their places [-]
    damaged: tuple[float, ...]  # share of them that are damaged [-]
    lost: tuple[float, ...]  # share of them that are one or the other [-]

    @property
    def line(self) -> str:
        """The row of the table."""
        shares = ("  ".join(f"{100 * x:3.0f}" for x in part) for part in (self.moved, self.damaged, self.lost))
        return f"| {self.task} | {self.physics} | {self.severity or '-'} | {self.targets} | {' | '.join(shares)} |"


HEADER = (
    "| task | physics | severity | targets | moved [%] | damaged [%] | moved or damaged [%] |\n"
    "| --- | --- | --- | ---: | --- | --- | --- |"
)


def rows(
    tasks: Sequence[str],
    scenes: int,
    split: str = "train",
    presets: Sequence[str] = tuple(PRESETS),
    severities: Sequence[str] = tuple(SEVERITIES),
    seed: int = 0,
) -> Iterator[Row]:
    """The rows of `presets` and `severities` of `tasks`, over `scenes` of a `split`, evenly spread.

    Presets with one strength have one row whatever `severities` says. Seeds are `seed`, `seed` + 1, ... Raises
    ValueError for unknown names, for tasks without such a split, and for more scenes than there are.
    """
    for task in tasks:
        one_of(task, RESCUES, "env_id")
        for physics in presets:
            one_of(physics, PRESETS, "physics")
            for severity in severities if physics == SCALED else (USUAL,):
                yield row(task, physics, severity, scenes, split, seed)


def row(name: str, physics: str, severity: str, scenes: int, split: str = "train", seed: int = 0) -> Row:
    """The row of one task, preset and severity over this number of `scenes` of a `split`, with seeds from `seed` on."""
    task = task_of(name, physics, None, severity)
    names = tuple(task.scenes(split))
    count = whole(scenes, 1, min(MOST_SCENES, len(names)), "scenes")
    specs = [task.build(names[k * len(names) // count]) for k in range(count)]
    ends = [task.max_frames * (k + 1) // QUARTERS for k in range(QUARTERS)]
    found = [fates(recorded(task, physics, spec, seed + k), spec, ends) for k, spec in enumerate(specs)]
    moved, damaged = np.concatenate(found, axis=-1)
    shares = (tuple(part.mean(-1).tolist()) for part in (moved, damaged, moved | damaged))
    return Row(name, physics, severity if physics == SCALED else "", moved.shape[-1], *shares)


def fates(line: Timeline, spec: SceneSpec, ends: Sequence[int]) -> np.ndarray:
    """Fates of the targets at the frames `ends`: whether moved, and whether damaged, [2, Q, T], bool."""
    targets = np.array([line.index(body.name) for body in spec.targets])
    places = line.positions(targets)
    samples = [min((end - line.first) // line.stride, len(places) - 1) for end in ends]
    moved = np.linalg.norm(places[samples] - line.start[targets], axis=-1) > MOVED
    at = line.damaged_at[targets]
    return np.stack([moved, (at >= 0) & (at <= np.array(ends)[:, None])])


def report(
    tasks: Sequence[str],
    scenes: int,
    split: str = "train",
    presets: Sequence[str] = tuple(PRESETS),
    severities: Sequence[str] = tuple(SEVERITIES),
    seed: int = 0,
) -> Iterator[str]:
    """The lines of the table, each as soon as it is known; the parameters are those of `rows`."""
    yield f"{scenes} scenes of `{split}`, evenly spread, in which nobody acts."
    yield "Shares of the targets after 1/4, 1/2, 3/4 and all of an episode:\n"
    yield HEADER
    for found in rows(tasks, scenes, split, presets, severities, seed):
        yield found.line
