"""Teams in the sketch in cases that are worked out by hand: two robots on a line, things between them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from hazard_ms.sketch.teams.starts import GAP, starts
from hazard_ms.sketch.teams.world import TeamSketch
from hazard_ms.skills.options.options import CART, END, FIRST, LOOK
from tests.worlds.sketch_scenes import (
    ARRIVED,
    BAG_FRAMES,
    CART_FRAMES,
    FRAMES_PER_METRE,
    LOOK_FRAMES,
    PICK_FRAMES,
    SETTLE,
    grid,
    scene,
    sure_times,
)

FOUR = grid(-4.0, 4.0, 4.0)  # stands at (-2, -2), (2, -2), (-2, 2) and (2, 2)
HERE, THERE = (-2.0, -2.0), (2.0, -2.0)  # where the first and the second robot start, both facing east
BEHIND = 30.0 * (180 - 25) / 180  # frames of half a turn, whose last 25 degrees are turned while driving
LOOK_AROUND, STOP = FIRST[LOOK], FIRST[END]


def frames_to(metres: float, turn: float = 0.0) -> int:
    """Whole frames to a thing so far away, after a `turn` [frames]."""
    return round(FRAMES_PER_METRE * (metres - ARRIVED) + SETTLE + turn)


def two(*sites: tuple[float, float], cart: tuple[float, float] | None = None, **more: Any) -> TeamSketch:
    """A rescue of one target for each site by two robots, whose skills always work; perhaps with a cart."""
    carts = {} if cart is None else {"cart_site": [1 + len(sites)]}
    places = [HERE, *sites, *([] if cart is None else [cart])]
    made = scene(places, range(1, 1 + len(sites)), **{"cells": FOUR, **carts, **more})
    sketch = TeamSketch([made], sure_times(), 1, 2)
    sketch.reset([0], [0])
    return sketch


def play(sketch: TeamSketch, *options: int) -> list[int]:
    """Play `options`, one after another: the robots that chose them."""
    asked = []
    for option in options:
        asked.append(int(sketch.turn[0]))
        sketch.step(np.array([option]))
    return asked


def wait(sketch: TeamSketch) -> None:
    """Let the first robot look around until the second is asked."""
    while sketch.turn[0] == 0:
        play(sketch, LOOK_AROUND)


def test_further_robots_start_at_the_nearest_stand_with_a_gap() -> None:
    sketch = TeamSketch([scene([(0, 0), (3, 0)], [1])], sure_times(), 1, 4)  # stands every half metre
    sketch.reset([0], [0])
    places = sketch.state.place
    assert places[0].tolist() == [0.0, 0.0]
    gaps = np.hypot(*(places[:, None] - places).transpose(2, 0, 1))[np.triu_indices(4, 1)]
    assert gaps.min() == 1.0 >= 2 * 0.29 + GAP > np.hypot(0.5, 0.5)  # Fetch has a radius of 0.29 m
    assert np.hypot(*places[1:].T).tolist() == [1.0] * 3
    assert sketch.state.site.tolist() == [0, -1, -1, -1]


def test_a_scene_must_have_room_for_all_robots() -> None:
    made = scene([(0, 0), (3, 0)], [1], cells=grid(-4.0, 4.0, 8.0))
    sketch = TeamSketch([made], sure_times(), 1, 1)
    assert starts(sketch.stack, 1, 0.29).tolist() == [[[0.0, 0.0]]]
    with pytest.raises(ValueError, match="robots must be at most 1 in hand/00, got 2"):
        TeamSketch([made], sure_times(), 1, 2)


@pytest.mark.parametrize("robots", [0, 5])
def test_teams_have_one_to_four_robots(robots: int) -> None:
    with pytest.raises(ValueError, match=f"robots must be a whole number from 1 to 4, got {robots}"):
        TeamSketch([scene([(0, 0), (3, 0)], [1])], sure_times(), 1, robots)


def test_scenes_with_fires_to_put_out_are_refused() -> None:
    fire = {"fire_site": [1], "fire_place": np.zeros((1, 2)), "hit_at": np.full((1, 1), -1)}
    levels = {"fire_level": np.zeros((1, 1, 1)), "flames": np.ones((1, 1), int), "fire_seen": np.ones((4, 1), bool)}
    with pytest.raises(ValueError, match="nothing to put out, got hand/00"):
        two((1.0, -2.0), **fire, **levels)


def test_each_robot_has_its_own_clock_and_the_one_that_is_done_first_is_asked() -> None:
    """The first looks around while the second walks 3 m, picks up and puts away: until frame 256."""
    sketch = two((5.0, -2.0), (-2.0, 2.0))
    assert sketch.mask[0, 0] and sketch.mask[1, 0]  # both see what is ahead of them
    assert play(sketch, LOOK_AROUND, 0, LOOK_AROUND) == [0, 1, 0]
    assert sketch.state.frame.tolist() == [2 * LOOK_FRAMES, frames_to(3.0)]  # it has yet to pick up
    assert play(sketch, *[LOOK_AROUND] * 3) == [0, 0, 0] and sketch.turn[0] == 1
    assert sketch.state.frame.tolist() == [5 * LOOK_FRAMES, frames_to(3.0) + PICK_FRAMES + BAG_FRAMES]
    assert sketch.score.tolist() == [0.5] and sketch.saved_at[0].tolist() == [256, -1]


def test_a_target_goes_to_who_is_there_first_whoever_set_off_first() -> None:
    """It is 3 m ahead of the first, and 1 m behind the second."""
    sketch = two((1.0, -2.0), (-2.0, 2.0))
    assert play(sketch, LOOK_AROUND, LOOK_AROUND, 0, 0) == [0, 1, 0, 1]
    near = LOOK_FRAMES + frames_to(1.0, BEHIND)
    assert sketch.saved_at[0, 0] == near + PICK_FRAMES + BAG_FRAMES
    assert sketch.state.failures[:, 0].tolist() == [1, 0]
    assert sketch.state.frame.tolist() == [LOOK_FRAMES + frames_to(3.0), near + PICK_FRAMES + BAG_FRAMES]
    assert sketch.score.tolist() == [0.5] and not sketch.over[0]


def test_who_comes_later_fails_and_hears_of_the_rescue_from_its_frame_on() -> None:
    """2 m from each, behind the second, which fails at frame 182; it is safe at 254."""
    sketch = two((0.0, -2.0), (-2.0, 2.0))
    play(sketch, LOOK_AROUND, LOOK_AROUND, 0, 0)
    assert sketch.saved_at[0].tolist() == [LOOK_FRAMES + frames_to(2.0) + PICK_FRAMES + BAG_FRAMES, -1] == [254, -1]
    assert sketch.turn[0] == 1 and sketch.state.frame[1] == LOOK_FRAMES + frames_to(2.0, BEHIND) == 182
    for frame, known in ((182, True), (242, True), (302, False)):
        wait(sketch)
        assert sketch.state.frame[1] == frame and sketch.mask[1, 0] == known
        play(sketch, LOOK_AROUND)


def test_what_one_fails_to_pick_up_is_there_for_the_other() -> None:
    sketch = two((0.0, -2.0), (-2.0, 2.0))
    sketch.state.ease[0] = 0.0
    play(sketch, LOOK_AROUND, LOOK_AROUND, 0, 0)
    assert sketch.state.failures[:, 0].tolist() == [1, 0]
    assert sketch.saved_at[0, 0] == LOOK_FRAMES + frames_to(2.0, BEHIND) + PICK_FRAMES + BAG_FRAMES


def test_both_put_away_into_the_same_cart_and_what_falls_beside_it_is_there_for_both() -> None:
    """The first misses the cart. The second, which saw the target at the start, finds it where it fell."""
    sketch = two((-1.0, -2.0), (3.0, -2.0), cart=(0.0, 2.0))
    play(sketch, LOOK_AROUND, LOOK_AROUND, 0, 1)
    assert sketch.state.held.tolist() == [0, 1]
    sketch.state.ease[0] = 0.0
    play(sketch, FIRST[CART], FIRST[CART])
    assert sketch.turn[0] == 0 and sketch.state.held[0] == -1 and sketch.state.laid[:, 0].tolist() == [3, 3]
    wait(sketch)
    assert sketch.saved_at[0, 1] > 0 and sketch.score.tolist() == [0.5]
    start = int(sketch.state.frame[1])
    play(sketch, LOOK_AROUND)
    wait(sketch)
    play(sketch, 0)
    wait(sketch)
    assert sketch.state.held[1] == 0 and sketch.state.frame[1] == start + LOOK_FRAMES + PICK_FRAMES  # it is there
    play(sketch, FIRST[CART])
    assert sketch.over[0] and sketch.score.tolist() == [1.0]
    assert sketch.saved_at[0, 0] == start + LOOK_FRAMES + PICK_FRAMES + CART_FRAMES


def test_a_robot_does_not_see_what_another_one_holds() -> None:
    """The first picks it up from frame 127 on. The second, which does not see it from its start, is moved."""
    for frame, known in ((60, True), (180, False)):
        pixels = np.full((4, 3), 99.0)
        pixels[1, 1] = 0.0
        sketch = two((0.5, -2.0), (-2.0, 2.0), pixels=pixels)
        play(sketch, 0)
        while sketch.state.frame[1] < frame:
            play(sketch, LOOK_AROUND)
        assert frames_to(2.5) == 127 and not sketch.state.known[1, 0]
        sketch.state.place[1], sketch.state.stand[1] = (2.0, 2.0), 3
        assert play(sketch, LOOK_AROUND) == [1]
        assert sketch.state.known[1, 0] == known


def test_the_episode_goes_on_until_all_have_stopped() -> None:
    sketch = two((5.0, -2.0))
    assert play(sketch, STOP) == [0] and not sketch.over[0]
    assert play(sketch, LOOK_AROUND, LOOK_AROUND) == [1, 1]
    assert play(sketch, STOP) == [1] and sketch.over.tolist() == [True]
    before = sketch.state.frame.copy()
    assert sketch.step(np.array([0]))[0].tolist() == [0.0] and (sketch.state.frame == before).all()


def test_it_ends_with_the_last_target_or_the_last_frame() -> None:
    sketch = two((-1.0, -2.0), (3.0, -2.0))
    play(sketch, 0, 1)
    assert sketch.over[0] and sketch.score.tolist() == [1.0]
    assert sketch.saved_at[0].tolist() == [frames_to(1.0) + PICK_FRAMES + BAG_FRAMES] * 2
    late = two((-1.0, -2.0), (3.0, -2.0), max_frames=120)
    play(late, 0, 1)
    assert late.over[0] and late.score.tolist() == [0.0] and late.state.frame.tolist() == [120, 120]


def test_what_the_hazard_brings_to_safety_counts_once_unless_a_robot_has_it() -> None:
    sketch = two((3.0, -2.0), (-2.0, 2.0), safe_at=[85, -1])
    play(sketch, *[LOOK_AROUND] * 4)
    assert sketch.score.tolist() == [0.5] and sketch.saved_at[0].tolist() == [85, -1]
    taken = two((3.0, -2.0), (-2.0, 2.0), cart=(0.0, 2.0), safe_at=[85, -1])
    play(taken, LOOK_AROUND, 0, *[LOOK_AROUND] * 4)  # the second has it from frame 34 on
    assert taken.score.tolist() == [0.0] and taken.state.held[1] == 0
