"""Decisions as numbers for a policy: one flat, bounded vector, made only from what the agent has seen and been told.

Four tables in a row: T targets, C carts, L landmarks, and one row about the whole; in tasks with measures two more: F
fires, and one row about extinguishers. Their columns are declared in `hazard_ms.skills.options.feature_columns`. An
empty slot is all zeros. Places are in the agent's own frame, whose x axis points ahead and whose y axis points to the
left, so that turning the whole room changes nothing.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from hazard_ms.sensing.sighting import Sighting
from hazard_ms.skills.decision import Decision
from hazard_ms.skills.motor.navigation import Ways
from hazard_ms.skills.motor.walking import ARRIVED
from hazard_ms.skills.options.feature_columns import (
    CART_COLUMNS,
    FIRE_COLUMNS,
    LANDMARK_COLUMNS,
    SOON,
    TOOL_COLUMNS,
    Column,
    global_columns,
    target_columns,
)
from hazard_ms.skills.options.fires import FIRE_SLOTS, THREAT, KnownFire, tool_in_hand
from hazard_ms.skills.options.landmarks import Landmark
from hazard_ms.skills.options.options import CART_SLOTS, LANDMARK_SLOTS, TARGET_SLOTS, Menu
from hazard_ms.spec.catalogue import MOST_VALUE
from hazard_ms.spec.extinguishers import EXTINGUISHERS

USUAL_VALUE = 5.0  # of a target at most where tasks have no measures (docs/benchmark.md 1)
JET_WAY = 2.5  # distance from flames at which a jet is opened [m] [ours]
FRAMES_PER_SECOND = 30.0  # of the presets (docs/benchmark.md 1)
FRAMES_PER_METRE = 62.0  # frames that a metre of walking takes (docs/benchmark.md 1)


class Encoder:
    """Encodes decisions of one task. Policies and the environment use the same encoder, so what they learn fits."""

    def __init__(self, ranges: Sequence[tuple[float, float]], radius: float, measures: bool = False) -> None:
        """Make the encoder of a task; `ranges`: ends of each hazard's usual level; `radius` of the robot [m].

        `measures`: whether its options have measures about a fire.
        """
        self.ranges, self.radius, self.measures = tuple(ranges), radius, measures
        most = float(MOST_VALUE if measures else USUAL_VALUE)
        self.tables: dict[str, tuple[int, tuple[Column, ...]]] = {
            "targets": (TARGET_SLOTS, target_columns(len(self.ranges), most)),
            "carts": (CART_SLOTS, CART_COLUMNS),
            "landmarks": (LANDMARK_SLOTS, LANDMARK_COLUMNS),
            "global": (1, global_columns(len(self.ranges))),
        }
        if measures:
            self.tables |= {"fires": (FIRE_SLOTS, FIRE_COLUMNS), "tools": (1, TOOL_COLUMNS)}
        self.size = sum(rows * len(columns) for rows, columns in self.tables.values())

    def cells(self) -> Iterator[tuple[int, str, int, Column]]:
        """Index, table, row and column of every number, in order."""
        index = 0
        for table, (rows, columns) in self.tables.items():
            for row in range(rows):
                for column in columns:
                    yield index, table, row, column
                    index += 1

    def space(self) -> gym.spaces.Box:
        """The bounds of all F numbers."""
        bounds = np.array([(column.low, column.high) for _, _, _, column in self.cells()], np.float32)
        return gym.spaces.Box(bounds[:, 0], bounds[:, 1], dtype=np.float32)

    def split(self, vector: NDArray[np.float32]) -> dict[str, NDArray[np.float32]]:
        """The tables of encoded decisions, [..., F], by name: views of the same numbers, [..., rows, columns]."""
        parts, start = {}, 0
        for table, (rows, columns) in self.tables.items():
            end = start + rows * len(columns)
            parts[table] = vector[..., start:end].reshape(*vector.shape[:-1], rows, len(columns))
            start = end
        return parts

    def encode(self, decision: Decision, menu: Menu) -> NDArray[np.float32]:
        """The features of a `decision` with its `menu`, within `space`: F dimensionless numbers, float32 [F]."""
        made = np.zeros(self.size, np.float32)
        parts = self.split(made)
        ways = self._ways(decision, menu)
        for slot, name in enumerate(menu.targets):
            self._put(parts["targets"][slot], "targets", self._target(decision, menu, ways, name))
        for slot, name in enumerate(menu.carts):
            sighting = decision.map.objects.get(decision.index(name))
            row = (float(sighting is not None), *self._place(decision, ways, sighting), menu.failures.get(name, 0))
            self._put(parts["carts"][slot], "carts", row)
        for slot, mark in enumerate(menu.landmarks):
            self._put(parts["landmarks"][slot], "landmarks", self._landmark(decision, ways, mark))
        self._put(parts["global"][0], "global", self._whole(decision))
        if self.measures:
            for slot, fire in enumerate(menu.fires):
                self._put(parts["fires"][slot], "fires", self._fire(decision, menu, ways, fire))
            self._put(parts["tools"][0], "tools", self._tool(decision, menu, ways))
        return made

    def _put(self, row: NDArray[np.float32], table: str, quantities: Sequence[float]) -> None:
        columns = self.tables[table][1]
        for k, (column, quantity) in enumerate(zip(columns, quantities, strict=True)):
            row[k] = min(max(quantity / column.scale, column.low), column.high)

    def _ways(self, decision: Decision, menu: Menu) -> Ways:
        """All paths from where the agent stands: one search for all things."""
        seen = decision.map
        names = (*menu.targets, *menu.carts, *(mark.name for mark in menu.landmarks))
        if menu.tool is not None:
            names = (*names, menu.tool.name)
        indices = {decision.index(name) for name in names} & set(seen.objects)
        goals = [_flat(seen.objects[index]) for index in sorted(indices)] + [fire.place for fire in menu.fires]
        inside = [goal for goal in goals if all(0 <= c < len(seen.explored) for c in seen.cell_of(goal))]
        start = decision.agent_position
        return Ways(seen.obstacles, seen.explored, seen.cell, seen.origin, start, inside, self.radius)

    def _place(self, decision: Decision, ways: Ways, sighting: Sighting | None) -> tuple[float, float, float]:
        """Distances ahead and to the left [m], and walking time [frames]."""
        if sighting is None:
            return 0.0, 0.0, 0.0
        return _seen_from(decision, ways, _flat(sighting), ARRIVED + sighting.radius)

    def _target(self, decision: Decision, menu: Menu, ways: Ways, name: str) -> tuple[float, ...]:
        target = decision.target(name)
        sighting = decision.map.objects.get(target.index)
        age = 0.0 if sighting is None else float(decision.frame - sighting.frame)
        return (
            float(sighting is not None),
            float(target.held),
            float(target.rescued),
            *self._place(decision, ways, sighting),
            target.value,
            float(target.flammable),
            float(target.waterproof),
            target.ignition_temperature,
            float(target.damaged),
            *self._levels(sighting),
            age,
            float(menu.failures.get(name, 0)),
        )

    def _levels(self, sighting: Sighting | None) -> list[float]:
        """Level, and its rise in SOON frames, of each hazard over a thing: 0 and 1 are the ends of its usual range."""
        made = []
        for k, (low, high) in enumerate(self.ranges):
            known = [] if sighting is None else [(f, row[k]) for f, row in sighting.history if len(row) > k]
            level = (known[-1][1] - low) / (high - low) if known else 0.0
            rise = 0.0
            if len(known) > 1:
                (early, before), (late, now) = known[-2:]
                rise = (now - before) / (high - low) * SOON / max(late - early, 1)
            made += [float(np.nan_to_num(level)), float(np.nan_to_num(rise))]
        return made

    def _landmark(self, decision: Decision, ways: Ways, mark: Landmark) -> tuple[float, ...]:
        sighting = decision.map.objects[decision.index(mark.name)]
        return (*self._place(decision, ways, sighting), mark.edge, float(mark.visits))

    def _fire(self, decision: Decision, menu: Menu, ways: Ways, fire: KnownFire) -> tuple[float, ...]:
        near = 0.0
        for target in decision.targets:
            sighting = decision.map.objects.get(target.index)
            if sighting is not None and not (target.rescued or target.held or target.damaged):
                near += target.value * (np.hypot(*np.subtract(_flat(sighting), fire.place)) <= THREAT)
        place = _seen_from(decision, ways, fire.place, JET_WAY)
        return 1.0, *place, fire.flames, float(decision.frame - fire.seen), near, menu.failures.get(fire.name, 0)

    def _tool(self, decision: Decision, menu: Menu, ways: Ways) -> tuple[float, ...]:
        tool = menu.tool
        if tool is None:
            return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, float(menu.out)
        seen = None if tool.held else decision.map.objects.get(decision.index(tool.name))
        charge = EXTINGUISHERS[tool.kind].seconds * tool.left * FRAMES_PER_SECOND
        return 1.0, float(tool.held), *self._place(decision, ways, seen), charge, float(menu.out)

    def _whole(self, decision: Decision) -> tuple[float, ...]:
        targets, seen = decision.targets, decision.map
        missing = [t for t in targets if not (t.rescued or t.held)]
        known = sum(t.index in seen.objects for t in missing)
        result = decision.last_result
        return (
            decision.frame / decision.max_frames,
            float(decision.max_frames - decision.frame),
            float(decision.held is not None and not (self.measures and tool_in_hand(decision))),
            float(bool(decision.containers)),
            float(known),
            float(len(missing) - known),
            float(sum(t.rescued for t in targets)),
            float(seen.explored.sum()) * seen.cell**2,
            float(result is not None and not result.ok),
            *(self._front(decision, k) for k in range(len(self.ranges))),
        )

    def _front(self, decision: Decision, hazard: int) -> float:
        """Distance to the nearest cell where the hazard was seen in the upper half of its range [m]."""
        seen, (low, high) = decision.map, self.ranges[hazard]
        y, x = np.nonzero(np.nan_to_num(seen.levels[hazard], nan=-np.inf) > (low + high) / 2)
        if not len(y):
            return float("inf")
        centres = seen.origin + seen.cell * (np.stack([x, y], axis=-1) + 0.5)
        return float(np.hypot(*(centres - np.asarray(decision.agent_position)).T).min())


def _seen_from(decision: Decision, ways: Ways, place: tuple[float, float], near: float) -> tuple[float, float, float]:
    """Distances ahead and to the left of `place` [m], and walking time to `near` [m] from it [frames]."""
    x, y = np.subtract(place, decision.agent_position)
    c, s = np.cos(decision.agent_heading), np.sin(decision.agent_heading)
    frames = ways.length(place, near) * FRAMES_PER_METRE
    return float(c * x + s * y), float(c * y - s * x), frames


def _flat(sighting: Sighting) -> tuple[float, float]:
    return float(sighting.position[0]), float(sighting.position[1])
