"""The arm's roadmap: the same wherever the robot stands, and with ways round what stands before it."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from hazard_ms.skills.motor.arm import posture_for
from hazard_ms.skills.motor.roadmap import Paths, Roadmap
from tests.worlds.arena import Arena

HIT = 8.0  # frames that a point in something counts as much as
LEAST_SHARE = 0.8  # of goals that must be reached round the pillar, where a straight line would go through it


def test_a_roadmap_does_not_depend_on_where_the_robot_is(arena: Arena) -> None:
    """Episodes in one process must not differ by what was played before them."""
    made = []
    for x, y, posture in ((0.7, 0.0, 0), (1.4, 2.5, 1)):
        arena.restart(x, y)
        for _ in range(20):
            arena.step(arena.agent.action(0.0, 0.05, arena.agent.between[posture], True))
        made.append(Roadmap(arena.agent))
    seen: list[np.ndarray] = []

    def noted(places: np.ndarray) -> np.ndarray:
        seen.append(places.copy())
        return np.zeros(len(places), np.int64)

    for one in made:
        assert not one.touching(noted).any()
    np.testing.assert_array_equal(made[0].postures, made[1].postures)
    np.testing.assert_array_equal(made[0].lines, made[1].lines)
    np.testing.assert_array_equal(seen[0], seen[1])


def test_places_at_rest_are_those_of_a_robot_at_the_origin(arena: Arena) -> None:
    arena.restart(0.0, 0.0)
    agent = arena.agent
    x, y, heading = agent.base()
    for posture in (agent.tucked, *agent.between):
        places, resting = agent.arm_places(posture), agent.arm_places(posture, resting=True)
        off = places[:, :2] - (x, y)
        turn = np.array([[np.cos(heading), -np.sin(heading)], [np.sin(heading), np.cos(heading)]])
        np.testing.assert_allclose(resting[:, :2], off @ turn, atol=2e-3)
        np.testing.assert_allclose(resting[:, 2], places[:, 2], atol=2e-3)


@pytest.mark.parametrize("height", [0.5, 0.8])
def test_paths_go_round_a_pillar(arena: Arena, height: float) -> None:
    """Hands and elbows must keep out of a pillar before the robot, looked at more closely than the search does."""
    arena.restart(0.0, 0.0)
    agent = arena.agent
    x, y, heading = agent.base()
    ahead = 0.75 * agent.build.span(height)[1]
    middle, radius = np.array([0.75 * ahead, 0.0]), 0.08

    def inside(places: np.ndarray) -> np.ndarray:
        dense = np.concatenate([places, (places[:, 1:] + places[:, :-1]) / 2], axis=1)
        return (np.hypot(*np.moveaxis(dense[..., :2] - middle, -1, 0)) < radius).sum(axis=1)

    def touches(arms: list[np.ndarray], radius: float) -> int:
        points = [a + s * (b - a) for a, b in itertools.pairwise(arms) for s in np.linspace(0.0, 1.0, 40)]
        places = np.array([agent.arm_places(p, resting=True) for p in points])
        return int((np.hypot(*np.moveaxis(places[..., :2] - middle, -1, 0)) < radius).sum())

    paths = Paths(agent, agent.tucked, inside, HIT)
    tried = round_it = 0
    for side in np.linspace(-0.5, 0.5, 11):
        goal = np.array([x, y, height]) + ahead * np.array([np.cos(heading + side), np.sin(heading + side), 0.0])
        arm = posture_for(arena.stage, goal).arm
        straight = [agent.tucked, arm]
        if not touches(straight, radius) or touches([arm, arm], radius):
            continue
        tried += 1
        round_it += not touches([agent.tucked, *paths.to(arm), arm], 0.7 * radius)
    assert tried >= 3 and round_it >= LEAST_SHARE * tried
