"""Durations of skills and how often they work, by robot: tables that are measured, stored beside this file, and drawn.

A skill has one row for each band of heights and clearances of the thing that it is done to. Frames are drawn from a
row's quantiles, which lie evenly between 0 and 1. `hazard-ms sketch fit` measures the tables anew.
"""

from __future__ import annotations

import json
import math
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hazard_ms.spec.checks import one_of
from hazard_ms.spec.foreign.files import printable
from hazard_ms.spec.foreign.plain import made
from hazard_ms.spec.foreign.plain import read as read_json

MEASURED = "fetch"  # the robot whose skill times stand in for those of robots without any
FORMAT = 1  # goes up when a field of the file changes its meaning
SHIPPED = Path(__file__).with_name("skill_times.json")
PICK_UP, BAG, CART, EXPLORE, NO_PATH = "pick_up", "bag", "cart", "explore", "no_path"
SKILLS = (PICK_UP, BAG, CART, EXPLORE, NO_PATH)  # the drops into the bag and over a cart are apart
LARGEST = 4_000_000  # of a file [bytes]; that of the package has 12 thousand [ours]
LONGEST = 10_000  # frames of one skill: any larger number must be a mistake [ours]

# the types of a row's entries in a file, apart from the bands
ROW = {"skill": str, "count": int, "success": float, "frames": tuple[float, ...], "failed": tuple[float, ...]}

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class SkillRow:
    """The outcome and the duration of one skill in one band. Raises ValueError for impossible numbers."""

    skill: str
    count: int  # attempts in the band; a row of a band with few of them rests on those of all
    success: float  # share of attempts that work, 0 to 1
    frames: tuple[float, ...]  # quantiles of attempts that work, evenly spaced, at least one
    failed: tuple[float, ...]  # quantiles of attempts that fail
    height: tuple[float, float] = (-math.inf, math.inf)  # of the middle of the thing above the floor, from and to [m]
    clearance: tuple[float, float] = (-math.inf, math.inf)  # from it to where the robot can stand, from and to [m]

    def __post_init__(self) -> None:
        one_of(self.skill, SKILLS, "skill")
        if not 0.0 <= self.success <= 1.0:
            raise ValueError(f"success of {self.skill} must be from 0 to 1, got {self.success!r}")
        for name in ("frames", "failed"):
            values = getattr(self, name)
            ordered = all(a <= b for a, b in zip(values, values[1:], strict=False))
            if not values or not ordered or not all(0.0 <= v <= LONGEST for v in values):
                raise ValueError(
                    f"{name} of {self.skill} must be sorted numbers from 0 to {LONGEST}, got {values!r:.100}"
                )
        for name in ("height", "clearance"):
            low, high = getattr(self, name)
            if not low < high:
                raise ValueError(
                    f"{name} of {self.skill} must be a band (low, high) with low below high, got {(low, high)}"
                )

    def holds(self, height: Floats, clearance: Floats) -> NDArray[np.bool_]:
        """Whether things at `height` [m] and `clearance` [m], [R] each, belong to this band, [R]."""
        (low, high), (near, far) = self.height, self.clearance
        return (height >= low) & (height < high) & (clearance >= near) & (clearance < far)


class SkillTimes:
    """The skill times of one robot."""

    def __init__(self, robot: str, rows: tuple[SkillRow, ...], source: str = "") -> None:
        """Take the `rows` of `robot`; `source` says where they were measured. Raises ValueError if a skill has none."""
        self.robot, self.rows, self.source = robot, rows, source
        self._of = {name: tuple(row for row in rows if row.skill == name) for name in SKILLS}
        for name, found in self._of.items():
            if not found:
                raise ValueError(f"skill times of {robot} must have a row for {name}, got none")

    def draw(
        self, skill: str, chance: Floats, height: Floats, clearance: Floats, ease: Floats
    ) -> tuple[NDArray[np.bool_], Floats]:
        """Draw R attempts: whether each works, [R], and its frames, [R].

        `chance`: uniform numbers, [R, 2]; `height` [m] and `clearance` [m] of the things, [R]; `ease`: factors on the
        share that works, [R]. Raises ValueError for a thing that belongs to no band.
        """
        worked, frames, left = np.zeros(len(chance), bool), np.zeros(len(chance)), np.ones(len(chance), bool)
        for row in self._of[skill]:
            held = left & row.holds(height, clearance)
            if not held.any():
                continue
            left &= ~held
            worked |= held & (chance[:, 0] < row.success * ease)
            frames += np.where(
                held, np.where(worked, _at(row.frames, chance[:, 1]), _at(row.failed, chance[:, 1])), 0.0
            )
        if left.any():
            n = int(np.argmax(left))
            raise ValueError(f"a height must lie in a band of {skill}, got {height[n]} m, clearance {clearance[n]} m")
        return worked, frames

    def typical(self, skill: str) -> tuple[float, float, float]:
        """Share of attempts that work, mean frames of these, and mean frames of the others; bands by their counts."""
        rows = self._of[skill]
        weight = np.array([max(row.count, 1) for row in rows], dtype=np.float64)
        table = np.array([(row.success, _mean(row.frames), _mean(row.failed)) for row in rows])
        success, frames, failed = np.average(table, axis=0, weights=weight)
        return float(success), float(frames), float(failed)

    def usual(self, skill: str, height: float) -> float:
        """Mean frames of the attempts that work on a thing at `height` [m], bands by their counts."""
        rows = [row for row in self._of[skill] if row.height[0] <= height < row.height[1]]
        return float(np.average([_mean(row.frames) for row in rows], weights=[max(row.count, 1) for row in rows]))

    def as_dict(self) -> dict[str, Any]:
        """The tables of this robot as plain data, for JSON; null for a band that is open."""
        rows = []
        for row in self.rows:
            plain = asdict(row)
            for name in ("height", "clearance"):
                plain[name] = [value if math.isfinite(value) else None for value in plain[name]]
            rows.append(plain)
        return {"source": self.source, "rows": rows}


def load(robot: str, path: Path = SHIPPED) -> SkillTimes:
    """The skill times of `robot` in the file `path`. Raises ValueError for an unknown robot or a damaged file."""
    table = read(path)
    return table[one_of(robot, table, f"robot in {path.name}")]


def shipped(robot: str) -> SkillTimes:
    """The shipped skill times of `robot`, or of Fetch for a robot that was not measured."""
    tables = read(SHIPPED)
    return tables.get(robot, tables[MEASURED])


def read(path: Path) -> dict[str, SkillTimes]:
    """The skill times of all robots in the file `path`. Raises ValueError for a file that does not hold them."""
    try:
        content = read_json(path, LARGEST)
        if content["format"] != FORMAT:
            raise ValueError(f"format must be {FORMAT}, got {content['format']!r:.50}")
        return {
            str(robot): SkillTimes(str(robot), tuple(map(_row, table["rows"])), str(table["source"]))
            for robot, table in content["robots"].items()
        }
    except (ValueError, LookupError, TypeError, AttributeError) as error:
        told = printable(f"{type(error).__name__}: {error}")
        raise ValueError(f"{path} must hold skill times, got {told}; `hazard-ms sketch fit` makes such files") from None


def as_json(tables: dict[str, SkillTimes]) -> str:
    """The skill times of several robots as the text of a file."""
    content = {"format": FORMAT, "robots": {robot: times.as_dict() for robot, times in sorted(tables.items())}}
    return json.dumps(content, indent=1, allow_nan=False) + "\n"


def _row(plain: dict[str, Any]) -> SkillRow:
    bands = {}
    for name in ("height", "clearance"):
        low, high = made(tuple[float | None, float | None], plain.get(name, (None, None)), name)
        bands[name] = (-math.inf if low is None else low, math.inf if high is None else high)
    return SkillRow(**{**{name: made(kind, plain[name], name) for name, kind in ROW.items()}, **bands})


def _at(quantiles: tuple[float, ...], share: Floats) -> Floats:
    """The frames at each `share` of the distribution with these `quantiles`, [R]."""
    return np.interp(share * (len(quantiles) - 1), np.arange(len(quantiles)), quantiles)


def _mean(quantiles: tuple[float, ...]) -> float:
    """Mean frames of the distribution with these `quantiles`."""
    return float(np.trapezoid(quantiles) / (len(quantiles) - 1)) if len(quantiles) > 1 else quantiles[0]
