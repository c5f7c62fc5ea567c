"""Reinforcement over the six actions: the same trainer, with the settings, the map and the network of the original."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch

from hazard_ms.agents.learned.map_policy import MapPolicy
from hazard_ms.agents.learned.weights import contents, load_map
from hazard_ms.learning.actor_critic import ActorCritic
from hazard_ms.learning.checks import Check, ended
from hazard_ms.learning.playing import MapPlayer, at_random, possible_at_random, six_scores
from hazard_ms.learning.ppo import Learner, shape_for, value_of
from hazard_ms.learning.settings import OURS, PAPER
from hazard_ms.learning.vec_env import SketchVecEnv
from hazard_ms.sketch.environments.batch import SketchBatch
from hazard_ms.sketch.scenes import more_scenes
from hazard_ms.sketch.skill_times import load
from hazard_ms.skills.options.paper_actions import COUNT
from tests.worlds.sketch_scenes import chancy_times, random_scene

FIRE = [(20.0, 600.0)]
FEW = dataclasses.replace(PAPER, rescues=4, steps=8, batch=16, check=1)


def learner(seed: int = 0, masked: bool = False, **more: Any) -> Learner:
    made = [random_scene(seed) for seed in range(2)]
    shape = shape_for("paper", FIRE, share=0.125, masked=masked)
    return Learner(
        made, made, FIRE, chancy_times(), seed, "paper", settings=dataclasses.replace(FEW, **more), shape=shape
    )


def test_the_settings_are_those_of_the_original() -> None:
    """[/docs/learning.md]: 32 steps in 32 batches, 4 passes, and so on; 16 rescues at once are ours."""
    assert PAPER.rescues * PAPER.steps // PAPER.batch == 32 and (PAPER.steps, PAPER.epochs) == (32, 4)
    assert (PAPER.rates, PAPER.clip, PAPER.discount, PAPER.trace) == ((2.5e-4, 2.5e-4), 0.1, 0.99, 0.95)
    model = learner().model
    assert (model.vf_coef, model.max_grad_norm, model.ent_coef) == (0.5, 0.5, 0.01)
    assert model.policy.optimizer.defaults["eps"] == 1e-5 and PAPER.decisions == 10**5 and OURS.patience == 0


@pytest.mark.parametrize("masked", [False, True])
def test_what_is_sampled_is_allowed(masked: bool) -> None:
    """Everything is, unless masked."""
    made = learner(masked=masked)
    env, seen = made.model.get_env(), set[bool]()
    assert env is not None
    obs = env.reset()
    for _ in range(20):
        mask = np.stack(env.env_method("action_masks"))
        with torch.no_grad():
            action = made.model.policy(torch.from_numpy(np.asarray(obs)), action_masks=mask)[0]
        assert mask[np.arange(4), action.numpy()].all()
        seen |= set(mask.all(axis=1).tolist())
        obs, *_ = env.step(action.numpy())
    assert (False in seen) is masked


def test_an_interrupted_training_goes_on_as_it_was_and_its_file_plays_alike(tmp_path: Path) -> None:
    first = learner()
    first.train(64, 60.0, lambda _: None)
    second = learner(seed=1)
    second.resume(first.saved())
    assert second.curve == first.curve and second.model.num_timesteps == 64
    for name, part in first.model.policy.state_dict().items():
        assert torch.equal(second.model.policy.state_dict()[name], part)
    second.train(96, 60.0, lambda _: None)
    assert second.curve[-1].decisions == 96 and isinstance(second.best, MapPolicy)
    packed, told = contents(second.best, "HazardFire-v1", {})
    (tmp_path / "one.safetensors").write_bytes(packed)
    (tmp_path / "one.json").write_text(told)
    scenes = [random_scene(seed) for seed in range(2)]
    again = load_map(tmp_path / "one.safetensors", "HazardFire-v1")
    assert value_of(again, scenes, chancy_times()) == second.value() == value_of(second.best, scenes, chancy_times())


def test_training_ends_when_it_is_stuck() -> None:
    """The best check is the second; the fourth is as good, but no better."""
    curve = [Check(k, 0.0, 0.0, value, 0.0, 0.0) for k, value in enumerate((0.1, 0.3, 0.2, 0.3, 0.25))]
    three, never = (dataclasses.replace(FEW, patience=patience) for patience in (3, 0))
    assert [ended(curve[:n], three, 10**6, 60.0) for n in range(6)] == [False] * 5 + [True]
    assert not ended(curve, never, 10**6, 60.0) and ended(curve, never, 4, 60.0)
    made = learner(patience=3)
    made.curve = curve
    made.train(10**6, 60.0, lambda _: None)
    assert len(made.curve) == 5 and made.model.num_timesteps == 0


def test_learners_get_scaled_rewards_and_info_tells_the_true_ones() -> None:
    envs = SketchVecEnv(SketchBatch([random_scene(1)], FIRE, chancy_times(), 3, "paper", actions="paper"), scale=0.05)
    envs.seed(0)
    assert envs.reset().shape == (3, 5, 64, 64)  # type: ignore[union-attr]
    sums, ends = np.zeros(3), 0
    for k in range(300):
        _, rewards, done, infos = envs.step(np.full(3, k % COUNT))
        sums += rewards / 0.05
        for n in np.flatnonzero(done):
            assert infos[n]["episode"]["r"] == pytest.approx(sums[n], abs=1e-3)
            sums[n], ends = 0.0, ends + 1
    assert ends > 3


def test_chance_among_what_can_be_done_rescues_more_than_chance() -> None:
    scenes = [random_scene(seed) for seed in range(4)]
    one, other = (six_scores(scenes, chancy_times(), policy).mean() for policy in (at_random, possible_at_random))
    assert 0.0 < one < other
    policy = learner().policy
    assert isinstance(policy, MapPolicy) and isinstance(learner().model.policy, ActorCritic)
    untrained = six_scores(scenes, chancy_times(), MapPlayer(policy).play).mean()
    assert abs(untrained - one) < 0.15  # it likes all actions alike


@pytest.mark.long
@pytest.mark.timeout(1800)
def test_learning_pays() -> None:
    """In eight rooms on fire: more Value than before it, by three standard errors of 64 paired rescues."""
    scenes = more_scenes("HazardFire-v1", "paper", 25, 8)
    shape = shape_for("paper", FIRE, share=0.125, masked=True)
    settings = dataclasses.replace(PAPER, check=8)
    made = Learner(scenes, scenes, FIRE, load("fetch"), 0, "paper", settings=settings, shape=shape)
    before = six_scores(scenes, load("fetch"), MapPlayer(made.policy).play)  # type: ignore[arg-type]
    made.train(20_000, 60.0, lambda _: None)
    gain = six_scores(scenes, load("fetch"), MapPlayer(made.policy).play) - before  # type: ignore[arg-type]
    assert gain.mean() > 3.0 * gain.std() / gain.size**0.5, (gain.mean(), gain.std(), made.curve)
