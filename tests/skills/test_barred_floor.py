"""Floor that a hazard keeps the robot out of is in the way of its walks, as far as the robot has seen it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
import torch

from hazard_ms.agents.search.walks import frames_between
from hazard_ms.skills import failures
from hazard_ms.skills.decision import Action
from hazard_ms.skills.executor import SkillEnv
from tests.worlds.two_rooms import DOOR, acted, spec, two_rooms

OPEN = replace(DOOR, open=1.0)
DOORWAY = (3.5, 2.0)  # of OPEN [m]


def beyond(side: float, line: float) -> Callable[[torch.Tensor], torch.Tensor]:
    """A hazard that forbids all that lies on one `side` of the line x = `line` [m]."""
    return lambda points: side * (points[..., 0] - line) > 0.0


@pytest.mark.parametrize("affects_agent", [True, False])
def test_a_look_bars_what_is_forbidden_of_the_floor_that_it_shows(affects_agent: bool) -> None:
    """And frees it where a later look shows that it no longer is; none of it where hazards do not act on the agent."""
    env = SkillEnv.make("HazardFire-v1", affects_agent=affects_agent, reward_mode="none")
    env.reset(seed=0)
    env.step(Action("explore"))
    y, x = np.nonzero(env.seen.told_at == env.seen.frame)  # what the last look of each round shows
    line = float(np.median(env.seen.centre_of(y, x)[:, 0])) + 0.01
    for side in (1.0, -1.0):
        env.base.episode.forbidden = beyond(side, line)  # type: ignore[method-assign]
        env.step(Action("explore"))
        y, x = np.nonzero(env.seen.told_at == env.seen.frame)
        east = side * (env.seen.centre_of(y, x)[:, 0] - line) > 0.0
        assert 0.2 < east.mean() < 0.8
        assert (env.seen.barred[y, x] == (east & affects_agent)).all()
        assert not (env.seen.barred & ~env.seen.explored).any()
    env.close()


def test_what_is_barred_of_a_fire_is_its_flames_and_the_hot_air_between_them() -> None:
    """Within half of a cell's 0.22 m of a flame, of the floor or of a thing, or above 500 C (docs/physics.md 1.4)."""
    env = SkillEnv.make("HazardFire-v1", affects_agent=True, reward_mode="none")
    env.reset(seed=0)
    for _ in range(8):  # fires begin at once, and grow
        env.step(Action("explore"))
    flames, seen = env.base.episode.flames(), env.seen
    assert flames is not None
    lit = flames.place[0, flames.lit[0], :2].numpy()
    y, x = np.nonzero(seen.told_at == seen.frame)
    middles = seen.centre_of(y, x)
    beside = np.abs(middles[:, None] - lit).max(-1).min(-1) <= 0.11
    floor = torch.as_tensor(np.pad(middles, ((0, 0), (0, 1))), dtype=torch.float32)
    hot = env.base.episode.levels(floor[None])[0, 0].numpy() > 500.0
    assert seen.barred[y, x].any() and (beside | hot)[seen.barred[y, x]].all()
    env.close()


def test_walks_keep_off_it_and_find_no_way_where_it_fills_a_door() -> None:
    with two_rooms(spec(door=OPEN)) as rooms:
        seen, place = rooms.stage.seen, rooms.stage.robot.base()[:2]
        seen.explored[:] = True  # so that no way leads around the rooms
        goal, near = np.array([[6.7, 0.3]]), np.array([0.6])
        assert np.isfinite(frames_between(seen, place, goal, near, 0.29)).all()
        y, x = np.indices(seen.explored.shape)
        seen.barred[np.hypot(*np.moveaxis(seen.centre_of(y, x) - DOORWAY, -1, 0)) < 0.6] = True
        assert np.isinf(frames_between(seen, place, goal, near, 0.29)[-1, 0])
        assert acted(rooms, Action("walk_to", "bottle_0")).reason == failures.NO_PATH
        seen.barred[:] = False
        assert acted(rooms, Action("walk_to", "bottle_0")).ok


def test_what_is_barred_is_no_wall() -> None:
    """A hand reaches over a fire's edge, and things are seen past it: heights stay as they were seen."""
    with two_rooms(spec(door=OPEN)) as rooms:
        seen = rooms.stage.seen
        before = seen.height
        seen.barred[:] = seen.explored
        assert (seen.height == before).all()
        assert (seen.obstacles[seen.explored] >= 1.0).all() and (seen.obstacles >= before).all()
        assert (seen.obstacles[~seen.explored] == before[~seen.explored]).all()
