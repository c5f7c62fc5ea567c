"""Compares one environment on the GPU with the same on the CPU: PhysX on CUDA is not bit-exact.

Both have one seed and the same actions. What there is after some numbers of frames is kept, and compared.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hazard_ms.cli.costs.tables import table
from results.gpu.rates import STATE, batch, motions

CHECKED = (0, 1, 2, 5, 10, 30, 100, 300)  # frames after which is compared [ours]
BODIES, JOINTS = "bodies: position [m]", "robot: joints [m, rad]"

Course = dict[str, NDArray[Any]]  # "frame/quantity" -> its numbers


def course(env_id: str, simulator: str, checked: Sequence[int] = CHECKED, seed: int = 0) -> Course:
    """Record one environment on `simulator`, "gpu" or "cpu", after as many frames of random motion as `checked` has.

    Arrays have their own shapes, [...], in the units that the names of quantities have.
    """
    env = batch(env_id, 1, STATE, simulator)
    try:
        env.reset(seed=seed)
        made: Course = {}
        actions = motions(env, max(checked), seed)
        for frame in range(max(checked) + 1):
            if frame in checked:
                made.update({f"{frame}/{name}": numbers for name, numbers in quantities(env.unwrapped).items()})
            if frame < max(checked):
                env.step(actions[frame])
        return made
    finally:
        env.close()


def quantities(base: Any) -> Course:
    """Places of the bodies, joints of the robot, and all that hazards, damage, rescue and hand keep, [...] each.

    The name of each ends with its unit.
    """
    return {**records(base.episode), JOINTS: base.agent.robot.get_qpos().cpu().numpy()}


def records(episode: Any) -> Course:
    """Places of the bodies, and all that hazards, damage, rescue and hand of an `episode` keep, [...] each."""
    made = {BODIES: episode.world.position[episode.world.exists]}
    for name, part in episode.parts.items():
        units = {f.name: f.metadata["unit"] for f in dataclasses.fields(part)}
        for field, value in part.save().items():
            made[f"{name}: {field}" + (f" [{units[field]}]" if units[field] else "")] = value
    return {name: value.cpu().numpy() for name, value in made.items()}


def keep(file: Path, made: Course) -> None:
    """Write a course into a file."""
    np.savez_compressed(file, **made)  # type: ignore[arg-type]  # numpy 2.4 takes them for its own keywords


def kept(file: Path) -> Course:
    """The course in a file."""
    with np.load(file, allow_pickle=False) as read:
        return dict(read)


def difference(a: NDArray[Any], b: NDArray[Any]) -> float:
    """The largest difference of two arrays, [...], of one quantity; of whole numbers and masks, how many differ.

    Raises ValueError for different shapes.
    """
    if a.shape != b.shape:
        raise ValueError(f"both runs must have arrays of one shape, got {a.shape} and {b.shape}")
    if a.dtype.kind != "f":
        return float((a != b).sum())
    same = (a == b) | (np.isnan(a) & np.isnan(b))
    with np.errstate(invalid="ignore"):
        apart = np.where(same, 0.0, np.abs(a.astype(float) - b.astype(float)))
    return float(np.where(np.isnan(apart), np.inf, apart).max(initial=0.0))


def differences_table(a: Mapping[str, NDArray[Any]], b: Mapping[str, NDArray[Any]]) -> str:
    """A row for each quantity that differs anywhere, a column for each number of frames; then how many never differ.

    Arrays have their own shapes, [...]. Places of bodies and, if there are any, joints have a row in any case. Raises
    ValueError for courses of different quantities or frames.
    """
    if set(a) != set(b):
        raise ValueError(f"both runs must have the same quantities, got a difference in {sorted(set(a) ^ set(b))}")
    found: dict[str, dict[str, str]] = {}
    for key, numbers in a.items():
        frame, name = key.split("/", 1)
        apart, counts = difference(numbers, b[key]), numbers.dtype.kind != "f"
        text = "0" if apart == 0.0 else f"{apart:.0f} of {numbers.size}" if counts else f"{apart:.1e}"
        found.setdefault(name, {})[frame] = text
    rows = {name: row for name, row in found.items() if name in (BODIES, JOINTS) or set(row.values()) != {"0"}}
    frames = [*found[BODIES]]
    lines = table(["after frames", *frames], [[name, *row.values()] for name, row in rows.items()])
    equal = len(found) - len([name for name in rows if set(found[name].values()) != {"0"}])
    return f"{lines}\n\nEqual in all these frames, bit for bit: {equal} of {len(found)} quantities."
