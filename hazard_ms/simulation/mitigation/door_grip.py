"""Hands that hold the handles of doors: assisted as grasps are, a leaf follows the hand that holds its handle.

    wanted = bearing of the hand from the hinge + what the leaf was ahead of it when the handle was taken

A hand that shuts within a grasp's reach of the middle of a handle holds it until it opens, or until it is SLIP away.
The leaf turns towards `wanted`, from where it is shut up to a quarter turn, by a quarter turn in OPENING_TIME at most,
both ways. It stays where it is while it would come nearer to what stands in its way, and while it needs more force at
the handle than the arm pulls (hazard_ms.simulation.mitigation.hinges). Without a hand it stays where it was left.

Limits: leaves of outer doors, and windows, do not turn; a hand holds no latch down; arms are not in the way of a leaf.
Angles are worked out in double precision, so that they are the same on all processors (hazard_ms.spec.rounding).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import torch
from torch import Tensor

from hazard_ms.scenes.shell import LEAF
from hazard_ms.simulation.mitigation import hinges
from hazard_ms.simulation.openings import Openings
from hazard_ms.simulation.state import State, quantity
from hazard_ms.spec import SceneSpec
from hazard_ms.spec.robot import GRASP_REACH

SLIP = 2 * GRASP_REACH  # distance of the hand from the handle at which it slips off [m] [ours]
QUARTER = math.pi / 2  # [rad]
FASTEST = QUARTER / hinges.OPENING_TIME  # most that a leaf turns [rad/s]

Discs = tuple[Tensor, Tensor]  # P places over the floor [m], [E, P, 2], and radii [m], [E, P]; -inf: none


@dataclass
class GripState(State):
    """The handles that hands hold, of O openings."""

    holds: Tensor = quantity("E O", "", "the hand holds its handle", dtype="bool")
    ahead: Tensor = quantity(
        "E O", "rad", "how far the leaf was ahead of the hand when that took its handle", low=-4.0, high=4.0
    )


class DoorGrip:
    """The hand of each of E agents at the O openings of its scene: those that are doors between rooms."""

    def __init__(self, specs: Sequence[SceneSpec], openings: Openings) -> None:
        """Take the doors of `specs`, whose state is that of `openings`."""
        shape, device = (len(specs), openings.count), openings.plan.width.device
        self._openings, self.width = openings, openings.plan.width
        self.state: GripState = GripState.allocate({"E": shape[0], "O": shape[1]}, device)
        self.doors = torch.zeros(shape, dtype=torch.bool, device=device)  # those between rooms
        # places of the hinges over the floor [m], and directions of the shut leaf and of its swing: [E, O, 2], world
        self.hinge, self.along, self.out = torch.zeros(3, *shape, 2, device=device, dtype=torch.float64)
        for e, spec in enumerate(specs):
            for k, o in enumerate(spec.room.openings):
                if o.kind == "door" and hinges.inner(o):
                    self.doors[e, k] = True
                    made = (self.hinge, self.along, self.out)
                    for of, numbers in zip(made, hinges.hinge(spec.room, o), strict=True):
                        of[e, k] = torch.from_numpy(numbers)

    @property
    def leaves(self) -> Tensor:
        """Whether there is a leaf that turns, bool [E, O]."""
        return self.doors & ~self._openings.state.broken

    @property
    def angle(self) -> Tensor:
        """Angles by which doors are open now [rad], [E, O], in double precision; 0: shut."""
        return (1.0 - self._openings.state.open.double()).clamp(0.0, 1.0).acos()

    def handles(self) -> Tensor:
        """Middles of the handles now [m], [E, O, 3], world frame."""
        far = (self.width.double() - hinges.HANDLE_EDGE)[..., None]
        return torch.cat([(self.hinge + far * self._direction(self.angle)).float(), self._height], -1)

    def follow(self, hand: Tensor, closed: Tensor, shuts: Tensor, discs: Discs, pull: float, dt: float) -> None:
        """Let each `hand` [m], [E, 3], take or leave a handle, and lead its leaf for `dt` [s].

        `closed`: whether it is shut, bool [E]; `shuts`: whether it takes what is there in this frame, bool [E];
        `discs`: what stands in the way of leaves; `pull`: force of the arm [N].
        """
        state, leaf, angle = self.state, self.leaves, self.angle
        gap = torch.where(leaf, (self.handles() - hand[:, None]).norm(dim=-1), torch.inf)
        nearest = torch.arange(gap.shape[1], device=gap.device) == gap.argmin(1, keepdim=True)
        takes = shuts[:, None] & nearest & (gap <= GRASP_REACH)
        off = hand[:, None, :2].double() - self.hinge
        bearing = torch.atan2((off * self.out).sum(-1), (off * self.along).sum(-1))
        state.ahead = torch.where(takes, (angle - bearing).float(), state.ahead)
        state.holds = (state.holds | takes) & closed[:, None] & (gap < SLIP)
        wanted = (bearing + state.ahead.double()).clamp(0.0, QUARTER)
        turned = angle + (wanted - angle).clamp(-FASTEST * dt, FASTEST * dt)
        moves = state.holds & ~self._meets(angle, turned, discs) & (self._force(turned > angle) <= pull)
        openings = self._openings
        openings.state.open.copy_(torch.where(moves, (1.0 - turned.cos()).float(), openings.state.open))
        openings.apply()

    @property
    def _height(self) -> Tensor:
        return (self._openings.plan.sill + hinges.HANDLE_HEIGHT)[..., None]

    def _direction(self, angle: Tensor) -> Tensor:
        """Direction of leaves at an `angle` [rad], [E, O], from their hinges: [E, O, 2]."""
        return angle.cos()[..., None] * self.along + angle.sin()[..., None] * self.out

    def _force(self, opening: Tensor) -> Tensor:
        """Force at the handle [N] that it takes to open a leaf, where `opening`, bool [E, O], or to shut it: [E, O]."""
        pressing = torch.where(opening, self._openings.force, -self._openings.force)
        return hinges.handle_force(pressing, self.width)

    def _meets(self, first: Tensor, last: Tensor, discs: Discs) -> Tensor:
        """Whether leaves come nearer to one of `discs` that they touch, from `first` to `last` [rad]: bool [E, O]."""
        places, radius = discs
        off = places.double()[:, None] - self.hinge[:, :, None]
        before, after = (self._gap(off, angle) for angle in (first, last))
        return ((after < radius[:, None] + LEAF / 2) & (after < before)).any(-1)

    def _gap(self, off: Tensor, angle: Tensor) -> Tensor:
        """Distances [m] of places `off` the hinges [m], [E, O, P, 2], from leaves at an `angle` [rad]: [E, O, P]."""
        line = self._direction(angle)[:, :, None]
        far = torch.minimum((off * line).sum(-1).clamp(min=0.0), self.width[..., None])
        return (off - far[..., None] * line).norm(dim=-1)
