"""The skill `drop`: let go of what the hand holds, into the bag or over the basket of a cart."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hazard_ms.episode.grasp import GRASP_REACH, conjugate
from hazard_ms.episode.safe_places import BAG_REACH
from hazard_ms.simulation.containers import BASKET_HIGH, BASKET_LOW
from hazard_ms.simulation.world import rotate
from hazard_ms.skills import failures
from hazard_ms.skills.context import Skill, Stage
from hazard_ms.skills.decision import Result
from hazard_ms.skills.motor.arm import REACH_FRAMES, THERE, fold, follow, go, lacking, posture_for
from hazard_ms.skills.motor.grasping import CLEAR, LIMIT, SHUT_FRAMES, come_near, standings
from hazard_ms.skills.motor.motion import turn_to
from hazard_ms.skills.motor.routes import NEARLY, Leg, Place, Surface, quickest
from hazard_ms.skills.motor.walking import known

OVER_BAG = 0.8 * BAG_REACH  # the hand opens this close to the mouth of the bag [m]
OFF_CENTRE = 0.04  # distance [m] between the thing and its place over the basket that the arm corrects [ours]
INSET = 0.14  # least distance from the walls of a basket to where a thing is let go [m] [ours]


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
    def over() -> bool:
        mouth = stage.robot.bag_position()[0].cpu().numpy()
        return bool(np.linalg.norm(stage.robot.hand() - mouth) < OVER_BAG)

    moved = yield from go(stage, stage.robot.tucked, REACH_FRAMES, over, NEARLY)
    opened = yield from _open(stage, stage.robot.tucked)
    return Result(True, frames=moved.frames + opened.frames)


def _into_cart(stage: Stage, cart: int, held: int) -> Skill:
    """Come near, hold the thing over the basket, open the hand, fold the arm back."""
    if not known(stage, cart):
        return Result(False, failures.UNKNOWN)
    if float(np.linalg.norm(stage.position(cart) - stage.robot.shoulder())) > LIMIT:
        return Result(False, failures.CART_UNREACHABLE)
    used = 0
    over = _over_basket(stage, cart, held)
    if float(np.hypot(*(over[:2] - stage.robot.base()[:2]))) > stage.robot.build.span(float(over[2]))[1]:
        used += (yield from come_near(stage, stage.position(cart))).frames
    over = _over_basket(stage, cart, held)
    used += (yield from turn_to(stage, over[:2])).frames
    goals = _goals(stage, over)
    if not goals:
        return Result(False, failures.CART_UNREACHABLE, used)
    place = _basket(stage, cart, over)
    route = quickest(stage, goals, Surface(stage, place), lacking(stage))
    used += (yield from follow(stage, route, close=THERE)).frames
    arm = route.legs[-1].arm
    beside = over - stage.position(held)  # the hand holds the thing by its edge
    beside[2] = 0.0
    if float(np.linalg.norm(beside)) > OFF_CENTRE:
        posture = posture_for(stage, over + beside)
        if posture.error < GRASP_REACH:
            arm = posture.arm
            used += (yield from go(stage, arm, REACH_FRAMES, close=THERE)).frames
    used += (yield from _open(stage, arm)).frames
    used += (yield from fold(stage, place)).frames
    return Result(True, frames=used)


def _goals(stage: Stage, over: NDArray[np.float64]) -> list[Leg]:
    """The posture for a hand at `over` [m], [3], from where the base stands, or from nearer if that is closer.

    Empty if the arm is too short.
    """
    heading = stage.robot.base()[2]
    found: list[tuple[float, Leg]] = []
    for ahead in standings(stage, over):
        posture = posture_for(stage, over - ahead * np.array([np.cos(heading), np.sin(heading), 0.0]))
        if posture.error < GRASP_REACH:
            found.append((posture.error, Leg(posture.arm, ahead)))
        if posture.error < OFF_CENTRE:
            break
    return [min(found, key=lambda each: each[0])[1]] if found else []


def _basket(stage: Stage, cart: int, over: NDArray[np.float64]) -> Place:
    """The basket of the `cart` for a hand at `over` [m], [3], which may come down to its rim."""
    extent = stage.world.extent[0, cart].cpu().numpy().astype(np.float64)
    size = (np.array(BASKET_HIGH) - np.array(BASKET_LOW)) * extent
    rim = float(stage.position(cart)[2] + BASKET_HIGH[2] * extent[2])
    return Place(over, float(size[:2].min()) / 2, rim, rim)


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
