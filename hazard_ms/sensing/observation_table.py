"""The one table of what observations hold: each key with the shape, unit, frame, range and meaning of its numbers.

Documentation, `hazard-ms describe` and the bounds of observation spaces all come from it. Joints are described by the
robot that is there, entries of the task by its terms, images of hazards by the hazards; all else is declared below.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hazard_ms.sensing.senses.thermal import RANGE
from hazard_ms.spec import Bound, Level, Term

# goes up whenever a key, its place, shape, type or bounds change: policies that were trained before no longer fit
OBSERVATION_VERSION = 1
# distance by which a joint may pass its limit, which PhysX enforces as a stiff spring [rad] or [m] [ours]
JOINT_MARGIN = 0.1
TURN = 2.0 * math.pi  # joints without limits have angles in (-TURN, TURN), as PhysX wraps them [rad]
INF = math.inf


@dataclass(frozen=True)
class Row:
    """One key of an observation, an action, info or reward. Bounds are single numbers, or one for each entry."""

    key: str  # "extra/agent_pose"
    shape: tuple[int, ...]  # in one environment
    dtype: str
    unit: str
    frame: str  # frame of coordinates
    low: Bound
    high: Bound
    meaning: str
    entries: tuple[str, ...] = ()  # names of the numbers along the last axis, if they differ

    def bounds(self) -> tuple[NDArray[Any], NDArray[Any]]:
        """Lowest and highest value of each number, [...], with the key's shape, type and unit."""
        dtype = np.dtype(self.dtype)
        least, most = {"b": (0, 1), "f": (-INF, INF)}.get(dtype.kind) or (np.iinfo(dtype).min, np.iinfo(dtype).max)
        width = self.shape[-1] if self.shape else 1
        made = []
        for bound in (self.low, self.high):
            some = bound if isinstance(bound, tuple) else (bound,)
            each = np.array([least if b <= least else most if b >= most else b for b in some], dtype)
            made.append(
                np.broadcast_to(np.tile(each, width // len(some)) if len(some) > 1 else each, self.shape).copy()
            )
        return made[0], made[1]


@dataclass(frozen=True)
class Meaning:
    """The declared properties of a key: everything but shape and type."""

    text: str
    unit: str = ""
    frame: str = ""
    low: Bound = -INF
    high: Bound = INF
    entries: tuple[str, ...] = ()


_BYTE = dict(low=0.0, high=255.0, entries=("red", "green", "blue"))
_MATRIX = "row by row, as ManiSkill gives it"
IMAGES = {  # of a camera, and of a point cloud; keys of ManiSkill
    "rgb": Meaning("colour of what is seen", **_BYTE),  # type: ignore[arg-type]
    "albedo": Meaning("colour of the surface, without light", **_BYTE),  # type: ignore[arg-type]
    "depth": Meaning("distance along the optical axis, 0 where nothing is hit; read it as unsigned", "mm"),
    "segmentation": Meaning("number of the thing, see `label_table`; 0 where nothing is hit", low=0.0),
    "thermal": Meaning("what a thermal camera shows, with `senses`", "°C", "", *RANGE),
    "position": Meaning("point that is seen", "mm", "camera, looking along -z, y up", entries=("x", "y", "z")),
    "normal": Meaning("normal of the surface; NaN where there is none", "", "camera", entries=("x", "y", "z")),
    "xyzw": Meaning(
        "point that is seen; w is 1, or 0 where nothing is hit", "m", "world", entries=("x", "y", "z", "w")
    ),
    "Color": Meaning("colour, 0 to 1, as the shader gives it", low=0.0, entries=("red", "green", "blue", "alpha")),
    "Position": Meaning("point that is seen, and its depth buffer", "m", "camera", entries=("x", "y", "z", "buffer")),
    "Segmentation": Meaning(
        "numbers of the part, of the thing, and two unused ones", low=0.0, entries=("part", "thing", "-", "-")
    ),
}
CAMERAS = {  # sensor_param
    "extrinsic_cv": Meaning(f"from the world to the camera (x right, y down, z ahead), {_MATRIX}", "-, m", "world"),
    "cam2world_gl": Meaning(f"from the camera (x right, y up, z back) to the world, {_MATRIX}", "-, m", "world"),
    "intrinsic_cv": Meaning(f"focal lengths and principal point, {_MATRIX}", "pixel", low=0.0),
}
CONTROLLERS = {  # states of controllers
    "target_qpos": Meaning("where the controller brings its joints", "rad or m"),
    "target_pose": Meaning("where it brings the hand", "m, -", "base", entries=("x", "y", "z", "qw", "qx", "qy", "qz")),
    "used": Meaning("which hand is in use: 0 the right one, 1 the left one", low=0.0, high=1.0),
    "shut": Meaning("the hand was last commanded shut", low=0.0, high=1.0, entries=("right", "left")),
}


class ObservationTable:
    """Describes the observations of one environment."""

    def __init__(
        self, joints: Mapping[str, Sequence[Any]], terms: Sequence[Term], levels: Mapping[str, Level], frames: float
    ) -> None:
        """`joints`: the active ones of each robot by its name, ManiSkill's; `levels`: of the hazards, by name.

        `frames`: the most that an episode can have.
        """
        self._joints, self._levels = joints, levels
        self._terms = {term.name: term for term in terms}
        self._frames = frames

    def rows(self, observation: Any, state: Mapping[str, Any]) -> Iterator[Row]:
        """All rows of `observation`, [E, ...] each, in order; see `leaf`."""
        for path, value in leaves(observation):
            yield from self.leaf(path, value, state)

    def leaf(self, path: tuple[str, ...], value: Any, state: Mapping[str, Any]) -> tuple[Row, ...]:
        """The rows of the key at `path`, whose numbers are `value`, [E, ...]: one; or several, of a vector of states.

        `state`: the states as a dict of agent and extra, [E, ...] each. A key that is not known, such as those that
        wrappers make, gets a row without a meaning, and without bounds.
        """
        if path not in ((), ("state",)) or value.shape[1:] != (_width(state),):
            return (self._row(path, value),)
        made, start = [], 0
        for part, numbers in leaves(state):
            row = self._row(part, numbers)
            end = start + int(np.prod(numbers.shape[1:]))
            made.append(replace(row, key=f"state[{start}:{end}] {row.key}", shape=(end - start,)))
            start = end
        return tuple(made)

    def _row(self, path: tuple[str, ...], value: Any) -> Row:
        told = self._meaning(path) or Meaning("")
        shape, dtype = tuple(value.shape[1:]), str(value.dtype).removeprefix("torch.")
        made = Row("/".join(path), shape, dtype, told.unit, told.frame, told.low, told.high, told.text, told.entries)
        fits = (
            np.size(told.low) == 1 == np.size(told.high) or shape[-1] % max(np.size(told.low), np.size(told.high)) == 0
        )
        return made if fits else replace(made, low=-INF, high=INF, meaning="")

    def _meaning(self, path: tuple[str, ...]) -> Meaning | None:
        robot = next(iter(self._joints))
        if len(path) > 1 and len(self._joints) > 1 and path[1] in self._joints:  # the part of one robot of a team
            robot, path = path[1], (path[0], *path[2:])
        if path[:1] == ("agent",):
            return self._proprioception(path, self._joints[robot])
        if path[:1] in (("extra",), ("sensor_data",)) and path[-1] == "hazard":
            levels = list(self._levels.values())
            names, units = tuple(self._levels), ", ".join(level.unit for level in levels)
            low = tuple(level.least for level in levels)
            return Meaning("level at the point that is seen, blurred (16 x 16)", units, "", low, INF, names)
        if path[:1] == ("extra",) and path[-1] != "thermal":
            return self._term(self._terms.get(path[-1]))
        if path[:1] == ("sensor_param",):
            return CAMERAS.get(path[-1])
        return IMAGES.get(path[-1]) if path[:1] in (("sensor_data",), ("pointcloud",), ("extra",)) else None

    def _term(self, term: Term | None) -> Meaning | None:
        if term is None:
            return None
        high: Bound = self._frames if term.unit == "frame" and term.high == INF else term.high
        text = f"of each target: {term.meaning}" if term.per_target else term.meaning
        return Meaning(text, term.unit, term.frame, term.low, high, term.entries)

    def _proprioception(self, path: tuple[str, ...], joints: Sequence[Any]) -> Meaning | None:
        names = tuple(joint.name for joint in joints)
        units = joint_units(joints)
        if path == ("agent", "qpos"):
            limits = np.array([joint.limits[0].cpu().reshape(-1).tolist() for joint in joints])
            limits = np.where(np.isfinite(limits), limits + [-JOINT_MARGIN, JOINT_MARGIN], [-TURN, TURN])
            low, high = (tuple(limits[:, side].tolist()) for side in (0, 1))
            return Meaning("position of each joint", units, "joints; the base's in the world", low, high, names)
        if path == ("agent", "qvel"):
            return Meaning(
                "velocity of each joint", units.replace("m", "m/s").replace("rad", "rad/s"), "joints", entries=names
            )
        return CONTROLLERS.get(path[-1]) if path[1:2] == ("controller",) else None


def joint_units(joints: Sequence[Any]) -> str:
    """The unit of each of ManiSkill's `joints`, separated by commas."""
    return ", ".join("m" if joint.type[0] == "prismatic" else "rad" for joint in joints)


def leaves(value: Any, path: tuple[str, ...] = ()) -> Iterator[tuple[tuple[str, ...], Any]]:
    """Every array of a nested observation with its path, in the order in which ManiSkill flattens it."""
    if not isinstance(value, Mapping):
        yield path, value
        return
    for key, inner in value.items():
        yield from leaves(inner, (*path, key))


def _width(state: Mapping[str, Any]) -> int:
    """Number of numbers in one environment of a nested state."""
    return sum(int(np.prod(value.shape[1:])) for _, value in leaves(state))
