"""Courses of measures and rescues: worked examples, and small problems in which every order is tried."""

from __future__ import annotations

import dataclasses
from itertools import permutations

import numpy as np
import pytest

from hazard_ms.sketch.planning.beginning import Course, best_course
from hazard_ms.sketch.planning.measures import Measure, Measures
from hazard_ms.sketch.planning.problem import Problem
from hazard_ms.sketch.planning.travel import MovingTravel, StaticTravel, straight_line

LIMIT = 1000.0
INF = np.inf


def on_a_line(targets: list[float], measures: list[float]) -> tuple[StaticTravel, dict[str, np.ndarray]]:
    """Ways between targets and measures at these places [m] on a line, 100 frames a metre, from the start at 0."""
    nodes, places = np.array([*targets, 0.0]), np.array(measures)
    ways = {
        "to": 100.0 * np.abs(nodes[:, None] - places),
        "between": 100.0 * np.abs(places[:, None] - places),
        "onward": 100.0 * np.abs(places[:, None] - nodes[:-1]),
    }
    return StaticTravel(100.0 * np.abs(nodes[:, None] - nodes)), ways


def problem(travel: StaticTravel, values: list[float], damaged: list[float], **rest: object) -> Problem:
    """Rescues that take 50 frames each beside the ways."""
    count = len(values)
    return Problem(travel, values, damaged, [46.0] * count, [4.0] * count, **{"limit": LIMIT, **rest})  # type: ignore[arg-type]


def names(course: Course, measures: Measures) -> list[str]:
    return [measures.measures[step.measure].name for step in course.steps]


def test_a_door_is_shut_first_where_that_saves_more_than_it_delays() -> None:
    """Two targets burn at 300 and 400, each 2 m away on either side. Without the door one is saved, with it both are.

    The door: 100 frames of way, 50 to shut it: done at 150. Then 3 m and 50 frames to one: 500, 4 m and 50: 950.
    """
    travel, ways = on_a_line([2.0, -2.0], [-1.0])
    given = problem(travel, [10.0, 8.0], [300.0, 400.0])
    shut = Measures([Measure("shut", 50.0, [INF, INF])], **ways)
    course = best_course(given, shut)
    assert course.steps == ((0, 100.0, 150.0),) and course.before is None
    assert course.plain == pytest.approx(9.0 + 10.0 * 0.6 + 8.0 * 0.05)
    assert course.value == pytest.approx(9.0 + 18.0 * 0.5 + 18.0 * 0.1)
    assert [(r.target, r.safe) for r in course.plan.rescues] == [(1, 300.0), (0, 750.0)]
    late = best_course(given, Measures([Measure("shut", 301.0, [INF, INF])], **ways))
    assert late.steps == () and late.value == late.plain == course.plain


def test_what_was_damaged_before_the_measure_is_done_stays_damaged() -> None:
    """The door is shut at 150: it saves what burns at 150, not what burned at 149."""
    travel, ways = on_a_line([2.0, -2.0], [-1.0])
    shut = Measures([Measure("shut", 50.0, [INF, INF])], **ways)
    at = [best_course(problem(travel, [10.0, 10.0], [149.0, by]), shut).value for by in (150.0, 149.9)]
    assert at == pytest.approx([10.0 + 10.0 * 0.05 + 10.0 * 0.6, 10.0 + 2 * 10.0 * 0.05])


def test_what_is_behind_a_shut_door_is_left_there() -> None:
    """With 1000 frames both targets could be carried off afterwards, but for the one behind the door."""
    travel, ways = on_a_line([2.0, -2.0], [-1.0])
    given = problem(travel, [10.0, 8.0], [300.0, 400.0])
    course = best_course(given, Measures([Measure("shut", 50.0, [INF, INF], closes=(1,))], **ways))
    assert course.value == pytest.approx(9.0 + 18.0 * 0.5 + 10.0 * 0.1)
    assert [r.target for r in course.plan.rescues] == [0]


def test_a_door_keeps_what_is_behind_it_from_being_carried_off() -> None:
    """Water carries two targets off at 300 and 149; the door is shut at 150. Without it one is fetched, by 250."""
    travel, ways = on_a_line([2.0, -2.0], [-1.0])
    given = problem(travel, [10.0, 8.0], [INF, INF], limit=400.0, gone_at=[300.0, 149.0])
    shut = Measures([Measure("shut", 50.0, [INF, INF], stays_until=[INF, INF])], **ways)
    course = best_course(given, shut)
    assert course.plain == pytest.approx(11.0)
    assert [s.done for s in course.steps] == [150.0]
    assert course.value == pytest.approx(10.0 + 8.8)  # it is carried off already, but is fetched by 300


def test_a_rescue_comes_before_the_measure_where_there_is_time_for_both() -> None:
    """A target at 0.5 m burns at 110, safe at 100; the one at 6 m would burn at 500, too late to be carried off."""
    travel, ways = on_a_line([0.5, 6.0], [1.0])
    given = problem(travel, [10.0, 10.0], [110.0, 500.0])
    course = best_course(given, Measures([Measure("shut", 50.0, [0.0, INF])], **ways))
    assert course.before is not None and course.before.target == 0 and course.before.safe == 100.0
    assert course.steps == ((0, 150.0, 200.0),)
    assert course.value == pytest.approx(10.0 + 10.0 * 0.6 + 10.0 * 0.6)


def test_a_fire_is_fought_with_what_was_fetched_while_it_lasts() -> None:
    """The extinguisher is 0.5 m away (40 frames), the fires 1.5 and 2.5 m from there; a fire takes 60 frames of jet."""
    travel, ways = on_a_line([5.0, 5.0], [-0.5, 1.0, 2.0])
    given = problem(travel, [10.0, 9.0], [420.0, 470.0], limit=600.0)
    for charge, fires in ((100.0, ["fire 0"]), (120.0, ["fire 0", "fire 1"])):
        measures = Measures(
            [
                Measure("fetch", 40.0, [0.0, 0.0], charge=charge),
                Measure("fire 0", 60.0, [INF, 0.0], needs=0, uses=60.0),
                Measure("fire 1", 60.0, [0.0, INF], needs=0, uses=60.0),
            ],
            **ways,
        )
        course = best_course(given, measures)
        assert names(course, measures) == ["fetch", *fires]
        assert [step.done for step in course.steps[:2]] == [90.0, 300.0]
        assert course.value == pytest.approx(9.5 + (5.0 if charge == 100.0 else 9.5))


def test_what_is_in_the_hand_is_used_or_put_down() -> None:
    """With the extinguisher in the hand a fire is fought at once; before a door it is put down, 20 frames."""
    travel, ways = on_a_line([5.0], [-1.0, 1.0, 1.0])
    given = problem(travel, [10.0], [300.0], limit=400.0)
    kinds = {
        "fire": Measure("fire", 60.0, [INF], needs=0, uses=60.0),
        "door": Measure("door", 60.0, [INF]),
    }
    for name, done in (("fire", 160.0), ("door", 180.0)):
        row = [Measure("fetch", 40.0, [0.0], charge=70.0), kinds[name], kinds[name]]
        course = best_course(given, Measures(row, **ways, in_hand=0, put_down=20.0))
        assert [step.done for step in course.steps] == [done]
        assert course.steps[0].measure in (1, 2)
    empty = [Measure("fetch", 40.0, [0.0], charge=50.0), kinds["fire"], kinds["fire"]]
    assert best_course(given, Measures(empty, **ways, in_hand=0, put_down=20.0)).steps == ()


def test_what_is_in_the_hand_is_rescued_first() -> None:
    travel, ways = on_a_line([2.0, -2.0], [-1.0])
    given = problem(travel, [10.0, 8.0], [300.0, 400.0], holding=0)
    course = best_course(given, Measures([Measure("shut", 50.0, [INF, INF])], **ways))
    assert course.before is None or (course.before.target, course.before.safe) == (0, 4.0)
    assert course.value >= 9.0 + 10.0 * 0.6 + 8.0 * 0.6 - 1e-9


def drawn(seed: int) -> tuple[Problem, Measures]:
    """Three targets, an extinguisher, two fires and a door, anywhere; ways that are not symmetric."""
    draw = np.random.default_rng(seed)
    travel = StaticTravel(draw.uniform(20, 200, (4, 4)))
    spared = np.where(draw.random((4, 3)) < 0.6, INF, draw.uniform(100, 1200, (4, 3)))
    given = problem(travel, draw.choice([1.0, 5.0, 20.0], 3).tolist(), draw.uniform(150, 500, 3).tolist())
    measures = [
        Measure("fetch", 40.0, [0.0] * 3, charge=100.0),
        Measure("fire 0", 60.0, spared[1].tolist(), needs=0, uses=60.0),
        Measure("fire 1", 40.0, spared[2].tolist(), needs=0, uses=50.0),
        Measure("door", 50.0, spared[3].tolist()),
    ]
    sizes = {"to": (4, 4), "between": (4, 4), "onward": (4, 3)}
    ways = {name: draw.uniform(20, 200, size) for name, size in sizes.items()}
    return dataclasses.replace(given, limit=800.0), Measures(measures, **ways, put_down=20.0)


def worth(given: Problem, measures: Measures, order: tuple[str | int, ...]) -> float | None:
    """What an order of measures (by name) and rescues (by number) averts, with 0.1 of its Value; None if too late."""
    table = np.array(given.travel._rows)  # type: ignore[attr-defined]
    index = {m.name: k for k, m in enumerate(measures.measures)}
    whole, safe_at, frame, here, charge = np.array(given.damaged_at), np.full(3, INF), 0.0, ("node", 3), None
    for what in order:
        there = ("node", what) if isinstance(what, int) else ("measure", index[what])
        if what in ("door", 0, 1, 2) and charge is not None:
            frame, charge = frame + measures.put_down, None
        kinds = here[0], there[0]
        ways = {("node", "node"): table, ("node", "measure"): measures.to, ("measure", "node"): measures.onward}
        frame += ways.get(kinds, measures.between)[here[1], there[1]]
        here = there
        if isinstance(what, int):
            frame = safe_at[what] = frame + 50.0
            continue
        measure = measures.measures[index[what]]
        frame += measure.frames
        if what == "fetch":
            charge = measure.charge
        elif what != "door":
            if charge is None or charge < measure.uses:
                return None
            charge -= measure.uses
        whole = np.where(whole < frame, whole, np.maximum(whole, measure.spared_until))
    if frame > given.limit:
        return None
    values, damaged = np.array(given.values), np.minimum(safe_at, given.limit) > whole
    value = np.where(damaged, 0.5, 1.0) * values
    return float((np.where(damaged, 0.5, 1.0) * values).sum() + 0.1 * value[np.isfinite(safe_at)].sum())


def test_no_course_is_better_than_the_best_order_of_all_and_most_are_as_good() -> None:
    """The value of each course is what its own steps are worth, and of 60 random problems 50 are solved exactly."""
    equal = fought = 0
    for seed in range(60):
        given, measures = drawn(seed)
        every: list[str | int] = [0, 1, 2, "fetch", "fire 0", "fire 1", "door"]
        orders = (order for n in range(6) for order in permutations(every, n))
        best = max(value for order in orders if (value := worth(given, measures, order)) is not None)
        course = best_course(given, measures)
        first = [] if course.before is None else [course.before.target]
        own = worth(given, measures, (*first, *names(course, measures), *(r.target for r in course.plan.rescues)))
        assert own == pytest.approx(course.value)
        length = len(first) + len(course.steps) + len(course.plan.rescues)
        assert course.plain - 1e-9 <= course.value and (course.value <= best + 1e-9 or length > 5)
        equal += course.value >= best - 1e-9
        fought += bool(course.steps)
    assert equal >= 50 and fought >= 30


def test_fading_counts_from_now_whatever_comes_first() -> None:
    """After a measure of 50 frames and its way of 100, a rescue that is safe at 300 counts 1 - 0.0005 * 300 of 8."""
    travel, ways = on_a_line([2.0, -2.0], [-1.0])
    given = problem(travel, [10.0, 8.0], [300.0, 400.0], fading=0.0005)
    course = best_course(given, Measures([Measure("shut", 50.0, [INF, INF])], **ways))
    rescues = 0.1 * (8.0 * (1 - 0.0005 * 300.0) + 10.0 * (1 - 0.0005 * 750.0))
    assert course.value == pytest.approx(18.0 + rescues)


def test_what_does_not_fit_is_refused() -> None:
    travel, ways = on_a_line([2.0, -2.0], [-1.0])
    given = problem(travel, [10.0, 8.0], [300.0, 400.0])
    with pytest.raises(ValueError, match="spared_until of shut must have 2 frames, got 1"):
        best_course(given, Measures([Measure("shut", 50.0, [INF])], **ways))
    with pytest.raises(ValueError, match=r"onward must have shape \(1, 2\), got \(1, 3\)"):
        Measures([Measure("shut", 50.0, [INF] * 2)], **{**ways, "onward": np.zeros((1, 3))})
    with pytest.raises(ValueError, match="a tool must be the number of a measure that fetches one"):
        Measures([Measure("fire", 50.0, [INF] * 2, needs=0)], **ways)
    with pytest.raises(ValueError, match=r"to must have shape \(3, K\) for this problem, got \(2, 1\)"):
        best_course(given, Measures([Measure("shut", 50.0, [INF] * 2)], ways["to"][1:], ways["between"], [[0.0]]))
    moving = MovingTravel([0], np.zeros((1, 2, 1)), [0.0], straight_line(62.0))
    with pytest.raises(ValueError, match="must be a StaticTravel .*, got MovingTravel"):
        best_course(dataclasses.replace(given, travel=moving), Measures([Measure("a", 1.0, [INF] * 2)], **ways))
