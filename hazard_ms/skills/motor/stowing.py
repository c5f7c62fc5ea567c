"""The skill `drop`: let go of what the hand holds, into the bag or over the basket of a cart."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hazard_ms.episode.grasp import GRASP_REACH, conjugate
from hazard_ms.simulation.containers import BASKET_HIGH, BASKET_LOW
from hazard_ms.simulation.world import rotate
from hazard_ms.skills import failures
from hazard_ms.skills.context import Skill, Stage
from hazard_ms.skills.decision import Result
from hazard_ms.skills.motor.arm import HOVER, NEARLY, REACH_FRAMES, THERE, go, posture_for, retract, unfold
from hazard_ms.skills.motor.grasping import CLEAR, LIMIT, SHUT_FRAMES, close_in, come_near, lacking
from hazard_ms.skills.motor.motion import turn_to
from hazard_ms.skills.motor.walking import known

INSET = 0.14  # least distance from the walls of a basket to where a thing is let go [m] [ours]
APPROACHES = 2  # number of attempts, the second from nearer than the first


def drop(stage: Stage, cart: int | None = None) -> Skill:
    """Let go of what the hand holds: into the bag, or over the thing `cart`.

    It fails as CART_UNREACHABLE if the cart is out of reach.
    """
    held = stage.held
    if held < 0:
        return Result(False, failures.NOT_HOLDING)
    given = yield from (_into_bag(stage) if cart is None else _into_cart(stage, cart, held))
    safe = bool(stage.world.safe[0, held])
    return Result(safe, given.reason if safe or given.reason else failures.NOT_RESCUED, given.frames)


def _into_bag(stage: Stage) -> Skill:
    moved = yield from go(stage, stage.robot.tucked, REACH_FRAMES, close=NEARLY)
    opened = yield from _open(stage, stage.robot.tucked)
    back = yield from retract(stage)
    return Result(True, frames=moved.frames + opened.frames + back.frames)


def _into_cart(stage: Stage, cart: int, held: int) -> Skill:
    """Come near, hold the thing over the basket, open the hand, fold the arm back."""
    if not known(stage, cart):
        return Result(False, failures.UNKNOWN)
    if float(np.linalg.norm(stage.position(cart) - stage.robot.shoulder())) > LIMIT:
        return Result(False, failures.CART_UNREACHABLE)
    used = 0
    for attempt in range(APPROACHES):
        middle = stage.position(cart)
        if attempt or float(np.hypot(*(_over_basket(stage, cart, held)[:2] - stage.robot.base()[:2]))) > _reach(
            stage, cart, held
        ):
            used += (yield from come_near(stage, middle, attempt)).frames
        over = _over_basket(stage, cart, held)
        used += (yield from turn_to(stage, over[:2])).frames
        high = float(over[2]) + HOVER
        used += (yield from unfold(stage, high, -lacking(stage))).frames
        used += (yield from close_in(stage, over, high)).frames
        posture = posture_for(stage, _over_basket(stage, cart, held))
        if posture.error < GRASP_REACH:
            used += (yield from go(stage, posture.arm, REACH_FRAMES, close=THERE)).frames
            used += (yield from _open(stage, posture.arm)).frames
            used += (yield from retract(stage, high, -lacking(stage))).frames
            return Result(True, frames=used)
        used += (yield from retract(stage, high, -lacking(stage))).frames
    return Result(False, failures.CART_UNREACHABLE, used)


def _reach(stage: Stage, cart: int, held: int) -> float:
    return stage.robot.build.span(float(_over_basket(stage, cart, held)[2]))[1]


def _over_basket(stage: Stage, cart: int, held: int) -> NDArray[np.float64]:
    """The point [m], [3], world frame, at which the hand lets go.

    It is over the place in the basket that is nearest to the robot, high enough for the thing.
    """
    world = stage.world
    x, y, _ = stage.robot.base()
    turn = world.rotation[0, cart]
    extent = world.extent[0, cart].cpu().numpy().astype(np.float64)
    offset = world.position.new_tensor([x, y, 0.0]) - world.position[0, cart]
    local = rotate(conjugate(turn), offset).cpu().numpy().astype(np.float64)
    low, high = np.array(BASKET_LOW) * extent, np.array(BASKET_HIGH) * extent
    middle, half = (low + high) / 2, np.maximum((high - low) / 2 - INSET, 0.0)
    place = np.clip(local, middle - half, middle + half)
    place[2] = high[2] + float(world.extent[0, held].max()) / 2 + CLEAR
    return np.asarray(
        stage.position(cart) + rotate(turn, world.position.new_tensor(place)).cpu().numpy(), dtype=np.float64
    )


def _open(stage: Stage, arm: NDArray[np.float64]) -> Skill:
    """Open the hand."""
    for _ in range(SHUT_FRAMES):
        yield stage.act(arm=arm, shut=False)
    return Result(True, frames=SHUT_FRAMES)
