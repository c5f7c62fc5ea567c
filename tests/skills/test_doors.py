"""Robots open and shut doors: at the handle, in the time of doors, and not against more than they can pull."""

from __future__ import annotations

import dataclasses
import math
from types import SimpleNamespace

import numpy as np
import pytest
import torch

from hazard_ms.simulation.mitigation import hinges
from hazard_ms.skills import failures
from hazard_ms.skills.actions import skill
from hazard_ms.skills.decision import Action
from hazard_ms.skills.mitigations.doors import open_ones, shut_ones
from hazard_ms.skills.mitigations.handles import home_side, stand
from hazard_ms.skills.mitigations.leaf import Leaf
from hazard_ms.skills.motor.grasping import GRASP_REACH
from hazard_ms.spec import AgentStart, Body, Fixture, Opening, Partition
from hazard_ms.spec.registry import ROBOTS
from tests.worlds.two_rooms import DOOR, FAR, HALL, HINGE, ONE, SIZE, TwoRooms, spec, two_rooms

OPEN, SHUT = Action("open", "door_0"), Action("shut", "door_0")
AJAR = dataclasses.replace(DOOR, open=1.0)
OPENING, SHUTTING = 120, 135  # frames of 4 s and 4.5 s [ANSI/BHMA A156.19]


def turning(rooms: TwoRooms, action: Action) -> tuple[object, list[float], float]:
    """The result of an action, the shares by which the door was open in each frame, and how near the hand came."""
    shares, nearest, advance = [], [math.inf], rooms.base.advance

    def advanced(low_level: object) -> object:
        made = advance(low_level)
        shares.append(rooms.share())
        if len(shares) < 2 or shares[-1] == shares[0]:  # the leaf has not moved yet
            handle = hinges.handle(
                rooms.base.specs[0].room, rooms.base.specs[0].room.openings[0], hinges.angle(shares[-1])
            )
            nearest.append(float(np.linalg.norm(rooms.stage.robot.hand() - handle)))
        return made

    rooms.base.advance = advanced
    try:
        for _ in range(6):  # walks of at most 100 frames
            result = rooms.run(skill(rooms.stage, action))
            if result.reason != failures.MAX_FRAMES:
                break
    finally:
        del rooms.base.advance
    return result, shares, min(nearest)


def leaf_known(rooms: TwoRooms) -> np.ndarray:
    """The hinge and the free end of the door's leaf as the robot remembers them [m], [2, 2]."""
    known = rooms.stage.doors.find("door_0")
    assert known is not None and known.leaf is not None
    return np.array(known.leaf)


@pytest.mark.parametrize("robot", ROBOTS)
@pytest.mark.parametrize("start", [HALL, FAR])
def test_a_door_opens_and_shuts_from_either_side(robot: str, start: object) -> None:
    """The hand gets to the handle first; the leaf takes a quarter turn in 4 s, and back in 4.5 s."""
    with two_rooms(spec(start=start), robot=robot) as rooms:  # type: ignore[arg-type]
        stage, side = rooms.stage, np.sign(rooms.stage.robot.base()[0] - HINGE[0])
        assert (shut_ones(stage), open_ones(stage)) == (("door_0",), ())
        result, shares, nearest = turning(rooms, OPEN)
        assert (result.ok, result.reason) == (True, "")  # type: ignore[attr-defined]
        assert rooms.share() == 1.0 and nearest < GRASP_REACH
        moving = [k for k, share in enumerate(shares) if 0.0 < share < 1.0]
        assert len(moving) + 1 == OPENING == moving[-1] - moving[0] + 2
        angles = np.arccos(1.0 - np.array(shares)[moving])
        assert np.diff(angles) == pytest.approx(np.full(OPENING - 2, math.pi / 2 / OPENING), abs=2e-3)
        assert (shut_ones(stage), open_ones(stage)) == ((), ("door_0",))
        assert np.sign(stage.robot.base()[0] - HINGE[0]) == side
        assert leaf_known(rooms) == pytest.approx(np.array([HINGE, HINGE - (DOOR.width, 0.0)]))
        result, shares, nearest = turning(rooms, SHUT)
        assert (result.ok, result.reason) == (True, "")  # type: ignore[attr-defined]
        assert rooms.share() == 0.0 and nearest < GRASP_REACH
        assert sum(0.0 < share < 1.0 for share in shares) + 1 == SHUTTING
        assert leaf_known(rooms) == pytest.approx(np.array([HINGE, HINGE + (0.0, DOOR.width)]))


@pytest.mark.parametrize("away", [0.45, 0.6, 0.75])
def test_a_robot_that_stands_too_near_to_the_handle_draws_back(away: float) -> None:
    """So near, the elbow meets the leaf before the hand gets to the handle; the door is shut at the first try."""
    handle = (HINGE + (-0.83, 0.0)).tolist()  # of a leaf that is open
    with two_rooms(spec(door=AJAR, start=AgentStart((handle[0] - 0.3, handle[1] + away), -math.pi / 2))) as rooms:
        result = rooms.run(skill(rooms.stage, SHUT))
        assert (result.ok, rooms.share()) == (True, 0.0) and result.frames < 330


def test_a_hand_pulls_the_moment_of_what_presses_and_the_usual_force() -> None:
    """NFPA 92: 22.2 N, and 100 N in the middle of 0.9 m pulled at 0.83 m; nothing more where it pushes along."""
    assert hinges.handle_force(100.0, 0.9) == pytest.approx(22.2 + 100.0 * 0.45 / 0.83)
    assert hinges.handle_force(-100.0, 0.9) == 22.2


def test_water_holds_a_door_that_opens_into_it_and_not_one_that_is_pushed_along() -> None:
    """Water at rest, rho g w / 2 (h^2 - k^2): more than 200 N here, 108 N at the handle; Fetch pulls with 59 N."""
    scene = dataclasses.replace(spec(), flood_side="west")
    with two_rooms(scene, ("flood",), "realistic") as rooms:
        still = rooms.stage.act()
        while float(rooms.world.fields["water"](torch.tensor([[[3.3, 2.0, 0.0]]]))[0, 0]) < 0.3:
            rooms.base.advance(still)
        for _ in range(90):  # until it has come to rest
            rooms.base.advance(still)
        pressing = float(rooms.world.openings.force[0, 0])
        beside = torch.tensor([[[HINGE[0] - 0.26, 2.0, 0.0], [HINGE[0] + 0.26, 2.0, 0.0]]], dtype=torch.float32)
        before, behind = rooms.world.fields["water"](beside)[0].tolist()
        assert pressing == pytest.approx(1000.0 * 9.81 * 0.9 * (before**2 - behind**2) / 2, rel=0.1)
        assert pressing > 200.0
        for _ in range(3):
            result = rooms.run(skill(rooms.stage, OPEN))
        assert (result.ok, result.reason) == (False, failures.HELD_SHUT)
        assert rooms.share() == 0.0
        rooms.world.openings.force[0, 0] = -pressing
        assert (
            Leaf(rooms.world, 0).force(True) == 22.2 < rooms.stage.robot.build.pull < Leaf(rooms.world, 0).force(False)
        )


def test_what_stands_in_the_swing_keeps_a_door_shut_and_what_is_light_is_pushed_away() -> None:
    """A leaf that needs 22 of 59 N pushes 37 N, and so slides up to 6.2 kg on a floor of friction 0.6."""
    chest = Fixture("chest", "cabinet", "plain_box", (3.1, 1.75, 0.0), scale=(0.3, 0.3, 0.5))
    crate = Body("crate", "box", "plain_box", (3.1, 1.75, 0.0), scale=(0.3, 0.3, 0.3), mass=20.0)
    light = dataclasses.replace(crate, mass=1.0)
    for thing, moves in ((chest, False), (crate, False), (light, True)):
        bodies, fixtures = ((thing,), ()) if isinstance(thing, Body) else ((), (thing,))
        with two_rooms(spec(bodies=bodies, fixtures=fixtures)) as rooms:
            result = turning(rooms, OPEN)[0]
            assert result.reason == ("" if moves else failures.IN_THE_SWING), thing  # type: ignore[attr-defined]
            assert (rooms.share() == 1.0) is moves
            if moves:
                assert float(rooms.world.position[0, rooms.index("crate"), 1]) < 1.55 - 0.02 - 0.14  # beyond the leaf


def test_a_leaf_does_not_turn_against_another_robot() -> None:
    build = SimpleNamespace(radius=0.28)
    standing = SimpleNamespace(base=lambda: (3.1, 1.75, 0.0), hand=lambda: (3.1, 1.75, 1.0), build=build)
    with two_rooms(spec()) as rooms:
        rooms.stage.others = (standing,)  # type: ignore[assignment]
        assert turning(rooms, OPEN)[0].reason == failures.IN_THE_SWING  # type: ignore[attr-defined]
        rooms.stage.others = ()
        assert turning(rooms, OPEN)[0].ok  # type: ignore[attr-defined]


def test_what_cannot_be_opened_says_why() -> None:
    doorway = Opening("doorway", "middle", 0.7, 0.9, 2.05)
    with two_rooms(spec(openings=(doorway,))) as rooms:
        stage = rooms.stage
        assert rooms.run(skill(stage, Action("open", "doorway_1"))).reason == failures.NO_LEAF
        stage.doors.known.clear()
        assert rooms.run(skill(stage, OPEN)).reason == failures.UNKNOWN
        rooms.look()
        rooms.world.openings.state.broken[0, 0] = True
        rooms.look()
        assert turning(rooms, SHUT)[0].reason == failures.BROKEN  # type: ignore[attr-defined]
        assert (shut_ones(stage), open_ones(stage)) == ((), ())


def test_windows_open_from_inside_and_are_not_broken_by_it() -> None:
    window = Opening("window", "north", 1.5, 1.0, 1.2, sill=0.9)
    with two_rooms(spec(openings=(window,)), physics="realistic") as rooms:
        result = turning(rooms, Action("open", "window_1"))[0]
        assert result.ok, result  # type: ignore[attr-defined]
        for _ in range(20):
            rooms.base.advance(rooms.stage.act())
        assert rooms.share(1) == pytest.approx(0.9) and not bool(rooms.world.openings.state.broken[0, 1])
        assert float(rooms.world.openings.width[0, 1]) == pytest.approx(0.9)
        assert turning(rooms, Action("shut", "window_1"))[0].ok and rooms.share(1) == 0.0  # type: ignore[attr-defined]


def test_a_saved_state_holds_how_far_a_door_has_turned() -> None:
    with two_rooms(spec(door=AJAR)) as rooms:
        rooms.world.openings.set_open(ONE, 0, 0.3)
        saved = rooms.base.get_state_dict()
        rooms.world.openings.set_open(ONE, 0, 1.0)
        rooms.base.set_state_dict(saved)
        assert rooms.share() == pytest.approx(0.3) and SIZE[0] > HINGE[0]


@pytest.mark.parametrize(("share", "nearest", "farthest"), [(1.0, 0.0, 0.3), (0.0, 0.3, 1.0)])
def test_a_walk_leads_into_an_open_doorway_and_up_to_a_shut_door(share: float, nearest: float, farthest: float) -> None:
    """The door is at x = 3.5 m, y = 2 m, and the walk begins 2 m from it."""
    with two_rooms(spec(dataclasses.replace(DOOR, open=share))) as rooms:
        for _ in range(4):  # walks of at most 100 frames
            result = rooms.run(skill(rooms.stage, Action("walk_to", "door_0")))
            if result.reason != failures.MAX_FRAMES:
                break
        x, y, _ = rooms.stage.robot.base()
        assert result.ok and nearest <= np.hypot(x - 3.5, y - 2.0) <= farthest + 0.05


@pytest.mark.parametrize(("start", "side"), [((1.5, 3.4), -1.0), ((1.5, 1.0), 1.0), ((5.5, 3.4), -1.0)])
def test_a_door_is_shut_from_the_side_from_which_the_robot_comes(start: tuple[float, float], side: float) -> None:
    """From the north-west the way leads round by the north-east and the south-east: it does not shut itself in."""
    south = dataclasses.replace(AJAR, centre=1.3)
    ways = (Opening("doorway", "middle", 3.3, 0.9, 2.05), Opening("doorway", "across", 5.3, 0.9, 2.05))
    scene = spec(door=south, start=AgentStart(start, 0.0), openings=ways)
    room = dataclasses.replace(scene.room, partitions=(*scene.room.partitions, Partition("across", "x", 2.6)))
    with two_rooms(dataclasses.replace(scene, room=room)) as rooms:
        leaf = Leaf(rooms.world, 0)
        assert home_side(rooms.stage, leaf) == side
        assert turning(rooms, SHUT)[0].ok  # type: ignore[attr-defined]
        assert np.sign(leaf.side(*rooms.stage.robot.base()[:2])) == side


def test_where_no_floor_around_a_door_was_seen_there_is_no_place_to_stand_at() -> None:
    """The floor within 1.5 m of the handle, which is farther than arms reach."""
    with two_rooms(spec()) as rooms:
        leaf, seen = Leaf(rooms.world, 0), rooms.stage.seen
        sides = (1.0, -1.0)
        assert any(stand(rooms.stage, leaf, 0.0, side) for side in sides)
        y, x = np.indices(seen.explored.shape)
        middles = seen.origin + (np.stack([x, y], -1) + 0.5) * seen.cell
        seen.explored &= np.linalg.norm(middles - leaf.handle()[:2], axis=-1) > 1.5
        assert [stand(rooms.stage, leaf, 0.0, side) for side in sides] == [None, None]
