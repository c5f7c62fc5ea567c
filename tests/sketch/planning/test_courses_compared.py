"""Courses whose measures change the ways, and those that rescues alone must be better than by a margin."""

from __future__ import annotations

import numpy as np
import pytest

from hazard_ms.sketch.planning.beginning import best_course
from hazard_ms.sketch.planning.measures import Changed, Measure, Measures
from tests.sketch.planning.test_beginning import INF, names, on_a_line, problem


def test_rescues_alone_must_be_better_by_the_margin() -> None:
    """The door that comes too late is shut all the same where rescues alone are better by less than the margin."""
    travel, ways = on_a_line([2.0, -2.0], [-1.0])
    given = problem(travel, [10.0, 8.0], [300.0, 400.0])
    late = Measures([Measure("shut", 301.0, [INF, INF])], **ways)
    # one is rescued first, at 250, then the door is shut by 851: 10.0 + 5.0 is 0.4 less than rescues alone have
    for margin, steps in ((0.3, 0), (0.5, 1)):
        course = best_course(given, late, margin=margin)
        assert len(course.steps) == steps
        assert course.plain == pytest.approx(9.0 + 10.0 * 0.6 + 8.0 * 0.05)
        assert course.value <= course.plain
        assert steps or course.value == course.plain


def test_a_shut_door_bars_the_ways_to_the_next_door_and_to_targets() -> None:
    """Both doors are done by 350, and what is 1 m to the west is fetched by 700; if the first bars it, by nobody."""
    travel, ways = on_a_line([3.0, 4.0, -1.0], [1.0, 2.0])
    given = problem(travel, [10.0, 9.0, 9.0], [350.0, 350.0, 750.0], limit=800.0)
    shut = [Measure("door 0", 50.0, [INF, 0.0, 0.0]), Measure("door 1", 50.0, [0.0, INF, 0.0])]
    free = best_course(given, Measures(shut, **ways))
    assert sorted(names(free, Measures(shut, **ways))) == ["door 0", "door 1"]
    asked: list[tuple[int, ...]] = []

    def changed(done: tuple[int, ...]) -> Changed:
        asked.append(done)
        return Changed(np.full(2, INF), np.full(3, INF), np.where(np.eye(3) > 0, 0.0, INF))

    course = best_course(given, Measures(shut, **ways, changed=changed))
    assert len(course.steps) <= 1 and not (course.steps and course.plan.rescues)
    assert asked and course.value < free.value


def test_no_second_door_is_shut_to_which_the_first_bars_the_way() -> None:
    """The targets are reached as before, so that nothing but the way from door to door keeps it from shutting both."""
    travel, ways = on_a_line([3.0, 4.0], [1.0, 2.0])
    given = problem(travel, [10.0, 9.0], [250.0, 350.0])
    shut = [Measure("door 0", 50.0, [INF, 0.0]), Measure("door 1", 50.0, [0.0, INF])]
    table = np.array([[0.0, 100.0], [100.0, 0.0]])

    def changed(done: tuple[int, ...]) -> Changed:
        return Changed(np.full(2, INF), ways["onward"][done[-1]], table)

    both, one = (best_course(given, Measures(shut, **ways, **rest)) for rest in ({}, {"changed": changed}))
    assert (len(both.steps), len(one.steps)) == (2, 1)
