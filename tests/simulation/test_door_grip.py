"""Hands that hold handles, and the leaves that follow them: against an arc that is worked out here."""

from __future__ import annotations

import dataclasses
import math

import pytest
import torch
from torch import Tensor

from hazard_ms.robots.fetch import HazardFetch
from hazard_ms.simulation.building import make_world
from hazard_ms.simulation.mitigation.door_grip import DoorGrip
from hazard_ms.simulation.world import World
from hazard_ms.spec import AgentStart, Body, Fixture, Opening, Partition, Room, SceneSpec
from hazard_ms.tasks.episode.grasp import Hand, lead_doors

DT = 1.0 / 30.0  # [s]
WIDE, FAR, HIGH = 0.9, 0.83, 1.0  # of the leaf; its handle from the hinge, and above the floor [m] [NFPA 92; ADA]
FASTEST = math.radians(90.0) / 4.0 * DT  # in a frame [rad] [ANSI/BHMA A156.19: a quarter turn in 4 s]
# by the axis along which the wall runs: the place of the hinge, and where bearings of 0 and a quarter turn lead from it
WALLS = {"y": ((3.5, 1.55), (0.0, 1.0), (-1.0, 0.0)), "x": ((1.55, 3.5), (1.0, 0.0), (0.0, -1.0))}


def scene(axis: str = "y", kind: str = "door", things: tuple[Body | Fixture, ...] = ()) -> SceneSpec:
    room = Room(
        (7.0, 7.0), openings=(Opening(kind, "middle", 2.0, WIDE, 2.05),), partitions=(Partition("middle", axis, 3.5),)
    )
    bottle = Body("bottle_0", "bottle", "plain_box", (6.7, 0.3, 0.0), scale=(0.08, 0.08, 0.2), mass=0.5)
    bodies = (bottle, *(thing for thing in things if isinstance(thing, Body)))
    fixtures = tuple(thing for thing in things if isinstance(thing, Fixture))
    return SceneSpec("test/door", room, fixtures, bodies, ("bottle",), (), AgentStart((6.0, 6.0)))


class Doors:
    """Scenes with hands at their doors, without a simulator."""

    def __init__(self, *scenes: SceneSpec) -> None:
        self.world: World = make_world(scenes, torch.device("cpu"))
        self.world.agent_build = HazardFetch.build
        self.grip = self.world.door_grip = DoorGrip(scenes, self.world.openings)
        self.hand = Hand.allocate({"E": len(scenes), "B": self.world.num_bodies}, "cpu")

    def frame(self, at: Tensor, shut: bool = True) -> Tensor:
        """Let a frame pass with the hands `at` [m], [E, 3]; the angles of the first doors [rad], [E]."""
        closed = torch.full((len(at),), shut)
        lead_doors(self.hand, self.world, at, closed, DT)
        self.hand.closed = closed
        return torch.acos(1.0 - self.world.openings.share[:, 0].double())


def on_arc(bearing: float, axis: str = "y", far: float = FAR, high: float = HIGH) -> Tensor:
    """A place [m], [1, 3], so `far` [m] from the hinge, at a `bearing` [rad] from the shut leaf."""
    (x, y), along, out = WALLS[axis]
    c, s = math.cos(bearing), math.sin(bearing)
    return torch.tensor([[x + far * (c * along[0] + s * out[0]), y + far * (c * along[1] + s * out[1]), high]])


@pytest.mark.parametrize("axis", WALLS)
def test_a_leaf_follows_the_hand_on_its_arc_as_far_behind_as_it_was_taken(axis: str) -> None:
    """Whatever the hand does towards the hinge, or up and down, and back again; never beyond its stops."""
    doors, ahead = Doors(scene(axis)), math.radians(4.0)
    assert float(doors.frame(on_arc(ahead, axis))[0]) == 0.0  # it is taken, and does not jump to the hand
    assert bool(doors.grip.state.holds[0, 0])
    degrees = [*(0.5 * k for k in range(1, 181)), *(90.0 - 0.5 * k for k in range(181))]
    for k, degree in enumerate(degrees):
        wanted = math.radians(degree)
        there = on_arc(ahead + wanted, axis, FAR + 0.05 * math.sin(k), HIGH + 0.05 * math.cos(k))
        assert float(doors.frame(there)[0]) == pytest.approx(wanted, abs=2e-4)
        handle = doors.grip.handles()[0, 0]
        torch.testing.assert_close(handle, on_arc(wanted, axis)[0], atol=2e-4, rtol=0.0)
    for degree in (-0.5, -1.0):  # against the frame
        assert float(doors.frame(on_arc(ahead + math.radians(degree), axis))[0]) == 0.0


def test_a_leaf_turns_no_faster_than_a_quarter_turn_in_four_seconds() -> None:
    doors = Doors(scene())
    doors.frame(on_arc(0.0))
    angles = [float(doors.frame(on_arc(math.radians(15.0)))[0]) for _ in range(25)]
    assert angles[:20] == pytest.approx([FASTEST * k for k in range(1, 21)], abs=1e-4)
    assert angles[20:] == pytest.approx([math.radians(15.0)] * 5, abs=1e-4)


def test_who_lets_go_leaves_the_door_as_it_is_and_so_does_who_slips_off() -> None:
    for slips in (False, True):
        doors = Doors(scene())
        for k in range(20):
            before = float(doors.frame(on_arc(0.7 * FASTEST * k))[0])
        gone = on_arc(before, far=FAR + 0.31) if slips else on_arc(before)
        doors.frame(gone, shut=slips)
        assert not doors.grip.state.holds.any()
        for _ in range(10):
            assert float(doors.frame(on_arc(before + 0.2))[0]) == before > 0.1
        assert not doors.grip.state.holds.any()


# of the hand from the handle [m], along the leaf, across it and upwards; whether it takes it: within 0.15 m
REACHES = (
    ((0.0, 0.14, 0.0), True),
    ((0.0, 0.16, 0.0), False),
    ((0.10, 0.10, 0.0), True),
    ((0.11, 0.11, 0.0), False),
    ((0.0, 0.0, -0.14), True),
    ((0.0, 0.0, 0.16), False),
    ((0.0, -0.14, 0.0), True),  # from the other side
)


@pytest.mark.parametrize(("off", "takes"), REACHES)
def test_a_hand_takes_a_handle_where_it_shuts_within_reach(off: tuple[float, float, float], takes: bool) -> None:
    along, across, up = off
    at = torch.tensor([[3.5 - across, 1.55 + FAR + along, HIGH + up]])
    doors = Doors(scene())
    doors.frame(at, shut=False)
    assert not doors.grip.state.holds.any()
    doors.frame(at)
    assert bool(doors.grip.state.holds[0, 0]) is takes
    arrives = Doors(scene())
    arrives.frame(at + 1.0)
    arrives.frame(at)
    assert not arrives.grip.state.holds.any()  # it was shut already


def test_a_hand_takes_a_thing_rather_than_a_handle() -> None:
    doors = Doors(scene())
    doors.world.position[0, 0] = on_arc(0.1)[0]
    doors.frame(on_arc(0.0))
    assert not doors.grip.state.holds.any()


def test_only_doors_between_rooms_that_have_a_leaf_can_be_taken() -> None:
    for made, broken in ((scene(kind="doorway"), False), (scene(), True)):
        doors = Doors(made)
        doors.world.openings.state.broken[:] = broken
        doors.frame(on_arc(0.0))
        assert not doors.grip.state.holds.any()
    doors = Doors(scene())
    doors.frame(on_arc(0.0))
    doors.world.openings.state.broken[:] = True
    doors.frame(on_arc(0.1))
    assert not doors.grip.state.holds.any() and float(doors.world.openings.state.open[0, 0]) == 0.0


def turned(doors: Doors) -> float:
    """The angle to which a hand leads the first door, that goes on to a quarter turn [rad]."""
    for k in range(130):
        angle = doors.frame(on_arc(min(FASTEST * k, math.pi / 2)))
        if not doors.grip.state.holds.any():
            break
    return float(angle[0])


def test_a_leaf_stops_before_a_robot_and_before_furniture_and_pushes_what_moves() -> None:
    """A disc in the swing stops it where the way from its middle to the leaf is its radius and half of the leaf."""
    free = Doors(scene())
    assert turned(free) == pytest.approx(math.pi / 2, abs=1e-3)
    for radius, robot in ((0.29, True), (0.2, False)):
        at = math.radians(60.0)
        place = on_arc(at, far=0.8)[0, :2]
        chest = Fixture("chest", "cabinet", "plain_box", (*place.tolist(), 0.0), scale=(2 * radius, 2 * radius, 0.5))
        doors = Doors(scene(things=() if robot else (chest,)))
        if robot:
            doors.world.agent_position[0, :2] = place
        assert turned(doors) == pytest.approx(at - math.asin((radius + 0.02) / 0.8), abs=1.1 * FASTEST)
    crate = Body("crate", "box", "plain_box", (*on_arc(1.0, far=0.8)[0, :2].tolist(), 0.0), mass=1.0)
    assert turned(Doors(scene(things=(crate,)))) == pytest.approx(math.pi / 2, abs=1e-3)


def test_what_presses_on_the_leaf_holds_it_against_the_arm() -> None:
    """Fetch pulls with the weight of 6 kg; at the handle it is 22.2 N and 0.45 / 0.83 of what presses on the middle."""
    most = (6.0 * 9.81 - 22.2) * FAR / 0.45
    for pressing, opens in ((most - 1.0, True), (most + 1.0, False), (-most - 1.0, True)):
        doors = Doors(scene())
        doors.world.openings.force[0, 0] = pressing
        assert (turned(doors) > 0.5) is opens


def test_each_door_of_a_batch_turns_as_it_would_alone() -> None:
    wide = dataclasses.replace(scene().room.openings[0], width=1.0, centre=2.05)
    two = dataclasses.replace(scene().room, openings=(wide, dataclasses.replace(wide, centre=5.0)))
    scenes = (scene(), scene(kind="doorway"), dataclasses.replace(scene(), room=two))
    together, apart = Doors(*scenes), [Doors(made) for made in scenes]
    for k in range(60):
        at = torch.cat([on_arc(0.9 * FASTEST * k), on_arc(0.0), on_arc(0.5 * FASTEST * k, far=0.93)])
        shut = k != 50
        every = together.frame(at, shut)
        for e, doors in enumerate(apart):
            assert float(doors.frame(at[e : e + 1], shut)[0]) == float(every[e])
            assert doors.grip.state.holds[0].sum() == together.grip.state.holds[e].sum()
    assert together.world.openings.state.open[2, 0] > 0.05 and float(together.world.openings.state.open[2, 1]) == 0.0
