"""Reinforcement in the sketch: what is asked of the policy while it learns, and that it learns."""

from __future__ import annotations

import dataclasses
import itertools

import numpy as np
import pytest
import torch

from hazard_ms.agents.learned.set_policy import SetPolicy
from hazard_ms.learning import ppo
from hazard_ms.learning.actor_critic import ActorCritic
from hazard_ms.learning.checks import Check
from hazard_ms.learning.cloning import scores
from hazard_ms.learning.ppo import Learner
from hazard_ms.learning.runs import line
from hazard_ms.learning.settings import OURS
from hazard_ms.sketch.rescues.scene import Ints
from hazard_ms.sketch.scenes import more_scenes
from hazard_ms.sketch.skill_times import load
from hazard_ms.sketch.world import Sketch
from hazard_ms.skills.options.options import CART, COUNT, END, FIRST
from tests.worlds.sketch_scenes import chancy_times, random_scene

FIRE = [(20.0, 600.0)]


FEW = dataclasses.replace(OURS, rescues=4, steps=8, batch=16, check=1)  # updates of few decisions


def learner(seed: int = 0, scenes: int = 2) -> Learner:
    made = [random_scene(seed) for seed in range(scenes)]
    return Learner(made, made, FIRE, chancy_times(), seed, "value", settings=FEW)


def at_random(sketch: Sketch, chance: np.random.Generator) -> Ints:
    """A random option of each rescue, but for stopping."""
    mask = sketch.mask.copy()
    mask[:, FIRST[END]] &= ~mask[:, : FIRST[END]].any(axis=1)
    return np.asarray((chance.random(mask.shape) * mask).argmax(axis=1))


def test_what_is_sampled_is_allowed_and_the_order_of_targets_changes_no_value() -> None:
    policy = learner().model.policy
    assert isinstance(policy, ActorCritic) and isinstance(policy.chooser, SetPolicy)
    chance, space = np.random.default_rng(0), policy.observation_space
    obs = torch.from_numpy(chance.uniform(space.low, space.high, (500, *space.shape)).astype(np.float32))  # type: ignore[attr-defined]
    mask = chance.random((500, COUNT)) < 0.2
    mask[:, -1] = True
    with torch.no_grad():
        actions, values, chances = policy(obs, action_masks=mask)
        again, same, spread = policy.evaluate_actions(obs, actions, torch.from_numpy(mask))
        targets = policy.chooser.layout.split(obs.numpy())["targets"]
        targets[:] = targets[:, chance.permutation(FIRST[CART])].copy()
        moved = policy.predict_values(obs)
    assert mask[np.arange(500), actions].all() and len(set(actions.tolist())) > 20
    torch.testing.assert_close(again, values)
    torch.testing.assert_close(same, chances)
    assert spread is not None and bool((spread <= torch.from_numpy(mask).sum(-1).log() + 1e-5).all())
    torch.testing.assert_close(moved, values, atol=1e-5, rtol=0)


def test_an_interrupted_training_goes_on_as_it_was() -> None:
    first, told = learner(), list[Check]()
    first.train(64, 60.0, told.append)
    assert told == first.curve and told[-1].decisions == 64
    second = learner(seed=1)
    second.resume(first.saved())
    assert second.curve == first.curve and second.model.num_timesteps == 64
    for one, other in ((first.model.policy, second.model.policy), (first.best, second.best)):
        for name, tensor in one.state_dict().items():
            assert torch.equal(other.state_dict()[name], tensor)
    one, other = (each.model.policy.optimizer.state_dict()["state"][0] for each in (first, second))
    assert torch.equal(one["exp_avg"], other["exp_avg"]) and one["step"] == other["step"] > 0
    second.train(128, 60.0, told.append)
    assert second.curve[: len(first.curve)] == first.curve and second.curve[-1].decisions == 128
    assert second.curve[-1].best == max(check.validation for check in second.curve)
    with pytest.raises(ValueError, match="must be one that hazard_ms saved"):
        second.resume(b"nothing")


def test_an_interrupted_training_does_not_play_its_first_episodes_again() -> None:
    first = learner()
    first.train(32, 60.0, lambda _: None)
    begun = [np.asarray(each.model.env.reset()) for each in (learner(), learner())]  # type: ignore[union-attr]
    assert (begun[0] == begun[1]).all()
    second = learner()
    second.resume(first.saved())
    assert (np.asarray(second.model.env.reset()) != begun[0]).any()  # type: ignore[union-attr]


def test_what_is_saved_has_learnt_from_all_that_it_counts() -> None:
    """The state at each check is that after the update on the decisions before it, and the first of nothing."""
    made, steps = learner(), list[tuple[int, int]]()

    def told(check: Check) -> None:
        state = made.model.policy.optimizer.state_dict()["state"]
        steps.append((check.decisions, int(state[0]["step"]) if state else 0))

    made.train(96, 60.0, told)
    updates = OURS.epochs * 32 // 16  # of a rollout: 32 decisions in batches of 16
    assert steps == [(32 * k, updates * k) for k in range(4)]


def test_training_ends_when_its_time_is_over_and_slows_down_until_then(monkeypatch: pytest.MonkeyPatch) -> None:
    """By a clock that goes on by a second whenever it is read."""
    made, rates, clock = learner(), list[float](), itertools.count()
    monkeypatch.setattr(ppo.time, "monotonic", lambda: float(next(clock)))
    made.train(10**6, 1.0, lambda _: rates.append(made.model.policy.optimizer.param_groups[0]["lr"]))
    assert 32 * 2 < made.model.num_timesteps < 32 * 30 and 59 < made.curve[-1].seconds < 64
    state = made.model.policy.optimizer.state_dict()["state"]
    assert int(state[0]["step"]) == OURS.epochs * made.model.num_timesteps // 16, (
        "it has learnt from all that it counts"
    )
    before = made.model.num_timesteps
    made.train(10**6, 1.0, lambda _: pytest.fail("it is over"))
    assert made.model.num_timesteps == before
    assert rates == sorted(rates, reverse=True) and rates[-1] < 0.5 * rates[0]
    made.progress(1.0)
    found = (made.model.lr_schedule(0.5), made.model.ent_coef)
    assert found == pytest.approx((OURS.rates[1], OURS.entropy[1]), rel=1e-9)
    with pytest.raises(ValueError, match="minutes must be positive, got 0"):
        made.train(10, 0, lambda _: None)


def test_another_policy_can_be_begun_with_and_is_left_as_it_was() -> None:
    start = learner(seed=3).policy
    assert isinstance(start, SetPolicy)
    before = {name: tensor.clone() for name, tensor in start.state_dict().items()}
    made = Learner([random_scene(0)], [random_scene(0)], FIRE, chancy_times(), 0, "paper", start, FEW)
    assert all(torch.equal(made.policy.state_dict()[name], tensor) for name, tensor in before.items())
    made.train(64, 60.0, lambda _: None)
    assert all(torch.equal(start.state_dict()[name], tensor) for name, tensor in before.items())
    assert any(not torch.equal(made.policy.state_dict()[name], tensor) for name, tensor in before.items())


def test_a_line_tells_rate_and_time_left() -> None:
    curve = [Check(k * 1000, k * 2.0, 0.5, 0.5, 0.6, 0.5) for k in range(1, 4)]
    assert line(curve, 303_000, 60.0).startswith("3,000 decisions, 500/s: training 0.500, validation 0.500")
    assert line(curve, 303_000, 60.0).endswith("10 min left") and line(curve, 303_000, 5.1).endswith("5 min left")


@pytest.mark.long
def test_twenty_thousand_decisions_are_twice_as_good_as_chance() -> None:
    """In rooms on fire, among them some that it never saw."""
    scenes, others = more_scenes("HazardFire-v1", "paper", 25, 8), more_scenes("HazardFire-v1", "paper", 1000, 16)
    made = Learner(scenes, others, FIRE, load("fetch"), 0, "value")
    made.train(20_000, 60.0, lambda _: None)
    chance = float(scores(others, load("fetch"), at_random).mean())
    assert made.curve[-1].best > 2.0 * chance, (chance, made.curve)
