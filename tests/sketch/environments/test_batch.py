"""Many rescues as one vector environment: each goes as if it were alone, and is followed by the next."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from hazard_ms.sketch.environments.batch import SketchBatch
from hazard_ms.sketch.rescues.state import TRAINING
from hazard_ms.skills.options.features import Encoder
from hazard_ms.skills.options.options import CART, COUNT, END, FIRST, GIVE_UP, LANDMARK, LOOK
from tests.worlds.sketch_scenes import chancy_times, random_scene

FIRE = [(20.0, 600.0)]


def batch(count: int, **more: Any) -> SketchBatch:
    scenes = [random_scene(seed, carts=2 * (seed % 2)) for seed in range(5)]
    return SketchBatch(scenes, FIRE, chancy_times(), count, **more)


def chosen(made: SketchBatch, chance: np.random.Generator) -> np.ndarray:
    """A random option of each rescue, out of those that can be chosen."""
    mask = made.action_masks()
    return np.asarray((chance.random(mask.shape) * mask).argmax(axis=1))


def test_spaces_and_what_comes_back_fit() -> None:
    made, chance = batch(7, domain=TRAINING), np.random.default_rng(0)
    obs, info = made.reset(seed=3)
    assert made.observation_space.contains(obs) and info["action_mask"].shape == (7, COUNT)
    for _ in range(30):
        obs, rewards, terminated, truncated, info = made.step(chosen(made, chance))
        assert made.observation_space.contains(obs) and made.single_observation_space.contains(obs[0])
        assert {part.shape for part in (rewards, terminated, truncated, info["value"], info["frame"])} == {(7,)}
        assert not (terminated & truncated).any()


def test_an_episode_is_followed_by_the_next_in_the_same_step() -> None:
    made, chance, sums, ends = batch(16, stop=False), np.random.default_rng(1), np.zeros(16), 0
    last, _ = made.reset(seed=0)
    for _ in range(80):
        obs, rewards, terminated, truncated, info = made.step(chosen(made, chance))
        sums, over = sums + rewards, terminated | truncated
        assert over.any() == ("final_obs" in info)
        for n in np.flatnonzero(over):
            ends += 1
            assert info["final_info"]["value"][n] == pytest.approx(sums[n]) and info["_final_info"][n]
            assert info["value"][n] == 0.0 == info["frame"][n] < info["final_info"]["frame"][n]
            assert info["final_info"]["decisions"][n] >= 1
            elapsed, remaining = Encoder(FIRE, 0.0).split(info["final_obs"][n])["global"][0, :2]
            frame = info["final_info"]["frame"][n]
            assert elapsed == pytest.approx(frame / (frame + 1500.0 * remaining), abs=1e-5) and (elapsed > 0) == (
                frame > 0
            )
        assert (info["frame"][~over] > 0).all() and (obs[~over] != last[~over]).any(axis=1).all()
        sums[over], last = 0.0, obs
    assert ends > 16


def test_a_seed_determines_everything_that_follows() -> None:
    found = []
    for seed in (5, 5, 6):
        made, chance = batch(8), np.random.default_rng(0)
        rows = [made.reset(seed=seed)[0], *(made.step(chosen(made, chance))[0] for _ in range(25))]
        found.append(np.stack(rows))
    np.testing.assert_array_equal(found[0], found[1])
    assert (found[0][0] != found[2][0]).any()


@pytest.mark.long
def test_of_100_000_options_that_masks_allow_none_is_impossible() -> None:
    """By the rules of the menu, written once more: what is known, open and not given up, and the right hand."""
    made, chance = batch(250, domain=TRAINING), np.random.default_rng(0)
    made.reset(seed=0)
    for _ in range(400):
        option, state = chosen(made, chance), made.sketch.state
        targets, row = state.value.shape[1], np.arange(250)
        kind = np.searchsorted([FIRST[CART], FIRST[LANDMARK], FIRST[LOOK], FIRST[END]], option, side="right")
        for n in row[kind < 2]:
            thing = option[n] if kind[n] == 0 else targets + option[n] - FIRST[CART]
            assert state.known[n, thing] and state.failures[n, thing] < GIVE_UP
            assert (state.held[n] < 0) == (kind[n] == 0)
            if kind[n] == 0:
                assert state.value[n, thing] > 0 and state.rescued_at[n, thing] < 0
        for n in row[kind == 2]:
            mark = made.sketch.slots[n, option[n] - FIRST[LANDMARK]]
            assert mark >= 0 and state.visits[n, mark] < 2
        assert not state.over.any()
        made.step(option)


@pytest.mark.parametrize(
    ("wrong", "said"),
    [({"count": 0}, "num_envs must be"), ({"count": 2, "stop": 1}, "stop"), ({"count": 2, "reward": "x"}, "reward")],
)
def test_what_cannot_be_is_refused(wrong: dict[str, Any], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        batch(**wrong)


def test_steps_and_resets_refuse_what_they_cannot_do() -> None:
    made = batch(2)
    with pytest.raises(ValueError, match="call reset first"):
        made.step(np.array([0, 0]))
    with pytest.raises(ValueError, match="seed must be one whole number"):
        made.reset(seed=[1, 2])
    with pytest.raises(ValueError, match="options must be None"):
        made.reset(options={"scene": "x"})
    with pytest.raises(ValueError, match="a reset option must be one of"):
        made.reset(options={"lerobot_rollout": True})
    made.reset(seed=0, options={"lerobot_new_rollout": True})  # as lerobot-eval does
    for wrong in (np.array([0]), np.array([0, COUNT]), np.array([0.0, 1.0])):
        with pytest.raises(ValueError, match="option must be"):
            made.step(wrong)
