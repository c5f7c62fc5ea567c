"""The things that agents can pick up and use, in tasks with mitigations: tools, and what is left in them.

Its state is saved with the others. Extinguishers are told apart by the beginning of their names: "co2_1" is one of
`hazard_ms.spec.extinguishers.EXTINGUISHERS`; all others hold 2 kg of powder.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass

import torch
from torch import Tensor

from hazard_ms.scenes.walls import on_wall, runs_along_x
from hazard_ms.simulation.jet import KINDS, Jet
from hazard_ms.simulation.state import State, quantity
from hazard_ms.spec import Body, SceneSpec
from hazard_ms.spec.catalogue import FLOOD_BOARD
from hazard_ms.spec.extinguishers import EXTINGUISHERS

CATEGORY = "fire_extinguisher"  # in the catalogue
IN_FRONT = -0.03  # of the middle of a board from the face of the wall that it leans against [m] [ours]
USUAL = "powder"  # what an extinguisher holds whose name does not say


@dataclass
class EquipmentState(State):
    """The part of the equipment of E agents that changes, with O openings; the nozzle of the extinguisher in use."""

    charge: Tensor = quantity("E B", "kg", "agent that is left in extinguishers", low=0.0)
    nozzle: Tensor = quantity("E 3", "m", "place of the nozzle")
    aim: Tensor = quantity("E 3", "", "direction of its jet, a unit vector", low=-1.01, high=1.01)
    kind: Tensor = quantity("E", "", "number of the kind of extinguisher", dtype="int", low=0, high=len(KINDS) - 1)
    flowing: Tensor = quantity("E", "", "it discharges", dtype="bool")
    stands_in: Tensor = quantity(
        "E B", "", "number of the opening in which a flood board stands, -1 for none", dtype="int", fill=-1, low=-1
    )


@dataclass
class NozzleState(State):
    """The nozzle of the extinguisher in use of a further robot of a team, in E environments."""

    nozzle: Tensor = quantity("E 3", "m", "place of the nozzle")
    aim: Tensor = quantity("E 3", "", "direction of its jet, a unit vector", low=-1.01, high=1.01)
    kind: Tensor = quantity("E", "", "number of the kind of extinguisher", dtype="int", low=0, high=len(KINDS) - 1)
    flowing: Tensor = quantity("E", "", "it discharges", dtype="bool")

    @property
    def jet(self) -> Jet:
        """The jet that comes from this nozzle, and shares its numbers."""
        return Jet(self.nozzle, self.aim, self.kind, self.flowing)


class Equipment:
    """The tools of E agents: bodies of some kinds that are no targets."""

    @torch.inference_mode(False)  # it changes in that mode and out of it
    def __init__(self, specs: Sequence[SceneSpec], target: Tensor, kinds: Collection[str]) -> None:
        """Take the bodies of `specs` of these `kinds` that are no `target`, bool [E, B].

        A kind is a category, or what a thing is called before its number: "flood_board_1" is a "flood_board".
        """
        shape, device, self.of = tuple(target.shape), target.device, tuple(kinds)
        self.tool = torch.zeros(shape, dtype=torch.bool, device=device)
        self.board = torch.zeros(shape, dtype=torch.bool, device=device)  # tools that are flood boards
        self.kinds = torch.full(shape, -1, device=device)  # of extinguishers, index into KINDS; -1 for others
        for e, spec in enumerate(specs):
            for b, thing in enumerate(spec.things):
                called = thing.name.rpartition("_")[0]
                usable = isinstance(thing, Body) and not {thing.category, called}.isdisjoint(kinds)
                self.tool[e, b] = usable and not bool(target[e, b])
                self.board[e, b] = self.tool[e, b] and called == FLOOD_BOARD
                if usable and thing.category == CATEGORY:
                    self.kinds[e, b] = KINDS.index(kind_of(thing.name))
        self.takes = target | self.tool
        openings = max(1, *(len(spec.room.openings) for spec in specs))
        self.stand = torch.zeros(shape[0], openings, 3, device=device)  # where a board's base is in an opening [m]
        self.turn = torch.zeros(shape[0], openings, 4, device=device)  # and how it is turned: its length along the wall
        for e, spec in enumerate(specs):
            for k, o in enumerate(spec.room.openings):
                self.stand[e, k] = torch.tensor(on_wall(spec.room, o.wall, o.centre, o.sill, IN_FRONT))
                half = 0.0 if runs_along_x(spec.room, o.wall) else math.pi / 4
                self.turn[e, k] = torch.tensor([math.cos(half), 0.0, 0.0, math.sin(half)])
        full = torch.tensor([kind.charge for kind in EXTINGUISHERS.values()], device=device)
        self.full = torch.where(self.kinds >= 0, full[self.kinds.clamp(min=0)], 0.0)  # charge at frame 0 [kg], [E, B]
        sizes = {"E": shape[0], "B": shape[1]}
        self.state: EquipmentState = EquipmentState.allocate(sizes, device)
        self.jet = Jet(self.state.nozzle, self.state.aim, self.state.kind, self.state.flowing)
        self.hands: list[tuple[Jet, Tensor]] = []  # the jet of each robot, and what it holds, bool [E, B]
        self.begin(torch.arange(shape[0], device=device))

    def begin(self, rows: Tensor) -> None:
        """Fill the extinguishers of the environments `rows`, indices [R], and close their nozzles."""
        self.state.clear(rows)
        self.state.charge[rows] = self.full[rows]
        self.state.aim[rows, 0] = 1.0

    @property
    def placed(self) -> Tensor:
        """The boards that stand in openings, bool [E, B]."""
        return self.state.stands_in >= 0

    def places(self) -> tuple[Tensor, Tensor]:
        """The base [m], [E, B, 3], and the rotation, [E, B, 4], of boards where they stand; of others any."""
        at = self.state.stands_in.clamp(min=0)[..., None]
        return self.stand.gather(1, at.expand(-1, -1, 3)), self.turn.gather(1, at.expand(-1, -1, 4))

    def boards(self, height: Tensor, count: int) -> Tensor:
        """Heights [m] up to which boards close the `count` openings, [E, O]; those of all things: `height` [E, B]."""
        made = height.new_zeros(height.shape[0], count)
        return made.scatter_reduce_(1, self.state.stands_in.clamp(min=0), height * self.placed, "amax")

    def advance(self, dt: float, clock: float) -> None:
        """Let `dt` [s] pass, in which jets use up the charge of what is held, `clock` times as fast.

        A nozzle closes where nothing that discharges is held, and when it is empty.
        """
        charge = self.state.charge
        for jet, held in self.hands:
            used = held & (self.kinds >= 0) & jet.flowing[:, None]
            spent = used * (jet.number("rate") * (dt * clock))[:, None]
            charge.copy_((charge - spent).clamp(min=0.0))
            jet.flowing.logical_and_((used & (charge > 0.0)).any(1))


def kind_of(name: str) -> str:
    """The kind of the extinguisher called `name`: the longest key of EXTINGUISHERS with which it begins."""
    found = [kind for kind in EXTINGUISHERS if name.startswith(kind)]
    return max(found, key=len, default=USUAL)
