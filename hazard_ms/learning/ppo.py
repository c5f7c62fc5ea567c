"""Proximal policy optimisation over options in the sketch, by sb3-contrib's MaskablePPO.

Worlds are drawn from TRAINING, wider than what was measured, so that policies bear what the sketch leaves out. What is
kept is the policy that did best in scenes that none is trained in.
"""

from __future__ import annotations

import io
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
import torch
from sb3_contrib import MaskablePPO
from stable_baselines3.common.callbacks import BaseCallback

from hazard_ms.agents.learned.set_policy import SetPolicy, Shape
from hazard_ms.learning.actor_critic import SetActorCritic
from hazard_ms.learning.cloning import JUDGE, scores
from hazard_ms.learning.playing import Player
from hazard_ms.learning.vec_env import SketchVecEnv
from hazard_ms.sketch.environments.batch import SketchBatch
from hazard_ms.sketch.policies import POLICIES
from hazard_ms.sketch.rescues.features import MISSING
from hazard_ms.sketch.rescues.scene import SketchScene
from hazard_ms.sketch.rescues.state import TRAINING
from hazard_ms.sketch.skill_times import SkillTimes

# [ours], all of them
RESCUES, STEPS = 64, 64  # rescues at once; decisions of each between two updates
BATCH, EPOCHS = 1024, 4  # decisions of a step of the optimiser; passes over the decisions of an update
RATES = (7e-4, 1e-4)  # of learning, at the beginning and at the end
ENTROPY = (0.01, 0.001)  # worth of chance, at the beginning and at the end
DISCOUNT, TRACE, CLIP = 1.0, 0.95, 0.2  # Value counts what is rescued late as much as what is rescued early
WIDTH, HEADS, BLOCKS = 32, 4, 1  # of the policy: three times as quick as that of behaviour cloning
CHECK = 8  # updates from one look at validation scenes to the next
FEW = 3  # validation scenes whose mean Value is kept with a policy, to see later whether it still plays alike


@dataclass(frozen=True)
class Check:
    """The worth of a policy at some time of its training."""

    decisions: int  # so far
    seconds: float  # so far, wall time, without what came before the training
    training: float  # mean Value of the episodes that ended since the last check; if none did, as then
    validation: float  # mean Value in the validation scenes
    greedy: float  # that of the policy `greedy` in the same episodes
    best: float  # greatest validation so far


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
        start: SetPolicy | None = None,
    ) -> None:
        """Make a learner.

        Args:
            scenes: Scenes to learn in.
            validation: Scenes whose Value chooses the policy that is kept.
            ranges: Ends of each hazard's usual level, in its unit.
            times: Skill times of the robot.
            seed: Seed of everything that is random.
            reward: "value" or "paper".
            start: Policy to begin with; by default an untrained one.

        Raises:
            ValueError: For an unknown reward, and for no scenes.
        """
        self._validation, self._times = validation, times
        self._share = 0.0  # of the training that is over
        self.curve: list[Check] = []
        shape = Shape(tuple(ranges), WIDTH, HEADS, BLOCKS, MISSING) if start is None else start.shape
        batch = SketchBatch(scenes, ranges, times, RESCUES, reward, domain=TRAINING)
        self.model = MaskablePPO(
            SetActorCritic,
            SketchVecEnv(batch),
            learning_rate=lambda _: _between(RATES, self._share),
            n_steps=STEPS,
            batch_size=BATCH,
            n_epochs=EPOCHS,
            gamma=DISCOUNT,
            gae_lambda=TRACE,
            clip_range=CLIP,
            ent_coef=ENTROPY[0],
            policy_kwargs={"shape": shape},
            seed=seed,
            device="cpu",
        )
        assert isinstance(self.model.policy, SetActorCritic)
        self.policy = self.model.policy.chooser
        if start is not None:
            self.policy.load_state_dict(start.state_dict())
        self.best = _copied(self.policy)
        self._greedy = float(scores(validation, times, POLICIES[JUDGE]).mean())

    def train(self, decisions: int, minutes: float, told: Callable[[Check], None]) -> None:
        """Learn until there were `decisions` in all, or for `minutes` in all; each check is `told`.

        Raises ValueError for numbers that are not positive.
        """
        for name, number in (("decisions", decisions), ("minutes", minutes)):
            if not number > 0:
                raise ValueError(f"{name} must be positive, got {number}")
        left = decisions - self.model.num_timesteps
        if left > 0:
            watch = _Watch(self, decisions, minutes, told)
            self.model.learn(left, callback=watch, reset_num_timesteps=False)
            watch.check()

    def check(self, seconds: float, values: Sequence[float]) -> Check:
        """Score the policy after `seconds` of training; `values`: those of the episodes that ended since the last."""
        found = float(scores(self._validation, self._times, Player(self.policy).play).mean())
        best = max([each.best for each in self.curve], default=-1.0)
        if found > best:
            self.best = _copied(self.policy)
        training = float(np.mean(values)) if values else self.curve[-1].training if self.curve else 0.0
        made = Check(self.model.num_timesteps, seconds, training, found, self._greedy, max(found, best))
        self.curve.append(made)
        return made

    def value(self) -> float:
        """The mean Value of the best policy so far in the first FEW validation scenes."""
        return float(scores(self._validation[:FEW], self._times, Player(self.best).play).mean())

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
            state = torch.load(io.BytesIO(packed), weights_only=True)
            self.model.policy.load_state_dict(state["policy"])
            self.model.policy.optimizer.load_state_dict(state["optimiser"])
            self.best.load_state_dict(state["best"])
            self.model.num_timesteps = int(state["decisions"])
            self.curve = [Check(**check) for check in state["curve"]]
        except Exception as error:  # torch raises errors of many kinds for a damaged file
            raise ValueError(f"the state of a training must be one that was saved, got {error}") from None

    def progress(self, share: float) -> None:
        """Bring rates to what they are when this `share` of the training is over."""
        self._share = min(share, 1.0)
        self.model.ent_coef = _between(ENTROPY, self._share)


class _Watch(BaseCallback):
    """Keeps the time of a training, and checks the policy every CHECK updates."""

    def __init__(self, learner: Learner, decisions: int, minutes: float, told: Callable[[Check], None]) -> None:
        super().__init__()
        self._learner, self._decisions, self._most, self._told = learner, decisions, 60.0 * minutes, told
        self._start = time.monotonic() - (learner.curve[-1].seconds if learner.curve else 0.0)
        self._values: list[float] = []
        self._rollouts = 0

    def _seconds(self) -> float:
        return time.monotonic() - self._start

    def _on_step(self) -> bool:
        infos: list[dict[str, Any]] = self.locals["infos"]
        self._values += [info["value"] for info in infos if "value" in info]
        return self._seconds() < self._most

    def _on_rollout_end(self) -> None:
        if self._rollouts % CHECK == 0:
            self.check()
        self._rollouts += 1
        share = self._learner.model.num_timesteps / self._decisions
        self._learner.progress(max(share, self._seconds() / self._most))

    def check(self) -> None:
        """Score the policy, and tell it."""
        made = self._learner.check(self._seconds(), self._values)
        self._values = []
        self._told(made)


def _between(ends: tuple[float, float], share: float) -> float:
    return ends[0] + share * (ends[1] - ends[0])


def _copied(policy: SetPolicy) -> SetPolicy:
    made = SetPolicy(policy.shape)
    made.load_state_dict(policy.state_dict())
    return made.eval()
