"""Ways past doors that were shut: several close off what each alone does not, and the robot stands on its own side."""

from __future__ import annotations

import numpy as np

from hazard_ms.agents.mitigating.barred import BESIDE, Barred, nearer, sided
from hazard_ms.agents.mitigating.prospects import Prospect
from hazard_ms.sketch.futures.interventions import SHUT
from hazard_ms.sketch.rescue_problem import RescueScene
from hazard_ms.spec import AgentStart, Opening, Partition, Room, SceneSpec

# A hall at y > 3 m, south of it two rooms beside each other with a door to the hall each, and one between them
HOME = SceneSpec(
    name="test/home",
    room=Room(
        (8.0, 5.0),
        openings=(
            Opening("door", "hall", 1.5, 0.9, 2.0, open=1.0),
            Opening("door", "hall", 6.5, 0.9, 2.0, open=1.0),
            Opening("doorway", "column", 4.0, 1.6, 2.0),
            Opening("door", "column", 1.5, 0.9, 2.0, open=1.0),
        ),
        partitions=(Partition("hall", "x", 3.0), Partition("column", "y", 4.0)),
    ),
    fixtures=(),
    bodies=(),
    target_categories=("book",),
    fires=(),
    agent_start=AgentStart((1.5, 4.0), 0.0),
)
MIDDLES = {0: (1.5, 3.0), 1: (6.5, 3.0), 3: (4.0, 1.5)}
WEST, EAST, HALL = np.array([1.5, 1.0]), np.array([6.5, 1.0]), np.array([6.5, 4.2])
GOALS, EDGES = np.stack([WEST, EAST, HALL]), np.zeros(3)


def doors(spec: SceneSpec = HOME) -> list[Prospect]:
    made = [Prospect(SHUT, (n,), np.array(at), np.array(at), 0.0, 200.0) for n, at in MIDDLES.items()]
    return sided(spec, made)


def scene() -> RescueScene:
    return RescueScene(HOME, "fetch", 0.29, 3000)


def one(number: int, x: float, y: float) -> int:
    """The number of the prospect of a door from the side of a place."""
    far = [np.hypot(*(p.last - (x, y))) if p.numbers == (number,) else np.inf for p in doors()]
    return int(np.argmin(far))


def test_each_door_is_shut_from_either_side_of_its_wall() -> None:
    places = {tuple(np.round(p.last, 6).tolist()) for p in doors() if p.numbers == (0,)}
    assert places == {(1.5, 3.0 - BESIDE), (1.5, 3.0 + BESIDE)}


def test_a_door_is_shut_from_the_side_that_is_nearer() -> None:
    frames = np.array([[5.0, 3.0, 7.0, 8.0, np.inf, 4.0]])
    assert nearer(frames, doors()).tolist() == [[np.inf, 3.0, 7.0, np.inf, np.inf, 4.0]]


def test_doors_close_off_together_what_each_alone_does_not() -> None:
    """From the hall, the western room has two ways in: its door, and through the other room."""
    barred = Barred(scene(), GOALS, EDGES, doors())
    hall_0, hall_1 = one(0, 1.5, 4.0), one(1, 6.5, 4.0)
    first, both = barred((hall_0,)), barred((hall_0, hall_1))
    assert first is not None and both is not None
    assert np.isfinite(first.onward).all() and first.onward[0] > first.onward[1]  # through the eastern room
    assert np.isfinite(both.onward).tolist() == [False, False, True]
    assert np.isfinite(first.table[0, 2]) and not np.isfinite(both.table[2, 0])


def test_who_shuts_itself_in_gets_to_what_is_there_and_to_no_other_door() -> None:
    barred = Barred(scene(), GOALS, EDGES, doors())
    hall_0, west_3, west_0 = one(0, 1.5, 4.0), one(3, 3.0, 1.5), one(0, 1.5, 2.0)
    inside = barred((west_3, west_0))
    assert inside is not None
    assert np.isfinite(inside.onward).tolist() == [True, False, False]
    assert not np.isfinite(inside.between[[one(1, 6.5, 4.0), one(1, 6.5, 2.0), hall_0]]).any()


def test_nothing_is_barred_before_a_door_is_shut() -> None:
    assert Barred(scene(), GOALS, EDGES, doors())(()) is None
    fire = doors()[0]._replace(kind="out")
    assert Barred(scene(), GOALS, EDGES, [fire])((0,)) is None
