"""Bounds on Value: worked examples on a line, and plans of real scenes, which stay below them."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from hazard_ms.robots.fetch import HazardFetch
from hazard_ms.sketch.bound import BAG, PICK, STOW, bound
from hazard_ms.sketch.planning.orienteering import solve
from hazard_ms.sketch.recording import record
from hazard_ms.sketch.rescue_problem import Outset, RescueScene
from hazard_ms.spec import AgentStart
from hazard_ms.tasks import task_of
from tests.worlds.halls import CART, SIZE, future, hall

FETCH = HazardFetch.build
HALF = SIZE * 3**0.5 / 2  # half of a box's longest diagonal [m]
# Farthest horizontal distance at which Fetch can touch a box: shoulder, arm, assisted grasp, half of the box [m]
TOUCH = 0.15 + 0.95 + 0.15 + HALF


def test_one_box_is_safe_after_the_shortest_walk_and_pick_up() -> None:
    spec = hall(5.0)
    soonest = 62 * (5.0 - TOUCH) + PICK + BAG
    assert bound(future(spec), spec, FETCH, [5.0], int(soonest)) == 0.0
    assert bound(future(spec), spec, FETCH, [5.0], int(soonest) + 1) == 1.0
    late, early = future(spec, damaged=int(soonest)), future(spec, damaged=int(soonest) + 2)
    assert [bound(line, spec, FETCH, [5.0], 300) for line in (late, early)] == [0.5, 1.0]
    assert bound(late, spec, FETCH, [5.0], 300, strict=True) == 1.0


def test_the_second_box_is_reached_from_where_the_first_was_touched() -> None:
    spec = hall(5.0, 9.0)
    both = 62 * (5.0 - TOUCH) + 62 * (4.0 - 2 * TOUCH) + 2 * (PICK + BAG)
    assert bound(future(spec), spec, FETCH, [5.0, 1.0], int(both) + 1) == 1.0
    assert bound(future(spec), spec, FETCH, [5.0, 1.0], int(both)) == pytest.approx(5 / 6)


def test_a_box_is_carried_to_the_cart() -> None:
    spec = hall(5.0, cart=-4.0)
    spec = dataclasses.replace(spec, agent_start=AgentStart((6.0, 3.0)))
    away = 62 * (9.0 - TOUCH - (0.15 + 0.95 + 0.15 + CART * 3**0.5 / 2))
    soonest = PICK + away + STOW
    # a frame of the record more or less, since what moves may be met between two
    assert bound(future(spec), spec, FETCH, [1.0], int(soonest) + 1) == 1.0
    assert bound(future(spec), spec, FETCH, [1.0], int(soonest) - 11) == 0.0


def test_what_flees_faster_than_a_robot_drives_is_never_met_unless_it_is_near() -> None:
    fast = 0.03  # [m per frame]; a robot drives 0.0161 m in a frame
    spec = hall(4.0, cart=0.0)
    assert bound(future(spec, fast), spec, FETCH, [1.0], 300) == 0.0
    assert bound(future(spec, -fast), spec, FETCH, [1.0], 300) == 1.0
    near = hall(1.2, cart=0.0)
    assert bound(future(near, fast), near, FETCH, [1.0], 300) == 1.0


def test_what_becomes_safe_by_itself_counts() -> None:
    spec = hall(20.0, 5.0, cart=5.0)
    assert bound(future(spec, alone=True), spec, FETCH, [5.0, 1.0], 100) == pytest.approx(5 / 6)


def test_values_must_be_as_many_as_targets() -> None:
    spec = hall(5.0)
    with pytest.raises(ValueError, match="values must be 1, one for each target, got 2"):
        bound(future(spec), spec, FETCH, [1.0, 1.0], 300)


@pytest.mark.parametrize("env_id", ["HazardFire-v1"])
def test_no_plan_at_usual_times_is_worth_more_than_the_bound(env_id: str) -> None:
    task = task_of(env_id, "paper")
    specs = [task.build(name) for name in task.scenes("test")[:3]]
    for spec, line in zip(specs, record(task, "paper", specs, range(3), 900), strict=True):
        targets = np.array([line.index(target.name) for target in spec.targets])
        worth = np.arange(1.0, len(targets) + 1.0)
        outset = Outset(spec.agent_start.position, spec.agent_start.heading, 0)
        scene = RescueScene(spec, "fetch", FETCH.radius, 900)
        plan = solve(scene.problem(line, targets, worth, np.zeros(0, np.int64), outset))
        least, most = (bound(line, spec, FETCH, worth.tolist(), 900, strict) for strict in (False, True))
        assert 0.0 < plan.value / worth.sum() <= least <= most <= 1.0
