"""References for teams: worked examples in a hall, and real scenes, where no plan is above its bound."""

from __future__ import annotations

import dataclasses

import pytest

from hazard_ms.robots.fetch import HazardFetch
from hazard_ms.sketch.bound import BAG, PICK, bound
from hazard_ms.sketch.recording import record
from hazard_ms.sketch.teams.plans import team_bound, team_plan
from hazard_ms.spec import AgentStart
from hazard_ms.spec.catalogue import value_of
from hazard_ms.tasks import task_of
from tests.sketch.test_bound import FETCH, TOUCH
from tests.worlds.halls import future, hall

MIDDLE = (11.0, 3.0)  # 5 m from both boxes [m]


def test_two_robots_reach_both_ends_of_a_hall_in_the_time_of_one_walk() -> None:
    spec = dataclasses.replace(hall(5.0, 15.0), agent_start=AgentStart(MIDDLE))
    soonest = int(62 * (5.0 - TOUCH) + PICK + BAG)
    for robots, shares in ((1, (0.0, 5 / 6)), (2, (0.0, 1.0))):
        bounds = [team_bound(future(spec), spec, FETCH, [5.0, 1.0], soonest + k, [MIDDLE] * robots) for k in (0, 1)]
        assert bounds == pytest.approx(shares)


def test_each_robot_is_as_far_as_its_start_says() -> None:
    spec = hall(5.0, 15.0)  # 5 and 15 m from where the first starts
    soonest = int(62 * (5.0 - TOUCH) + PICK + BAG)
    starts = [(1.0, 3.0), (21.0, 3.0)]
    assert team_bound(future(spec), spec, FETCH, [1.0, 1.0], soonest + 1, starts) == 1.0
    assert team_bound(future(spec), spec, FETCH, [1.0, 1.0], soonest + 1, starts[:1] * 2) == 0.5


def test_damage_halves_unless_it_is_ignored_and_what_becomes_safe_by_itself_counts() -> None:
    spec = hall(5.0)
    late = future(spec, damaged=100)
    shares = [team_bound(late, spec, FETCH, [1.0], 300, [(1.0, 3.0)] * 2, strict) for strict in (False, True)]
    assert shares == [0.5, 1.0]
    assert team_bound(future(spec, alone=True), spec, FETCH, [1.0], 60, [(1.0, 3.0)] * 2) == 1.0
    with pytest.raises(ValueError, match="values must be 1, one for each target, got 2"):
        team_bound(late, spec, FETCH, [1.0, 1.0], 300, [(1.0, 3.0)])


def test_the_best_plan_at_usual_times_is_below_the_bound_and_more_robots_do_more() -> None:
    task = task_of("HazardFire-v1", "paper")
    specs = [task.build(name) for name in task.scenes("test")[:3]]
    gained = 0
    for spec, line in zip(specs, record(task, "paper", specs, range(3), 600), strict=True):
        values, begin = [float(value_of(target)) for target in spec.targets], spec.agent_start.position
        plans = [team_plan(line, spec, "fetch", values, 600, [begin] * robots) for robots in (1, 2, 3)]
        bounds = [team_bound(line, spec, HazardFetch.build, values, 600, [begin] * robots) for robots in (1, 2, 3)]
        assert bounds[0] == pytest.approx(bound(line, spec, HazardFetch.build, values, 600))
        assert all(0.0 < plan <= most <= 1.0 for plan, most in zip(plans, bounds, strict=True))
        assert plans == sorted(plans) and bounds == sorted(bounds)
        gained += plans[0] < plans[1]
    assert gained > 0
