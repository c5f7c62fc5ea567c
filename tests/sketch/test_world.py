"""The sketch in cases that are worked out by hand."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from hazard_ms.sketch.rescues.state import Domain
from hazard_ms.sketch.world import Sketch
from hazard_ms.skills.options.options import CART, COUNT, END, FIRST, GIVE_UP, LANDMARK, LOOK
from tests.worlds.sketch_scenes import (
    ARRIVED,
    BAG_FRAMES,
    CART_FRAMES,
    FRAMES_PER_METRE,
    LOOK_FRAMES,
    LOST_FRAMES,
    PICK_FRAMES,
    SETTLE,
    grid,
    scene,
    sure_times,
)


def walk_frames(metres: float) -> float:
    """Frames to a thing so far ahead."""
    return FRAMES_PER_METRE * (metres - ARRIVED) + SETTLE


def walk(metres: float) -> int:
    """Whole frames to a thing so far ahead."""
    return round(walk_frames(metres))


def one(made: Any, **more: Any) -> Sketch:
    """A sketch of one rescue whose skills always work."""
    sketch = Sketch([made], sure_times(), 1, **more)
    sketch.reset([0], [0])
    return sketch


def play(sketch: Sketch, *options: int) -> list[float]:
    """The rewards of `options`, one after the other."""
    return [float(sketch.step(np.array([option]))[0][0]) for option in options]


@pytest.mark.parametrize(("damaged_at", "value"), [(-1, 1.0), (1000, 1.0), (253, 1.0), (252, 0.5), (200, 0.5)])
def test_a_target_three_metres_ahead(damaged_at: int, value: float) -> None:
    """62 frames for each of 2.5 m, 3 to start and stop, 94 to pick up and 4 to put away: 256; in the hand after 252."""
    sketch = one(scene([(0, 0), (3, 0)], [1], damaged_at=[damaged_at]))
    assert play(sketch, 0) == [value]
    assert sketch.state.rescued_at.tolist() == [[256]] == [[walk(3.0) + PICK_FRAMES + BAG_FRAMES]]
    assert sketch.state.over.all()


def test_what_lies_behind_is_known_after_a_look_around_and_costs_a_turn() -> None:
    sketch = one(scene([(0, 0), (-3, 0)], [1]))
    assert sketch.mask[0].nonzero()[0].tolist() == [FIRST[LOOK], FIRST[END]]
    play(sketch, FIRST[LOOK])
    assert sketch.state.frame[0] == LOOK_FRAMES
    assert sketch.mask[0].nonzero()[0].tolist() == [0, FIRST[END]]  # it has just looked around
    play(sketch, 0)
    turn = 30.0 * (180 - 25) / 180  # the last 25 degrees are turned while driving
    handled = PICK_FRAMES + BAG_FRAMES
    assert sketch.state.rescued_at[0, 0] == LOOK_FRAMES + round(walk(3.0) + turn) + handled


def test_carts_are_where_things_are_safe_in_the_open() -> None:
    sketch = one(scene([(0, 0), (3, 0), (3, 4)], [1], cart_site=[2]))
    assert FIRST[CART] not in sketch.mask[0].nonzero()[0]  # nothing in the hand yet
    assert play(sketch, 0) == [0.0]
    assert sketch.mask[0].nonzero()[0].tolist() == [FIRST[CART], FIRST[LOOK], FIRST[END]]
    start = int(sketch.state.frame[0])
    assert play(sketch, FIRST[CART]) == [1.0]
    turn = 30.0 * (np.degrees(np.arctan2(4.0, 0.5)) - 25) / 180  # the robot is at 2.5 m
    assert sketch.state.frame[0] == start + round(walk_frames(np.hypot(0.5, 4.0)) + turn) + CART_FRAMES


def test_a_search_walks_to_a_landmark_and_shows_what_is_there() -> None:
    cells = grid(-4.0, 4.0, 4.0)  # from the east, the target is seen, too
    pixels = np.where(cells["stand"][:, :1] > 0, [[9, 9, 9]], [[9, 0, 9]])
    stands = cells["stand"][:, 0] > 0
    spots = np.where(stands, 0b1110, 0b0011).astype(np.uint16)[:, None]
    sites = [(-2, -2), (3, -1), (2, -2)]
    east = scene(sites, [1], landmark_site=[2], cells=cells, pixels=pixels, spots=spots)
    sketch = one(east)
    assert not sketch.mask[0, 0] and sketch.mask[0, FIRST[LANDMARK]]
    play(sketch, FIRST[LANDMARK])
    assert sketch.state.frame[0] == walk(4.0) + LOOK_FRAMES
    assert sketch.mask[0, 0]
    assert sketch.mask[0, FIRST[LANDMARK]]  # furniture hides some of the floor around it for good
    play(sketch, FIRST[LANDMARK])
    assert not sketch.mask[0, FIRST[LANDMARK]]  # nothing new is expected after two visits


def test_a_target_without_a_way_is_given_up() -> None:
    sketch = one(scene([(0, 0), (3, 0)], [1], cells=grid(-4.0, 4.0, 8.0), travel=np.array([[np.inf, np.inf]])))
    assert play(sketch, *[0] * GIVE_UP) == [0.0] * GIVE_UP
    assert sketch.state.frame[0] == GIVE_UP * LOST_FRAMES
    assert not sketch.mask[0, 0]
    play(sketch, 0)
    assert sketch.state.frame[0] == GIVE_UP * LOST_FRAMES + 10  # what cannot be chosen costs a few frames


def test_a_long_walk_ends_on_the_way_and_goes_on_from_there() -> None:
    sketch = one(scene([(0, 0), (20, 0)], [1], max_frames=5000))
    play(sketch, 0)
    assert sketch.state.frame[0] == 800
    assert sketch.state.place[0, 0] == pytest.approx(800 / walk(20.0) * 19.5)
    play(sketch, 0)
    whole = walk(20.0) + SETTLE + PICK_FRAMES + BAG_FRAMES  # it stopped once more
    assert sketch.state.rescued_at[0, 0] == pytest.approx(whole, abs=1)


def test_a_thing_that_drifts_away_is_met_where_it_can_be_reached() -> None:
    """It is 3 m ahead, goes on to 6 m after 100 frames and to 9 m after 2,000: the robot is at 6 m in between."""
    course = np.repeat([[1], [2], [3]], [10, 190, 1], axis=0)
    sketch = one(scene([(0, 0), (3, 0), (6, 0), (9, 0)], [1], target_site=course))
    play(sketch, 0)
    assert sketch.state.rescued_at[0, 0] == walk(6.0) + PICK_FRAMES + BAG_FRAMES


def test_what_the_hazard_brings_to_safety_counts_unless_the_robot_has_it() -> None:
    sites = [(0, 0), (3, 0), (0, 3)]
    sketch = one(scene(sites, [1, 2], safe_at=[85, -1], damaged_at=[84, -1]))
    assert play(sketch, *[FIRST[LOOK]] * 4) == [0.0, 0.0, 0.0, 0.25]
    assert sketch.state.rescued_at[0].tolist() == [85, -1]
    taken = one(scene([*sites, (6, 0)], [1, 2], cart_site=[3], safe_at=[260, -1]))
    assert play(taken, 0, *[FIRST[LOOK]] * 3) == [0.0] * 4
    assert taken.state.held[0] == 0


def test_stop_ends_the_episode_unless_it_is_forbidden() -> None:
    sketch = one(scene([(0, 0), (3, 0)], [1]))
    play(sketch, FIRST[END])
    assert sketch.state.over.all() and sketch.state.frame[0] == 0
    assert not sketch.mask.any()
    endless = one(scene([(0, 0), (3, 0)], [1]), stop=False)
    assert not endless.mask[0, FIRST[END]]
    play(endless, FIRST[END])
    assert not endless.state.over.any() and endless.state.frame[0] == 10


@pytest.mark.parametrize(
    ("option", "told"),
    [
        (np.array([0, 1]), "whole numbers"),
        (np.array([0.0]), "whole numbers"),
        (np.array([COUNT]), "from 0 to"),
        (np.array([-1]), "from 0 to"),
    ],
)
def test_what_is_no_option_is_refused(option: np.ndarray, told: str) -> None:
    with pytest.raises(ValueError, match=told):
        one(scene([(0, 0), (3, 0)], [1])).step(option)


def test_what_no_sketch_can_be_made_of_is_refused() -> None:
    made = scene([(0, 0), (3, 0)], [1])
    with pytest.raises(ValueError, match="count must be at least 1"):
        Sketch([made], sure_times(), 0)
    with pytest.raises(ValueError, match="at least one"):
        Sketch([], sure_times(), 1)
    with pytest.raises(ValueError, match="shape"):
        Sketch([made], sure_times(), 2).reset([0], [0])
    with pytest.raises(ValueError, match="scene must be from 0 to 0"):
        Sketch([made], sure_times(), 1).reset([1], [0])
    with pytest.raises(ValueError, match=r"travel .* must have shape"):
        scene([(0, 0), (3, 0)], [1], travel=np.zeros((1, 1)))
    with pytest.raises(ValueError, match="target_site .* must be numbers"):
        scene([(0, 0), (3, 0)], [2])
    with pytest.raises(ValueError, match="pace must be positive"):
        Domain(pace=(1.3, 0.8))
    with pytest.raises(ValueError, match="missed must be a share"):
        Domain(missed=2.0)


def test_a_look_around_shows_smaller_things_than_a_look_straight_ahead() -> None:
    """A flat picture shows things at its edge larger: at 52.5 degrees by 1 / cos^3, 4.4 times."""
    for pixels, seen in ((3.1, (True, True)), (2.9, (False, True)), (0.7, (False, True)), (0.6, (False, False))):
        sketch = one(scene([(0, 0), (3, 0)], [1], cells=grid(-4.0, 4.0, 8.0), pixels=np.array([[9.0, pixels]])))
        ahead = bool(sketch.state.known[0, 0])
        play(sketch, FIRST[LOOK])
        assert (ahead, bool(sketch.state.known[0, 0])) == seen
