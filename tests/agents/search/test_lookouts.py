"""Where to search: what unseen floor is, which places show most of it, and that each counts what others leave."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hazard_ms.agents.search.lookouts import FROM_AFAR, HIDDEN, lookouts, unseen_floor
from hazard_ms.sensing.detection.eyes import FAR
from hazard_ms.skills.decision import Decision
from tests.worlds.playground import Playground

HERE = (0.0, 0.0)  # where it has looked around [m]


def looked(places: dict[str, tuple[float, float]], sight: float = 3.0) -> Decision:
    """What is known after a look around from the origin, by which all of `places` are known."""
    ground = Playground(places, {}, sight=20.0)
    ground.look()
    ground.map.explored[:] = False
    ground.sight = sight
    ground.look()
    return ground.decision()


def test_unseen_floor_lies_beyond_the_border_of_what_was_seen() -> None:
    """A ring of 2 m around a disc of 3 m."""
    seen = looked({}).map
    ring = unseen_floor(seen)
    y, x = np.nonzero(ring)
    far = np.hypot(seen.origin[0] + (x + 0.5) * 0.1, seen.origin[1] + (y + 0.5) * 0.1)
    assert 2.9 < far.min() and far.max() < 5.1
    assert not (ring & seen.explored).any()


def test_nothing_is_unseen_behind_walls() -> None:
    """A wall of half a metre around the floor that was seen: no floor borders on what was not."""
    decision = looked({})
    seen = decision.map
    y, x = np.nonzero(seen.explored)
    outer = np.hypot(*(seen.origin + 0.1 * (np.stack([x, y], -1) + 0.5)).T) > 2.5
    seen._firm[y[outer], x[outer]] = 1.0
    assert not unseen_floor(seen).any()


def test_the_farther_out_the_more_a_place_shows() -> None:
    """Beside where it stands, a thing shows hardly anything new; at the border it shows most."""
    decision = looked({"here": (0.2, 0.0), "border": (2.9, 0.0)})
    found = {mark.name: mark.share for mark in lookouts(decision, {}, [HERE], [])}
    assert 0.1 < found["border"] < 0.5 and found.get("here", 0.0) < 0.5 * found["border"]


def test_places_beside_each_other_count_once() -> None:
    """A second thing 0.3 m away shows little that the first did not; one on the other side shows as much."""
    names = {"first": (2.9, 0.0), "beside": (2.9, 0.3), "opposite": (-2.9, 0.0)}
    found = {mark.name: mark.share for mark in lookouts(looked(names), {}, [HERE], [])}
    sides = {"first", "beside"} & set(found)
    assert max(found[name] for name in sides) == pytest.approx(found["opposite"], rel=0.1)
    assert sum(found[name] for name in sides) < 1.35 * found["opposite"]


def test_no_more_is_found_than_there_is() -> None:
    around = {f"t{n}": (2.9 * np.cos(n), 2.9 * np.sin(n)) for n in range(7)}
    assert sum(mark.share for mark in lookouts(looked(around), {}, [HERE], [])) <= 1 - HIDDEN + 1e-9


@pytest.mark.parametrize("count", [1, 2])
def test_looks_in_vain_leave_less_hope(count: int) -> None:
    """A disc of 2.5 m has been looked at. By Bayes' rule a target there was missed each time, or no look shows it."""
    decision = looked({"border": (2.4, 0.0)})
    seen = decision.map
    y, x = np.nonzero(seen.explored)
    middle = seen.origin[:, None] + 0.1 * (np.stack([x, y]) + 0.5)
    disc = np.hypot(*middle) <= 2.5
    seen._firm[y[~disc], x[~disc]] = 1.0
    missed = (1 - HIDDEN) * HIDDEN**count
    part = (np.hypot(middle[0] - 2.4, middle[1])[disc] < FAR).mean()  # of the disc, that is seen from the border
    found = lookouts(decision, {}, [HERE] * count, [])
    assert found[0].share == pytest.approx(part * missed / (missed + HIDDEN), rel=0.04)


def test_a_look_from_beside_leaves_little_to_find_and_two_visits_exhaust_a_place() -> None:
    decision = looked({"border": (2.9, 0.0)})
    first, elsewhere, beside = (
        lookouts(decision, {}, [HERE, *more], [])[0].share for more in ([], [(0.0, 2.9)], [(2.9, 0.3)])
    )
    assert first / 2 < elsewhere < 1.2 * first
    assert beside < first / 2
    assert lookouts(decision, {"border": 2}, [HERE], []) == lookouts(decision, {}, [HERE], ["border"]) == ()


def test_where_no_floor_is_left_it_goes_to_what_it_has_not_visited() -> None:
    decision = looked({"near": (1.0, 0.0), "beside": (1.2, 0.0), "far": (-3.0, 0.0)})
    seen = replace(decision, map=decision.map)
    seen.map._firm[:] = 1.0
    assert [mark.name for mark in lookouts(seen, {}, [], [])] == ["near", "far"]
    assert [mark.name for mark in lookouts(seen, {"near": 1}, [], [])] == ["beside", "far"]


def test_a_place_shows_its_share_of_all_that_may_be_hidden() -> None:
    """Floor of the disc that was seen counts HIDDEN of the ring that was not; a look shows what is within FAR."""
    decision = looked({"border": (2.9, 0.0)})
    y, x = np.mgrid[-60:60, -60:60] * 0.1 + 0.05
    away = np.hypot(x, y)
    floor = away < 5.0
    missed = (1 - HIDDEN) * np.where(away < 3.0, HIDDEN, 1.0) * floor / floor.sum()  # there, and not seen yet
    expected = missed[np.hypot(x - 2.9, y) < FAR].sum() / (missed.sum() + HIDDEN)  # Bayes' rule
    assert lookouts(decision, {}, [HERE], [])[0].share == pytest.approx(expected, rel=0.07)


def test_what_a_detector_saw_from_afar_is_hardly_searched() -> None:
    """With a sight of 1.8 m, floor that was seen counts HIDDEN within that of the look, and FROM_AFAR beyond."""
    decision = looked({"border": (2.9, 0.0)})
    y, x = decision.map.origin[::-1, None, None] + 0.1 * (np.indices(decision.map.explored.shape) + 0.5)
    ring, away = unseen_floor(decision.map), np.hypot(x, y)
    floor = decision.map.explored | ring
    left = np.where(away < 1.8, HIDDEN, np.where(ring, 1.0, FROM_AFAR)) * floor
    missed = (1 - HIDDEN) * left / floor.sum()
    expected = missed[np.hypot(x - 2.9, y) < 1.8].sum() / (missed.sum() + HIDDEN)
    assert lookouts(decision, {}, [HERE], [], sight=1.8)[0].share == pytest.approx(expected, rel=0.07)
