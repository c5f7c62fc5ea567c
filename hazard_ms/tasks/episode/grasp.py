"""The agent's hand: assisted grasp, as the original's humanoid had it.

When the gripper closes within reach of a target, the target is held and follows the gripper. When the gripper opens,
the target falls, or is rescued if the gripper is over the bag that the agent carries. The rule is the same for skills,
policies and replays.
"""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor

from hazard_ms.hazards.base import State, none_set, quantity
from hazard_ms.simulation.kernels.bodies import Bodies
from hazard_ms.simulation.kernels.reaching import nearest
from hazard_ms.simulation.world import World, rotate
from hazard_ms.spec.robot import GRASP_REACH

PUT_AWAY_HEIGHT = -10.0  # height at which things in the bag wait, out of sight and out of reach [m]


@dataclass
class Hand(State):
    """The hand of each agent: what it holds, and how."""

    held: Tensor = quantity("E", "", "index of the held body, -1 for none", dtype="int", fill=-1, low=-1, high="B")
    closed: Tensor = quantity("E", "", "gripper was commanded shut in the last frame", dtype="bool")
    offset: Tensor = quantity("E 3", "m", "base of the held body in the gripper's frame")
    turn: Tensor = quantity("E 4", "", "rotation of the held body in the gripper's frame")


def conjugate(rotation: Tensor) -> Tensor:
    """The inverse of unit quaternions w x y z, [..., 4]."""
    return torch.cat([rotation[..., :1], -rotation[..., 1:]], dim=-1)


def multiply(a: Tensor, b: Tensor) -> Tensor:
    """The product of quaternions w x y z, [..., 4]: the rotation b, then a."""
    w = a[..., :1] * b[..., :1] - (a[..., 1:] * b[..., 1:]).sum(-1, keepdim=True)
    v = a[..., :1] * b[..., 1:] + b[..., :1] * a[..., 1:] + torch.cross(a[..., 1:], b[..., 1:], dim=-1)
    return torch.cat([w, v], dim=-1)


def distance_to_boxes(world: World, point: Tensor) -> Tensor:
    """Distance [m] from `point` [m], [E, 3], to the surface of every thing's box, [E, B]; 0 inside."""
    local = rotate(world.rotation, point[:, None] - world.position, back=True)
    return (local.abs() - world.extent / 2).clamp(min=0).norm(dim=-1)


def nearest_target(world: World, hand: Tensor) -> tuple[Tensor, Tensor]:
    """The target, or tool, that is not safe and nearest to the `hand` [m], [E, 3]: its index along B, -1: none, [E].

    And the distance [m] of the hand from the surface of its box, infinite for none, [E]. Both hold until the next call.
    """
    found = world.launches.once(nearest, world.frame, lambda: (world.frame.clone(), world.agent_heading.clone()))
    bodies = world.launches.struct(Bodies, world)
    world.launches.run(nearest, (world.num_envs,), hand, world.takeable, bodies, *found)
    return found[0], found[1]


def graspable(world: World, gripper: Tensor) -> Tensor:
    """Index along B of the target that a hand takes if it shuts at `gripper` [m], [E, 3]: [E], -1 for none."""
    index, distance = nearest_target(world, gripper.contiguous())
    return torch.where(distance <= GRASP_REACH, index, -1)


def update(
    hand: Hand, world: World, gripper: Tensor, rotation: Tensor, closed: Tensor, others: Tensor | None = None
) -> Tensor:
    """Take or let go, given the gripper's position [m], [E, 3], its `rotation` [E, 4] and its command `closed` [E].

    `others`: what the hands of other robots hold, bool [E, B], which is not taken from them; None: there are none.
    Returns the index along B of what was let go, [E], -1 for none.
    """
    changed = closed != hand.closed
    if none_set(changed):
        return torch.full_like(hand.held, -1)  # nothing is taken or let go
    hand.closed = closed.clone()
    shut, holds = changed & closed, hand.held >= 0
    dropped = torch.where(changed & ~closed, hand.held, -1)
    taken = torch.where(shut & ~holds, graspable(world, gripper), -1)
    if others is not None:
        taken = torch.where(others.gather(1, taken.clamp(min=0)[:, None])[:, 0], -1, taken)
    if none_set((dropped >= 0) | (taken >= 0)):
        return dropped
    hand.held = torch.where(taken >= 0, taken, torch.where(dropped >= 0, -1, hand.held))
    _remember(hand, world, gripper, rotation, taken)
    index = torch.arange(world.num_bodies, device=world.device)
    world.held[:] = index == hand.held[:, None]
    return dropped


def lead_doors(hand: Hand, world: World, gripper: Tensor, closed: Tensor, dt: float) -> None:
    """Let hands take handles, lead leaves, and let go, in tasks in which leaves follow them; call it before `update`.

    `gripper`: positions [m], [E, 3]; `closed`: commands of this frame of `dt` [s], [E]. What a hand can take as well,
    it takes instead of a handle.
    """
    if world.door_grip is None:
        return
    shuts = closed & ~hand.closed & (hand.held < 0) & (graspable(world, gripper) < 0)
    fixed = world.exists & ~world.movable
    robot = torch.full_like(world.agent_heading, world.robot.radius)[:, None]
    discs = (
        torch.cat([world.agent_position[:, None, :2], world.position[..., :2]], 1),
        torch.cat([robot, torch.where(fixed, world.extent[..., :2].amin(-1) / 2, -torch.inf)], 1),
    )
    world.door_grip.follow(gripper, closed, shuts, discs, world.robot.pull, dt)


def _remember(hand: Hand, world: World, gripper: Tensor, rotation: Tensor, taken: Tensor) -> None:
    """Record the poses of newly held bodies in the gripper's frame, drawn in until they touch the gripper."""
    e = torch.arange(world.num_envs, device=world.device)
    b = taken.clamp(min=0)
    base = world.base_of(world.position[e, b], world.rotation[e, b], world.extent[e, b])
    inverse = conjugate(rotation)
    local = rotate(inverse, base - gripper)
    gap = distance_to_boxes(world, gripper)[e, b]
    centre = rotate(inverse, world.position[e, b] - gripper)
    local = local - centre / centre.norm(dim=-1, keepdim=True).clamp(min=1e-6) * gap[:, None]
    new = (taken >= 0)[:, None]
    hand.offset = torch.where(new, local, hand.offset)
    hand.turn = torch.where(new, multiply(inverse, world.rotation[e, b]), hand.turn)


def places(hand: Hand, world: World, gripper: Tensor, rotation: Tensor) -> tuple[Tensor, Tensor, Tensor]:
    """Bodies in a hand or in the bag, bool [E, B], and the bases [m], [E, B, 3], and rotations, [E, B, 4], of all."""
    base = world.base_of(world.position, world.rotation, world.extent)
    held = world.held[..., None]
    base = torch.where(held, (gripper + rotate(rotation, hand.offset))[:, None], base)
    turn = torch.where(held, multiply(rotation, hand.turn)[:, None], world.rotation)
    frozen = world.held | world.away
    if world.equipment is not None:
        stands = world.equipment.placed & ~world.held
        there = world.equipment.places()
        base, turn = (torch.where(stands[..., None], new, old) for new, old in zip(there, (base, turn), strict=True))
        frozen = frozen | stands
    parked = base.clone()
    parked[..., 2] = PUT_AWAY_HEIGHT
    base = torch.where(world.away[..., None], parked, base)
    return frozen, base, turn
