"""The ways of a scene past doors that measures have shut, from the side on which the robot then stands."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from hazard_ms.agents.mitigating.prospects import ANY_WAY, Array, Prospect, as_now
from hazard_ms.sketch.futures.interventions import SHUT
from hazard_ms.sketch.futures.surroundings import across
from hazard_ms.sketch.planning.measures import Changed
from hazard_ms.sketch.rescue_problem import RescueScene
from hazard_ms.sketch.travel.ways import Ways
from hazard_ms.spec import SceneSpec

BESIDE = 1.0  # distance from a door at which the robot stands once it has shut it [m] [ours]
ON_FLOOR = 0.2  # distance from the floor that is reached, up to which a place lies on it [m] [ours]


def sided(spec: SceneSpec, doors: Sequence[Prospect]) -> list[Prospect]:
    """Each of `doors` twice: shut by a robot that stays on the one side of it, and on the other."""
    made = []
    for door in doors:
        out = across(spec, door.numbers[0])
        for place in (door.first + BESIDE * out, door.first - BESIDE * out):
            made.append(door._replace(first=place, last=place))
    return made


def nearer(frames: Array, made: Sequence[Prospect]) -> Array:
    """The frames of ways to K prospects, [..., K], with inf to the farther side of each door.

    A robot that shuts a door stays on the side from which it comes (hazard_ms.skills.mitigations.handles.home_side).
    """
    least: dict[int, Array] = {}
    for k, p in enumerate(made):
        if p.kind == SHUT:
            door = p.numbers[0]
            least[door] = np.minimum(least.get(door, np.inf), frames[..., k])
    kept = frames.copy()
    for k, p in enumerate(made):
        if p.kind == SHUT:
            kept[..., k][frames[..., k] > least[p.numbers[0]]] = np.inf
    return kept


class Barred:
    """Tells the ways among G `goals` [m], [G, 2], and what can be `made` once some of that is done."""

    def __init__(self, scene: RescueScene, goals: Array, edges: Array, made: Sequence[Prospect]) -> None:
        """`edges`: distance of each goal's edge from its middle [m], [G]."""
        self._scene, self._goals, self._edges, self._made = scene, goals, edges, tuple(made)
        self._first = np.stack([p.first for p in made])
        self._own = np.array([p.edge for p in made])
        self._ways: dict[frozenset[int], list[Ways]] = {}  # by the doors that are shut: one for each part of the floor
        self._told: dict[tuple[frozenset[int], int], Changed] = {}

    def __call__(self, done: tuple[int, ...]) -> Changed | None:
        """The ways once the prospects of these numbers are `done` in this order; None where no door is among them."""
        doors = frozenset(self._made[k].numbers[0] for k in done if self._made[k].kind == SHUT)
        if not doors:
            return None
        key = doors, done[-1]
        if key not in self._told:
            self._told[key] = self._changed(doors, self._made[done[-1]].last)
        return self._told[key]

    def _changed(self, doors: frozenset[int], here: Array) -> Changed:
        ways = self._past(doors, here)
        route = ways.route(here[None], self._goals, self._edges)
        ends = ways.along(here[None], self._goals, ANY_WAY, self._edges)
        table = ways.frames(ends[:, None], self._goals[None], route.last[:, None], self._edges)
        np.fill_diagonal(table, 0.0)
        between = nearer(ways.frames(here[None], self._first, edge=self._own), self._made)
        return Changed(between, route.frames(), table)

    def _past(self, doors: frozenset[int], here: Array) -> Ways:
        """The ways from a place `here` [m], [2], on while these doors are shut beside those that are."""
        for ways in self._ways.get(doors, ()):
            if np.hypot(*(ways.places - here).T).min(initial=np.inf) <= ON_FLOOR:
                return ways
        spec = self._scene.spec
        shares = [0.0 if number in doors else o.share for number, o in enumerate(spec.room.openings)]
        made = Ways(as_now(spec, shares, (float(here[0]), float(here[1]))), radius=self._scene.ways.radius)
        self._ways.setdefault(doors, []).append(made)
        return made
