"""A robot goes round a thing that its arm does not get at from where it stands, and knows where it never will."""

from __future__ import annotations

from collections.abc import Generator
from typing import Any

import numpy as np
import pytest

from hazard_ms.skills import failures
from hazard_ms.skills.context import LowLevel, Stage
from hazard_ms.skills.motor import grasping
from hazard_ms.skills.motor.grasping import APART, ELSEWHERE, HOPELESS, pick_up
from hazard_ms.skills.motor.reaching import Way, arm_way
from tests.worlds.arena import Arena, Box
from tests.worlds.skill_room import horizontal, walk

HIGH = 1.5  # of what the robot believes to stand around the thing [m]
NEAR, FAR = 0.2, 0.5  # from the middle of the thing to that [m]
LITTLE = 20  # frames in which nothing but a turn is done


def _believe(arena: Arena, name: str, opening: float) -> None:
    """Let the robot believe in a wall around a thing, open on the far side over the angle `opening` [rad]."""
    x, y, _ = arena.agent.base()
    seen, thing = arena.stage.seen, arena.stage.position(arena.index(name))
    row, column = np.mgrid[0 : seen.height.shape[0], 0 : seen.height.shape[1]]
    away_x = seen.origin[0] + (column + 0.5) * seen.cell - thing[0]
    away_y = seen.origin[1] + (row + 0.5) * seen.cell - thing[1]
    far = np.hypot(away_x, away_y)
    behind = np.arctan2(thing[1] - y, thing[0] - x)
    off = np.abs(np.angle(np.exp(1j * (np.arctan2(away_y, away_x) - behind))))
    wall = (far > NEAR) & (far < FAR) & (off > opening / 2)
    seen.tell(np.where(wall, HIGH, 0.0).astype(np.float32), np.zeros_like(seen.explored))


def test_the_base_goes_round_to_where_the_arm_gets_at_a_thing(fresh: Arena) -> None:
    assert walk(fresh, "bowl")
    stage, index = fresh.stage, fresh.index("bowl")
    _believe(fresh, "bowl", np.deg2rad(200.0))
    fresh.agent.use_hand(stage.position(index))
    here = arm_way(stage, index, set(), stage.position(index))
    assert here is None or here.route.hits > HOPELESS
    x, y, _ = fresh.agent.base()
    assert fresh.run(pick_up(stage, index)).ok
    assert np.hypot(*np.subtract(fresh.agent.base()[:2], (x, y))) > 0.5  # it went to the side, or behind the bowl


def test_an_arm_that_would_not_get_there_stays_where_it_is(fresh: Arena) -> None:
    assert walk(fresh, "bowl")
    _believe(fresh, "bowl", 0.0)
    before = horizontal(fresh, "bowl")
    result = fresh.run(pick_up(fresh.stage, fresh.index("bowl")))
    assert not result.ok and result.reason == failures.UNREACHABLE and result.frames < LITTLE
    assert fresh.stage.arm_gap(fresh.agent.tucked) < 0.1 and abs(horizontal(fresh, "bowl") - before) < 0.05


SCREENED = (
    Box("plinth", (0.8, 0.0, 0.35), (0.2, 0.2, 0.7), target=False),
    Box("screen", (0.6, 0.0, 1.0), (0.03, 0.5, 0.5), target=False),
    Box("can", (0.8, 0.0, 0.76), (0.07, 0.07, 0.12), 0.3),
)


def test_what_was_in_the_way_unseen_is_gone_round() -> None:
    """The map does not show a screen: the arm meets it, the robot looks again, and stands elsewhere."""
    arena = Arena(SCREENED)
    try:
        arena.map._firm[:] = 0.0
        result = arena.run(pick_up(arena.stage, arena.index("can")))
        assert result.ok and arena.looks > 0
        assert np.hypot(*arena.agent.base()[:2]) > APART
    finally:
        arena.close()


def test_who_went_a_long_way_to_a_better_place_does_not_go_round_again(monkeypatch: pytest.MonkeyPatch) -> None:
    """As before, but `_first_way` takes the frames of a long way to a better place."""
    first = grasping._first_way

    def far(stage: Stage, *rest: Any) -> Generator[LowLevel, None, tuple[Way | None, int]]:
        for _ in range(ELSEWHERE):
            yield stage.act()
        way, moved = yield from first(stage, *rest)
        return way, moved + ELSEWHERE

    monkeypatch.setattr(grasping, "_first_way", far)
    arena = Arena(SCREENED)
    try:
        arena.map._firm[:] = 0.0
        result = arena.run(pick_up(arena.stage, arena.index("can")))
        assert not result.ok and ELSEWHERE < result.frames < 2 * ELSEWHERE + LITTLE
        assert np.hypot(*arena.agent.base()[:2]) < APART
    finally:
        arena.close()
