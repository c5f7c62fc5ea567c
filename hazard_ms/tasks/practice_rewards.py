"""Goals and rewards of the practice tasks: to stand before a thing, to hold it, or to have it in the bag, unharmed.

Beside the 1 for success, each frame pays a hint. A walk is paid for its speed towards the thing. It takes hundreds of
frames, so that a reward for being near would tell one action from another by a hundredth of what is still to come
(measured in a room without physics: 11 % success after 40,000 actions, and 90 % with this). A reach, of some forty
actions, is paid for being near. The hints of an episode add up to less than success: nobody gains by waiting.
"""

from __future__ import annotations

import torch
from torch import Tensor

from hazard_ms.spec import Goal, Term, rounding
from hazard_ms.spec.robot import GRASP_REACH
from hazard_ms.tasks.episode.grasp import distance_to_boxes
from hazard_ms.tasks.episode.safe_places import BAG_REACH
from hazard_ms.tasks.episode.situation import Situation

WALK_FRAMES, PICK_UP_FRAMES = 450, 120  # of an episode: 7 m at full speed; a skill's pick-up takes 81 at most [ours]
STOW_FRAMES, FETCH_FRAMES = 240, 750  # twice as long as a skill, or a walk and that, takes at most [ours]
BEFORE, FACING = 0.85, 0.3  # distance [m] and bearing [rad] at which the robot stands before a thing and faces it
FULL_SPEED = 0.5  # of the benchmark's robots: 1/62 m a frame (robots/planar.py) at 30 frames a second [m/s]
HALFWAY = 0.25  # distance from where it could take the thing at which a hand gets half the largest hint [m] [ours]


def beside(situation: Situation, values: Tensor) -> Tensor:
    """The numbers of `values`, [E, B, ...], that belong to the target nearest to the robot, [E, ...]."""
    world = situation.world
    far = apart(situation, world.agent_position[:, None, :2])[:, 0]
    return values[torch.arange(world.num_envs, device=world.device), nearest(situation, far)]


def nearest(situation: Situation, distance: Tensor) -> Tensor:
    """Index along B of the target with the least `distance`, [E, B]: [E]."""
    return torch.where(wanted(situation), distance, torch.inf).argmin(dim=1)


def wanted(situation: Situation) -> Tensor:
    """Targets that are neither safe nor harmed, bool [E, B]."""
    world = situation.world
    return world.target & ~world.safe & ~situation.episode.damage.damaged


def lost(situation: Situation) -> Tensor:
    """Whether every target is harmed, bool [E]."""
    return ~(situation.world.target & ~situation.episode.damage.damaged).any(dim=1)


def apart(situation: Situation, points: Tensor) -> Tensor:
    """Distances over the floor [m] from `points` [m], [E, P, 2], to the middles of all things, [E, P, B]."""
    return (points[:, :, None] - situation.world.position[:, None, :, :2]).norm(dim=-1)


def gaps(situation: Situation, points: Tensor) -> Tensor:
    """Distances over the floor [m] from `points` [m], [E, P, 2], to boxes along the walls around things, [E, P, B]."""
    world = situation.world
    off = (points[:, :, None] - world.position[:, None, :, :2]).abs() - world.extent[:, None, :, :2] / 2
    return off.clamp(min=0.0).norm(dim=-1)


def thing_ahead(situation: Situation) -> Tensor:
    """Middle of the nearest target in the frame of the base: ahead, left, up [m], [E, 3]."""
    world = situation.world
    return in_base(situation, beside(situation, world.position) - world.agent_position)


def in_base(situation: Situation, vector: Tensor) -> Tensor:
    """The `vector`, [E, ..., 3], of the world in the frame of the base, in its unit."""
    world = situation.world
    shape = (world.num_envs, *[1] * (vector.dim() - 2))
    c, s = (turn(world.agent_heading).reshape(shape) for turn in (rounding.cos, rounding.sin))
    x, y, z = vector.unbind(-1)
    return torch.stack([c * x + s * y, c * y - s * x, z], dim=-1)


def gap(situation: Situation) -> Tensor:
    """Distance [m] from the hand to the box of the nearest target, [E]; 0 inside."""
    world = situation.world
    return beside(situation, distance_to_boxes(world, situation.agent.gripper_pose()[0]))


def arrived(situation: Situation) -> Tensor:
    """Whether the robot stands before the nearest target and faces it, bool [E]."""
    ahead = thing_ahead(situation)
    bearing = torch.atan2(ahead[:, 1], ahead[:, 0])
    return (ahead[:, :2].norm(dim=-1) <= BEFORE) & (bearing.abs() <= FACING)


def walk_hint(situation: Situation) -> Tensor:
    """Speed of the robot towards the nearest target as a share of FULL_SPEED, [E], from -1 to 1."""
    world = situation.world
    there = (beside(situation, world.position) - world.agent_position)[:, :2]
    speed = (situation.agent.base_velocity() * there).sum(dim=1) / there.norm(dim=1).clamp(min=1e-6)
    return (speed / FULL_SPEED).clamp(-1.0, 1.0)


def walk_dense(situation: Situation) -> Tensor:
    """Dense reward, [E]: 1 for standing before the thing; each frame up to 1/450 for coming nearer to it."""
    return arrived(situation).float() + walk_hint(situation) / WALK_FRAMES


def holding(situation: Situation) -> Tensor:
    """Whether a target that is not harmed is in the hand, bool [E]."""
    return (situation.world.held & wanted(situation)).any(dim=1)


def nearness(gap: Tensor, reach: float) -> Tensor:
    """Nearness of what is `gap` [m], [E], away to where it is within `reach` [m], [E], from 0 to 1."""
    return 1.0 / (1.0 + (gap - reach).clamp(min=0.0) / HALFWAY)


def pick_up_hint(situation: Situation) -> Tensor:
    """Nearness of the hand to where it could take the nearest target, [E], from 0 to 1."""
    return nearness(gap(situation), GRASP_REACH)


def pick_up_dense(situation: Situation) -> Tensor:
    """Dense reward, [E]: 1 for the thing in the hand; each frame up to 1/120 for a hand near it."""
    return holding(situation).float() + pick_up_hint(situation) / PICK_UP_FRAMES


def stowed(situation: Situation) -> Tensor:
    """Whether a target is in the bag that was not harmed before, bool [E]."""
    return (situation.world.safe & ~situation.episode.damage.damaged).any(dim=1)


def stow_hint(situation: Situation) -> Tensor:
    """Hint on the way into the bag, [E], 0 to 1: half of that of a pick-up; once it is held, a half and more."""
    agent = situation.agent
    away = (agent.gripper_pose()[0] - agent.bag_position()).norm(dim=1)
    over = nearness(away, BAG_REACH)
    return torch.where(holding(situation), 0.5 + 0.5 * over, 0.5 * pick_up_hint(situation))


def stow_dense(situation: Situation) -> Tensor:
    """Dense reward, [E]: 1 for the thing in the bag; each frame up to 1/240 on the way there."""
    return stowed(situation).float() + stow_hint(situation) / STOW_FRAMES


def fetch_hint(situation: Situation) -> Tensor:
    """Hint of the reward of a fetch, [E]: a quarter of that of a walk; beside the thing a quarter and more."""
    near = (thing_ahead(situation)[:, :2].norm(dim=-1) <= BEFORE) | holding(situation)
    return torch.where(near, 0.25 + 0.75 * stow_hint(situation), 0.25 * walk_hint(situation))


def fetch_dense(situation: Situation) -> Tensor:
    """Dense reward, [E]: 1 for the thing in the bag; each frame up to 1/750 on the way there."""
    return stowed(situation).float() + fetch_hint(situation) / FETCH_FRAMES


DISTANCE = Term(
    "distance", lambda s: thing_ahead(s)[:, :2].norm(dim=-1), "to the thing, over the floor", unit="m", low=0.0
)
GAP = Term("gap", gap, "from the hand to the box of the thing", unit="m", low=0.0)
WALK_TO = Goal(
    success=arrived,
    dense=walk_dense,
    sparse=lambda s: arrived(s).float(),
    largest=1.0 + 1.0 / WALK_FRAMES,
    least=-1.0 / WALK_FRAMES,
    fail=lost,
    info=(DISTANCE,),
    done="arrived",
    verb="walk_to",
)
PICK_UP = Goal(
    success=holding,
    dense=pick_up_dense,
    sparse=lambda s: holding(s).float(),
    largest=1.0 + 1.0 / PICK_UP_FRAMES,
    fail=lost,
    info=(GAP,),
    done="in the hand",
    verb="pick_up",
)
STOW = Goal(
    success=stowed,
    dense=stow_dense,
    sparse=lambda s: stowed(s).float(),
    largest=1.0 + 1.0 / STOW_FRAMES,
    fail=lost,
    info=(GAP,),
    done="in the bag",
    verb="drop",
)
FETCH = Goal(
    success=stowed,
    dense=fetch_dense,
    sparse=lambda s: stowed(s).float(),
    largest=1.0 + 1.0 / FETCH_FRAMES,
    least=-0.25 / FETCH_FRAMES,
    fail=lost,
    info=(DISTANCE, GAP),
    done="in the bag",
    verb="drop",
)
