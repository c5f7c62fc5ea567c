"""Rewards and ends of rescues in the sketch, worked out by hand."""

from __future__ import annotations

import numpy as np
import pytest

from hazard_ms.sketch.environments.choices import OptionChoices
from hazard_ms.sketch.environments.rewarded import Rewarded
from hazard_ms.sketch.rescues.scene import SketchScene
from hazard_ms.sketch.rescues.state import TRAINING
from hazard_ms.sketch.world import Sketch
from hazard_ms.skills.options.options import CART, END, FIRST, LOOK
from tests.worlds.sketch_scenes import BAG_FRAMES, PICK_FRAMES, chancy_times, random_scene, scene, sure_times

FIRE = [(20.0, 600.0)]
EACH = round(62 * 1.5 + 3) + PICK_FRAMES + BAG_FRAMES  # frames of a rescue 2 m away


def played(made: SketchScene, reward: str) -> Rewarded:
    """One rescue in a scene, just begun."""
    play = Rewarded(OptionChoices(Sketch([made], sure_times(), 1), FIRE), reward)
    play.reset([0], [0])
    return play


def test_the_only_target_two_metres_away() -> None:
    """(20 - 0) - (0 - 20) - 0.1, as in the paper's code."""
    made = scene([(0.0, 0.0), (2.0, 0.0)], [1])
    rewards, terminated, truncated, _ = played(made, "paper").step([0])
    assert rewards.tolist() == pytest.approx([39.9]) and terminated.all() and not truncated.any()
    assert played(made, "value").step([0])[0].tolist() == [1.0]


def test_what_is_damaged_counts_half_and_what_waits_is_measured_from_where_the_robot_is() -> None:
    """From (1.5, 0), where the way to the first target ends, it is 2.5 m to the second."""
    made = scene([(0.0, 0.0), (2.0, 0.0), (4.0, 0.0)], [1, 2], value=[5.0, 1.0], damaged_at=[10, -1])
    value, of_paper = played(made, "value"), played(made, "paper")
    assert value.step([0])[0].tolist() == pytest.approx([2.5 / 6.0])
    assert of_paper.step([0])[0].tolist() == pytest.approx([20.0 - 10.0 * (2.5 - 2.0) - 0.1], abs=0.3)
    assert value.step([1])[0].tolist() == pytest.approx([1.0 / 6.0])


def test_a_cart_is_what_counts_with_full_hands() -> None:
    made = scene([(0.0, 0.0), (2.0, 0.0), (2.0, 3.0)], [1], cart_site=[2])
    play = played(made, "paper")
    taken = float(play.step([0])[0][0])
    to_cart = float(np.hypot(*(play.sketch.state.place[0] - (2.0, 3.0))))
    assert taken == pytest.approx(-10.0 * (to_cart - 2.0) - 0.1) and 2.5 < to_cart < 3.5
    brought, terminated, *_ = play.step([FIRST[CART]])
    assert brought.tolist() == pytest.approx([20.0 + 10.0 * to_cart - 0.1]) and terminated.all()


def test_what_cannot_be_chosen_is_punished() -> None:
    made = scene([(0.0, 0.0), (2.0, 0.0)], [1])
    assert played(made, "paper").step([7])[0].tolist() == pytest.approx([-5.1])
    assert played(made, "value").step([7])[0].tolist() == [0.0]
    assert played(made, "paper").step([FIRST[LOOK]])[0].tolist() == pytest.approx([-0.1])


def test_stopping_terminates_and_the_end_of_time_truncates() -> None:
    made = scene([(0.0, 0.0), (2.0, 0.0)], [1], max_frames=EACH - 1)
    _, terminated, truncated, _ = played(made, "value").step([FIRST[END]])
    assert (terminated.tolist(), truncated.tolist()) == ([True], [False])
    rewards, terminated, truncated, _ = played(made, "value").step([0])
    assert (rewards.tolist(), terminated.tolist(), truncated.tolist()) == ([0.0], [False], [True])


@pytest.mark.parametrize("carts", [0, 2])
def test_the_rewards_of_episodes_add_up_to_their_value(carts: int) -> None:
    """Worked out from what was rescued when; with changed values, and with things that drift to safety."""
    scenes = [random_scene(seed, carts=carts, moving=True) for seed in range(6)]
    play = Rewarded(OptionChoices(Sketch(scenes, chancy_times(), 48, TRAINING, stop=False), FIRE))
    seeds, chance, total = np.arange(48), np.random.default_rng(0), np.zeros(48)
    play.reset(seeds % 6, seeds)
    state = play.sketch.state
    while not state.over.all():
        total += play.step((chance.random(play.sketch.mask.shape) * play.sketch.mask).argmax(axis=1))[0]
    worth = np.where(state.spoiled, 0.5, 1.0) * state.value * (state.rescued_at >= 0)
    assert total == pytest.approx(worth.sum(axis=1) / state.value.sum(axis=1)) and 0.05 < total.mean() < 0.95


def test_an_unknown_reward_is_refused() -> None:
    with pytest.raises(ValueError, match="reward must be one of value, paper, got 'gold'"):
        played(scene([(0.0, 0.0), (2.0, 0.0)], [1]), "gold")
