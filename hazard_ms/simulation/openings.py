"""The doors, windows and doorways of E scenes: one state of them, which all hazards, and robots, read and write.

    closed, ajar, open   a share of the width, from a leaf's upper end along the wall, is open from sill to top
    broken               leaf or pane is gone: as open as it can be
    leak                 a closed one has gaps: GAP wide over its height for air and smoke, GAP high under it for water
    load                 a closed one breaks under a net force above its strength, all hazards added
    fire                 a leaf burns through after its resistance, counted as
                         hazard_ms.hazards.fire.realistic.twozone.leaves says

Openings count along O: those of the room in its order, then stand-ins for outer doors (hazard_ms.scenes.inlets), which
are a wall until a flood begins. Nothing is drawn by chance. Limits: a leaf swings freely and is not in the way of air
or water when it is open; what is broken is gone at once.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import torch
from torch import Tensor

from hazard_ms.scenes.inlets import inlets
from hazard_ms.scenes.walls import WALLS, on_wall, thickness_of
from hazard_ms.simulation.state import State, quantity
from hazard_ms.simulation.walls import Walls, leaves
from hazard_ms.spec import Opening, SceneSpec

# Gap of a closed door or window [m]: NFPA 80 allows 19 mm under a leaf and 3 mm around it, together 0.032 m^2 of a door
# of 0.9 x 2.0 m, 16 mm over its height; EN 12101-6 takes 0.01 to 0.02 m^2
GAP = 0.02
# Net force that a closed leaf bears [N]: EN 1627 presses with 3 kN where a door of the class RC 1 or RC 2 is held. An
# inner door of 0.9 m so breaks at 0.82 m of water on one side; buildings are to be sealed up to 0.6 m only [PPS 25]
INNER_STRENGTH = 3000.0
OUTER_STRENGTH = 6000.0  # hung and locked twice as firmly: 1.17 m of water [ours]
PANE_STRENGTH = 3500.0  # pressure that a pane bears [Pa] [NFPA 921: glass breaks at 3.4 to 6.9 kPa]
# Standard fire that a leaf bears [s]: thin panels 5 min, panels faced on both sides 10 to 20 min [IEBC, Resource A,
# table 5.1] [ours: 10 min]; outer doors are solid
INNER_RESISTANCE, OUTER_RESISTANCE = 600.0, 1200.0
BESIDE = 0.2  # distance from the faces of a wall at which both sides of an opening are looked at [m] [ours]
EVERY = 5  # frames from one look at loads and heat to the next: those of a fire's updates [ours]


class Plan(NamedTuple):
    """The openings of E scenes as they are built, [E, O] each unless it says otherwise."""

    exists: Tensor  # bool
    door: Tensor  # whether it has a leaf that can be opened, bool
    window: Tensor  # bool
    outside: Tensor  # whether its second side is outdoors, bool
    inlet: Tensor  # whether a flood begins with it open, bool
    width: Tensor  # [m]
    sill: Tensor  # height of the lower edge [m]
    top: Tensor  # height of the upper edge [m]
    high: Tensor  # upper end along the wall [m]
    leak: Tensor  # GAP; 0 for stand-ins and doorways [m]
    strength: Tensor  # net force that it bears when closed [N]
    resistance: Tensor  # standard fire that it bears [s]
    share: Tensor  # share of the width that is open at frame 0
    beside: Tensor  # places on the floor of the first side, south or west of an inner wall, and the second [m], E O 2 3


class Strain(NamedTuple):
    """Load and heat that a hazard puts on openings at one time, [E, O] each."""

    force: Tensor  # net force on what closes them, towards the second side [N]
    ageing: Tensor  # standard fire per time [s/s]
    shattered: Tensor  # whether heat breaks the pane, bool


@dataclass
class OpeningState(State):
    """The part of O openings that changes: how far they are open, and what they still bear."""

    open: Tensor = quantity("E O", "", "share of the width that is open", low=0.0, high=1.0)
    broken: Tensor = quantity("E O", "", "leaf or pane is gone", dtype="bool")
    hold: Tensor = quantity("E O", "s", "standard fire that the leaf still bears", fill=math.inf)


class Openings:
    """The openings of E scenes; `walls` are kept as open as the openings in them are."""

    @torch.inference_mode(False)  # it changes in that mode and out of it
    def __init__(self, specs: Sequence[SceneSpec], walls: Walls, device: torch.device | str) -> None:
        rows = [all_openings(s) for s in specs]
        self.count = max(1, *(len(row) for row in rows))
        self.inner = any(leaves(s) for s in specs)  # whether an inner wall has a door
        self.plan = _plan(specs, rows, self.count, device)
        self.force = torch.zeros(len(specs), self.count, device=device)  # at the last look, towards the second side [N]
        self.state: OpeningState = OpeningState.allocate({"E": len(specs), "O": self.count}, device)
        self._walls, self._spans = walls, walls.doorway[..., 1:3].clone()
        self._index = _in_walls(specs, walls.doorway, device)
        if self.inner:
            self._spans[..., 0] = self._spans[..., 1] - self.plan.width.gather(1, self._index.clamp(min=0))
        whole = torch.cat([walls.doorway[..., :1], self._spans, walls.doorway[..., 3:]], -1)
        self.opened = Walls(walls.any, walls.wall, whole, walls.ways)  # with all doors open
        self.begin(torch.arange(len(specs), device=device))

    def begin(self, rows: Tensor) -> None:
        """Put the openings of the environments `rows`, indices [R], as their scenes have them at frame 0."""
        self.state.clear(rows)
        self.force[rows] = 0.0
        self.state.open[rows], self.state.hold[rows] = self.plan.share[rows], self.plan.resistance[rows]
        self.apply()

    def let_in(self, rows: Tensor) -> None:
        """Open what water comes in through in the environments `rows`, indices [R]."""
        self.state.open[rows] = torch.where(self.plan.inlet[rows], 1.0, self.state.open[rows])
        self.apply()

    def set_open(self, rows: Tensor, opening: Tensor | int, share: Tensor | float) -> None:
        """Open doors and windows in the environments `rows`, indices [R].

        They open to a `share` of their width, 0 to 1, [R] or one for all. `opening` is the number along O, [R]
        or one for all. What has no leaf (any more) stays as it is. Raises ValueError for numbers out of range
        that need no look at a tensor.
        """
        if isinstance(opening, int) and not 0 <= opening < self.count:
            raise ValueError(f"opening must be from 0 to {self.count - 1}, got {opening}")
        if not isinstance(share, Tensor) and not 0.0 <= share <= 1.0:
            raise ValueError(f"share must be from 0 to 1, got {share}")
        held = self.state.open[rows, opening]
        leaf = self.plan.door[rows, opening] | self.plan.window[rows, opening]
        movable = leaf & ~self.state.broken[rows, opening]
        wanted = torch.as_tensor(share, dtype=held.dtype, device=held.device).clamp(0.0, 1.0)
        self.state.open[rows, opening] = torch.where(movable, wanted, held)
        self.apply()

    @property
    def ways(self) -> tuple[Tensor, Tensor]:
        """Masks [-] of the doorways and doors in inner walls, as in Walls: those there are, those open, [E, D]."""
        there = self._index >= 0
        return there, there & (self.share.gather(1, self._index.clamp(min=0)) > 0.0)

    @property
    def share(self) -> Tensor:
        """Share of the width that is open now, [E, O]."""
        return torch.where(self.state.broken, 1.0, self.state.open)

    @property
    def width(self) -> Tensor:
        """Width that lets air and smoke pass now [m], [E, O]: at least that of the gap."""
        return torch.minimum(torch.maximum(self.share * self.plan.width, self.plan.leak), self.plan.width)

    def bear(self, strains: Sequence[Strain], due: Tensor, dt: float) -> None:
        """Let `strains` act for `dt` [s] in the environments `due`, [E], bool: what they break is gone."""
        if not strains:
            return
        plan, state = self.plan, self.state
        force = torch.stack([s.force for s in strains]).sum(0)
        self.force.copy_(torch.where(due[:, None], force, self.force))
        ageing = torch.stack([s.ageing for s in strains]).sum(0)
        shattered = torch.stack([s.shattered for s in strains]).any(0) & plan.window
        state.hold.copy_(torch.where(due[:, None], (state.hold - ageing * dt).clamp(min=0.0), state.hold))
        overloaded = (state.open <= 0.0) & (force.abs() > plan.strength)
        gone = (plan.door | plan.window) & (overloaded | (state.hold <= 0.0) | shattered)
        state.broken.logical_or_(gone & due[:, None])
        self.apply()

    def apply(self) -> None:
        """Write what is open of the doors in inner walls into these."""
        if self.inner:
            low, high = self._spans.unbind(-1)
            share = self.share.gather(1, self._index.clamp(min=0))
            low = torch.where(share < 1.0, high - share * (high - low), low)
            self._walls.doorway[..., 1] = torch.where(self._index >= 0, low, self._walls.doorway[..., 1])


def all_openings(spec: SceneSpec) -> list[Opening]:
    """The openings of a scene in the order of O: its room's, then stand-ins for outer doors that a flood needs."""
    return [*spec.room.openings, *(o for o in inlets(spec) if o not in spec.room.openings)]


def _in_walls(specs: Sequence[SceneSpec], doorway: Tensor, device: torch.device | str) -> Tensor:
    """Number along O of each doorway and door in an inner wall, [E, D] as `doorway` [E, D, 5] has them; -1: none."""
    found = torch.full(doorway.shape[:2], -1, device=device)
    for e, spec in enumerate(specs):
        numbers = [k for k, o in enumerate(spec.room.openings) if o.wall not in WALLS]
        found[e, : len(numbers)] = torch.tensor(numbers, device=device, dtype=torch.int64)
    return found


def _plan(
    specs: Sequence[SceneSpec], rows: Sequence[Sequence[Opening]], count: int, device: torch.device | str
) -> Plan:
    made = [[_entry(spec, o) for o in row] for spec, row in zip(specs, rows, strict=True)]
    nothing = (*[False] * 5, *[0.0] * 5, math.inf, math.inf, 0.0, [[0.0] * 3] * 2)
    padded = [[*row, *[nothing] * (count - len(row))] for row in made]
    columns = (torch.tensor([[entry[k] for entry in row] for row in padded], device=device) for k in range(14))
    return Plan(*columns)


def _entry(spec: SceneSpec, o: Opening) -> tuple[Any, ...]:
    """The fields of Plan of one opening, as numbers."""
    room, outside, spare = spec.room, o.wall in WALLS, o not in spec.room.openings
    door, window = o.kind == "door" and not spare, o.kind == "window"
    strength = OUTER_STRENGTH if outside else INNER_STRENGTH
    resistance = OUTER_RESISTANCE if outside else INNER_RESISTANCE
    deep = thickness_of(room, o.wall) if not outside else 0.0
    sides = [list(on_wall(room, o.wall, o.centre, 0.0, depth)) for depth in (-BESIDE, deep + BESIDE)]
    if outside:  # water and heat are those before it
        sides[1] = sides[0]
    pane = PANE_STRENGTH * o.width * o.height if window else math.inf
    return (
        *(True, door, window, outside, o in inlets(spec)),
        *(o.width, o.sill, o.sill + o.height, o.centre + o.width / 2, GAP if door or window else 0.0),
        *(strength if door else pane, resistance if door else math.inf, o.share, sides),
    )
