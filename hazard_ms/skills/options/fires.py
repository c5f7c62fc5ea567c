"""Fires as an agent knows them, and its extinguishers: what the options `fire` and `tool` are about.

A fire is a patch of warm cells on the agent's map, with a hot thing near it by which the skill `extinguish` can be told
where to go. Its place is the middle of the patch, the hottest cells first of all; its flames are as many as explain the
temperatures (docs/physics.md 1.1: a flame at d metres weighs (0.5 / max(d, 0.5))^2 beside the room's 1). What was put
out stays out of the list until heat is seen there that is newer.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from hazard_ms.skills.decision import Decision, Tool

EXTINGUISH, FIRE_NAME = "extinguish", "fire"
FIRE_SLOTS = 6  # F, number of slots for fires: a home begins with four, and what is seen of one may fall apart [ours]
WARM = 100.0  # level of cells that belong to a fire: 1.25 m from a single flame [C] [ours]
ROOM, FLAME = 20.0, 600.0  # temperatures of the room and of flames [C] (docs/physics.md 1.1)
REACH = 0.5  # distance at which a flame weighs as much as the room, and nearer ones no more [m] (docs/physics.md 1.1)
HOT = 100.0  # level from which a thing can be named to the skill: boiling water [C]
AROUND = 1.8  # distance from a thing within which the skill finds flames, less the error of where they are [m] [ours]
SHOWN = 4.5  # flames for each that temperatures seem to tell, since sources share the room [measured: 3 to 6]
GAP = 4  # cells, twice which lie between two fires at least [ours]
COLD = 1.5  # distance from a fire that was put out within which older heat tells nothing [m] [ours]
LEAST_LEFT = 0.02  # share of the charge from which an extinguisher is of use [ours]
TOOL_GIVE_UP = 2  # failures after which a tool is no longer offered [ours]
THREAT = 3.0  # distance from a fire within which it threatens things [m] [ours]

Places = NDArray[np.float64]


@dataclass(frozen=True)
class KnownFire:
    """A fire that was seen."""

    name: str  # of the hot thing by which it is told
    place: tuple[float, float]  # its middle [m]
    flames: float  # about as many as it had when last seen
    seen: int  # frame of that


def measured(mitigations: Collection[str], hazards: Iterable[str]) -> int | None:
    """The number of the hazard, out of the names of all `hazards`, that policies can take measures about, or None."""
    names = list(hazards)
    return names.index(FIRE_NAME) if EXTINGUISH in mitigations and FIRE_NAME in names else None


class FireMemory:
    """The fires of one episode."""

    def __init__(self, hazard: int) -> None:
        """Begin an episode; `hazard`: the number of the fire among its hazards."""
        self._hazard = hazard
        self._known: dict[str, KnownFire] = {}
        self._out: list[tuple[tuple[float, float], int]] = []  # places where fires were put out [m], and when
        self.count_out = 0

    def fires(self, decision: Decision) -> tuple[KnownFire, ...]:
        """The fires that are known at `decision`, the ones with most flames first, F at most."""
        seen = decision.map
        levels = seen.levels[self._hazard]
        hot = np.nan_to_num(levels, nan=0.0) >= WARM
        for place, frame in self._out:
            y, x = np.nonzero(hot)
            old = (np.hypot(*(seen.centre_of(y, x) - place).T) < COLD) & (seen.told_at[y, x] <= frame)
            hot[y[old], x[old]] = False
        grown = ndimage.binary_dilation(hot, np.ones((3, 3)), iterations=GAP)
        labels, count = ndimage.label(grown, np.ones((3, 3)))
        found: dict[str, KnownFire] = {}
        for label in range(1, count + 1):
            y, x = np.nonzero(hot & (labels == label))
            points = seen.centre_of(y, x)
            weight = (levels[y, x] - ROOM) / (FLAME - np.minimum(levels[y, x], FLAME - 1.0))
            middle = (points * weight[:, None] ** 2).sum(axis=0) / (weight**2).sum()
            away = np.maximum(np.hypot(*(points - middle).T), REACH)
            name = self._named(decision, middle, found)
            if name is not None:
                flames = SHOWN * float(np.median(weight * (away / REACH) ** 2))
                place = float(middle[0]), float(middle[1])
                found[name] = KnownFire(name, place, flames, int(seen.told_at[y, x].max()))
        self._known = found
        return tuple(sorted(found.values(), key=lambda fire: -fire.flames)[:FIRE_SLOTS])

    def _named(self, decision: Decision, place: Places, taken: Collection[str]) -> str | None:
        """The hot thing nearest to the `place` of a fire [m], [2], by which it can be told; None for none."""
        best, name = AROUND, None
        for index, thing in decision.map.objects.items():
            hot = len(thing.levels) > self._hazard and thing.levels[self._hazard] >= HOT
            if not hot or decision.names[index] in taken or decision.names[index] == decision.held:
                continue
            away = float(np.hypot(*(thing.position[:2] - place)))
            if away < best:
                best, name = away, decision.names[index]
        return name

    def note(self, name: str, frame: int, burned: bool) -> None:
        """Remember that the fire told by `name` is out since `frame`; `burned`: that it was put out, not gone."""
        fire = self._known.get(name)
        if fire is not None:
            self._out.append((fire.place, frame))
            self.count_out += burned


def usable_tool(decision: Decision, failures: Mapping[str, int]) -> Tool | None:
    """The extinguisher in the hand, else the nearest known one that is not empty; None for none."""
    made, best = None, np.inf
    for tool in decision.tools:
        if not tool.kind or tool.left <= LEAST_LEFT:
            continue
        if tool.held:
            return tool
        seen = decision.map.objects.get(decision.index(tool.name))
        if seen is None or failures.get(tool.name, 0) >= TOOL_GIVE_UP:
            continue
        away = float(np.hypot(*(seen.position[:2] - decision.agent_position)))
        if away < best:
            made, best = tool, away
    return made


def tool_in_hand(decision: Decision) -> bool:
    """Whether what the hand holds is a tool, not a target."""
    return any(tool.held for tool in decision.tools)
