"""Behaviour cloning over options in the sketch, with rounds in which the student's own rescues are labelled (DAgger).

A student learns from `hazard_ms.learning.labels`: it raises its expected worth, less what keeps it from chance,

    loss = - sum over options of p (worth - mean worth) - SOFT entropy(p)

whose best p is in proportion to exp(expected worth / SOFT). The mean over labels is within the exponent, so that luck
in single labels does not mislead it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor

from hazard_ms.agents.learned.set_policy import SetPolicy, Shape
from hazard_ms.learning.labels import SEEDS, Labels, collect
from hazard_ms.learning.playing import TRIALS, Player
from hazard_ms.sketch.policies import POLICIES, Policy, play
from hazard_ms.sketch.rescues.features import MISSING
from hazard_ms.sketch.rescues.scene import Floats, SketchScene
from hazard_ms.sketch.rescues.state import AGAIN, TRAINING, Domain
from hazard_ms.sketch.skill_times import SkillTimes
from hazard_ms.sketch.world import Sketch

SOFT = 0.02  # value share by which an option must be better to be chosen e times as often [ours]
JUDGE = "greedy"  # the policy that goes on after the options that are tried
STUDENT = 0.7  # share of the options that the student chooses in the rounds after the first
BATCH = 256  # decisions of a step of the optimiser [ours]
RATE = 2e-3  # greatest rate of learning [ours]
DECAY = 1e-3  # of weights [ours]
STEEPEST = 1.0  # norm that gradients are cut to [ours]
EPOCHS = 3  # passes over all labels in a round: ten in the last of five rounds lost 0.02 of Value [ours]


@dataclass(frozen=True)
class Round:
    """The outcome of one round of training."""

    number: int
    labels: int  # in all rounds so far
    student: float  # mean Value on validation scenes
    greedy: float  # that of the policy `greedy` in the same episodes

    def __str__(self) -> str:
        return (
            f"round {self.number}: {self.labels:,} labels, validation Value {self.student:.3f} "
            f"(greedy {self.greedy:.3f})"
        )


class Student:
    """A policy that learns, and plays in the sketch."""

    def __init__(self, ranges: Sequence[tuple[float, float]], seed: int) -> None:
        """Make an untrained student; `ranges`: ends of each hazard's usual level, in its unit."""
        with torch.random.fork_rng(devices=[]):
            torch.manual_seed(seed)
            self.policy = SetPolicy(Shape(tuple(ranges), ignored=MISSING))
        player = Player(self.policy)
        self.encoder, self.play = player.encoder, player.play
        self._chance = torch.Generator().manual_seed(seed)
        mirrored = [column.name == "left" for _, _, _, column in self.encoder.layout.cells()]
        self._mirrored = torch.tensor(mirrored)

    def learn(self, labels: Labels, epochs: int) -> None:
        """Pass over all `labels` in a new order in each of `epochs`, in mirrored rooms half of the time."""
        features, mask, worth = (torch.from_numpy(part) for part in (labels.features, labels.mask, labels.worth))
        steps = epochs * -(-len(features) // BATCH)
        optimiser = torch.optim.AdamW(self.policy.parameters(), RATE, weight_decay=DECAY)
        rates = torch.optim.lr_scheduler.OneCycleLR(optimiser, RATE, total_steps=steps)
        self.policy.train()
        for _ in range(epochs):
            for some in torch.randperm(len(features), generator=self._chance).split(BATCH):
                turned = (torch.rand(len(some), 1, generator=self._chance) < 0.5) & self._mirrored
                seen = torch.where(turned, -features[some], features[some])
                optimiser.zero_grad()
                loss(self.policy(seen, mask[some]), mask[some], worth[some]).backward()
                torch.nn.utils.clip_grad_norm_(self.policy.parameters(), STEEPEST)
                optimiser.step()
                rates.step()
        self.policy.eval()


def loss(logits: Tensor, mask: Tensor, worth: Tensor) -> Tensor:
    """The mean over decisions of what a policy should make small, from `logits`, `mask` and `worth`, [N, A] each."""
    sure = logits.log_softmax(-1)
    share = sure.exp()
    mean = (worth * mask).sum(-1, keepdim=True) / mask.sum(-1, keepdim=True)
    gained = (share * (worth - mean) * mask).sum(-1)
    return -(gained - SOFT * (share * sure * mask).sum(-1)).mean()


def scores(scenes: Sequence[SketchScene], times: SkillTimes, policy: Policy) -> Floats:
    """The Values of TRIALS rescues in each of `scenes`, with the seeds 0, 1, ..., as `policy` plays: [TRIALS, W]."""
    seeds = np.arange(TRIALS * len(scenes))
    sketch = Sketch(scenes, times, len(seeds), Domain(again=AGAIN))
    sketch.reset(seeds % len(scenes), seeds)
    play(sketch, policy)
    return sketch.state.score.reshape(TRIALS, len(scenes))


def train(
    student: Student,
    scenes: Sequence[SketchScene],
    validation: Sequence[SketchScene],
    times: SkillTimes,
    seed: int,
    rounds: int,
    episodes: int,
    told: Callable[[Round], None],
) -> list[Round]:
    """Train `student` in `scenes` for `rounds` of `episodes` each; afterwards it is as after its best round.

    The best is that of the highest mean Value in the scenes `validation`. Each round is `told`. Raises ValueError for
    numbers below 1.
    """
    for name, number in (("rounds", rounds), ("episodes", episodes)):
        if number < 1:
            raise ValueError(f"{name} must be at least 1, got {number}")
    chance, judge = np.random.default_rng(seed), POLICIES[JUDGE]
    usual, made = float(scores(validation, times, judge).mean()), list[Round]()
    sketch = Sketch(scenes, times, episodes, TRAINING)
    labels, best = None, None
    for number in range(rounds):
        sketch.reset(chance.integers(len(scenes), size=episodes), chance.integers(SEEDS, size=episodes))
        new = collect(sketch, student.encoder, student.play, judge, STUDENT if number else 0.0, chance)
        labels = new if labels is None else labels + new
        student.learn(labels, EPOCHS)
        made.append(Round(number, len(labels.mask), float(scores(validation, times, student.play).mean()), usual))
        if best is None or made[-1].student > best[0]:
            best = made[-1].student, {name: part.clone() for name, part in student.policy.state_dict().items()}
        told(made[-1])
    assert best is not None
    student.policy.load_state_dict(best[1])
    return made
