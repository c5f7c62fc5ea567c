"""Teams of the sketch choose as those of the simulator do: cases that are worked out by hand."""

from __future__ import annotations

import numpy as np
import pytest

from hazard_ms.sketch.policies import greedy
from hazard_ms.sketch.policies import play as play_alone
from hazard_ms.sketch.teams.policies import POLICIES, allocated, auction, independent, mean_values, play
from hazard_ms.sketch.teams.world import TeamSketch
from hazard_ms.sketch.world import Sketch
from hazard_ms.skills.options.options import CART, END, FIRST, LOOK
from tests.sketch.teams.test_random_teams import scenes
from tests.sketch.teams.test_team_world import frames_to, two
from tests.worlds.sketch_scenes import BAG_FRAMES, LOOK_FRAMES, PICK_FRAMES, chancy_times, scene, sure_times

NO_CHANCE = np.random.default_rng(0)


def after_looks(*sites: tuple[float, float], **more: object) -> TeamSketch:
    """A rescue of one target for each site by robots at (-2, -2) and (2, -2), both of which have looked around."""
    sketch = two(*sites, **more)  # type: ignore[arg-type]
    for _ in range(2):
        assert POLICIES["auction"](sketch, NO_CHANCE).tolist() == [FIRST[LOOK]]
        sketch.step(np.array([FIRST[LOOK]]))
    return sketch


def test_each_target_goes_to_the_robot_that_gets_there_on_the_shortest_way_with_what_it_fetches_before() -> None:
    """The second bids 1 m for the first target, then 1 + 1 + 4 m for the other, for which the first one bids 7 m."""
    assert allocated(after_looks((1.0, -2.0), (5.0, -2.0))).tolist() == [[1, 1]]
    assert allocated(after_looks((1.0, -2.0), (4.5, -2.0))).tolist() == [[1, 1]]  # 5.5 and 6.5 m
    assert allocated(after_looks((1.0, -2.0), (2.0, 2.0))).tolist() == [[1, 0]]  # 1 + 1 + 4.12 and 5.66 m


def test_a_robot_bids_only_for_what_it_has_seen_and_has_not_given_up() -> None:
    sketch = after_looks((1.0, -2.0), (5.0, -2.0))
    sketch.state.failures[1, 0] = 4
    assert allocated(sketch).tolist() == [[0, 1]]
    sketch.asked_site[0] = -1
    assert allocated(sketch).tolist() == [[-1, 1]]


def test_what_a_robot_is_on_its_way_to_stays_its_own() -> None:
    """The first, told to, sets off to what is nearer to the second, which then leaves it alone and takes the other."""
    sketch = after_looks((1.0, -2.0), (5.0, -2.0))
    sketch.step(np.array([0]))
    assert sketch.turn.tolist() == [1] and allocated(sketch).tolist() == [[0, 1]]
    assert auction(sketch, NO_CHANCE).tolist() == [1]
    assert independent(sketch, NO_CHANCE).tolist() == [0]


def test_a_robot_looks_around_rather_than_stop_while_another_one_fetches() -> None:
    sketch = after_looks((0.0, -2.0))
    assert auction(sketch, NO_CHANCE).tolist() == [0]
    sketch.step(np.array([0]))
    assert sketch.turn.tolist() == [1] and auction(sketch, NO_CHANCE).tolist() == [FIRST[LOOK]]
    sketch.state.failures[:] = 4
    sketch._menu()
    sketch.aim[:] = -1  # nobody fetches it any more
    assert auction(sketch, NO_CHANCE).tolist() == [FIRST[END]]


def test_what_is_in_a_hand_goes_to_the_nearest_cart() -> None:
    sketch = after_looks((-1.0, -2.0), (3.0, -2.0), cart=(0.0, 2.0))
    for _ in range(2):
        sketch.step(auction(sketch, NO_CHANCE))
    assert sketch.state.held.tolist() == [0, 1] and allocated(sketch).tolist() == [[0, 1]]
    assert auction(sketch, NO_CHANCE).tolist() == [FIRST[CART]]


def test_two_who_divide_the_targets_are_sooner_done_than_two_who_run_to_the_same() -> None:
    """Both like what lies between them best. Alone, the second one comes too late for it, and then goes for the other.

    In the auction it goes there at once: 4.47 m, after a turn by 116.6 degrees.
    """
    first = LOOK_FRAMES + frames_to(2.0) + PICK_FRAMES + BAG_FRAMES
    done = {}
    for name, policy in POLICIES.items():
        sketch = two((0.0, -2.0), (0.0, 2.0))
        play(sketch, policy)
        done[name] = sketch.saved_at[0].tolist()
        assert sketch.score.tolist() == [1.0]
    turn = 30.0 * (np.degrees(np.arctan2(4.0, -2.0)) - 25) / 180
    assert done["auction"] == [first, LOOK_FRAMES + frames_to(np.hypot(2, 4), turn) + PICK_FRAMES + BAG_FRAMES]
    assert done["independent"][0] == first and done["independent"][1] > done["auction"][1] + frames_to(1.0)


@pytest.mark.parametrize("team", POLICIES)
@pytest.mark.parametrize("family", ["rooms", "carts", "carts and drift"])
def test_one_robot_of_any_team_is_greedy(team: str, family: str) -> None:
    count = 60
    one, own = (made(scenes(family), chancy_times(), count, *more) for made, *more in ((Sketch,), (TeamSketch, 1)))
    for sketch in (one, own):
        sketch.reset(np.arange(count) % 10, np.arange(count))
    play_alone(one, greedy)
    play(own, POLICIES[team])
    assert (one.state.score == own.score).all() and (one.state.frame == own.state.frame).all()


def test_more_robots_rescue_more_and_auctions_help() -> None:
    """8 targets in a square of 12 m, for 900 frames."""
    places = np.random.default_rng(0).uniform(-4.0, 8.0, (8, 8, 2))
    hurry = [scene([(0.0, 0.0), *map(tuple, row)], range(1, 9), max_frames=900) for row in places.tolist()]
    means = {}
    for team in POLICIES:
        for robots in (1, 2, 4):
            means[team, robots] = mean_values(team, hurry, range(8), sure_times(), robots, 1).mean()
        assert means[team, 1] < means[team, 2] < means[team, 4]
    assert means["auction", 2] > means["independent", 2] and means["auction", 4] > means["independent", 4]


def test_the_mean_value_of_a_scene_is_the_same_alone_as_among_others() -> None:
    some = scenes("carts")[:3]
    many = mean_values("auction", some, [0, 1, 2], chancy_times(), 2, 20)
    assert mean_values("auction", some[2:], [2], chancy_times(), 2, 20).tolist() == many[2:].tolist()
    with pytest.raises(ValueError, match="team must be one of independent, auction, got 'joint'"):
        mean_values("joint", some, [0, 1, 2], chancy_times(), 2, 20)
