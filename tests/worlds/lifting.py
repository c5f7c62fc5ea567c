"""Hazards that push and hit as told, and a simulator that records its calls, for tests of an episode."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import torch
from torch import Tensor

from hazard_ms.hazards.base import Hazard, Push, State, quantity
from hazard_ms.simulation.world import World


@dataclass
class LiftState(State):
    advanced_at: Tensor = quantity("E", "frame", "the frame of the last advance", dtype="int", fill=-1)


@dataclass(frozen=True)
class Lift(Hazard):
    """Lifts everything with `newton`, spins it with `torque`, damages `hits`, destroys agents at x > `edge`."""

    newton: float = 1.0
    torque: float | None = None
    hits: int = -1
    edge: float = 100.0
    name = "lift"
    state_type = LiftState

    def reset(self, state: LiftState, world: World, rows: Tensor) -> None:
        state.advanced_at[rows] = 0

    def force(self, state: LiftState, world: World, dt: float) -> Push:
        up = torch.zeros_like(world.position)
        up[..., 2] = 1.0
        return Push(self.newton * up, None if self.torque is None else self.torque * up)

    def advance(self, state: LiftState, world: World, dt: float) -> None:
        state.advanced_at.copy_(world.frame)

    def damaged(self, state: LiftState, world: World) -> Tensor:
        return (torch.arange(world.num_bodies) == self.hits).expand_as(world.exists)

    def image(self, state: LiftState, world: World, points: Tensor) -> Tensor:
        return torch.zeros(points.shape[:2])

    def forbids(self, state: LiftState, world: World, points: Tensor) -> Tensor:
        return points[..., 0] > self.edge


@dataclass(frozen=True)
class Sink(Lift):
    name = "sink"


class Simulator:
    """A simulator that only records its calls."""

    def __init__(self) -> None:
        self.told: list[tuple[str, Any]] = []

    def read(self, world: World) -> None:
        self.told.append(("read", None))

    def push(self, force: Tensor, torque: Tensor | None) -> None:
        self.told.append(("push", (force, torque)))

    def place(self, rows: Tensor, base: Tensor, rotation: Tensor) -> None:
        self.told.append(("place", base.clone()))

    def loosen(self, loose: Tensor) -> None: ...

    def freeze(self, frozen: Tensor, base: Tensor, rotation: Tensor) -> None:
        self.told.append(("freeze", (frozen.clone(), base.clone())))

    def asleep(self) -> Tensor:
        raise AssertionError("an episode must not call this")

    def put_to_sleep(self, asleep: Tensor) -> None:
        raise AssertionError("an episode must not call this")

    def of(self, kind: str) -> list[Any]:
        return [what for name, what in self.told if name == kind]
