"""Small problems of planning as plain numbers, and their best plans by trying every order."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from hazard_ms.sketch.planning.problem import Problem
from hazard_ms.sketch.planning.travel import MovingTravel, StaticTravel, Travel, straight_line

Spot = tuple[int, int]  # node, index of the recorded frame
PER_METRE = 62.0  # frames (docs/benchmark.md 1)


@dataclass(frozen=True)
class PlainProblem:
    """What a `Problem` says apart from its travel. Targets are nodes 0 to M - 1, then carts, then the start."""

    values: list[float]
    damaged_at: list[float]
    pick: list[float]
    drop: list[float]
    limit: float
    carts: int
    holding: int | None

    def travel(self) -> Travel:
        raise NotImplementedError

    def meetings(self, spot: Spot, target: int, frame: float, waiting: bool) -> Iterator[tuple[float, Spot]]:
        """The earliest meeting and, with `waiting`, all later ones that are recorded."""
        raise NotImplementedError

    def carry(self, spot: Spot, cart: int) -> float:
        raise NotImplementedError

    def problem(self) -> Problem:
        return Problem(
            self.travel(), self.values, self.damaged_at, self.pick, self.drop, self.limit, holding=self.holding
        )


@dataclass(frozen=True)
class Table(PlainProblem):
    """Everything rests; walks are random numbers, so that detours can be shorter than straight ways."""

    frames: list[list[float]]

    def travel(self) -> Travel:
        return StaticTravel(self.frames, self.carts)

    def meetings(self, spot: Spot, target: int, frame: float, waiting: bool) -> Iterator[tuple[float, Spot]]:
        yield frame + self.frames[spot[0]][target], (target, 0)

    def carry(self, spot: Spot, cart: int) -> float:
        return self.frames[spot[0]][len(self.values) + cart]


@dataclass(frozen=True)
class Drift(PlainProblem):
    """Targets move on a plane as recorded, and rest when the recording ends."""

    frames: list[float]
    positions: list[list[list[float]]]  # [K][M][2]
    fixed: list[list[float]]  # carts, then the start

    def travel(self) -> Travel:
        walk = straight_line(PER_METRE)
        return MovingTravel(self.frames, self.positions, self.fixed[-1], walk, self.fixed[:-1])

    def _at(self, spot: Spot) -> list[float]:
        moving = spot[0] < len(self.values)
        return self.positions[spot[1]][spot[0]] if moving else self.fixed[spot[0] - len(self.values)]

    def meetings(self, spot: Spot, target: int, frame: float, waiting: bool) -> Iterator[tuple[float, Spot]]:
        x, y = self._at(spot)
        way = 0.0
        for index, (then, row) in enumerate(zip(self.frames, self.positions, strict=True)):
            way = PER_METRE * math.hypot(row[target][0] - x, row[target][1] - y)
            if frame + way <= then:
                yield then, (target, index)
                if not waiting:
                    return
        yield max(frame + way, self.frames[-1]), (target, len(self.frames) - 1)

    def carry(self, spot: Spot, cart: int) -> float:
        return PER_METRE * math.dist(self._at(spot), self.fixed[cart])


def best_by_trial(plain: PlainProblem, waiting: bool = False) -> tuple[float, float]:
    """Value and last frame of the best plan, by depth-first search through all orders and carts.

    Targets are met as early as possible or, with `waiting`, at any recorded frame.
    """
    count, best = len(plain.values), (0.0, 0.0)

    def put_away(target: int, spot: Spot, frame: float) -> Iterator[tuple[float, Spot]]:
        if not plain.carts:
            yield frame + plain.drop[target], spot
        for cart in range(plain.carts):
            yield frame + plain.carry(spot, cart) + plain.drop[cart], (count + cart, 0)

    def add(target: int, left: set[int], spot: Spot, frame: float, value: float) -> None:
        for safe, after in put_away(target, spot, frame):
            if safe <= plain.limit:
                whole = safe <= plain.damaged_at[target]
                extend(left - {target}, after, safe, value + plain.values[target] * (1.0 if whole else 0.5))

    def extend(left: set[int], spot: Spot, frame: float, value: float) -> None:
        nonlocal best
        if value > best[0] or (value == best[0] and frame < best[1]):
            best = value, frame
        for target in left:
            for met, where in plain.meetings(spot, target, frame, waiting):
                add(target, left, where, met + plain.pick[target], value)

    start, targets = (count + plain.carts, 0), set(range(count))
    if plain.holding is None:
        extend(targets, start, 0.0, 0.0)
    else:
        add(plain.holding, targets, start, 0.0, 0.0)
    return best


def random_problem(
    chance: np.random.Generator, moving: bool, most_targets: int, most_carts: int, stride: float = 6.0
) -> PlainProblem:
    """A problem of up to these numbers of targets and carts, with a recorded frame in every `stride` if they move."""
    count = int(chance.integers(1, most_targets + 1))
    carts = int(chance.integers(1, most_carts + 1)) if most_carts else 0
    common = {
        "values": chance.choice([1.0, 5.0], count).tolist(),
        "damaged_at": np.where(chance.random(count) < 0.4, np.inf, chance.uniform(0, 700, count)).tolist(),
        "pick": chance.uniform(0, 90, count).tolist(),
        "drop": chance.uniform(0, 60, carts or count).tolist(),
        "limit": float(chance.uniform(100, 1500)),
        "carts": carts,
        "holding": int(chance.integers(count)) if chance.random() < 0.2 else None,
    }
    nodes = count + carts + 1
    if not moving:
        return Table(**common, frames=chance.uniform(5, 250, (nodes, nodes)).tolist())
    return random_drift(chance, common, nodes, stride)


def random_drift(chance: np.random.Generator, common: dict, nodes: int, stride: float = 6.0) -> Drift:
    """Targets that drift in random directions, some faster than one walks, until each comes to rest."""
    count, frames = len(common["values"]), np.arange(0.0, 600.0, stride)
    first = chance.uniform(-2.5, 2.5, (nodes, 2))
    velocity = chance.normal(0, 0.5 / PER_METRE, (count, 2))  # [m/frame]
    rest = chance.uniform(0, 600, count)
    positions = first[:count] + np.minimum(frames[:, None], rest)[..., None] * velocity
    return Drift(**common, frames=frames.tolist(), positions=positions.tolist(), fixed=first[count:].tolist())
