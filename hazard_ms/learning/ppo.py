"""Proximal policy optimisation in the sketch, by sb3-contrib's MaskablePPO, over options or the six actions.

Where masks allow everything, as those of the six actions do, it is Stable-Baselines3's PPO.

Worlds are drawn from TRAINING, wider than what was measured, so that policies bear what the sketch leaves out. What is
kept is the policy that did best in scenes that none is trained in.
"""

from __future__ import annotations

import io
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np
import torch
from sb3_contrib import MaskablePPO
from stable_baselines3.common.callbacks import BaseCallback

from hazard_ms.agents.learned.map_policy import MapPolicy, MapShape
from hazard_ms.agents.learned.set_policy import SetPolicy, Shape
from hazard_ms.agents.learned.weights import stored, unpacked_state
from hazard_ms.learning.actor_critic import ActorCritic
from hazard_ms.learning.checks import Check, curve_of, ended
from hazard_ms.learning.cloning import JUDGE, scores
from hazard_ms.learning.playing import MapPlayer, Player, six_scores
from hazard_ms.learning.settings import OURS, Settings
from hazard_ms.learning.vec_env import SketchVecEnv
from hazard_ms.sketch.environments.batch import SketchBatch
from hazard_ms.sketch.environments.choices import OPTIONS
from hazard_ms.sketch.paper.maps import MISSING as MISSING_PLANES
from hazard_ms.sketch.policies import POLICIES
from hazard_ms.sketch.rescues.features import MISSING
from hazard_ms.sketch.rescues.scene import SketchScene
from hazard_ms.sketch.rescues.state import TRAINING
from hazard_ms.sketch.skill_times import SkillTimes

WIDTH, HEADS, BLOCKS = 32, 4, 1  # of the policy over options: three times as quick as that of behaviour cloning
SHARE = 0.5  # of the widths of the original's network: policies for all tasks stay below 1.5 MB
FEW = 3  # validation scenes whose mean Value is kept with a policy, to see later whether it still plays alike


class Learner:
    """A policy that learns, with all that is needed to go on after an interruption."""

    def __init__(
        self,
        scenes: Sequence[SketchScene],
        validation: Sequence[SketchScene],
        ranges: Sequence[tuple[float, float]],
        times: SkillTimes,
        seed: int,
        reward: str,
        start: SetPolicy | MapPolicy | None = None,
        settings: Settings = OURS,
        shape: Shape | MapShape | None = None,
    ) -> None:
        """Make a learner.

        Args:
            scenes: Scenes to learn in.
            validation: Scenes whose Value chooses the policy that is kept.
            ranges: Ends of each hazard's usual level, in its unit.
            times: Skill times of the robot.
            seed: Seed of everything that is random.
            reward: "value" or "paper".
            start: Policy to begin with; by default an untrained one of `shape`.
            settings: Settings of the training, and what its actions mean.
            shape: Architecture of the policy; by default one that fits the actions.

        Raises:
            ValueError: For an unknown reward, and for no scenes.
        """
        self._validation, self._times, self.settings, self._seed = validation, times, settings, seed
        self._share = 0.0  # of the training that is over
        self.curve: list[Check] = []
        shape = start.shape if start is not None else shape or shape_for(settings.actions, ranges)
        masked = isinstance(shape, MapShape) and shape.masked
        batch = SketchBatch(
            scenes, ranges, times, settings.rescues, reward, domain=TRAINING, actions=settings.actions, masked=masked
        )
        self.model = MaskablePPO(
            ActorCritic,
            SketchVecEnv(batch, settings.scale),
            learning_rate=lambda _: _between(settings.rates, self._share),
            n_steps=settings.steps,
            batch_size=settings.batch,
            n_epochs=settings.epochs,
            gamma=settings.discount,
            gae_lambda=settings.trace,
            clip_range=settings.clip,
            ent_coef=settings.entropy[0],
            policy_kwargs={"shape": shape},
            seed=seed,
            device="cpu",
        )
        assert isinstance(self.model.policy, ActorCritic)
        self.policy = self.model.policy.chooser
        if start is not None:
            self.policy.load_state_dict(start.state_dict())
        self.best = _copied(self.policy)
        self._greedy = float(scores(validation, times, POLICIES[JUDGE]).mean())

    def train(self, decisions: int, minutes: float, told: Callable[[Check], None]) -> None:
        """Learn until there were `decisions` in all, or for `minutes` in all, or until it is stuck; checks are `told`.

        Raises ValueError for numbers that are not positive.
        """
        for name, number in (("decisions", decisions), ("minutes", minutes)):
            if not number > 0:
                raise ValueError(f"{name} must be positive, got {number}")
        if not ended(self.curve, self.settings, decisions, minutes):
            watch = _Watch(self, decisions, minutes, told)
            self.model.learn(decisions - self.model.num_timesteps, callback=watch, reset_num_timesteps=False)
            watch.check()

    def check(self, seconds: float, values: Sequence[float]) -> Check:
        """Score the policy after `seconds` of training; `values`: those of the episodes that ended since the last."""
        found = value_of(self.policy, self._validation, self._times)
        best = max([each.best for each in self.curve], default=-1.0)
        if found > best:
            self.best = _copied(self.policy)
        training = float(np.mean(values)) if values else self.curve[-1].training if self.curve else 0.0
        made = Check(self.model.num_timesteps, seconds, training, found, self._greedy, max(found, best))
        self.curve.append(made)
        return made

    def value(self) -> float:
        """The mean Value of the best policy so far in the first FEW validation scenes."""
        return value_of(self.best, self._validation[:FEW], self._times)

    def saved(self) -> bytes:
        """All that is needed to go on: plain numbers and tensors."""
        state = {
            "policy": self.model.policy.state_dict(),
            "optimiser": self.model.policy.optimizer.state_dict(),
            "best": self.best.state_dict(),
            "decisions": self.model.num_timesteps,
            "curve": [asdict(check) for check in self.curve],
        }
        packed = io.BytesIO()
        torch.save(state, packed)
        return packed.getvalue()

    def resume(self, packed: bytes) -> None:
        """Go on from what `saved` gave. Raises ValueError for anything else."""
        try:
            state = unpacked_state(packed)
            self.curve = curve_of(packed)
            self.model.policy.load_state_dict(state["policy"])
            self.model.policy.optimizer.load_state_dict(state["optimiser"])
            self.best.load_state_dict(state["best"])
            self.model.num_timesteps = int(state["decisions"])
            self.model.set_random_seed(self._seed + self.model.num_timesteps)  # or the first episodes come again
        except Exception as error:  # torch raises errors of many kinds for a damaged file
            raise ValueError(f"the training state must be one that hazard_ms saved, got {error}") from None

    def progress(self, share: float) -> None:
        """Bring rates to what they are when this `share` of the training is over."""
        self._share = min(share, 1.0)
        self.model.ent_coef = _between(self.settings.entropy, self._share)


class _Watch(BaseCallback):
    """Keeps the time of a training, and checks the policy every so many updates.

    It ends a training only between updates, so that what was played has been learnt from.
    """

    def __init__(self, learner: Learner, decisions: int, minutes: float, told: Callable[[Check], None]) -> None:
        super().__init__()
        self._learner, self._decisions, self._most, self._told = learner, decisions, 60.0 * minutes, told
        self._start = time.monotonic() - (learner.curve[-1].seconds if learner.curve else 0.0)
        self._values: list[float] = []
        self._rollouts, self._over = 0, False

    def _seconds(self) -> float:
        return time.monotonic() - self._start

    def _on_step(self) -> bool:
        infos: list[dict[str, Any]] = self.locals["infos"]
        self._values += [info["value"] for info in infos if "value" in info]
        if self._over:  # the step that was made since will never be learnt from
            self._learner.model.num_timesteps -= self.training_env.num_envs
        return not self._over

    def _on_rollout_start(self) -> None:
        if self._rollouts % self._learner.settings.check == 0:  # before it plays on: what was played has been learnt
            self.check()
        self._rollouts += 1
        learner = self._learner
        self._over = self._seconds() >= self._most or ended(learner.curve, learner.settings, self._decisions, np.inf)

    def _on_rollout_end(self) -> None:
        share = self._learner.model.num_timesteps / self._decisions
        self._learner.progress(max(share, self._seconds() / self._most))

    def check(self) -> None:
        """Score the policy, and tell it, unless it is as it was at the last check."""
        if self._learner.curve and self._learner.curve[-1].decisions == self._learner.model.num_timesteps:
            return
        made = self._learner.check(self._seconds(), self._values)
        self._values = []
        self._told(made)


def _between(ends: tuple[float, float], share: float) -> float:
    return ends[0] + share * (ends[1] - ends[0])


def shape_for(
    actions: str,
    ranges: Sequence[tuple[float, float]],
    share: float = SHARE,
    masked: bool = False,
    measures: bool = False,
) -> Shape | MapShape:
    """The usual shape of a policy for "options" or "paper" that learns in the sketch.

    `share` of the widths of the original's network, and whether actions are `masked`, are those of "paper"; `measures`
    of "options": whether some are about a fire.
    """
    if actions == OPTIONS:
        return Shape(tuple(ranges), WIDTH, HEADS, BLOCKS, MISSING, measures)
    return MapShape(tuple(ranges), share=share, masked=masked, ignored=MISSING_PLANES, at_things=True)


def value_of(policy: SetPolicy | MapPolicy, scenes: Sequence[SketchScene], times: SkillTimes) -> float:
    """The mean Value of a policy in `scenes`."""
    if isinstance(policy, MapPolicy):
        return float(six_scores(scenes, times, MapPlayer(policy).play).mean())
    return float(scores(scenes, times, Player(policy).play).mean())


def _copied(policy: SetPolicy | MapPolicy) -> SetPolicy | MapPolicy:
    """A copy that is rounded as its file is."""
    made = type(policy)(policy.shape)  # type: ignore[arg-type]
    made.load_state_dict(stored(policy))
    return made.eval()
