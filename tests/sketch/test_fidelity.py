"""Policies of the sketch in cases that are worked out by hand, and the comparison with real episodes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hazard_ms.sketch.fidelity import Fidelity, SceneScore, compared, same_order, sketched, table
from hazard_ms.sketch.policies import POLICIES, greedy, nearest, play, rule
from hazard_ms.sketch.world import Sketch
from hazard_ms.skills.options.options import CART, END, FIRST, LANDMARK, LOOK
from tests.worlds.sketch_scenes import (
    BAG_FRAMES,
    LOOK_FRAMES,
    PICK_FRAMES,
    chancy_times,
    grid,
    random_scene,
    scene,
    sure_times,
)

NO_CHANCE = np.random.default_rng(0)


def after_a_look(made: object, **more: object) -> Sketch:
    """One rescue that looked around first."""
    sketch = Sketch([made], sure_times(), 1)  # type: ignore[list-item]
    sketch.reset([0], [0])
    sketch.step(np.array([FIRST[LOOK]]))
    return sketch


def test_greedy_weighs_distance_against_worth_and_nearest_does_not() -> None:
    """(1 + 1) / 1 against (3 + 1) / 5."""
    sketch = after_a_look(scene([(0, 0), (1, 0), (3, 0)], [1, 2], value=[1.0, 5.0]))
    assert greedy(sketch, NO_CHANCE).tolist() == [1]
    assert nearest(sketch, NO_CHANCE).tolist() == [0]


def test_greedy_halves_what_will_be_damaged_by_the_line_through_two_sightings() -> None:
    """Levels of 0 at frame 0 and 6 at frame 60 give 6 + 0.1 x (3 + 1) m x 62 frames/m = 31 on arrival at the second."""
    level = np.zeros((20, 2, 1))
    level[6:, 1] = 6.0
    for limit, choice in ((31.5, 1), (30.5, 0)):
        made = scene(
            [(0, 0), (-3, 0), (3, 0)], [1, 2], value=[3.0, 4.0], heading=0.0, level=level, limit=[[np.inf], [limit]]
        )
        assert greedy(after_a_look(made), NO_CHANCE).tolist() == [choice]


def test_greedy_turns_away_from_what_failed_and_goes_to_the_nearest_cart() -> None:
    sketch = after_a_look(scene([(0, 0), (1, 0), (1.5, 0), (4, 0), (2, 0)], [1, 2], cart_site=[3, 4]))
    assert greedy(sketch, NO_CHANCE).tolist() == [0]
    sketch.state.failures[0, 0] = 1
    assert greedy(sketch, NO_CHANCE).tolist() == [1]
    sketch.step(np.array([1]))
    assert sketch.state.held[0] == 1
    assert greedy(sketch, NO_CHANCE).tolist() == [FIRST[CART] + 1]


@pytest.mark.parametrize("policy", POLICIES.values(), ids=POLICIES)
def test_all_look_first_and_search_when_they_know_no_target(policy: object) -> None:
    hidden = np.array([[9, 0, 9]])
    made = scene([(0, 0), (3, 0), (2, 2)], [1], landmark_site=[2], cells=grid(-4.0, 4.0, 8.0), pixels=hidden)
    sketch = Sketch([made], sure_times(), 1)
    sketch.reset([0], [0])
    assert policy(sketch, NO_CHANCE).tolist() == [FIRST[LOOK]]  # type: ignore[operator]
    sketch.step(np.array([FIRST[LOOK]]))
    sketch.state.spots[:] = 1  # much is left to see around the landmark
    sketch._menu()
    assert policy(sketch, NO_CHANCE).tolist() == [FIRST[LANDMARK]]  # type: ignore[operator]


def test_greedy_stops_where_nothing_is_left_and_rule_looks_on() -> None:
    sketch = after_a_look(scene([(0, 0), (3, 0)], [1], cells=grid(-4.0, 4.0, 8.0), pixels=np.zeros((1, 2))))
    assert greedy(sketch, NO_CHANCE).tolist() == [FIRST[END]]
    assert rule(sketch, NO_CHANCE).tolist() == [FIRST[LOOK]]


def test_rule_draws_any_known_target_and_gives_up_after_two_failures() -> None:
    sketch = after_a_look(scene([(0, 0), (1, 0), (2, 0), (3, 0)], [1, 2, 3]))
    sketch.state.failures[0, 1] = 2
    chance = np.random.default_rng(0)
    assert {int(rule(sketch, chance)[0]) for _ in range(50)} == {0, 2}


def test_policies_choose_what_can_be_chosen() -> None:
    for carts in (0, 2):
        scenes = [random_scene(number, carts=carts) for number in range(10)]
        for policy in POLICIES.values():
            sketch, chance = Sketch(scenes, chancy_times(), 40), np.random.default_rng(0)
            sketch.reset(np.arange(40) % 10, np.arange(40))
            while not sketch.state.over.all():
                option = policy(sketch, chance)
                given_up = (sketch.state.failures >= 2).any(axis=1)  # the rule agent then waits
                assert (sketch.mask[np.arange(40), option] | sketch.state.over | given_up).all()
                sketch.step(option)
            assert sketch.state.score.max() > 0.3


def test_the_score_in_a_scene_is_the_mean_of_its_trials() -> None:
    made = scene([(0, 0), (3, 0)], [1])
    frames = LOOK_FRAMES + 158 + PICK_FRAMES + BAG_FRAMES
    assert sketched("greedy", [made], [7], sure_times(), trials=3) == [SceneScore("hand/00", 7, 1.0, frames, 1.0)]
    many = sketched("greedy", [random_scene(2), random_scene(3)], [0, 1], chancy_times(), trials=200)
    again = sketched("greedy", [random_scene(3)], [1], chancy_times(), trials=200)
    assert again == many[1:]
    sketch = Sketch([random_scene(3)], chancy_times(), 200)
    sketch.reset(np.zeros(200, int), np.arange(200, 400))
    play(sketch, greedy)
    assert many[1].value == pytest.approx(sketch.state.score.mean())


def scores(values: list[float], frames: float) -> list[SceneScore]:
    return [SceneScore(f"room/{n:02d}", n, value, frames, 2.0) for n, value in enumerate(values)]


def test_the_comparison_gives_gaps_ranks_and_frames() -> None:
    found = compared("greedy", scores([0.2, 0.4, 0.9], 1000.0), scores([0.3, 0.25, 1.0], 1080.0))
    assert (found.real_value, found.sketch_value) == pytest.approx((0.5, 1.55 / 3))
    assert found.correlation == pytest.approx(0.5)  # ranks 1 2 3 and 2 1 3: 1 - 6 x 2 / (3 x 8)
    assert (found.real_frames, found.sketch_frames) == (500.0, 540.0)
    assert not found.good
    assert compared("greedy", scores([0.2, 0.4, 0.9], 1000.0), scores([0.2, 0.45, 0.95], 1080.0)).good
    assert not compared("greedy", scores([0.2, 0.4, 0.9], 1000.0), scores([0.2, 0.45, 0.95], 1200.0)).good
    assert not compared("greedy", scores([0.2, 0.4, 0.9], 1000.0), scores([0.3, 0.5, 0.99], 1000.0)).good
    assert np.isnan(compared("greedy", scores([0.5, 0.5], 9.0), scores([0.4, 0.5], 9.0)).correlation)


def test_the_ranks_are_those_of_scenes_that_were_played_several_times() -> None:
    """Means 0.3, 0.5, 0.7 beside 0.2, 0.4, 0.9: the same ranks, though single episodes are not in the same order."""

    def twice(first: list[float], second: list[float]) -> list[SceneScore]:
        again = [SceneScore(p.scene, p.seed + 3, p.value, p.last, p.rescued) for p in scores(second, 900.0)]
        return [*scores(first, 900.0), *again]

    found = compared("rule", twice([0.6, 0.1, 0.8], [0.0, 0.9, 0.6]), twice([0.2, 0.3, 0.9], [0.2, 0.5, 0.9]))
    assert found.episodes == 6 and found.correlation == pytest.approx(1.0)


def test_scenes_of_the_same_mean_are_a_tie_in_whatever_order_they_were_played() -> None:
    """(0.1 + 0.2) + 0.3 and (0.3 + 0.2) + 0.1 differ in their last bit."""
    played = [SceneScore(f"room/{n % 2}", n, v, 900.0, 2.0) for n, v in enumerate([0.1, 0.3, 0.2, 0.2, 0.3, 0.1])]
    assert np.isnan(compared("rule", played, [replace(p, value=p.seed / 9) for p in played]).correlation)


def test_different_episodes_are_not_compared() -> None:
    with pytest.raises(ValueError, match="same episodes"):
        compared("greedy", scores([0.2, 0.4], 9.0), scores([0.2], 9.0))
    with pytest.raises(ValueError, match="same episodes"):
        compared("greedy", [], [])


def test_the_table_tells_whether_the_agents_keep_their_order() -> None:
    rows = [Fidelity("greedy", 25, 0.7, 0.72, 0.8, 400.0, 410.0), Fidelity("rule", 25, 0.5, 0.75, 0.7, 400.0, 410.0)]
    assert not same_order(rows)
    text = table({"HazardFire-v1": rows, "HazardWind-v1": rows[:1]}).splitlines()
    assert len(text) == 6
    assert text[1].split() == ["HazardFire-v1", "greedy", "25", "0.700", "0.720", "+0.020", "0.80", "400", "410", "yes"]
    assert text[2].endswith("no") and text[3].endswith("no") and text[5].endswith("yes")
