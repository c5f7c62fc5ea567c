"""Where agents put things down in the lee, and how plans choose between that and the carts."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from hazard_ms.agents.gale.sites import OnGround, sites
from hazard_ms.agents.gale.stops import PUT_DOWN, SURER, put_away, stops
from hazard_ms.sensing.semantic_map import SemanticMap
from hazard_ms.sensing.sighting import Sighting
from hazard_ms.sketch.planning.orienteering import solve
from hazard_ms.sketch.planning.problem import Problem
from hazard_ms.sketch.planning.travel import MovingTravel, straight_line
from hazard_ms.skills.actions import skill
from hazard_ms.skills.decision import DROP, WALK_TO, Action

RADIUS = 0.29  # of the robot [m]
AHEAD = RADIUS + 0.35  # of what it puts down from its middle [m]


def decision(wall: float | None = None) -> Any:
    """An agent at the origin that faces +x and holds thing 0; thing 1 is at (4, 0), thing 2 at (0, 3)."""
    seen = SemanticMap((0.0, 0.0), np.zeros(3, bool))
    height = np.zeros_like(seen.height)
    if wall is not None:
        row, column = seen.cell_of((wall, 0.0))
        height[row - 3 : row + 4, column] = 1.0
    seen.tell(height, np.ones_like(seen.explored))
    places = {1: (4.0, 0.0, 0.0), 2: (0.0, 3.0, 0.0)}
    seen.objects = {index: Sighting(np.array(at, np.float32), 0.1, 0.2, 0, 9) for index, at in places.items()}
    return SimpleNamespace(
        map=seen, agent_position=(0.0, 0.0), agent_heading=0.0, held="bag_1", names=("bag_1", "car_1", "tree_1")
    )


def test_things_are_put_down_before_the_robot_where_it_stands_or_where_a_walk_ends() -> None:
    """A walk to a thing of 0.1 m radius ends 0.6 m before its middle; its first step is 1 m long."""
    found = {str(stop.action): stop for stop in stops(decision(), RADIUS)}
    assert found["drop"].place == pytest.approx((AHEAD, 0.0)) and found["drop"].frames == PUT_DOWN
    assert found["walk_to car_1"].place == pytest.approx((3.4 + AHEAD, 0.0), abs=0.15)
    assert found["walk_to tree_1"].place == pytest.approx((0.0, 2.4 + AHEAD), abs=0.15)
    assert found["walk_one_step tree_1"].place == pytest.approx((0.0, 1.0 + AHEAD), abs=0.15)
    assert found["walk_to car_1"].frames == pytest.approx(62.0 * 3.4 + 20.0 + PUT_DOWN, abs=10.0)


def test_nothing_is_put_down_into_what_stands_there() -> None:
    assert Action(DROP) not in {stop.action for stop in stops(decision(wall=AHEAD), RADIUS)}


def test_it_goes_to_the_nearest_place_that_keeps_the_thing_unless_a_cart_is_hardly_farther() -> None:
    def east(points: NDArray[np.float64]) -> NDArray[np.bool_]:
        return points[:, 0] > 2.0

    far = put_away(decision(), RADIUS, east, cart=1000.0)
    assert far is not None and far.action == Action(WALK_TO, "car_1")
    assert put_away(decision(), RADIUS, east, cart=far.frames + SURER - 1.0) is None
    assert put_away(decision(), RADIUS, lambda points: points[:, 0] > 9.0, cart=1000.0) is None
    # its own place would do, but not 0.2 m before it: the walk may end there
    end = 3.4 + AHEAD
    assert put_away(decision(), RADIUS, lambda points: points[:, 0] > end - 0.15, cart=1000.0) is None


def test_sites_are_the_nearest_good_places_of_each_target_and_serve_others() -> None:
    points = np.array([[0.0, 0.0], [1.0, 0.0], [5.0, 0.0], [9.0, 0.0]])
    good = np.array([[False, True, True, False], [False, False, True, True], [False, False, False, False]])
    found = sites(points, good, np.array([[0.0, 0.0], [6.0, 0.0], [0.0, 0.0]]))
    assert found.places.tolist() == [[1.0, 0.0], [5.0, 0.0], [9.0, 0.0]]
    assert found.keep.tolist() == [[True, True, False], [False, True, True], [False, False, False]]


def problem(keep: list[list[bool]], limit: float) -> Problem:
    """Targets at (1, 0) and (2, 0), a start at (0, 0), a cart at (10, 0), a site at (1.5, 0); 10 frames a metre."""
    places = np.array([[[1.0, 0.0], [2.0, 0.0]]])
    fixed = np.array([[10.0, 0.0], [1.5, 0.0]])
    travel = MovingTravel([0.0], places, [0.0, 0.0], straight_line(10.0), fixed)
    kept = np.array(keep, bool)
    return Problem(OnGround(travel, kept, None), [5.0, 1.0], [np.inf] * 2, [0.0] * 2, [0.0] * 2, limit=limit)


def test_plans_bring_into_the_lee_what_stays_there_and_the_rest_into_carts() -> None:
    """Both into the lee: 10 + 5 + 5 + 5 frames; the second into the cart: 10 + 5 + 5 + 80; both into the cart: 260."""
    both = solve(problem([[True], [True]], 1000.0))
    assert both.value == 6.0 and both.frame == 25.0 and [r.cart for r in both.rescues] == [1, 1]
    mixed = solve(problem([[True], [False]], 1000.0))
    assert mixed.frame == 100.0 and {r.target: r.cart for r in mixed.rescues} == {0: 1, 1: 0}
    assert solve(problem([[False], [False]], 1000.0)).frame == 260.0
    assert solve(problem([[True], [False]], 99.0)).value == 5.0


@pytest.mark.parametrize(("on_ground", "name"), [(True, "put_down"), (False, "drop")])
def test_a_drop_without_a_cart_puts_things_on_the_ground_where_that_can_rescue(on_ground: bool, name: str) -> None:
    stage: Any = SimpleNamespace(world=SimpleNamespace(equipment=None), on_ground=on_ground, held=0)
    doing: Any = skill(stage, Action(DROP))
    assert doing.gi_code.co_name == name
