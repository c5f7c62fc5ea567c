"""The skill `put_on`: what the hand holds is put on top of furniture, where it is dry while the water stays below.

The hand brings the thing over a free spot near the edge, lower and lower, and opens. Limits: only tops are used, no
boards below them; furniture that floats off takes along what lies on it.
"""

from __future__ import annotations

import itertools

import numpy as np
from numpy.typing import NDArray

from hazard_ms.skills import failures
from hazard_ms.skills.context import Skill, Stage
from hazard_ms.skills.decision import Result
from hazard_ms.skills.mitigations.approach import approach
from hazard_ms.skills.motor.arm import REACH_FRAMES, fold, follow, go, lacking, posture_for
from hazard_ms.skills.motor.grasping import SHUT_FRAMES
from hazard_ms.skills.motor.kinematics import lifted
from hazard_ms.skills.motor.reaching import STAND_OFF
from hazard_ms.skills.motor.routes import quickest
from hazard_ms.skills.motor.surface import Leg, Place, Surface
from hazard_ms.skills.motor.walking import known
from hazard_ms.spec.robot import GRASP_REACH

FLAT = ("table", "coffee_table", "dining_table", "counter", "cabinet", "shelf", "bookshelf", "stove", "bench")
HEIGHTS = (0.3, 1.3)  # of tops that are used [m] [ours]
INSET = 0.06  # gap between a thing and the edge of the top [m] [ours]
GRID = 0.08  # between the spots that are looked at [m] [ours]
GAP = 0.05  # between a thing and what stands there already [m] [ours]
RAISED, FALL = 0.15, 0.04  # of the base above the top on the way there, and where the hand opens [m] [ours]
OFF = 0.05  # error of its place that is corrected [m] [ours]
SETTLE = 20  # frames in which a thing comes to rest [ours]


def tops(stage: Stage) -> tuple[str, ...]:
    """Names of known furniture on which something can be put, while something is in the hand."""
    fixed = [b for b in sorted(stage.seen.objects) if stage.held >= 0 and _top(stage, stage.labeller.thing(b)) > 0.0]
    return tuple(stage.labeller.names[b] for b in fixed)


def put_on(stage: Stage, name: str) -> Skill:
    """Put what the hand holds on the furniture called `name`."""
    index, held = stage.labeller.index(name), stage.held
    if held < 0:
        return Result(False, failures.NOT_HOLDING)
    if not known(stage, index):
        return Result(False, failures.UNKNOWN)
    thing = stage.labeller.thing(index)
    top = _top(stage, thing)
    if top <= 0.0:
        return Result(False, failures.NO_TOP)
    used = 0
    nearest, farthest = stage.robot.build.span(top)
    for share in (STAND_OFF, 0.7):
        spot = _spot(stage, thing, top, held)
        if spot is None:
            return Result(False, failures.NO_ROOM, used)
        walked = yield from approach(stage, spot, max(nearest, share * farthest), farthest + GRASP_REACH)
        used += walked.frames
        if not walked.ok:
            return Result(False, walked.reason, used)
        put = yield from _put(stage, thing, spot, held)
        used += put.frames
        if put.ok or stage.held < 0:
            return Result(put.ok, put.reason, used)
    return Result(False, failures.UNREACHABLE, used)


def _top(stage: Stage, thing: int) -> float:
    """Height of the top of furniture on which things are put [m]; 0 for others."""
    things = stage.world.specs[0].things
    if thing < len(stage.world.specs[0].bodies) or things[thing].category not in FLAT:
        return 0.0
    high = float(stage.world.position[0, thing, 2] + stage.world.extent[0, thing, 2] / 2)
    return high if HEIGHTS[0] <= high <= HEIGHTS[1] else 0.0


def _spot(stage: Stage, thing: int, top: float, held: int) -> NDArray[np.float64] | None:
    """The free spot for the base of the thing `held` on a top, [3] [m], nearest to the robot; None for none."""
    world = stage.world
    half = world.extent[0, thing, :2].cpu().numpy().astype(np.float64) / 2
    wide = float(world.extent[0, held].max()) / 2
    w, _, _, z = world.rotation[0, thing].tolist()
    turn = 2.0 * np.arctan2(z, w)
    along, across = np.array([np.cos(turn), np.sin(turn)]), np.array([-np.sin(turn), np.cos(turn)])
    room = half - wide - INSET
    if (room < 0.0).any():
        return None
    steps = [np.linspace(-r, r, max(1, int(2 * r / GRID) + 1)) for r in room]
    middle = stage.position(thing)[:2]
    spots = [middle + a * along + b * across for a, b in itertools.product(*steps)]
    base = world.position[0, :, 2] - world.extent[0, :, 2] / 2
    there = world.exists[0] & ~world.away[0] & ~world.held[0] & (base > top - 0.1) & (base < top + 0.5)
    others = [(stage.position(b)[:2], float(world.extent[0, b, :2].max()) / 2) for b in there.nonzero()[:, 0].tolist()]
    free = [s for s in spots if all(np.hypot(*(s - at)) > wide + far + GAP for at, far in others)]
    here = np.array(stage.robot.base()[:2])
    return np.array([*min(free, key=lambda s: float(np.hypot(*(s - here)))), top]) if free else None


def _put(stage: Stage, thing: int, spot: NDArray[np.float64], held: int) -> Skill:
    """Bring the thing `held` over the `spot`, lower it, open the hand, and fold the arm."""
    place = Place(spot, float(stage.world.extent[0, held].max()) / 2, float(spot[2]), float(spot[2]) + 0.3)
    surface, used = Surface(stage, place), 0
    goal, arm = spot + np.array([0.0, 0.0, RAISED]), None
    for height in (RAISED, FALL):
        for _ in range(2):
            wanted = spot + np.array([0.0, 0.0, height])
            aim = stage.robot.hand() + wanted - _base(stage, held) if arm is not None else goal
            posture = posture_for(stage, aim)
            if posture.error > OFF:
                break
            arm = posture.arm
            if used == 0:
                used += (yield from follow(stage, quickest(stage, [Leg(arm, 0.0)], surface, lacking(stage)))).frames
            else:
                used += (yield from go(stage, arm, REACH_FRAMES)).frames
    near = arm is not None and float(np.hypot(*(_base(stage, held) - spot)[:2])) < 2 * OFF
    if arm is not None and near:
        opened = 0
        while opened < SETTLE and (opened < SHUT_FRAMES or stage.held < 0):
            yield stage.act(arm=stage.robot.arm(), shut=False)
            opened += 1
        used += opened + (yield from go(stage, lifted(stage.robot, stage.robot.arm(), 0.2), REACH_FRAMES)).frames
    used += (yield from fold(stage, place)).frames
    if stage.held >= 0:
        return Result(False, failures.UNREACHABLE, used)
    low = float(_base(stage, held)[2])
    return Result(low > spot[2] - 0.1, "" if low > spot[2] - 0.1 else failures.FELL_OFF, used)


def _base(stage: Stage, held: int) -> NDArray[np.float64]:
    """The place below the middle of a thing, at its lowest point as its box is turned now, [3] [m]."""
    world = stage.world
    w, x, y, z = world.rotation[0, held].tolist()
    up = np.array([2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)])  # third row of its matrix
    lower = float(np.abs(up) @ world.extent[0, held].cpu().numpy()) / 2
    return stage.position(held) - np.array([0.0, 0.0, lower])
