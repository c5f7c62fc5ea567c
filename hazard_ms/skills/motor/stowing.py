"""The skill `drop`: let go of what the hand holds, into the bag, or in the basket of a cart.

A thing is put into the basket, not dropped over it: wind would take it, and it may stick to the fingers.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hazard_ms.simulation.containers import BASKET_HIGH, BASKET_LOW
from hazard_ms.simulation.world import rotate
from hazard_ms.skills import failures
from hazard_ms.skills.context import Skill, Stage
from hazard_ms.skills.decision import Result
from hazard_ms.skills.motor.arm import CARRIED, REACH_FRAMES, fold, fold_until, follow, go, lacking
from hazard_ms.skills.motor.grasping import LIMIT, SHUT_FRAMES, come_near
from hazard_ms.skills.motor.kinematics import Posture, lifted, solve
from hazard_ms.skills.motor.motion import turn_to
from hazard_ms.skills.motor.reaching import standings
from hazard_ms.skills.motor.routes import Route, quickest
from hazard_ms.skills.motor.surface import NEARLY, Leg, Place, Surface
from hazard_ms.skills.motor.walking import known
from hazard_ms.tasks.episode.grasp import conjugate
from hazard_ms.tasks.episode.safe_places import BAG_REACH

OVER_BAG = 0.8 * BAG_REACH  # the hand opens this close to the mouth of the bag [m]
INSETS = (0.16, 0.09)  # least distances from the walls of a basket to where a thing is put, in turn [m] [ours]
SUNK = 0.03  # depth below the rim to which the middle of a thing, or its base, is lowered [m] [ours]
OFF = 0.06  # most that a posture may bring a thing off its place in the basket [m] [ours]
RAISED = 0.2  # height above its place in the basket to which a thing is brought first [m] [ours]
ABOVE = 0.15  # that posture is reached when every joint is this close [rad] [ours]
LOWERED = 0.02  # and the one in the basket, where the thing is not in it before [rad] [ours]
DRAW_BACK = 0.3  # how much farther than for a table the base may draw back [m] [ours]
FALL = 0.3  # most that a thing may fall into a basket [m] [ours]
MARGIN = 0.06  # least distance from the walls of the basket to what falls into it [m] [ours]
FALL_FRAMES = 10  # frames in which it falls in [ours]
DRIVE_ON = 0.9  # most that the base drives straight on while the arm unfolds: the arm takes as long [m] [ours]
HIT_COST = 20.0  # what a point of the arm in a cart counts as much as: carts do not give way [frames] [ours]
RETREAT = 0.5  # how far it draws back from a cart before it tries another posture [m] [ours]
TRIES = 2  # number of postures that are tried
SIDES = tuple(np.deg2rad([75.0, 45.0, 15.0, -15.0]).tolist())  # how far down the fingers point [rad] [ours]


@dataclass(frozen=True)
class Basket:
    """The basket of a cart as the robot stands before it."""

    spots: tuple[NDArray[np.float64], ...]  # where the held thing may go, near the robot [m], each [3], world frame
    place: Place  # keeps the hand above the rim


@dataclass(frozen=True)
class Way:
    """A way into a basket: a route to above it, and from there to the joints `arm` [rad], [J]."""

    number: int  # of the posture
    route: Route
    arm: NDArray[np.float64]


def drop(stage: Stage, cart: int | None = None) -> Skill:
    """Let go of what the hand holds: into the bag, or in the basket of the cart that the map knows as `cart`.

    It fails with the thing in the hand: as CART_UNREACHABLE where that cannot get over the basket, else as BLOCKED.
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

    folded = yield from fold_until(stage, over)
    if not folded.ok:  # the thing would fall to the floor
        return folded
    return Result(True, frames=folded.frames + (yield from _open(stage, stage.robot.tucked)).frames)


def _into_cart(stage: Stage, index: int, held: int) -> Skill:
    """Unfold the arm over the basket while the base drives on, lower the thing, open the hand, fold the arm back.

    Where the arm is too short even so, the base comes near first.
    """
    if not known(stage, index):
        return Result(False, failures.UNKNOWN)
    cart = stage.labeller.thing(index)
    place = stage.position(cart) if cart >= 0 else stage.seen.objects[index].position
    if float(np.linalg.norm(place - stage.robot.shoulder())) > LIMIT:
        return Result(False, failures.CART_UNREACHABLE)
    if cart < 0:  # it turns to the place, and finds no cart there
        turned = yield from turn_to(stage, (float(place[0]), float(place[1])))
        stage.labeller.missed(index)
        return Result(False, failures.CART_UNREACHABLE, turned.frames)
    used, tried, came_near = 0, set[int](), False
    while len(tried) < TRIES:
        basket = _basket(stage, cart)
        used += (yield from turn_to(stage, basket.spots[0][:2])).frames
        way = _way(stage, basket, held, tried) if came_near or _ahead(stage, basket) else None
        if way is None and not came_near:
            used += (yield from come_near(stage, stage.position(cart))).frames
            came_near = True
            continue
        if way is None:
            break
        tried.add(way.number)
        lowered = yield from _lower_into(stage, cart, held, way)
        used += lowered.frames
        used += (yield from fold(stage, basket.place)).frames
        if lowered.ok:
            return Result(True, frames=used)
        if len(tried) < TRIES:  # where the arm met the cart it has no room to unfold
            used += (yield from go(stage, stage.robot.tucked, REACH_FRAMES, close=CARRIED, forward=-RETREAT)).frames
    return Result(False, failures.CART_UNREACHABLE, used)


def _ahead(stage: Stage, basket: Basket) -> bool:
    """Whether the arm is long enough for the basket, if the base drives straight on while it unfolds."""
    spot = basket.spots[-1]
    far = float(np.hypot(*(spot[:2] - stage.robot.base()[:2])))
    return far - min(standings(stage, spot)[-1], DRIVE_ON) <= stage.robot.build.span(float(spot[2]))[1]


def _lower_into(stage: Stage, cart: int, held: int, way: Way) -> Skill:
    """Bring the `held` thing above the basket, lower it, open the hand if it is in, and raise the hand again."""

    def inside() -> bool:
        return _inside(stage, cart, held)

    used = (yield from follow(stage, way.route, close=ABOVE)).frames
    used += (yield from go(stage, way.arm, REACH_FRAMES, inside, LOWERED)).frames
    placed = inside() or _inside(stage, cart, held, falling=True)
    if placed:
        used += (yield from _open(stage, stage.robot.arm(), held)).frames
    used += (yield from go(stage, way.route.legs[-1].arm, REACH_FRAMES, close=NEARLY)).frames
    return Result(placed, frames=used)


def _way(stage: Stage, basket: Basket, held: int, tried: set[int]) -> Way | None:
    """The quickest way to bring the `held` thing into the `basket`; the base may drive straight on meanwhile.

    None if the arm is too short for all postures that are not in `tried`.
    """
    surface, back, heading = Surface(stage, basket.place), lacking(stage) + DRAW_BACK, stage.robot.base()[2]
    carried = _carried(stage, held)
    best, least = None, np.inf
    ends = ((spot, min(ahead, DRIVE_ON)) for spot in basket.spots for ahead in standings(stage, spot))
    for number, ((spot, ahead), down) in enumerate(itertools.product(ends, SIDES)):
        if number in tried:
            continue
        moved = ahead * np.array([np.cos(heading), np.sin(heading), 0.0])
        for posture in _postures(stage, spot - moved, carried, down):
            above = lifted(stage.robot, posture.arm, RAISED)
            lowered = HIT_COST * surface.hits([Leg(above, ahead), Leg(posture.arm, ahead)])
            if stage.arm_gap(above) / stage.robot.build.arm_step + lowered >= least:
                continue
            route = quickest(stage, [Leg(above, ahead)], surface, back, hit_cost=HIT_COST)
            if route.cost + lowered < least:
                best, least = Way(number, route, posture.arm), route.cost + lowered
    return best


def _postures(stage: Stage, spot: NDArray[np.float64], carried: NDArray[np.float64], down: float) -> Iterator[Posture]:
    """Postures that bring an end of what is `carried` to `spot` [m], [3], the fingers `down` [rad]; none if too far.

    Where the hand must be depends on how it is turned, so the search goes on from what it finds.
    """
    shoulder = stage.robot.shoulder()
    level = spot[:2] - shoulder[:2]
    level = level / max(float(np.hypot(*level)), 1e-6)
    pointing = np.array([*(np.cos(down) * level), -np.sin(down)])
    for end in carried:
        goal = spot
        for _ in range(3):
            posture = solve(stage.robot, goal, pointing)
            hand, turn, _ = stage.robot.kinematics(posture.arm)
            missed = float(np.linalg.norm(hand + turn @ end - spot))
            if missed < OFF / 2:
                break
            goal = spot - turn @ end
        if missed < OFF:
            yield posture


def _carried(stage: Stage, held: int) -> NDArray[np.float64]:
    """Base and middle of the `held` thing in the hand's frame [m], [2, 3]."""
    hand = stage.env.hand
    up = hand.offset.new_tensor([0.0, 0.0, 0.5 * float(stage.world.extent[0, held, 2])])
    base = hand.offset[0]
    return np.stack([end.cpu().numpy().astype(np.float64) for end in (base, base + rotate(hand.turn[0], up))])


def _ends(stage: Stage, held: int) -> NDArray[np.float64]:
    """Middle and base of the `held` thing [m], [2, 3], world frame: in a cart is what has one of them there."""
    world = stage.world
    base = world.base_of(world.position[:, held], world.rotation[:, held], world.extent[:, held])[0]
    return np.stack([stage.position(held), base.cpu().numpy().astype(np.float64)])


def _hollow(stage: Stage, cart: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The lowest and highest corner of the basket in the frame of the `cart` [m], each [3]."""
    extent = stage.world.extent[0, cart].cpu().numpy().astype(np.float64)
    return np.array(BASKET_LOW) * extent, np.array(BASKET_HIGH) * extent


def _local(stage: Stage, cart: int, point: NDArray[np.float64]) -> NDArray[np.float64]:
    """The `point` [m], [3], world frame, in the frame of the `cart`."""
    turn = conjugate(stage.world.rotation[0, cart])
    return rotate(turn, turn.new_tensor(point - stage.position(cart))).cpu().numpy().astype(np.float64)


def _inside(stage: Stage, cart: int, held: int, falling: bool = False) -> bool:
    """Whether the `held` thing would lie in the basket of the `cart` if the hand opened now, or after `falling`."""
    low, high = _hollow(stage, cart)
    if falling:
        low, high = low + [MARGIN, MARGIN, 0.0], high + [-MARGIN, -MARGIN, FALL]
    points = np.stack([_local(stage, cart, end) for end in _ends(stage, held)])
    return bool(((points > low) & (points < high)).all(axis=1).any())


def _basket(stage: Stage, cart: int) -> Basket:
    """The basket of the `cart`, and the places in it that are nearest to the robot."""
    world, (low, high) = stage.world, _hollow(stage, cart)
    here, spots = _local(stage, cart, np.array([*stage.robot.base()[:2], 0.0])), []
    for inset in INSETS:
        half = np.maximum((high - low) / 2 - inset, 0.0)
        place = np.clip(here, (low + high) / 2 - half, (low + high) / 2 + half)
        place[2] = high[2] - SUNK
        turned = rotate(world.rotation[0, cart], world.position.new_tensor(place)).cpu().numpy()
        spots.append(np.asarray(stage.position(cart) + turned, dtype=np.float64))
    return Basket(tuple(spots), Place(spots[0], 0.0, np.inf, float(stage.position(cart)[2] + high[2])))


def _open(stage: Stage, arm: NDArray[np.float64], falling: int = -1) -> Skill:
    """Open the hand, and wait while the thing of index `falling` falls into a basket."""
    used = 0
    while used < SHUT_FRAMES or (falling >= 0 and used < FALL_FRAMES and not bool(stage.world.safe[0, falling])):
        yield stage.act(arm=arm, shut=False)
        used += 1
    return Result(True, frames=used)
