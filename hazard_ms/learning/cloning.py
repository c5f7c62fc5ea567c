"""Behaviour cloning over options: from recorded choices, or from labels that the sketch gives.

In the sketch, there are rounds in which the student's own rescues are labelled (DAgger).

There, a student learns from `hazard_ms.learning.labels`: it raises its expected worth, less what keeps it from chance,

    loss = - sum over options of p (worth - mean worth) - SOFT entropy(p)

whose best p is in proportion to exp(expected worth / SOFT). The mean over labels is within the exponent, so that luck
in single labels does not mislead it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor
from torch.nn.functional import cross_entropy

from hazard_ms.agents.learned.choices import Choices
from hazard_ms.agents.learned.set_policy import SetPolicy, Shape
from hazard_ms.learning.labels import SEEDS, Labels, collect
from hazard_ms.learning.playing import TRIALS, Player
from hazard_ms.sketch.policies import POLICIES, Policy, fighter, play
from hazard_ms.sketch.rescues.features import MISSING
from hazard_ms.sketch.rescues.scene import Floats, SketchScene
from hazard_ms.sketch.rescues.state import AGAIN, TRAINING, Domain
from hazard_ms.sketch.skill_times import SkillTimes
from hazard_ms.sketch.world import Sketch

SOFT = 0.02  # value share by which an option must be better to be chosen e times as often [ours]
JUDGE = "greedy"  # the policy that goes on after the options that are tried, in the first rounds
JUDGED = 2  # rounds; afterwards the student itself goes on, which raised its Value in flood from 0.68 to 0.69 [ours]
CHOICE_TRIALS = 40  # rescues in each validation scene: luck moves the mean of 24 scenes by 0.007 [ours]
STUDENT = 0.7  # share of the options that the student chooses in the rounds after the first
BATCH = 256  # decisions of a step of the optimiser [ours]
RATE = 2e-3  # greatest rate of learning [ours]
DECAY = 1e-3  # of weights [ours]
STRONG_DECAY = 0.05  # of weights that learn from recordings, which are few [ours]
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

    def __init__(self, ranges: Sequence[tuple[float, float]], seed: int, measures: bool = False) -> None:
        """Make an untrained student; `ranges`: ends of each hazard's usual level, in its unit.

        `measures`: whether its options have measures about a fire.
        """
        with torch.random.fork_rng(devices=[]):
            torch.manual_seed(seed)
            self.policy = SetPolicy(Shape(tuple(ranges), ignored=MISSING, measures=measures))
        player = Player(self.policy)
        self.encoder, self.play = player.encoder, player.play
        self._chance = torch.Generator().manual_seed(seed)
        mirrored = [column.name == "left" for _, _, _, column in self.encoder.layout.cells()]
        self._mirrored = torch.tensor(mirrored)

    def learn(self, labels: Labels, epochs: int) -> None:
        """Pass over all `labels` in a new order in each of `epochs`, in mirrored rooms half of the time."""
        worth = torch.from_numpy(labels.worth)
        self._pass(labels.features, labels.mask, epochs, DECAY, lambda logits, mask, r: loss(logits, mask, worth[r]))

    def imitate(self, choices: Choices, epochs: int) -> None:
        """Pass over recorded `choices` as `learn` does over labels, and make what was chosen likelier."""
        chosen = torch.from_numpy(choices.option)
        self._pass(
            choices.features, choices.mask, epochs, STRONG_DECAY, lambda logits, _, r: cross_entropy(logits, chosen[r])
        )

    def agreement(self, choices: Choices) -> float:
        """The share of recorded `choices` that this student would choose, too."""
        own = self.policy.choose(torch.from_numpy(choices.features), torch.from_numpy(choices.mask))
        return float((own.numpy() == choices.option).mean())

    def _pass(
        self,
        features: NDArray[np.float32],
        mask: NDArray[np.bool_],
        epochs: int,
        decay: float,
        cost: Callable[[Tensor, Tensor, Tensor], Tensor],
    ) -> None:
        """Make `cost` of the logits, the masks and the numbers of decisions small, in `epochs` passes over all."""
        seen, allowed = torch.from_numpy(features), torch.from_numpy(mask)
        steps = epochs * -(-len(seen) // BATCH)
        optimiser = torch.optim.AdamW(self.policy.parameters(), RATE, weight_decay=decay)
        rates = torch.optim.lr_scheduler.OneCycleLR(optimiser, RATE, total_steps=steps)
        self.policy.train()
        for _ in range(epochs):
            for some in torch.randperm(len(seen), generator=self._chance).split(BATCH):
                turned = (torch.rand(len(some), 1, generator=self._chance) < 0.5) & self._mirrored
                optimiser.zero_grad()
                logits = self.policy(torch.where(turned, -seen[some], seen[some]), allowed[some])
                cost(logits, allowed[some], some).backward()
                torch.nn.utils.clip_grad_norm_(self.policy.parameters(), STEEPEST)
                optimiser.step()
                rates.step()
        self.policy.eval()


def imitate(student: Student, found: Choices, passes: int, told: Callable[[str], None]) -> dict[str, dict[str, float]]:
    """Train `student` on recorded choices in some `passes` over all but those of every tenth episode.

    Returns how many decisions there were of both kinds, and in what share it chooses as the teacher; each is `told`.
    """
    learnt, held_out = found.split()
    student.imitate(learnt, passes)
    made = {}
    for name, part in (("learnt from", learnt), ("held out", held_out)):
        if count := len(part.option):
            made[name] = {"decisions": count, "agreement": student.agreement(part)}
            told(f"{count:,} decisions {name}: it agrees with the teacher in {made[name]['agreement']:.1%}")
    return made


def loss(logits: Tensor, mask: Tensor, worth: Tensor) -> Tensor:
    """The mean over decisions of what a policy should make small, from `logits`, `mask` and `worth`, [N, A] each."""
    sure = logits.log_softmax(-1)
    share = sure.exp()
    mean = (worth * mask).sum(-1, keepdim=True) / mask.sum(-1, keepdim=True)
    gained = (share * (worth - mean) * mask).sum(-1)
    return -(gained - SOFT * (share * sure * mask).sum(-1)).mean()


def scores(scenes: Sequence[SketchScene], times: SkillTimes, policy: Policy, trials: int = TRIALS) -> Floats:
    """The Values of `trials` rescues in each of `scenes`, with the seeds 0, 1, ..., as `policy` plays: [trials, W]."""
    seeds = np.arange(trials * len(scenes))
    sketch = Sketch(scenes, times, len(seeds), Domain(again=AGAIN))
    sketch.reset(seeds % len(scenes), seeds)
    play(sketch, policy)
    return sketch.state.score.reshape(trials, len(scenes))


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

    In the first JUDGED rounds, JUDGE, or `fighter` where there are fires to put out, plays on after the options that
    are tried, then the student. The best round is that of the highest mean Value in the scenes `validation`. Each round
    is `told`. Raises ValueError for numbers below 1.
    """
    for name, number in (("rounds", rounds), ("episodes", episodes)):
        if number < 1:
            raise ValueError(f"{name} must be at least 1, got {number}")
    chance, usual, made = np.random.default_rng(seed), _value(validation, times, POLICIES[JUDGE]), list[Round]()
    sketch = Sketch(scenes, times, episodes, TRAINING)
    judge = fighter if sketch.stack.measures else POLICIES[JUDGE]
    labels, best = None, None
    for number in range(rounds):
        sketch.reset(chance.integers(len(scenes), size=episodes), chance.integers(SEEDS, size=episodes))
        judge = judge if number < JUDGED else student.play
        new = collect(sketch, student.encoder, student.play, judge, STUDENT if number else 0.0, chance)
        labels = new if labels is None else labels + new
        student.learn(labels, EPOCHS)
        made.append(Round(number, len(labels.mask), _value(validation, times, student.play), usual))
        if best is None or made[-1].student > best[0]:
            best = made[-1].student, {name: part.clone() for name, part in student.policy.state_dict().items()}
        told(made[-1])
    assert best is not None
    student.policy.load_state_dict(best[1])
    return made


def _value(scenes: Sequence[SketchScene], times: SkillTimes, policy: Policy) -> float:
    return float(scores(scenes, times, policy, CHOICE_TRIALS).mean())
