"""In water a course must avert more than in fire, since what drifts delays it; in fire rescues are delayed."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from hazard_ms.agents.mitigating.choice import LEAST_GAIN, LEAST_IN_WATER, UNPLANNED, Chooser
from hazard_ms.sketch.planning.beginning import Course, Step
from hazard_ms.sketch.planning.problem import Plan, Problem
from hazard_ms.sketch.planning.travel import StaticTravel
from hazard_ms.spec import Task
from hazard_ms.tasks.house import hazard_house_fire, hazard_house_flood

AT_RISK = Problem(StaticTravel(np.ones((3, 3))), [60.0, 40.0], [500.0, np.inf], [50.0] * 2, [4.0] * 2, limit=1000.0)
PLAN = Plan((), 0.0, 0.0, True, 0.0, 1)


@pytest.mark.parametrize(("task", "share"), [(hazard_house_fire(), LEAST_GAIN), (hazard_house_flood(), LEAST_IN_WATER)])
def test_a_course_must_avert_a_share_of_what_is_at_risk(task: Task, share: float) -> None:
    """60 are at risk: what is never damaged does not count."""
    base: Any = SimpleNamespace(task=task)
    steps = (Step(0, 100.0, 300.0),)
    for more, worth in ((0.9, False), (1.1, True)):
        course = Course(None, steps, PLAN, 20.0 + more * share * 60.0, 20.0)
        assert Chooser(base)._is_worth_it(course, AT_RISK) == worth
    assert not Chooser(base)._is_worth_it(Course(None, (), PLAN, 99.0, 0.0), AT_RISK)


@pytest.mark.parametrize(("task", "more"), [(hazard_house_fire(), UNPLANNED), (hazard_house_flood(), 0.0)])
def test_a_fight_is_weighed_against_rescues_as_long_as_they_take(task: Task, more: float, monkeypatch: Any) -> None:
    """A plan of rescues that all come in time leaves nothing to fight for: what is lost hangs on what delays them."""
    base: Any = SimpleNamespace(task=task)
    asked = list[Problem]()
    monkeypatch.setattr(Chooser, "_lost", lambda self, problem: asked.append(problem) or [])
    Chooser(base).course(AT_RISK, [0, 1], Any, (0.0, 0.0), -1, ())  # type: ignore[arg-type]
    assert [list(problem.pick) for problem in asked] == [[50.0 + more] * 2]
