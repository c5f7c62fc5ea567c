"""The jets of fire extinguishers: one nozzle in each environment, and what arrives where (torch).

A jet is a cone of constant density across. It ends at its reach, and at walls. Limit: things do not shade each other.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import torch
from torch import Tensor

from hazard_ms.simulation.walls import Walls, blocked
from hazard_ms.spec.checks import one_of
from hazard_ms.spec.extinguishers import EXTINGUISHERS

KINDS = tuple(EXTINGUISHERS)
NEAREST = 0.5  # nearer things get no denser a jet than at this distance [m] [ours]


@dataclass
class Jet:
    """The nozzles of E environments: all closed at first. Whoever holds an extinguisher opens, aims and closes them."""

    place: Tensor  # of the nozzle [m], [E, 3], world frame
    aim: Tensor  # unit vector, [E, 3], world frame
    kind: Tensor  # index into KINDS, [E], int64
    flowing: Tensor  # whether it discharges, [E], bool

    @classmethod
    def closed(cls, count: int, device: torch.device | str = "cpu") -> Jet:
        """`count` closed nozzles."""
        zero = torch.zeros(count, 3, device=device)
        kind = torch.zeros(count, dtype=torch.int64, device=device)
        return cls(zero, zero + torch.tensor([1.0, 0.0, 0.0], device=device), kind, kind.bool())

    def open(self, rows: Tensor, kind: str, place: Tensor, towards: Tensor) -> None:
        """Discharge the extinguisher `kind` in the environments `rows`, indices [R].

        It goes from `place` in the direction of the point `towards` [m], both [R, 3], world frame. Raises ValueError
        for an unknown kind, and where both places are one.
        """
        one_of(kind, EXTINGUISHERS, "extinguisher")
        way = towards - place
        length = way.norm(dim=-1, keepdim=True)
        if not bool((length > 0).all()):
            raise ValueError(f"towards must differ from the place of the nozzle, got {towards.tolist()} for both")
        self.place[rows], self.aim[rows] = place, way / length
        self.kind[rows], self.flowing[rows] = KINDS.index(kind), True

    def close(self, rows: Tensor) -> None:
        """Close the nozzles of the environments `rows`, indices [R]."""
        self.flowing[rows] = False

    def number(self, of: str) -> Tensor:
        """A number of each environment's extinguisher, [E], float32: a field of `Extinguisher`, or its `rate`."""
        of_all = [float(getattr(e, of)) for e in EXTINGUISHERS.values()]
        return torch.tensor(of_all, device=self.kind.device)[self.kind]


def spot(jet: Jet, points: Tensor) -> tuple[Tensor, Tensor]:
    """Cross-sections of the jets at `points` [m], [E, P, 3], world frame, and whether they hit them.

    Areas [m^2], [E, P], and whether the points are within the cone and its reach, [E, P], bool.
    """
    way = points - jet.place[:, None]
    along = (way * jet.aim[:, None]).sum(-1)
    aside = (way - along[..., None] * jet.aim[:, None]).norm(dim=-1)
    wide = along.clamp(min=NEAREST) * jet.number("angle").tan()[:, None]
    hit = (along > 0) & (along <= jet.number("reach")[:, None]) & (aside <= wide)
    return math.pi * wide.square(), hit


def spray(jet: Jet, walls: Walls, points: Tensor) -> Tensor:
    """Flux of the agent at `points` [m], [E, P, 3], world frame, on a surface across the jet [kg/m^2 s], [E, P]."""
    area, hit = spot(jet, points)
    hit &= jet.flowing[:, None] & ~blocked(walls, jet.place[:, None], points)[:, 0]
    return torch.where(hit, jet.number("rate")[:, None] / area, 0.0)
