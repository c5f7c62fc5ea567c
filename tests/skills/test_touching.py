"""The counts and searches of kernels, against plain computations point by point and cell by cell."""

from __future__ import annotations

import heapq
import math

import numpy as np
import pytest

from hazard_ms.robots.chain import Chain
from hazard_ms.skills.motor.navigation import Ways, plan
from hazard_ms.skills.motor.searching import Aim, cheapest, tied, trace
from hazard_ms.skills.motor.surface import Leg, Place, Surface
from hazard_ms.skills.motor.touching import Counter, ground
from tests.worlds.arena import Arena

CELL, WEST, SOUTH = 0.1, -2.0, -1.5
VALUES = dict(x=0.2, y=0.1, ahead_x=0.6, ahead_y=0.8, radius=0.3, own=0.4, west=WEST, south=SOUTH, cell=CELL, gap=0.06)
PLACE = dict(place_x=0.7, place_y=0.6, place_radius=0.1, bottom=0.5, slope=0.7, top=0.8)
OPEN = dict(out_x=0.0, out_y=0.0, depth=0.0, half_width=0.0, roof=0.0)
SHELF = dict(out_x=0.8, out_y=-0.6, depth=0.5, half_width=0.2, roof=0.9)
SHARES = (0.0, 0.33, 0.67)


def in_something(point: np.ndarray, ahead: float, heights: np.ndarray, opening: dict[str, float]) -> bool:
    """Whether a point in the base's frame is below what the arm must keep above there."""
    base = np.array([0.2 + ahead * 0.6, 0.1 + ahead * 0.8])
    x, y = base + (0.6 * point[0] - 0.8 * point[1], 0.8 * point[0] + 0.6 * point[1])
    if math.dist((x, y), base) < 0.3:
        return bool(point[2] < 0.4)
    row, column = math.floor((y - SOUTH) / CELL), math.floor((x - WEST) / CELL)
    known = 0 <= row < heights.shape[0] and 0 <= column < heights.shape[1]
    height = float(heights[row, column]) if known else 0.0
    beside = math.dist((x, y), (0.7, 0.6)) - 0.1
    low = height + 0.06
    if height < 0.8 or beside < 0.06:
        low = min(low, 0.5 + 0.7 * max(beside, 0.0))
    out = np.array([opening["out_x"], opening["out_y"]])
    along, across = out @ (x - 0.7, y - 0.6), out @ (y - 0.6, 0.7 - x)
    wide = opening["half_width"]
    if -wide < along < opening["depth"] and abs(across) < wide and point[2] < opening["roof"]:
        low = min(low, 0.5 + min(0.7 * max(beside, 0.0), 0.06))  # the board, and what the arm keeps above it
    return bool(point[2] < low)


@pytest.mark.parametrize("opening", [OPEN, SHELF])
def test_points_along_arms_are_counted_as_one_by_one(opening: dict[str, float]) -> None:
    rng = np.random.default_rng(0)
    heights = rng.choice([0.0, 0.3, 0.7, 1.5], (30, 40)).astype(np.float32)
    counter = Counter(ground(**VALUES, **PLACE, **opening), SHARES, heights)
    for number in (1, 7, 400, 3):  # more than there is room for at first, and fewer again
        places = rng.uniform([-0.5, -1.5, 0.0], [3.0, 1.5, 1.6], (number, 4, 3))
        ahead = rng.uniform(-0.5, 0.5, number)
        expected = []
        for joints, far in zip(places, ahead, strict=True):
            points = [a + s * (b - a) for a, b in zip(joints[:-1], joints[1:], strict=True) for s in SHARES]
            expected.append(sum(in_something(point, far, heights, opening) for point in (*points, joints[-1])))
        assert counter.touched(places, ahead).tolist() == expected
        assert number < 7 or len(set(expected)) > 2, "nothing to tell apart"


def test_a_route_hits_what_its_legs_hit_one_after_another(arena: Arena) -> None:
    """Whether a leg was looked at before, or together with others, makes no difference."""
    arena.restart()
    stage, agent = arena.stage, arena.agent
    place = Place(np.array([0.7, 0.0, 0.5]), 0.05, 0.45, 0.55)
    arms = [agent.tucked, *agent.between, *agent.outstretched]
    legs = [Leg(arm, 0.1 * k, near=0.0) for k, arm in enumerate(arms)]
    together = Surface(stage, place).hits(legs)
    one_by_one = [Surface(stage, place).hits([a, b]) for a, b in zip(legs[:-1], legs[1:], strict=True)]
    assert together == sum(one_by_one) > 0
    again = Surface(stage, place)
    assert [again.hits(legs[:3]), again.hits(legs), again.hits(legs)] == [sum(one_by_one[:2]), together, together]
    assert Surface(stage, place).hits(legs, one_by_one[0]) == one_by_one[0]


def test_places_along_the_arm_are_those_of_pinocchio(arena: Arena) -> None:
    """To the last bit, for more postures than there is room for at first, and for fewer again."""
    arena.restart(0.7, -0.3, 0.4)
    agent = arena.agent
    model, low, high = agent._model, *agent.arm_limits.T
    hand = agent._hand if agent.uid == "hazard_fetch" else agent._hands[agent._used]
    moving = agent._arm if agent.uid == "hazard_fetch" else agent._arms[agent._used]
    rng = np.random.default_rng(3)
    chain, joints = Chain(agent.robot._objs[0], [hand]), agent.all_joints()
    for count in (1, 300, 5):
        arms = rng.uniform(low, high, (count, len(low)))
        found = chain.places(joints, moving, arms)
        for arm, place in zip(arms, found, strict=True):
            joints[moving] = arm
            model.compute_forward_kinematics(joints)
            np.testing.assert_array_equal(place[0], model.get_link_pose(hand).p)
        joints = agent.all_joints()


def searched(cost: np.ndarray, first: int, limit: float) -> dict[int, float]:
    """Cheapest costs by Dijkstra's algorithm over a dictionary of cells."""
    height, width = cost.shape
    paid, waiting, settled = {first: 0.0}, [(0.0, first)], set()
    while waiting:
        spent, here = heapq.heappop(waiting)
        if here in settled:
            continue
        settled.add(here)
        for dy in (-1, 0, 1):
            for dx in (-1, 0, 1):
                y, x = here // width + dy, here % width + dx
                if (dy or dx) and 0 <= y < height and 0 <= x < width:
                    through = spent + (cost.flat[here] + cost[y, x]) / 2 * CELL * math.hypot(dy, dx)
                    if through < limit and through < paid.get(y * width + x, math.inf):
                        paid[y * width + x] = through
                        heapq.heappush(waiting, (through, y * width + x))
    return paid


def test_cheapest_costs_are_those_of_a_plain_search() -> None:
    rng = np.random.default_rng(1)
    cost = np.exp(rng.normal(0.0, 1.0, (23, 31)))
    cost[5:18, 14] = 1e6
    first, limit = 11 * 31 + 3, 4.0
    expected = searched(cost, first, limit)
    assert 100 < len(expected) < cost.size
    spent, before = cheapest(cost, CELL, first, limit)
    assert {int(k): spent[k] for k in np.flatnonzero(np.isfinite(spent))} == expected
    cells = trace(before, max(expected, key=lambda k: expected[k]), 31)
    steps = np.hypot(*np.diff(cells, axis=0).T) * (cost[tuple(cells[1:].T)] + cost[tuple(cells[:-1].T)]) / 2 * CELL
    assert steps.sum() == pytest.approx(max(expected.values()))
    aim = Aim(1.0, 1.0, 0.2, 0.5, 3.0, 1000.0)
    part, _ = cheapest(cost, CELL, first, limit, aim)
    ends = {k: math.dist((k % 31 * CELL, k // 31 * CELL), (1.0, 1.0)) for k in expected}
    worth = {k: expected[k] + (3.0 if far <= 0.5 else 1000.0) * max(far - 0.2, 0.0) for k, far in ends.items()}
    best = min(worth, key=lambda k: worth[k])
    assert part[best] == expected[best] and np.isfinite(part).sum() < len(expected)
    assert (part[np.isfinite(part)] >= spent[np.isfinite(part)]).all()


def test_where_ways_are_equally_cheap_it_is_known() -> None:
    cost = np.ones((5, 7))
    cost[2, 3] = 50.0  # round it on either side
    spent, before = cheapest(cost, CELL, 2 * 7 + 1, 1e3)
    assert tied(trace(before, 2 * 7 + 5, 7), spent, cost, CELL)
    assert not tied(trace(before, 0, 7), spent, cost, CELL)


def test_one_goal_is_found_as_among_several() -> None:
    """The search for one goal ends early; that for several goes on to the ends of the map."""
    rng = np.random.default_rng(2)
    height = np.where(rng.random((80, 80)) < 0.02, 1.0, 0.0).astype(np.float32)
    seen, origin, start = np.ones(height.shape, bool), np.array([-4.0, -4.0]), (0.05, 0.05)
    height[38:43, 38:43] = 0.0
    goals = [(float(x), float(y)) for x, y in rng.uniform(-3.9, 3.9, (12, 2))]
    ways = Ways(height, seen, CELL, origin, start, goals, 0.29)
    for goal in goals:
        for near, enough in ((0.0, None), (0.5, 1.4)):
            alone, among = (
                plan(height, seen, CELL, origin, start, goal, 0.29, near, enough),
                ways.path(goal, near, enough),
            )
            assert alone is not None and among is not None
            assert np.array_equal(alone.points, among.points) and alone.short == among.short
